//! Hemispheres off the edges where surfaces meet.
//!
//! A view that looks straight along a room, as those of many boxes do, has pixels on the very line where wall and floor
//! meet. A hemisphere there leaves through the floor: it begins in the floor's plane, and what is nearer than ε is no hit.
//! Its record, half of it dark, would serve all around. So it stands a little beside the edge, where the wall's irradiance
//! goes towards what it is at its end. Hemispheres that are not kept (`-aa 0`) stand where the ray ends, as in Radiance.

use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Vec3};

/// How far off an edge hemispheres stand: far enough, in ε, for their rays to meet what stands there, and nothing to a scene.
const OFF: f64 = 16.0 * EPSILON;
/// Surfaces whose plane is as near as this to a point stand on it: rays from it may miss them.
const ON: f64 = 2.0 * EPSILON;
/// The least cosine between the ray and a surface whose side it is on.
const LEAST_COSINE: f64 = 1e-6;

impl<O: Observer> Walk<'_, O> {
    /// How far beside the hit of `ray` its hemisphere stands, `normal` being on the side to be lit. Chance keeps off edges
    /// what hemispheres meet; what the eye looks at may be there by design.
    #[inline]
    pub(crate) fn off_edges(&mut self, ray: &Ray<'_>, normal: DVec3) -> Vec3 {
        if ray.depth == 0 { self.off_what_stands_on(ray, normal) } else { Vec3::ZERO }
    }

    /// The way off the surfaces that stand on the hit. What leans to its own surface by less than 45° (55° between the
    /// tangents) is not found.
    #[inline(never)]
    fn off_what_stands_on(&mut self, ray: &Ray<'_>, normal: DVec3) -> Vec3 {
        let u = normal.any_orthonormal_vector();
        let mut ways = [DVec3::ZERO; 2];
        for (way, tangent) in ways.iter_mut().zip([u, normal.cross(u)]) {
            // Over the point, from one side to the other.
            let origin = ray.point + (normal + tangent) * OFF;
            let over = ambit_trace::Ray { origin, direction: -tangent, limit: 2.0 * OFF };
            self.work.rays += 1;
            let Some(hit) = self.tracer.scene.world.nearest(&over) else { continue };
            let met = over.origin + over.direction * hit.distance;
            let facing = ray.direction.dot(hit.normal);
            if (met - ray.point).dot(hit.normal).abs() <= ON && facing.abs() > LEAST_COSINE {
                // To the side that the ray comes from.
                let away = hit.normal * -facing.signum();
                *way = (away - normal * away.dot(normal)).normalize_or_zero() * OFF;
            }
        }
        // Both rays may have met the same surface.
        let [a, b] = ways;
        (a + if (a - b).length() > ON { b } else { DVec3::ZERO }).as_vec3()
    }
}
