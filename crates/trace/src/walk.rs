//! The walk through the tree: what is shared by the scalar and the vector version, and the scalar version.
//!
//! A ray that starts outside is moved, in f64, to where it enters the world's box, and everything is taken relative to
//! the tree's centre. Let u = 2⁻²⁴ be the rounding of f32. A plane b of a box is met at (b − o)·r with r = 1/d; what is
//! computed differs from that by rounding o (u|o|), d and r (2u of the result), the product o·r (u|o|) and the
//! sum (u of the result), in distance along the axis less than 3u|b| + 5u|o|. Boxes are widened by 8u|b| and
//! the origin is shifted by 8u|o| against each plane, plus `noise`, a bound of the rounding in f64; so no box is missed
//! that holds a point of the ray, and the widening costs nothing in the walk itself (compare Ize 2013).

use crate::block::Scale;
use crate::collapse::SLACK;
use crate::node::{LEAF, Node, WIDTH};
use crate::ray::Ray;
use ambit_base::DVec3;
use ambit_scene::Bounds;

/// Directions below this are replaced by it, so that no product overflows.
pub(crate) const LEAST_DIRECTION: f32 = 1e-20;

/// Relative rounding of a handful of operations in f64.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How far off a distance in f64 can be for a unit of coordinate, met at a cosine of ε.
pub(crate) const GRAZING: f64 = 1e-9;

/// Entries of the stacks: enough for ordinary trees, and for any.
pub(crate) const STACK: usize = 160;
pub(crate) const DEEP_STACK: usize = 1024;

/// Entries a walk through a tree of that many levels can need.
pub(crate) fn stack_needed(depth: usize) -> usize {
    depth * (WIDTH - 1) + 1
}

/// What every ray needs to know of a tree before it enters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gate {
    /// What the tree's boxes are relative to.
    pub(crate) centre: DVec3,
    /// Around everything, with room for tolerances.
    pub(crate) bounds: Bounds,
    /// Largest coordinate of the bounds.
    pub(crate) extent: f64,
}

impl Gate {
    pub(crate) fn new(bounds: Bounds, centre: DVec3) -> Self {
        let extent = bounds.min.abs().max_element().max(bounds.max.abs().max_element());
        Self { centre, bounds, extent }
    }

    /// What the margins of blocks depend on.
    pub(crate) fn scale(&self) -> Scale {
        let (low, high) = (self.bounds.min - self.centre, self.bounds.max - self.centre);
        Scale { centre: self.centre, span: low.abs().max(high.abs()).max_element(), extent: self.extent }
    }
}

/// A ray made ready for a tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Distance by which the origin was moved.
    pub(crate) start: f64,
    /// Largest coordinate involved, for the rounding of distances.
    pub(crate) extent: f64,
    pub(crate) inverse: [f32; 4],
    /// Origin × inverse, shifted for near planes.
    pub(crate) near: [f32; 4],
    /// Origin × inverse, shifted for far planes.
    pub(crate) far: [f32; 4],
    /// Which of a node's arrays hold the near planes; the far ones are their neighbours.
    pub(crate) array: [usize; 3],
}

/// Where a ray begins to be walked: how far from its origin, and the largest coordinate involved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub(crate) distance: f64,
    pub(crate) extent: f64,
}

impl Start {
    /// None if the ray misses the box, or has coordinates that are no numbers.
    pub(crate) fn new(gate: &Gate, ray: &Ray) -> Option<Self> {
        let (o, d) = (ray.origin, ray.direction);
        let reach = o.abs().max_element();
        if !(reach.is_finite() && o.is_finite() && d.is_finite()) || gate.bounds.is_empty() {
            return None;
        }
        let extent = reach.max(gate.extent);
        let outside = o.cmplt(gate.bounds.min).any() || o.cmpgt(gate.bounds.max).any();
        let distance = if outside { enter(&gate.bounds, extent * ROUNDING, o, d)? } else { 0.0 };
        Some(Self { distance, extent })
    }
}

impl Entry {
    /// None if the ray misses the box, or has coordinates that are no numbers.
    pub(crate) fn new(gate: &Gate, ray: &Ray) -> Option<Self> {
        let Start { distance: start, extent } = Start::new(gate, ray)?;
        let noise = extent * ROUNDING;
        let origin = (ray.origin + ray.direction * start - gate.centre).to_array();
        let d = ray.direction.to_array();
        let mut entry = Self { start, extent, inverse: [0.0; 4], near: [0.0; 4], far: [0.0; 4], array: [0, 2, 4] };
        for a in 0..3 {
            let (o, d) = (origin[a] as f32, d[a] as f32);
            let r = 1.0 / d.abs().max(LEAST_DIRECTION).copysign(d);
            let shift = (SLACK * o.abs() + noise as f32).copysign(r);
            entry.inverse[a] = r;
            entry.near[a] = -((o + shift) * r);
            entry.far[a] = -((o - shift) * r);
            entry.array[a] += usize::from(r < 0.0);
        }
        Some(entry)
    }

    /// The distance from the ray's origin that a distance in the walk stands for, rounded up.
    #[inline]
    pub(crate) fn distance(&self, reach: f32) -> f64 {
        (self.start + f64::from(reach)) * (1.0 + ROUNDING)
    }

    /// The distance in the walk beyond which nothing within `bound` of the ray's origin can lie.
    #[inline]
    pub(crate) fn reach(&self, bound: f64) -> f32 {
        let t = bound - self.start + GRAZING * self.extent;
        // The last term is for distances so small that f32 has fewer digits for them.
        t as f32 * (1.0 + 8.0 * f32::EPSILON) + f32::MIN_POSITIVE
    }
}

/// Distance at which the box, grown by `noise`, is entered from outside, rounded down.
fn enter(bounds: &Bounds, noise: f64, o: DVec3, d: DVec3) -> Option<f64> {
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for a in 0..3 {
        let (low, high) = (bounds.min[a] - noise - o[a], bounds.max[a] + noise - o[a]);
        if d[a] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
        } else {
            let (x, y) = (low / d[a], high / d[a]);
            near = near.max(x.min(y));
            far = far.min(x.max(y));
        }
    }
    (near <= far * (1.0 + ROUNDING)).then_some((near * (1.0 - ROUNDING) - noise).max(0.0))
}

/// Visits leaves in about the order of distance. `leaf` gives the distance that still matters, below 0 to stop.
pub(crate) fn walk<const N: usize>(nodes: &[Node], entry: &Entry, bound: f64, mut leaf: impl FnMut(u32) -> f32) {
    let mut reach = entry.reach(bound);
    let mut stack = [(0u32, 0.0f32); N];
    let mut top = 0;
    let mut word = 0u32;
    loop {
        if word & LEAF != 0 {
            reach = leaf(word);
        } else {
            let node = &nodes[word as usize];
            let base = top;
            for i in 0..WIDTH {
                let (mut near, mut far) = (0.0f32, reach);
                for a in 0..3 {
                    let k = entry.array[a];
                    near = near.max(node.planes[k][i] * entry.inverse[a] + entry.near[a]);
                    far = far.min(node.planes[k ^ 1][i] * entry.inverse[a] + entry.far[a]);
                }
                if near <= far {
                    let mut at = top;
                    while at > base && stack[at - 1].1 < near {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (node.child[i], near);
                    top += 1;
                }
            }
        }
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            if stack[top].1 <= reach {
                word = stack[top].0;
                break;
            }
        }
    }
}
