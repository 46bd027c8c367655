//! Sources at infinity as rays see them that leave the scene, and aimed rays at their goal.

use crate::materials::Finish;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::sources::{Emitter, SourceId};
use crate::walk::Walk;
use ambit_base::{DVec3, FAR, Rgb};
use ambit_scene::{ObjectId, VOID};
use ambit_trace::Hit;
use std::f64::consts::PI;

impl<O: Observer> Walk<'_, O> {
    /// Shades a ray that leaves the scene with the distant source it falls in, if any.
    pub(crate) fn distant(&mut self, ray: &mut Ray<'_>) {
        let Some(modifier) = self.meet_distant(ray) else { return };
        if !self.shade_with(ray, modifier, Finish { pattern: Rgb::ONE, tilt: DVec3::ZERO }) {
            ray.hit = None;
        }
    }

    /// Lets a ray that leaves the scene hit the distant source it falls in, if any; returns the source's modifier.
    pub(crate) fn meet_distant(&self, ray: &mut Ray<'_>) -> Option<ObjectId> {
        ray.distance = FAR;
        ray.point = ray.origin;
        let source = &self.tracer.scene.sources[self.find_distant(ray)? as usize];
        // Not its negation, of which a coordinate of 0 would be -0 in what is printed.
        ray.hit = Some(stand_in(source.object, source.modifier, FAR, DVec3::ZERO - ray.direction));
        Some(source.modifier)
    }

    fn find_distant(&self, ray: &Ray<'_>) -> Option<SourceId> {
        let scene = self.tracer.scene;
        let within = |id: SourceId| {
            let s = &scene.sources[id as usize];
            s.image.is_none()
                && matches!(s.emitter, Emitter::Distant)
                && 2.0 * PI * (1.0 - s.centre.dot(ray.direction)) <= s.size
        };
        if let Some(target) = ray.target {
            return within(target).then_some(target);
        }
        let mut glow = None;
        let mut clear = false;
        for &id in &scene.distant {
            if !within(id) {
                continue;
            }
            let source = &scene.sources[id as usize];
            if source.glow || !source.sampled {
                glow = glow.or(Some(id));
            } else if source.clear {
                clear = true;
            } else {
                return Some(id);
            }
        }
        if clear && ray.lineage.meets(Kinds::INDIRECT) {
            return None;
        }
        glow
    }

    /// True if the ray is aimed at the source it has hit.
    pub(crate) fn is_target(&self, ray: &Ray<'_>) -> bool {
        let (Some(target), Some(hit)) = (ray.target, &ray.hit) else { return false };
        let source = &self.tracer.scene.sources[target as usize];
        source.image.is_none() && source.object == hit.object
    }

    /// Radiance of a patterned source towards a ray's point, nothing in between: the source's own modifiers are
    /// evaluated where the line in direction `l` meets it.
    pub(crate) fn source_value(&mut self, ray: &Ray<'_>, id: SourceId, l: DVec3) -> Rgb {
        let source = &self.tracer.scene.sources[id as usize];
        let Some((distance, normal)) = source.intersect(ray.point, l) else { return Rgb::ZERO };
        let (child, _) = ray.spawn(Kinds::SHADOW_REFLECTED, l, None, &self.tracer.options.limits, 0);
        let mut child = child.aimed(id);
        child.distance = distance;
        child.point = if distance < FAR { child.origin + l * distance } else { child.origin };
        child.hit = Some(stand_in(source.object, source.modifier, distance, normal));
        if let Some(hit) = &mut child.hit {
            hit.cosine = -l.dot(normal);
        }
        let modifier = source.modifier;
        self.shade_with(&mut child, modifier, Finish { pattern: Rgb::ONE, tilt: DVec3::ZERO });
        child.value
    }
}

/// A hit that no search has found.
pub(crate) fn stand_in(object: ObjectId, modifier: ObjectId, distance: f64, normal: DVec3) -> Hit {
    Hit {
        distance,
        object,
        modifier,
        normal,
        cosine: 1.0,
        placement: None,
        uv: [0.0; 2],
        tilt: DVec3::ZERO,
        mesh_triangle: false,
    }
}

/// The hit of a sensor that no surface carries.
pub(crate) fn sensor(distance: f64, normal: DVec3) -> Hit {
    stand_in(VOID, VOID, distance, normal)
}
