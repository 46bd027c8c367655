//! Mesh triangles: does a line pass through, without cracks and double hits.
//!
//! Vertices are sheared so that the ray runs along an axis (Woop, Benthin and Wald 2013); what remains is whether the
//! origin of a plane lies inside a triangle. A vertex has the same sheared coordinates in all its triangles, and the
//! sign of each edge's product is found exactly; where it is zero, the ray counts as displaced by a vanishing amount, first
//! along one axis, then along the other (Edelsbrunner and Mücke 1990). So every line through a closed surface passes
//! through it consistently, at edges and vertices too.

use ambit_base::DVec3;

/// Products whose difference is below this share of their sum may have the wrong sign: 4 roundings.
const UNSURE: f64 = 2.0 * f64::EPSILON;

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

/// One triangle of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trio {
    /// Numbers of its vertices.
    pub(crate) corners: [u32; 3],
    /// Its own number in the mesh.
    pub(crate) number: u32,
}

impl Shear {
    #[inline]
    fn apply(&self, v: DVec3) -> [f64; 2] {
        let [i, j, k] = self.axes;
        let (v, o) = (v.to_array(), self.origin.to_array());
        let height = v[k] - o[k];
        [v[i] - o[i] - self.slope[0] * height, v[j] - o[j] - self.slope[1] * height]
    }

    /// Does the line pass through the triangle?
    #[inline]
    pub(crate) fn passes(&self, corners: &[DVec3; 3]) -> bool {
        let v = corners.map(|c| self.apply(c));
        let left = [0, 1, 2].map(|c| runs_left(v[c], v[(c + 1) % 3]));
        left[0] == left[1] && left[1] == left[2]
    }

    /// Weights of the corners where the line passes.
    pub(crate) fn weights(&self, corners: &[DVec3; 3]) -> [f64; 3] {
        let v = corners.map(|c| self.apply(c));
        let e = [0, 1, 2].map(|c| {
            let (a, b) = (v[c], v[(c + 1) % 3]);
            a[0] * b[1] - a[1] * b[0]
        });
        let sum = e[0] + e[1] + e[2];
        // The edge opposite a corner is the one after the next.
        if sum == 0.0 { [1.0, 0.0, 0.0] } else { [e[1] / sum, e[2] / sum, e[0] / sum] }
    }
}

/// Normal of the front, twice the area long.
#[inline]
pub(crate) fn normal(corners: &[DVec3; 3]) -> DVec3 {
    (corners[1] - corners[0]).cross(corners[2] - corners[0])
}

/// Does the edge from `a` to `b` pass the origin on its right, the origin displaced by a vanishing amount if it lies
/// on the edge's line? Swapping the ends always swaps the answer, unless the ends are equal.
#[inline]
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
                        s.passes(&vertices)
                    })
                    .count();
                assert_eq!(passed, 1, "{n} {shift}");
            }
        }
    }
}
