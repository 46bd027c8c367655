//! Records off the edges where surfaces meet.
//!
//! A view that looks straight along a room, as those of many boxes do, has pixels on the very line where wall and floor
//! meet. A hemisphere there leaves through the floor: it begins in the floor's plane, and what is nearer than ε is no hit.
//! Its record, half of it dark, would serve all around. So it is taken a little beside the edge, where the wall's
//! irradiance goes towards what it is at its end.

use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON};

/// How far off an edge records are taken, in least spacings of records: little to them, much to ε.
const OFF: f64 = 0.01;
/// The same in ε, at least.
const OFF_EPSILONS: f64 = 16.0;
/// Surfaces as near as this to a point stand on it, in ε: rays from it may miss them.
const ON_EPSILONS: f64 = 2.0;
/// The least cosine between the ray and a surface whose side it is on.
const LEAST_COSINE: f64 = 1e-6;

impl<O: Observer> Walk<'_, O> {
    /// The hit of `ray`, moved off what stands on it within the surface whose `normal` is on the side to be lit.
    #[cold]
    pub(crate) fn off_edges(&mut self, ray: &Ray<'_>, normal: DVec3) -> DVec3 {
        let limits = self.cache.limits();
        let off = (OFF * limits.accuracy * limits.min_radius).max(OFF_EPSILONS * EPSILON);
        let u = normal.any_orthonormal_vector();
        let mut place = ray.point;
        for tangent in [u, normal.cross(u)] {
            // Over the point, from one side to the other.
            let over = ambit_trace::Ray {
                origin: ray.point + (normal + tangent) * off,
                direction: -tangent,
                limit: 2.0 * off,
            };
            self.work.rays += 1;
            let Some(hit) = self.tracer.scene.world.nearest(&over) else { continue };
            let facing = ray.direction.dot(hit.normal);
            if (hit.distance - off).abs() <= ON_EPSILONS * EPSILON && facing.abs() > LEAST_COSINE {
                // On the side that the ray comes from.
                let away = hit.normal * -facing.signum();
                place += (away - normal * away.dot(normal)).normalize_or_zero() * off;
            }
        }
        place
    }
}
