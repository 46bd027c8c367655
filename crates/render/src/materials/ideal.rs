//! What ideal surfaces do with a ray: one child that is reflected, or one that passes, and what that makes of the
//! lengths of the path. Also the test whether a hit from behind counts.

use super::Facing;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{DVec3, Rgb};

/// Tags of the random numbers of children.
const REFLECTED: u64 = 2;
const PASSED: u64 = 3;

impl<O: Observer> Walk<'_, O> {
    /// The hit's normals turned to the viewer, noted in the ray; None if it comes from behind and `-bv` is off.
    pub(super) fn visible_side(&self, ray: &mut Ray<'_>, tilt: DVec3) -> Option<Facing> {
        if ray.cosine() < 0.0 && !self.tracer.options.back_visible {
            return None;
        }
        let facing = Facing::of(ray, tilt, true);
        ray.normal = facing.normal;
        Some(facing)
    }

    /// Follows `direction`, the mirrored one, and adds what comes from there as the ray's mirrored light. Its length goes on
    /// beyond the surface only if that is flat and `straight`.
    pub(super) fn reflect(&mut self, ray: &mut Ray<'_>, direction: DVec3, coefficient: Rgb, straight: bool) {
        let Some(mut child) = self.child(ray, Kinds::REFLECTED, direction, coefficient, REFLECTED) else { return };
        self.evaluate(&mut child);
        let light = child.coefficient * child.value;
        let beyond = child.length_of(light);
        ray.value += light;
        ray.mirrored = light;
        ray.mirrored_length = ray.distance;
        if straight && self.is_flat(ray) {
            ray.mirrored_length += beyond;
        }
    }

    /// Goes on through a thin surface and adds what comes from there. The ray's length goes on only if that is `straight`.
    pub(super) fn pass(&mut self, ray: &mut Ray<'_>, direction: DVec3, coefficient: Rgb, straight: bool) {
        let Some(mut child) = self.child(ray, Kinds::TRANSFERRED, direction, coefficient, PASSED) else { return };
        self.evaluate(&mut child);
        let light = child.coefficient * child.value;
        let beyond = child.length_of(light);
        ray.value += light;
        if straight {
            ray.unmirrored_length = ray.distance + beyond;
        }
    }
}
