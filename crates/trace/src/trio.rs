//! Mesh triangles, four to a block: does a line pass through, without cracks and double hits.
//!
//! Vertices are sheared so that the ray runs along an axis (Woop, Benthin and Wald 2013); what remains is whether the
//! origin of a plane lies inside a triangle. A vertex has the same sheared coordinates in all its triangles, and the
//! sign of each edge's product is found exactly; where it is zero, the ray counts as displaced by a vanishing amount, first
//! along one axis, then along the other (Edelsbrunner and Mücke 1990). So every line through a closed surface passes
//! through it consistently, at edges and vertices too.

use crate::facet::LANES;
use ambit_base::DVec3;

/// Products whose difference is below this share of their sum may have the wrong sign: 4 roundings.
pub(crate) const UNSURE: f64 = 2.0 * f64::EPSILON;

/// A ray, and how to shear vertices for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    pub(crate) origin: DVec3,
    /// The two other axes and the one along which the direction is largest.
    pub(crate) axes: [usize; 3],
    /// Direction along the two other axes over that along the third.
    pub(crate) slope: [f64; 2],
}

impl Shear {
    #[inline]
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        let a = direction.abs();
        let k = if a.x >= a.y && a.x >= a.z {
            0
        } else if a.y >= a.z {
            1
        } else {
            2
        };
        let axes = [(k + 1) % 3, (k + 2) % 3, k];
        Self { origin, axes, slope: [direction[axes[0]] / direction[k], direction[axes[1]] / direction[k]] }
    }
}

/// Four triangles, component by component.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Trios {
    /// By corner, axis and lane.
    pub(crate) corners: [[[f64; LANES]; 3]; 3],
    /// Numbers of the triangles; `u32::MAX` for none.
    pub(crate) triangle: [u32; LANES],
}

impl Trios {
    pub(crate) fn pack(list: &[u32; LANES], triangles: &[[u32; 3]], vertices: &[DVec3]) -> Self {
        let mut corners = [[[0.0; LANES]; 3]; 3];
        for (lane, &number) in list.iter().enumerate().filter(|(_, t)| **t != u32::MAX) {
            for (corner, v) in corners.iter_mut().zip(triangles[number as usize]) {
                for (axis, slot) in corner.iter_mut().enumerate() {
                    slot[lane] = vertices[v as usize][axis];
                }
            }
        }
        Self { corners, triangle: *list }
    }

    /// Lanes that hold a triangle.
    #[inline]
    pub(crate) fn used(&self) -> u8 {
        (0..LANES).fold(0, |m, i| m | u8::from(self.triangle[i] != u32::MAX) << i)
    }

    pub(crate) fn corner(&self, k: usize, lane: usize) -> DVec3 {
        DVec3::new(self.corners[k][0][lane], self.corners[k][1][lane], self.corners[k][2][lane])
    }

    /// Normal of the front, twice the area long.
    pub(crate) fn normal(&self, lane: usize) -> DVec3 {
        let a = self.corner(0, lane);
        (self.corner(1, lane) - a).cross(self.corner(2, lane) - a)
    }

    fn sheared(&self, s: &Shear, lane: usize) -> [[f64; 2]; 3] {
        let [i, j, k] = s.axes;
        [0, 1, 2].map(|c| {
            let v = &self.corners[c];
            let height = v[k][lane] - s.origin[k];
            [v[i][lane] - s.origin[i] - s.slope[0] * height, v[j][lane] - s.origin[j] - s.slope[1] * height]
        })
    }

    /// Lanes that the line is not sure to miss.
    pub(crate) fn test(&self, s: &Shear) -> u32 {
        let mut mask = 0;
        for lane in 0..LANES {
            let v = self.sheared(s, lane);
            let (mut positive, mut negative) = (false, false);
            for c in 0..3 {
                let (a, b) = (v[c], v[(c + 1) % 3]);
                let (p, q) = (a[0] * b[1], a[1] * b[0]);
                let unsure = UNSURE * (p.abs() + q.abs());
                positive |= p - q > unsure;
                negative |= q - p > unsure;
            }
            mask |= u32::from(!(positive && negative)) << lane;
        }
        mask
    }

