//! Where the tree's f32 coordinates lie: the centre they are relative to, and the box of the whole.

use crate::bounds::{Box32, grown};
use ambit_base::{DVec3, EPSILON};
use ambit_scene::Bounds;

/// How far outside its outline a surface can be hit, generously: ε of the polygon test on both axes and the height
/// that makes on a plane of slope up to √2.
const TOLERANCE: f64 = 4.0 * EPSILON;

/// Rounding of the hit tests, as a share of the largest coordinate.
const ROUNDING: f64 = 1e-14;

/// A centre and a box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// The mean of the surfaces' centres: a few large surfaces do not pull it away from the many small ones, near
    /// which the precision is wanted.
    pub(crate) centre: DVec3,
    /// Around everything, tolerances included; empty if there is nothing.
    pub(crate) bounds: Bounds,
    tolerance: f64,
}

impl Frame {
    pub(crate) fn around(boxes: impl Iterator<Item = Bounds>) -> Self {
        let (mut bounds, mut sum, mut count) = (Bounds::EMPTY, DVec3::ZERO, 0u32);
        for b in boxes {
            bounds.join(&b);
            sum += (b.min + b.max) * 0.5;
            count += 1;
        }
        if count == 0 {
            return Self { centre: DVec3::ZERO, bounds, tolerance: 0.0 };
        }
        let extent = bounds.min.abs().max(bounds.max.abs()).max_element();
        let tolerance = TOLERANCE + ROUNDING * extent;
        let mean = sum / f64::from(count);
        let centre = if mean.is_finite() { mean } else { DVec3::ZERO };
        Self { centre, bounds: grown(bounds, 2.0 * tolerance), tolerance }
    }

    /// A box with room for the tolerances of hits in it.
    pub(crate) fn widened(&self, b: Bounds) -> Bounds {
        grown(b, self.tolerance)
    }

    /// The box of one surface in the tree.
    pub(crate) fn child(&self, b: Bounds) -> Box32 {
        Box32::around(&self.widened(b), self.centre)
    }
}
