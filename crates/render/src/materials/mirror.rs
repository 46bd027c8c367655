//! mirror: a perfect mirror that relays light sources as virtual ones.

use super::{Facing, Finish, mirror_direction};
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::Rgb;
use ambit_scene::{ObjectId, VOID};
use ambit_trace::Opacity;

/// Arguments of mirror.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mirror {
    pub(crate) colour: Rgb,
    pub(crate) alternate: Option<Alternate>,
}

/// The material that stands in where the mirror is not to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alternate {
    /// `void`, or a name that nothing bears: the ray passes.
    Void,
    /// A named modifier.
    Modifier(ObjectId),
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn mirror(&mut self, ray: &mut Ray<'_>, m: &Mirror, finish: Finish, bare: &Finish) -> bool {
        let relayed = self.relays_target(ray);
        if let (Some(alternate), None) = (m.alternate, relayed) {
            let id = match alternate {
                Alternate::Void => VOID,
                Alternate::Modifier(id) => id,
            };
            let seen = ray.cosine() < 0.0 || !ray.lineage.meets(Kinds::INDIRECT);
            if seen || self.tracer.scene.modifiers.opacity(id) == Opacity::Transparent {
                return self.shade_with(ray, id, *bare);
            }
        }
        // What looks for another source finds nothing here.
        if ray.target.is_some() && relayed.is_none() {
            return true;
        }
        if ray.cosine() < 0.0 {
            return self.tracer.options.back_visible;
        }
        let facing = Facing::of(ray, finish.tilt, true);
        ray.normal = facing.normal;
        let k = m.colour * finish.pattern;
        let plain = relayed.is_some() || ray.is_ambient() || !facing.textured;
        let direction = if plain {
            let n = facing.geometric;
            ray.direction - n * (2.0 * ray.direction.dot(n))
        } else {
            mirror_direction(ray.direction, &facing)
        };
        let Some(mut child) = self.child(ray, Kinds::REFLECTED, direction, k, 2) else { return true };
        child.target = relayed;
        self.evaluate(&mut child);
        let light = child.coefficient * child.value;
        let beyond = child.length_of(light);
        ray.value += light;
        ray.mirrored = light;
        ray.mirrored_length = ray.distance;
        if self.is_flat(ray) && plain {
            ray.mirrored_length += beyond;
        }
        true
    }
}
