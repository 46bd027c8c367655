//! light, illum, glow and spotlight: what a ray that meets an emitter sees.

use super::mirror::Alternate;
use super::{Facing, Finish};
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::sources::Spot;
use crate::walk::Walk;
use ambit_base::{EPSILON, Rgb};
use ambit_scene::{Kind, VOID};

/// Arguments of a light-source material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    pub(crate) kind: Kind,
    pub(crate) emission: Rgb,
    /// Largest distance of direct light from a glow.
    pub(crate) radius: f64,
    pub(crate) spot: Option<Spot>,
    /// What an illum is to rays that are not aimed at it.
    pub(crate) alternate: Option<Alternate>,
}

impl Light {
    /// True if a shadow ray aimed at something else ends here.
    pub(crate) fn blocks(&self) -> bool {
        self.kind != Kind::Illum
    }

    /// A glow that is farther than its radius acts as an ordinary surface in the ambient calculation.
    fn glows_from(&self, distance: f64) -> bool {
        self.kind == Kind::Glow && self.radius >= -EPSILON && distance > self.radius
    }

    /// An illum that lets rays pass which are not aimed at it.
    pub(crate) fn is_clear_illum(&self) -> bool {
        self.kind == Kind::Illum && matches!(self.alternate, None | Some(Alternate::Void))
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn light(&mut self, ray: &mut Ray<'_>, m: &Light, finish: Finish, bare: &Finish) -> bool {
        let front = ray.cosine() > 0.0;
        let indirect = ray.lineage.meets(Kinds::INDIRECT) && !ray.is_shadow();
        if indirect && front && !m.glows_from(ray.distance) {
            ray.discount();
            return true;
        }
        let aimed_here = self.is_target(ray);
        if let Some(target) = ray.target
            && !aimed_here
        {
            if m.kind != Kind::Illum {
                return true;
            }
            let source = &self.tracer.scene.sources[target as usize];
            if front && source.image.is_none() && (source.illum || source.glow) {
                return true;
            }
        }
        if m.kind == Kind::Illum && !aimed_here {
            let id = match m.alternate {
                Some(Alternate::Modifier(id)) => id,
                _ => VOID,
            };
            return self.shade_with(ray, id, *bare);
        }
        let far_glow = m.kind == Kind::Glow && m.radius >= 0.0 && ray.travelled + ray.distance > m.radius;
        if !self.tracer.options.direct.visible && !ray.is_shadow() && !far_glow {
            ray.discount();
            return true;
        }
        if !front {
            return self.tracer.options.back_visible;
        }
        ray.normal = ray.hit.as_ref().map_or(-ray.direction, |_| Facing::of(ray, finish.tilt, false).normal);
        if let Some(spot) = &m.spot
            && -spot.aim.dot(ray.direction) < spot.cosine
        {
            return true;
        }
        ray.value = m.emission * finish.pattern;
        true
    }
}
