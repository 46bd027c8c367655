//! Eight triangles or convex quadrilaterals in f32: which of them a ray may hit. Those are then tested exactly.
//!
//! With the origin o, the unit direction d, a corner v and the edges e₁, e₂ from it, let c = v − o, r = c × d and
//! n = e₁ × e₂. The plane is met at t, at v + u·e₁ + w·e₂, with u·D = r·e₂, w·D = −r·e₁, t·D = n·c, D = n·d (Möller and
//! Trumbore 1997). Everything is held against D rather than divided by it, so that errors do not grow at
//! grazing angles: let ε = 2⁻²⁴, M the largest coordinate of the world relative to its centre, L the largest sum of an edge's
//! components. c is wrong by less than 4εM, r by 20εM, u·D and w·D by 36εML, D by 12εL², t·D by 60εML². A point of
//! the plane off by x moves u·D and w·D by less than xL, t·D by xL²; that holds for the rounding of the exact test,
//! however oblique the ray. Its tolerance is a product with an edge in the projection, which is u·D or w·D times the
//! cosine of the projection, at least 1/√3. So a surface is passed over only if it is surely missed.

use crate::polygon;
use ambit_base::DVec3;
use ambit_scene::ObjectId;

/// Surfaces in a block.
pub(crate) const LANES: usize = 8;

/// Rounding of the test in f32 as a share of ML + L²: the sum of what an edge between u and w meets is 84 of 2⁻²⁴.
const ROUNDING: f64 = 1.0 / (1 << 17) as f64;

/// Rounding of the exact test as a share of the largest coordinate.
const EXACT_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Margins from here on let everything pass: products may overflow.
const LARGEST: f64 = 1e30;

/// A corner and the edges from it, relative to the world's centre, component by component.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Block {
    pub(crate) corner: [[f32; LANES]; 3],
    pub(crate) edges: [[[f32; LANES]; 3]; 2],
    /// How much u and w of an edge opposite the corner may be below 0.
    pub(crate) margin: f32,
    /// The same for the distance.
    pub(crate) depth: f32,
    /// Number of the first surface; the others follow.
    pub(crate) first: u32,
    /// A bit for each lane in use, and above them one for each that stops every shadow ray.
    bits: u32,
    /// The objects, so that a shadow ray need look no further; 0 in a mesh.
    pub(crate) object: [ObjectId; LANES],
}

/// What a quadrilateral needs beside: the slopes of the two edges opposite the corner, (a − 1)/b and (b − 1)/a for a
/// fourth corner at v + a·e₁ + b·e₂; 0 for a parallelogram.
pub(crate) type Slopes = [[f32; LANES]; 2];

/// Sizes of a world that margins depend on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) centre: DVec3,
    /// Largest coordinate relative to the centre.
    pub(crate) span: f64,
    /// Largest coordinate.
    pub(crate) extent: f64,
}

impl Block {
    /// No surfaces yet.
    pub(crate) fn new(first: u32) -> Self {
        Self {
            corner: [[0.0; LANES]; 3],
            edges: [[[0.0; LANES]; 3]; 2],
            margin: 0.0,
            depth: 0.0,
            first,
            bits: 0,
            object: [0; LANES],
        }
    }

    /// A bit for each lane in use.
    #[inline]
    pub(crate) fn used(&self) -> u32 {
        self.bits & ((1 << LANES) - 1)
    }

    /// A bit for each lane that stops every shadow ray.
    #[inline]
    pub(crate) fn blocks(&self) -> u32 {
        self.bits >> LANES
    }

    /// Adds the next surface: corners in order, and the tolerance of the exact test as a product with an edge in the
    /// projection ([`polygon::tolerance`]). Gives the slopes of a quadrilateral.
    pub(crate) fn push(
        &mut self,
        scale: &Scale,
        corners: &[DVec3],
        tolerance: f64,
        object: ObjectId,
        blocks: bool,
    ) -> [f32; 2] {
        let lane = self.used().trailing_ones() as usize;
        let (v, e) = (corners[0], [corners[1] - corners[0], corners[corners.len() - 1] - corners[0]]);
        let fourth = if let [_, _, opposite, _] = *corners { weights(e, opposite - v) } else { [1.0; 2] };
        let slopes = [(fourth[0] - 1.0) / fourth[1], (fourth[1] - 1.0) / fourth[0]];
        let relative = v - scale.centre;
        for (slots, of) in [&mut self.corner].into_iter().chain(&mut self.edges).zip([relative, e[0], e[1]]) {
            for (slot, x) in slots.iter_mut().zip(of.to_array()) {
                slot[lane] = x as f32;
            }
        }
        let length = e.iter().map(|e| e.abs().element_sum()).fold(0.0, f64::max);
        let off = ROUNDING * (scale.span + length) + EXACT_ROUNDING * scale.extent;
        let slope = |i: usize| (1.0 + slopes[i].abs()).max(1.0 / fourth[1 - i]);
        let steepest = slope(0).max(slope(1));
        let margin = (off * length + 1.75 * tolerance) * steepest;
        let depth = 2.0 * off * length * length;
        // The largest product in between.
        let product = length * length * (scale.span + length) * steepest;
        let up = |x: f64| if product < LARGEST { (x as f32).next_up() + f32::MIN_POSITIVE } else { f32::INFINITY };
        self.margin = self.margin.max(up(margin));
        self.depth = self.depth.max(up(depth));
        self.object[lane] = object;
        self.bits |= (1 | u32::from(blocks) << LANES) << lane;
        slopes.map(|s| s as f32)
    }
}

/// The weights a and b of an opposite corner at v + a·e₁ + b·e₂.
fn weights(e: [DVec3; 2], opposite: DVec3) -> [f64; 2] {
    let dropped = polygon::dropped_axis(e[0].cross(e[1]));
    let [p, q, r] = [e[0], e[1], opposite].map(|v| polygon::project(v, dropped));
    let det = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    [det(r, q) / det(p, q), det(p, r) / det(p, q)]
}
