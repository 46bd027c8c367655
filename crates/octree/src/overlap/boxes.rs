//! Points and segments against axis-aligned boxes.

use ambit_base::{DVec3, EPSILON};

/// On which side of a box a point lies: one bit an axis for "below", one for "above".
pub(super) type Side = u8;

const BELOW: [Side; 3] = [1, 2, 4];
const ABOVE: [Side; 3] = [8, 16, 32];
const ALL_SIDES: Side = 63;

/// After so many moves of an end a segment that is still undecided counts as outside.
const MOST_CLIPS: usize = 6;

/// A box that counts points within [`EPSILON`] of it as its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisBox {
    /// Smallest coordinates.
    pub(crate) lo: DVec3,
    /// Largest coordinates.
    pub(crate) hi: DVec3,
}

impl AxisBox {
    /// The box of a cube.
    #[inline]
    pub(crate) fn new(lo: DVec3, edge: f64) -> Self {
        Self { lo, hi: lo + edge }
    }

    /// Which sides of the box a point is beyond; 0 if it is in the box.
    #[inline]
    pub(super) fn side(&self, p: DVec3) -> Side {
        let below = p.cmplt(self.lo - EPSILON).bitmask() as Side;
        let above = p.cmpgt(self.hi + EPSILON).bitmask() as Side;
        below | above << 3
    }

    /// The sides beyond which all of the points are, and whether one of them is in the box.
    #[inline]
    pub(super) fn classify(&self, points: impl IntoIterator<Item = DVec3>) -> Points {
        let mut all = ALL_SIDES;
        let mut inside = 0;
        let mut count = 0;
        for p in points {
            let s = self.side(p);
            all &= s;
            inside += usize::from(s == 0);
            count += 1;
        }
        Points { inside, count, one_sided: all != 0 }
    }

    /// True if the segment passes through the box (Cohen–Sutherland).
    pub(crate) fn clip(&self, mut p: DVec3, mut q: DVec3) -> bool {
        let (mut sp, mut sq) = (self.side(p), self.side(q));
        for _ in 0..MOST_CLIPS {
            if sp | sq == 0 {
                return true;
            }
            if sp & sq != 0 {
                return false;
            }
            if sp == 0 {
                std::mem::swap(&mut p, &mut q);
                std::mem::swap(&mut sp, &mut sq);
            }
            let Some(axis) = (0..3).find(|&i| sp & (BELOW[i] | ABOVE[i]) != 0) else { return true };
            let plane = if sp & BELOW[axis] != 0 { self.lo[axis] } else { self.hi[axis] };
            let d = (plane - p[axis]) / (q[axis] - p[axis]);
            let mut moved = p + (q - p) * d;
            moved[axis] = plane;
            p = moved;
            sp = self.side(p);
        }
        sp | sq == 0
    }
}

/// What [`AxisBox::classify`] finds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points {
    pub(super) inside: usize,
    pub(super) count: usize,
    pub(super) one_sided: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_clipped() {
        let b = AxisBox::new(DVec3::ZERO, 1.0);
        for (p, q, passes) in [
            ([-1.0, 0.5, 0.5], [2.0, 0.5, 0.5], true),
            ([-1.0, 0.5, 0.5], [-0.5, 0.5, 0.5], false),
            ([-1.0, -1.0, -1.0], [2.0, 2.0, 2.0], true),
            ([-1.0, 1.5, 0.5], [1.5, -1.0, 0.5], true),
            ([-1.0, 1.1, 0.5], [0.5, 2.0, 0.5], false),
            ([1.9, -0.5, 0.5], [0.5, 2.9, 0.5], false),
            ([0.2, 0.2, 0.2], [9.0, 9.0, 9.0], true),
            ([1.0 + 5e-7, 0.0, 0.0], [3.0, 0.0, 0.0], true),
        ] {
            assert_eq!(b.clip(p.into(), q.into()), passes, "{p:?} {q:?}");
            assert_eq!(b.clip(q.into(), p.into()), passes, "{q:?} {p:?}");
        }
    }
}