    /// Does the line pass through?
    pub(crate) fn passes(&self, s: &Shear, lane: usize) -> bool {
        let v = self.sheared(s, lane);
        let left = [0, 1, 2].map(|c| runs_left(v[c], v[(c + 1) % 3]));
        left[0] == left[1] && left[1] == left[2]
    }

    /// Weights of the corners where the line passes.
    pub(crate) fn weights(&self, s: &Shear, lane: usize) -> [f64; 3] {
        let v = self.sheared(s, lane);
        let e = [0, 1, 2].map(|c| {
            let (a, b) = (v[c], v[(c + 1) % 3]);
            a[0] * b[1] - a[1] * b[0]
        });
        let sum = e[0] + e[1] + e[2];
        // The edge opposite a corner is the one after the next.
        if sum == 0.0 { [1.0, 0.0, 0.0] } else { [e[1] / sum, e[2] / sum, e[0] / sum] }
    }
}

/// Does the edge from `a` to `b` pass the origin on its right, the origin displaced by a vanishing amount if it lies
/// on the edge's line? Swapping the ends always swaps the answer, unless the ends are equal.
fn runs_left(a: [f64; 2], b: [f64; 2]) -> bool {
    let (p, q) = (a[0] * b[1], a[1] * b[0]);
    let d = p - q;
    if d.abs() > UNSURE * (p.abs() + q.abs()) {
        return d > 0.0;
    }
    // p and q are so close that their difference is exact; their roundings decide.
    let (p_rest, q_rest) = (a[0].mul_add(b[1], -p), a[1].mul_add(b[0], -q));
    let rest = q_rest - p_rest;
    if d != rest {
        return d > rest;
    }
    if a[1] == b[1] { b[0] > a[0] } else { a[1] > b[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_exact_and_swap_with_the_ends() {
        // Multiples of a third that are collinear only almost.
        let points: Vec<[f64; 2]> = (0..200)
            .map(|i| [f64::from(i - 100) / 3.0, f64::from(i - 100) / 3.0 * 0.7 + f64::from(i % 3) * 1e-17])
            .collect();
        for a in &points {
            for b in points.iter().filter(|b| *b != a) {
                assert_ne!(runs_left(*a, *b), runs_left(*b, *a), "{a:?} {b:?}");
            }
        }
        let third = 1.0 / 3.0;
        // third·3 rounds to 1, the product itself is below.
        assert!(!runs_left([third, 1.0], [1.0, 3.0]) && runs_left([1.0, 3.0], [third, 1.0]));
    }

    #[test]
    fn a_line_through_a_shared_vertex_passes_one_triangle_of_the_fan() {
        for n in [3usize, 5, 8] {
            let rim: Vec<DVec3> = (0..n)
                .map(|i| (std::f64::consts::TAU * i as f64 / n as f64).sin_cos())
                .map(|(y, x)| DVec3::new(x, y, 0.2 * x))
                .collect();
            for shift in 0..50 {
                let o = DVec3::new(0.1 * f64::from(shift), 0.3, 2.0);
                let d = (-o).normalize();
                let s = Shear::new(o, d);
                let passed = (0..n)
                    .filter(|&i| {
                        let vertices = [DVec3::ZERO, rim[i], rim[(i + 1) % n]];
                        let t = Trios::pack(&[0, u32::MAX, u32::MAX, u32::MAX], &[[0, 1, 2]], &vertices);
                        assert!(t.test(&s) & 1 == 1 || !t.passes(&s, 0));
                        t.passes(&s, 0)
                    })
                    .count();
                assert_eq!(passed, 1, "{n} {shift}");
            }
        }
    }
}
