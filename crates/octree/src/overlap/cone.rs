//! Cones, cylinders and rings against cubes: the generator of the surface that is nearest to the cube's centre is
//! tried, and where that does not decide, the eight parts of the cube.

use super::polygon::normalised;
use super::{AxisBox, ROOT_3};
use ambit_base::{DVec3, EPSILON};

/// The lateral surface between two circles on one axis; a ring has both in one plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConeFamily {
    /// Centre of the smaller circle.
    pub(crate) p0: DVec3,
    /// Centre of the larger circle.
    pub(crate) p1: DVec3,
    /// Smaller radius.
    pub(crate) r0: f64,
    /// Larger radius.
    pub(crate) r1: f64,
    /// Unit vector along the axis.
    pub(crate) axis: DVec3,
}

impl ConeFamily {
    /// True if the surface comes within the cube. Cubes of edge below twice `smallest` are not divided further.
    pub(crate) fn meets(&self, origin: DVec3, edge: f64, smallest: f64) -> bool {
        let half = edge * 0.5;
        let centre = origin + half;
        if let Some((e0, e1)) = self.generator(centre) {
            let reach = half * ROOT_3 + EPSILON;
            if segment_distance(centre, e0, e1) > reach * reach {
                return false;
            }
            if AxisBox::new(origin, edge).clip(e0, e1) {
                return true;
            }
        }
        // A cube that no longer shrinks can not be divided either.
        if half < smallest || half <= f64::MIN_POSITIVE {
            return true;
        }
        (0..8).any(|number| {
            let mut part = origin;
            for axis in 0..3 {
                if number >> axis & 1 != 0 {
                    part[axis] += half;
                }
            }
            self.meets(part, half, smallest)
        })
    }

    /// The straight line on the surface that is nearest to `p`; none for a point on the axis.
    fn generator(&self, p: DVec3) -> Option<(DVec3, DVec3)> {
        let v = p - self.p0;
        let along = v.dot(self.axis);
        let out = normalised(v - self.axis * along)?;
        Some((self.p0 + out * self.r0, self.p1 + out * self.r1))
    }
}

/// Squared distance of a point from a segment, by the lengths of the triangle's sides.
fn segment_distance(p: DVec3, e0: DVec3, e1: DVec3) -> f64 {
    let d = e0.distance_squared(e1);
    let d0 = e0.distance_squared(p);
    let d1 = e1.distance_squared(p);
    if d1 > d0 {
        if d1 - d0 > d {
            return d0;
        }
    } else if d0 - d1 > d {
        return d1;
    }
    if d == 0.0 {
        return d0;
    }
    let t = d + d0 - d1;
    d0 - 0.25 * t * t / d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tube_is_empty_inside() {
        let c = ConeFamily { p0: DVec3::ZERO, p1: DVec3::Z * 10.0, r0: 4.0, r1: 4.0, axis: DVec3::Z };
        let at = |x: f64, y: f64, z: f64| c.meets(DVec3::new(x, y, z), 1.0, 1e-3);
        assert!(!at(-0.5, -0.5, 4.0), "on the axis");
        assert!(at(3.5, -0.5, 4.0));
        assert!(!at(4.5, -0.5, 4.0));
        assert!(!at(3.5, -0.5, 10.5));
    }

    #[test]
    fn distances_from_segments() {
        let (a, b) = (DVec3::ZERO, DVec3::X * 4.0);
        for (p, d) in [([-3.0, 0.0, 4.0], 25.0), ([2.0, 3.0, 0.0], 9.0), ([7.0, 4.0, 0.0], 25.0)] {
            assert!((segment_distance(p.into(), a, b) - d).abs() < 1e-12);
        }
        assert_eq!(segment_distance(DVec3::Y, a, a), 1.0);
    }
}
