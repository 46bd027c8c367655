//! antimatter: volumes in which listed modifiers are invisible.

use crate::materials::Finish;
use crate::observer::Observer;
use crate::prepare::Node;
use crate::ray::{ClipSet, Kinds, Ray};
use crate::walk::Walk;
use ambit_scene::{ObjectId, VOID};
use std::sync::{PoisonError, RwLock};

/// Arguments of antimatter.
#[derive(Clone, Debug)]
pub(crate) struct Antimatter {
    /// What shades the cut, or [`VOID`].
    pub(crate) first: ObjectId,
    /// Modifiers that vanish inside, ascending.
    pub(crate) listed: Box<[ObjectId]>,
}

/// The sets of modifiers that rays have made invisible, by number. Only scenes with antimatter ever add one.
#[derive(Debug, Default)]
pub(crate) struct ClipSets {
    sets: RwLock<Vec<Box<[ObjectId]>>>,
}

impl ClipSets {
    /// True if `set` holds `modifier`.
    pub(crate) fn contains(&self, set: ClipSet, modifier: ObjectId) -> bool {
        self.with(set, |s| s.binary_search(&modifier).is_ok())
    }

    fn with<R>(&self, set: ClipSet, f: impl FnOnce(&[ObjectId]) -> R) -> R {
        let sets = self.sets.read().unwrap_or_else(PoisonError::into_inner);
        f(if set == 0 { &[] } else { &sets[set as usize - 1] })
    }

    /// `set` with the listed modifiers added, or taken away.
    fn changed(&self, set: ClipSet, listed: &[ObjectId], add: bool) -> ClipSet {
        let mut members = self.with(set, <[ObjectId]>::to_vec);
        members.retain(|m| !listed.contains(m));
        if add {
            members.extend_from_slice(listed);
            members.sort_unstable();
        }
        if members.is_empty() {
            return 0;
        }
        let mut sets = self.sets.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(i) = sets.iter().position(|s| **s == *members) {
            return i as ClipSet + 1;
        }
        sets.push(members.into());
        sets.len() as ClipSet
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn antimatter(&mut self, ray: &mut Ray<'_>, m: &Antimatter, bare: &Finish) -> bool {
        let front = ray.cosine() > 0.0;
        ray.next_clipped = self.tracer.scene.clip_sets.changed(ray.clipped, &m.listed, front);
        if m.first == VOID || self.inside(ray, m) <= 0 {
            return false;
        }
        // The cut shows the inside of what was clipped: the surface, and its textures, as seen from behind.
        if let Some(hit) = &mut ray.hit {
            hit.normal = -hit.normal;
            hit.cosine = -hit.cosine;
        }
        self.shade_with(ray, m.first, Finish { tilt: -bare.tilt, ..*bare })
    }

    /// How many more clipped surfaces the ray's ancestors entered than left. What a ray leaves through counts as entered
    /// where its material has turned it to the viewer.
    fn inside(&self, ray: &Ray<'_>, m: &Antimatter) -> i32 {
        let mut count = 0;
        let mut link = ray;
        while let Some(parent) = link.parent {
            let reflected = Kinds::REFLECTED.union(Kinds::SPECULAR_REFLECTED).union(Kinds::AMBIENT_REFLECTED);
            // Where it was reflected, a ray did not cross.
            if !link.kind.meets(reflected.union(Kinds::SHADOW_REFLECTED))
                && let Some(hit) = &parent.hit
                && m.listed.binary_search(&hit.modifier).is_ok()
            {
                let entered = hit.cosine > 0.0 || self.turned(parent);
                count += if entered { 1 } else { -1 };
            }
            link = parent;
        }
        count
    }

    /// True if the ray has been shaded by a material that looks the same from both sides. Backs that are not visible let it
    /// pass as it is.
    fn turned(&self, ray: &Ray<'_>) -> bool {
        let of = |id| self.tracer.scene.modifiers.get(id).0;
        self.tracer.options.back_visible
            && ray.material != VOID
            && matches!(of(ray.material), Node::Material(m) if m.is_two_sided())
    }
}
