//! dielectric and interface: refraction and reflection at the boundary of solids, with absorption along the way.

use super::{Facing, Finish, mirror_direction};
use crate::observer::Observer;
use crate::ray::{Interior, Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{EPSILON, Rgb};

/// A boundary between two media.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dielectric {
    /// Transmission per unit length and index behind the normal.
    pub(crate) inside: (Rgb, f64),
    /// The same in front of the normal; None for a dielectric, whose outside is the global medium.
    pub(crate) outside: Option<(Rgb, f64)>,
}

/// Transmission below which absorption is taken as [`BLACK`].
const LEAST: f32 = 1e-40;
const BLACK: f32 = 100.0;

fn absorption(transmission: Rgb) -> Interior {
    let one = |t: f32| {
        if t >= 1.0 {
            0.0
        } else if t < LEAST {
            BLACK
        } else {
            -t.ln()
        }
    };
    let extinction = Rgb::new(one(transmission.x), one(transmission.y), one(transmission.z));
    Interior { extinction, ..Interior::VACUUM }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn dielectric(&mut self, ray: &mut Ray<'_>, m: &Dielectric, finish: Finish) -> bool {
        let facing = Facing::of(ray, finish.tilt, true);
        let outside = match m.outside {
            Some((t, _)) => absorption(t * finish.pattern),
            // Light scatters evenly again, whatever `-mg` says: so Radiance has it.
            None => Interior { eccentricity: 0.0, ..self.tracer.global_interior() },
        };
        let inside = absorption(m.inside.0 * finish.pattern);
        let outer_index = m.outside.map_or(1.0, |o| o.1);
        let entering = ray.cosine() > 0.0;
        ray.normal = if entering { facing.normal } else { -facing.normal };
        let (eta, beyond) = if entering {
            if m.outside.is_some() {
                ray.interior = outside.within(ray.interior);
            }
            (outer_index / m.inside.1, inside.within(ray.interior))
        } else {
            ray.interior = inside.within(ray.interior);
            (m.inside.1 / outer_index, outside.within(ray.interior))
        };
        let d = ray.direction;
        let c = facing.cosine;
        let squared = 1.0 - eta * eta * (1.0 - c * c);
        let mut reflected = 1.0;
        if squared >= EPSILON {
            let c2 = squared.sqrt();
            let perpendicular = (c - eta * c2) / (c + eta * c2);
            let parallel = (1.0 / c - eta / c2) / (1.0 / c + eta / c2);
            reflected = 0.5 * (perpendicular * perpendicular + parallel * parallel);
            let k = Rgb::splat(((1.0 - reflected) * eta * eta) as f32);
            if let Some(mut child) = self.child(ray, Kinds::REFRACTED, d, k, 3) {
                let mut direction = d * eta + facing.normal * (eta * c - c2);
                if facing.textured && direction.dot(facing.geometric) >= -EPSILON {
                    // Still with the angles at the tilted normal, as in Radiance.
                    direction = d * eta + facing.geometric * (eta * c - c2);
                }
                child.direction = direction.normalize();
                child.interior = beyond;
                self.evaluate(&mut child);
                let light = child.coefficient * child.value;
                let length = child.length_of(light);
                ray.value += light;
                let straight = self.is_flat(ray) && (!facing.textured || ray.is_ambient());
                if straight || (eta - 1.0).abs() <= EPSILON {
                    ray.unmirrored_length = ray.distance + length;
                }
            }
        }
        if ray.is_shadow() || reflected <= EPSILON {
            return true;
        }
        let straight = !facing.textured || ray.is_ambient();
        self.reflect(ray, mirror_direction(d, &facing), Rgb::splat(reflected as f32), straight);
        true
    }
}
