//! Planar polygons against cubes: vertices, then edges, then the point where the cube's diagonal nearest to the normal
//! pierces the polygon's plane.

use super::AxisBox;
use crate::Cube;
use ambit_base::{DVec3, EPSILON};

/// Lengths whose square differs from 1 by no more than this are corrected linearly when normalising.
const NEARLY_UNIT: f64 = EPSILON;

/// A polygon prepared for tests; `coordinates` are x, y, z of each vertex in turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolygonTest<'a> {
    vertices: &'a [[f64; 3]],
}

impl<'a> PolygonTest<'a> {
    /// Numbers beyond the last whole vertex are left out.
    #[inline]
    pub(crate) fn new(coordinates: &'a [f64]) -> Self {
        Self { vertices: coordinates.as_chunks().0 }
    }

    /// True if the polygon comes within the cube.
    pub(crate) fn meets(&self, cube: &Cube) -> bool {
        let around = tolerant_box(cube);
        let points = around.classify(self.vertices.iter().map(|&v| v.into()));
        points.inside > 0 || (!points.one_sided && self.crosses(&around))
    }

    /// Which children of a cube the polygon comes within: what [`PolygonTest::meets`] says of each, found together.
    #[inline]
    pub(crate) fn children(&self, cube: &Cube, octants: &Octants) -> u8 {
        let mut inside = 0;
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &v in self.vertices {
            let p = DVec3::from(v);
            inside |= octants.touched(p, p);
            low = low.min(p);
            high = high.max(p);
        }
        // The vertices are on one side of all other children, or the polygon may cross them.
        let mut open = octants.touched(low, high) & !inside;
        let mut met = inside;
        while open != 0 {
            let number = open.trailing_zeros() as usize;
            open &= open - 1;
            if self.crosses(&tolerant_box(&cube.child(number))) {
                met |= 1 << number;
            }
        }
        met
    }

    /// The rest of the test, for a polygon without a vertex in the box.
    fn crosses(&self, around: &AxisBox) -> bool {
        let Some(&last) = self.vertices.last() else { return false };
        let mut p = DVec3::from(last);
        for &v in self.vertices {
            let q = DVec3::from(v);
            if around.clip(p, q) {
                return true;
            }
            p = q;
        }
        let Some((normal, offset)) = self.plane() else { return false };
        let up = normal.cmpgt(DVec3::ZERO);
        let a = DVec3::select(up, around.lo, around.hi);
        let b = DVec3::select(up, around.hi, around.lo);
        let da = normal.dot(a) - offset;
        let db = normal.dot(b) - offset;
        if da > EPSILON || db < -EPSILON {
            return false;
        }
        self.contains((a * db - b * da) / (db - da), normal)
    }

    /// Unit normal and mean distance from the origin along it; none for zero area.
    fn plane(&self) -> Option<(DVec3, f64)> {
        let first = DVec3::from(*self.vertices.first()?);
        let mut sum = DVec3::ZERO;
        let mut before = DVec3::from(*self.vertices.get(1)?) - first;
        for &v in &self.vertices[2..] {
            let d = DVec3::from(v) - first;
            sum += before.cross(d);
            before = d;
        }
        let normal = normalised(sum)?;
        let total: f64 = self.vertices.iter().map(|&v| normal.dot(v.into())).sum();
        Some((normal, total / self.vertices.len() as f64))
    }

    /// Even–odd rule in the coordinate plane the polygon is seen largest in; boundary points count as inside.
    fn contains(&self, point: DVec3, normal: DVec3) -> bool {
        let mut dropped = 0;
        for axis in 1..3 {
            if normal[axis].abs() > normal[dropped].abs() {
                dropped = axis;
            }
        }
        let (xi, yi) = ((dropped + 1) % 3, (dropped + 2) % 3);
        let (x, y) = (point[xi], point[yi]);
        let flat = |v: &[f64; 3]| (v[xi], v[yi]);
        let Some(last) = self.vertices.last() else { return false };
        let mut p0 = flat(last);
        let mut crossings = 0;
        for v in self.vertices {
            let p1 = flat(v);
            let (x0, x1) = (p0.0 > x, p1.0 > x);
            if (p0.1 - y).abs() <= EPSILON && (p1.1 - y).abs() <= EPSILON && x0 != x1 {
                return true;
            }
            if (p0.1 > y) != (p1.1 > y) {
                if x0 && x1 {
                    crossings += 1;
                } else if x0 != x1 {
                    let a = (p0.1 - y) * (p1.0 - x);
                    let b = (p0.0 - x) * (p1.1 - y);
                    if (a - b).abs() <= EPSILON {
                        return true;
                    }
                    crossings += usize::from((p1.1 > p0.1) != (a > b));
                } else if (p0.0 - x).abs() <= EPSILON && (p1.0 - x).abs() <= EPSILON {
                    return true;
                }
            }
            p0 = p1;
        }
        crossings % 2 == 1
    }
}

