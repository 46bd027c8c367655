//! The first-order effect of a texture on an uncached hemisphere.

use crate::hemisphere::Hemisphere;
use ambit_base::{Colour, DVec3, Rgb};

/// Normals whose cosine is at least this count as one.
const UNTEXTURED: f64 = 0.9999;
/// Factors below this are not applied: the first order has broken down.
const MIN_FACTOR: f64 = 0.05;
/// Largest tangent of a sample's angle to the normal that counts: its square has no finite mean over the hemisphere.
const MAX_TANGENT: f64 = 20.0;

/// Gathers the rotational gradient of one uncached hemisphere from its samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tilt {
    moment: [f64; 2],
    sum: f64,
}

impl Tilt {
    /// Counts the sample of a cell.
    pub fn add(&mut self, plan: &Hemisphere, cell: usize, radiance: Rgb) {
        let d = plan.local(cell);
        let brightness = f64::from(radiance.mean());
        let tangent = (1.0 / d.z).min(MAX_TANGENT / d.x.hypot(d.y).max(f64::MIN_POSITIVE));
        self.moment[0] -= brightness * tangent * d.y;
        self.moment[1] += brightness * tangent * d.x;
        self.sum += brightness;
    }

    /// What the mean of the samples is to be multiplied by for the given shading normal.
    pub fn factor(&self, plan: &Hemisphere, shading: DVec3) -> f32 {
        let frame = plan.frame();
        if frame.n.dot(shading) >= UNTEXTURED || self.sum <= 0.0 {
            return 1.0;
        }
        let turn = frame.n.cross(shading);
        let [mu, mv] = self.moment;
        let factor = 1.0 + (turn.dot(frame.u) * mu + turn.dot(frame.v) * mv) / self.sum;
        if factor >= MIN_FACTOR { factor as f32 } else { 1.0 }
    }
}
