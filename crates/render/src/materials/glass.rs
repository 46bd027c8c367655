//! glass: a thin pane with all internal reflections summed.

use super::{Facing, Finish};
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Rgb};
use ambit_trace::Hit;

/// Arguments of glass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glass {
    /// Transmissivity for one pass along the normal.
    pub(crate) transmissivity: Rgb,
    pub(crate) index: f64,
}

/// Transmissivities below this are raised to it, unless all are.
const LEAST: f32 = 1e-15;

/// Index of refraction where none is given.
pub(crate) const WINDOW_INDEX: f64 = 1.52;

impl Glass {
    /// Transmitted and reflected fraction for a cosine of incidence, averaged over polarisations.
    fn fractions(&self, c: f64) -> (Rgb, Rgb) {
        let n = self.index;
        let kappa = (1.0 - 1.0 / (n * n) + (c / n) * (c / n)).sqrt();
        let r1 = ((c - n * kappa) / (c + n * kappa)).powi(2);
        let r2 = ((1.0 / c - n / kappa) / (1.0 / c + n / kappa)).powi(2);
        let one = |tau: f32| {
            let x = f64::from(tau.max(LEAST)).powf(1.0 / kappa);
            let (mut t, mut r) = (0.0, 0.0);
            for rho in [r1, r2] {
                let loop_sum = 1.0 - (rho * x).powi(2);
                t += 0.5 * (1.0 - rho).powi(2) * x / loop_sum;
                r += 0.5 * rho * (1.0 + (1.0 - 2.0 * rho) * x * x) / loop_sum;
            }
            (t as f32, r as f32)
        };
        // Most panes are grey.
        let t = self.transmissivity;
        let x = one(t.x);
        let y = if t.y == t.x { x } else { one(t.y) };
        let z = if t.z == t.y { y } else { one(t.z) };
        (Rgb::new(x.0, y.0, z.0), Rgb::new(x.1, y.1, z.1))
    }
}

impl<O: Observer> Walk<'_, O> {
    /// The share of a shadow ray that passes a pane of nothing but glass; None if the hit is something else.
    #[inline]
    pub(crate) fn through_pane(&self, hit: &Hit) -> Option<Rgb> {
        let m = self.tracer.scene.modifiers.plain_glass(hit.modifier).filter(|_| hit.tilt == DVec3::ZERO)?;
        if hit.cosine <= 0.0 && !self.tracer.options.back_visible {
            return Some(Rgb::ONE);
        }
        Some(if m.transmissivity.max_element() < LEAST {
            Rgb::ZERO
        } else {
            m.fractions(hit.cosine.abs().max(EPSILON)).0
        })
    }

    pub(crate) fn glass(&mut self, ray: &mut Ray<'_>, m: &Glass, finish: Finish) -> bool {
        if ray.cosine() <= 0.0 && !self.tracer.options.back_visible {
            return false;
        }
        let facing = Facing::of(ray, finish.tilt, true);
        ray.normal = facing.normal;
        let (t, r) = m.fractions(facing.cosine.abs().max(EPSILON));
        let straight = !facing.textured || ray.is_shadow() || ray.is_ambient();
        if m.transmissivity.max_element() >= LEAST {
            let direction = if straight || self.is_phong(ray) { ray.direction } else { refracted(ray, m, &facing) };
            self.pass(ray, direction, t * finish.pattern, straight);
        }
        if ray.is_shadow() {
            return true;
        }
        self.reflect(ray, facing.mirrored(ray.direction), r, straight);
        true
    }
}

/// The direction of a ray that a pane of varying thickness deflects: d + 2(1 − n)p. As in Radiance nothing asks which
/// side of the pane it ends on, or the reflected one.
fn refracted(ray: &Ray<'_>, m: &Glass, facing: &Facing) -> DVec3 {
    let d = ray.direction;
    (d + facing.tilt * (2.0 * (1.0 - m.index))).normalize_or(d)
}