/// The box in which a polygon counts as being in a cube: a little larger than the cube.
#[inline]
fn tolerant_box(cube: &Cube) -> AxisBox {
    AxisBox::new(cube.origin - EPSILON, cube.edge + 2.0 * EPSILON)
}

/// The limits of a cube's eight children, for polygons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Octants {
    /// What is below is not in the lower, upper children of an axis.
    low: [DVec3; 2],
    /// What is above is not in the lower, upper children of an axis.
    high: [DVec3; 2],
}

/// The children in the lower and in the upper half of each axis, one bit each.
const HALVES: [[u8; 2]; 3] = [[0b0101_0101, 0b1010_1010], [0b0011_0011, 0b1100_1100], [0b0000_1111, 0b1111_0000]];

impl Octants {
    /// The children of a cube.
    pub(crate) fn new(cube: &Cube) -> Self {
        let boxes = [0, 7].map(|number| tolerant_box(&cube.child(number)));
        Self { low: boxes.map(|b| b.lo - EPSILON), high: boxes.map(|b| b.hi + EPSILON) }
    }

    /// The children that a box is not beside of.
    #[inline]
    fn touched(&self, low: DVec3, high: DVec3) -> u8 {
        let mut mask = 0xff;
        for (axis, halves) in HALVES.iter().enumerate() {
            let along = |half: usize| {
                let beside = high[axis] < self.low[half][axis] || low[axis] > self.high[half][axis];
                if beside { 0 } else { halves[half] }
            };
            mask &= along(0) | along(1);
        }
        mask
    }
}

/// The vector made unit length the way Radiance does, to the last bit; none for the zero vector.
pub(super) fn normalised(v: DVec3) -> Option<DVec3> {
    let square = v.dot(v);
    if square == 0.0 || !square.is_finite() {
        return None;
    }
    if (1.0 - NEARLY_UNIT..=1.0 + NEARLY_UNIT).contains(&square) {
        let length = 0.5 + 0.5 * square;
        return Some(v * (2.0 - length));
    }
    Some(v * (1.0 / square.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [f64; 12] = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 4.0, 4.0, 0.0, 0.0, 4.0, 0.0];

    #[test]
    fn a_square_is_found_by_corner_edge_and_face() {
        let p = PolygonTest::new(&SQUARE);
        for (origin, edge, meets) in [
            ([-0.5, -0.5, -0.5], 1.0, true),
            ([1.5, -0.5, -0.5], 1.0, true),
            ([1.5, 1.5, -0.5], 1.0, true),
            ([1.5, 1.5, 0.5], 1.0, false),
            ([1.5, 1.5, -1.0 - 1e-6], 1.0, true),
            ([1.5, 1.5, -1.0 - 1e-5], 1.0, false),
            ([4.5, 4.5, -0.5], 1.0, false),
            ([-1.0, -1.0, -1.0], 8.0, true),
        ] {
            assert_eq!(p.meets(&Cube { origin: origin.into(), edge }), meets, "{origin:?}");
        }
    }

    #[test]
    fn a_hole_has_no_surface() {
        // Outline and inner loop joined by a seam.
        let mut frame = vec![0.0; 0];
        for (x, y) in [
            (0.0, 0.0),
            (8.0, 0.0),
            (8.0, 8.0),
            (0.0, 8.0),
            (0.0, 0.0),
            (2.0, 2.0),
            (2.0, 6.0),
            (6.0, 6.0),
            (6.0, 2.0),
            (2.0, 2.0),
        ] {
            frame.extend([x, y, 1.0]);
        }
        let p = PolygonTest::new(&frame);
        assert!(!p.meets(&Cube { origin: DVec3::new(3.5, 3.5, 0.5), edge: 1.0 }));
        assert!(p.meets(&Cube { origin: DVec3::new(6.5, 3.5, 0.5), edge: 1.0 }));
    }

    #[test]
    fn fewer_than_three_vertices_are_nowhere() {
        for n in 0..3 {
            let p = PolygonTest::new(&SQUARE[..3 * n]);
            assert!(!p.meets(&Cube { origin: DVec3::splat(7.5), edge: 1.0 }));
        }
    }

    proptest::proptest! {
        #[test]
        fn children_together_are_children_one_by_one(
            numbers in proptest::collection::vec(-1.5f64..1.5, 9..19),
            snapped in proptest::bool::ANY,
        ) {
            // On a coarse grid vertices and edges lie in the faces of the cubes.
            let snap = |x: &f64| if snapped { (x * 4.0).round() / 4.0 } else { *x };
            let numbers: Vec<f64> = numbers.iter().map(snap).collect();
            let p = PolygonTest::new(&numbers);
            let cube = Cube { origin: DVec3::splat(-1.0), edge: 2.0 };
            let together = p.children(&cube, &Octants::new(&cube));
            for number in 0..8 {
                proptest::prop_assert_eq!(together >> number & 1 != 0, p.meets(&cube.child(number)));
            }
        }
    }
}
