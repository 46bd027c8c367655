//! Derivatives from the edges of a mesh of sample points, eight edges at a time.
//!
//! The terms of [`crate::derivatives`] for an edge a→b, with r̂ and ŝ the directions to its ends, nr = 1/r, ns = 1/s,
//! v(u) = (1−u) r̂ + u ŝ and f(u) = (1−u) nr + u ns, are integrals of smooth functions without roots or differences of
//! large numbers (v/|v| runs along the edge's arc, f/|v| is the reciprocal distance there):
//!
//! ```text
//! I₁ e = (ŝ nr − r̂ ns) ∫ du/|v|²        (N·c) q    = (r̂ × ŝ)·N ∫ v f/|v|⁴ du
//! (N·c) I₂ = (r̂ × ŝ)·N ∫ f²/|v|⁴ du     (N·c) M    = (r̂ × ŝ)·N ∫ v vᵀ f²/|v|⁶ du     M = I₃ rrᵀ + J₃(reᵀ+erᵀ) + K₃ eeᵀ
//! ```
//!
//! Neighbouring samples are seen under small angles, so that three Gauss points do: the error of an edge seen
//! under an angle of γ radians is at most 0.01 γ⁵ over its distance (squared). Single precision: hemispheres are noisier by far.

use crate::derivatives::Derivatives;
use ambit_base::DVec3;
use std::f64::consts::FRAC_1_PI;
use wide::f32x8;

/// Edges added at a time.
const LANES: usize = 8;
/// Gauss points of the unit interval, and their weights: √(3/5)/2 about the middle.
const NODES: [(f32, f32); 3] = [(0.112_701_66, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_35, 5.0 / 18.0)];

/// Sample points of a hemisphere by direction in its frame and reciprocal distance (1/scene unit), in columns.
///
/// `slope` is w of the plane that the point lies in: along any direction d, the plane's reciprocal distance is w·d.
#[derive(Clone, Debug, Default)]
pub(crate) struct Points {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    near: Vec<f32>,
    slope: [Vec<f32>; 3],
    len: usize,
}

/// Planes seen at a smaller cosine than this are taken for unknown: their slope would be mostly rounding.
const EDGE_ON: f64 = 1e-5;
/// Points count as lying in each other's planes up to this part of the planes' slopes, which is what rounding of
/// directions does.
const SLACK: f32 = 1e-5;

impl Points {
    /// Points from unit directions, reciprocal distances and normals of the surfaces they lie on (0: unknown, which counts as
    /// facing the origin).
    pub(crate) fn new(points: impl ExactSizeIterator<Item = (DVec3, f32, DVec3)>) -> Self {
        let len = points.len();
        // What lies behind the last point is read with it, for edges of no weight.
        let column = || Vec::with_capacity(len + LANES);
        let slope = [column(), column(), column()];
        let mut columns = Self { x: column(), y: column(), z: column(), near: column(), slope, len };
        for (d, near, normal) in points {
            columns.push(d.x as f32, d.y as f32, d.z as f32, near);
            let cosine = normal.dot(d);
            let slope = if cosine.abs() < EDGE_ON { d } else { normal / cosine } * f64::from(near);
            for (column, w) in columns.slope.iter_mut().zip(slope.to_array()) {
                column.push(w as f32);
            }
        }
        columns.pad();
        for column in &mut columns.slope {
            column.resize(len + LANES, 0.0);
        }
        columns
    }

    fn push(&mut self, x: f32, y: f32, z: f32, near: f32) {
        self.x.push(x);
        self.y.push(y);
        self.z.push(z);
        self.near.push(near);
    }

    fn pad(&mut self) {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.near] {
            column.resize(self.len + LANES, 0.0);
        }
    }

    /// The points with the given numbers, in that order.
    pub(crate) fn picked(&self, numbers: impl ExactSizeIterator<Item = usize>) -> Self {
        let len = numbers.len();
        let mut columns = Self { len, ..Self::default() };
        for k in numbers {
            columns.push(self.x[k], self.y[k], self.z[k], self.near[k]);
        }
        columns.pad();
        columns
    }

    /// Tangential components of the direction to a point.
    pub(crate) fn tangential(&self, k: usize) -> [f32; 2] {
        [self.x[k], self.y[k]]
    }

    /// Reciprocal distances.
    pub(crate) fn nearness(&self) -> &[f32] {
        &self.near[..self.len]
    }

    /// Of the points `from`, `from + 1` … and `to`, `to + 1` …, which pairs may lie on connected surfaces: on one plane, or
    /// on two planes that meet between them, as in corners. Else one surface ends between them in front of the other.
    pub(crate) fn joined(&self, from: usize, to: usize, count: usize) -> Vec<bool> {
        let mut joined = Vec::with_capacity(count.next_multiple_of(LANES));
        for k in (0..count).step_by(LANES) {
            let ([ax, ay, az, near_a], [bx, by, bz, near_b]) = (self.eight(from + k), self.eight(to + k));
            let ([px, py, pz], [qx, qy, qz]) = (self.slopes(from + k), self.slopes(to + k));
            // How much in front of the other's plane the first is, and behind it the second: of different signs where both
            // are in front or both behind, and the planes meet between.
            let a = near_a - (qx * ax + qy * ay + qz * az);
            let b = px * bx + py * by + pz * bz - near_b;
            let size = px * px + py * py + pz * pz + qx * qx + qy * qy + qz * qz;
            let meet = (a * b - size * (SLACK * SLACK)).to_array();
            joined.extend(meet.map(|x| x <= 0.0));
        }
        joined.truncate(count);
        joined
    }

    fn slopes(&self, k: usize) -> [f32x8; 3] {
        [0, 1, 2].map(|axis| load(&self.slope[axis], k))
    }

    fn eight(&self, k: usize) -> [f32x8; 4] {
        [&self.x, &self.y, &self.z, &self.near].map(|column| load(column, k))
    }
}

/// Eight numbers from `k` on.
fn load(column: &[f32], k: usize) -> f32x8 {
    f32x8::from(<[f32; LANES]>::try_from(&column[k..k + LANES]).expect("a range of eight"))
}

/// Weights of many edges, with room for whole groups of eight.
pub(crate) struct Weights {
    weights: Vec<f32>,
    len: usize,
}

impl Weights {
    /// Of `len` edges, 0 each.
    pub(crate) fn new(len: usize) -> Self {
        Self { weights: vec![0.0; len.next_multiple_of(LANES)], len }
    }

    /// The weights, to be set.
    pub(crate) fn all(&mut self) -> &mut [f32] {
        &mut self.weights[..self.len]
    }
}

/// Groups whose sums are kept in single precision.
const RUN: usize = 32;

/// Adds the edges from the points `from`, `from + 1` … to the points `to`, `to + 1` …, as many as there are weights.
pub(crate) fn add_edges(sum: &mut Derivatives, points: &Points, from: usize, to: usize, weights: &Weights) {
    for (run, weights) in weights.weights.chunks(LANES * RUN).enumerate() {
        let mut sums = Sums::default();
        for (group, weights) in weights.chunks_exact(LANES).enumerate() {
            let k = (run * RUN + group) * LANES;
            sums.add(points.eight(from + k), points.eight(to + k), load(weights, 0));
        }
        sums.add_to(sum);
    }
}

/// Sums over eight lanes: ∇F times 2π, H times π.
#[derive(Default)]
struct Sums {
    gx: f32x8,
    gy: f32x8,
    hxx: f32x8,
    hxy: f32x8,
    hyy: f32x8,
}

impl Sums {
    /// Adds eight edges.
    #[inline]
    fn add(&mut self, [ax, ay, az, near_a]: [f32x8; 4], [bx, by, bz, near_b]: [f32x8; 4], weight: f32x8) {
        // |v|² = 1 − u(1−u)|r̂ − ŝ|².
        let (dx, dy, dz) = (bx - ax, by - ay, bz - az);
        let chord2 = dx * dx + dy * dy + dz * dz;
        let rise = near_b - near_a;
        let zero = f32x8::ZERO;
        let [mut i1, mut qx, mut qy, mut i2, mut mxx, mut mxy, mut myy] = [zero; 7];
        for (u, share) in NODES {
            let inverse = f32x8::ONE / (f32x8::ONE - chord2 * (u * (1.0 - u)));
            let near = (near_a + rise * u) * inverse;
            let (wx, wy) = ((ax + dx * u) * near, (ay + dy * u) * near);
            let inverse = inverse * share;
            i1 += inverse;
            let (sx, sy) = (wx * inverse, wy * inverse);
            qx += sx;
            qy += sy;
            i2 += near * near * share;
            mxx += wx * sx;
            mxy += wx * sy;
            myy += wy * sy;
        }
        // N × e over r s, and N · c over r s.
        let (ex, ey) = ((ay * near_b - by * near_a) * weight, (bx * near_a - ax * near_b) * weight);
        let cz = (ax * by - ay * bx) * weight;
        self.gx += i1 * ex + cz * qx * 2.0;
        self.gy += i1 * ey + cz * qy * 2.0;
        self.hxx += ex * qx * 2.0 + cz * (mxx * 4.0 - i2);
        self.hxy += ex * qy + ey * qx + cz * mxy * 4.0;
        self.hyy += ey * qy * 2.0 + cz * (myy * 4.0 - i2);
    }

    fn add_to(self, sum: &mut Derivatives) {
        let total = |lanes: f32x8| lanes.to_array().into_iter().map(f64::from).sum::<f64>();
        for (to, lanes) in sum.gradient.iter_mut().zip([self.gx, self.gy]) {
            *to += 0.5 * FRAC_1_PI * total(lanes);
        }
        for (to, lanes) in sum.hessian.iter_mut().zip([self.hxx, self.hxy, self.hyy]) {
            *to += FRAC_1_PI * total(lanes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::Stream;

    /// A random direction upwards and one `angle` away from it.
    fn pair(key: u64, angle: f64) -> [DVec3; 2] {
        let draw = |tag| DVec3::from_array(Stream::new(tag, key).three()) - 0.5;
        let a = draw(0).normalize();
        let a = DVec3::new(a.x, a.y, a.z.abs());
        let across = draw(1).reject_from(a).normalize();
        [a, a * angle.cos() + across * angle.sin()]
    }

    #[test]
    fn edges_agree_with_the_closed_form() {
        for angle in [0.02, 0.1, 0.2, 0.4f64] {
            // Rounding of directions and reciprocal distances, and what three Gauss points leave; relative to the greater
            // reciprocal distance of the ends (squared for the Hessian).
            let tolerance = 3e-7 + 0.01 * angle.powi(5);
            for key in 0..3000 {
                let [a, b] = pair(key, angle);
                let [p, q, w] = Stream::new(2, key).three();
                let scale = [1e-4, 1.0, 1e5][key as usize % 3];
                let (r, s) = (scale * 10f64.powf(2.0 * p - 1.0), scale * 10f64.powf(2.0 * q - 1.0));
                let mut exact = Derivatives::default();
                exact.add_edge(a * r, b * s, w);
                let points =
                    Points::new([(a, (1.0 / r) as f32, DVec3::ZERO), (b, (1.0 / s) as f32, DVec3::ZERO)].into_iter());
                let mut weights = Weights::new(1);
                weights.all()[0] = w as f32;
                let mut sum = Derivatives::default();
                add_edges(&mut sum, &points, 0, 1, &weights);
                let near = 1.0 / r.min(s);
                let close = |got: &[f64], exact: &[f64], size: f64| {
                    got.iter().zip(exact).all(|(x, y)| (x - y).abs() <= tolerance * w * size)
                };
                assert!(close(&sum.gradient, &exact.gradient, near), "{key} at {angle}: {sum:?} for {exact:?}");
                assert!(close(&sum.hessian, &exact.hessian, near * near), "{key} at {angle}: {sum:?} for {exact:?}");
            }
        }
    }

    /// Two points in a room by their directions, with the distance and the normal of the nearest plane n·p = h.
    fn pair_joined(planes: &[(DVec3, f64)], a: DVec3, b: DVec3) -> bool {
        let meet = |d: DVec3| {
            let ahead = planes.iter().filter(|(n, _)| n.dot(d) > 0.0);
            let nearest = ahead.map(|(n, h)| (h / n.dot(d), *n)).min_by(|x, y| x.0.total_cmp(&y.0));
            let (t, n) = nearest.expect("a plane ahead");
            (d, (1.0 / t) as f32, n)
        };
        let points = Points::new([meet(a.normalize()), meet(b.normalize())].into_iter());
        points.joined(0, 1, 1)[0]
    }

    #[test]
    fn points_on_one_plane_and_across_corners_are_joined() {
        for scale in [1e-4, 1.0, 1e5] {
            // A wall 0.1 away and a ceiling 2 above.
            let room = [(DVec3::X, 0.1 * scale), (DVec3::Z, 2.0 * scale)];
            for key in 0..1000 {
                let [a, b] = pair(key, 0.3);
                let inside = |d: DVec3| d.x > 0.0 && d.z > 0.0;
                if inside(a) && inside(b) {
                    assert!(pair_joined(&room, a, b), "{key}: {a} and {b} at {scale}");
                }
            }
        }
    }

    #[test]
    fn a_surface_in_front_of_another_is_not_joined_with_it() {
        for scale in [1e-4f64, 1.0, 1e5] {
            let near = (DVec3::new(0.3, 0.1, 1.0).normalize(), (0.5 * scale).recip() as f32, DVec3::Z);
            let far = (DVec3::new(0.2, 0.1, 1.0).normalize(), (2.0 * scale).recip() as f32, DVec3::Z);
            let sky = (DVec3::new(0.1, 0.1, 1.0).normalize(), 1e-12, DVec3::ZERO);
            let points = Points::new([near, far, sky, sky].into_iter());
            assert_eq!(points.joined(0, 1, 3), [false, false, true], "at {scale}");
        }
    }

    #[test]
    fn coincident_points_add_nothing() {
        let points = Points::new([(DVec3::Z, 2.0, DVec3::ZERO); 9].into_iter());
        let mut weights = Weights::new(8);
        weights.all().fill(1.0);
        let mut sum = Derivatives::default();
        add_edges(&mut sum, &points, 0, 1, &weights);
        assert_eq!(sum, Derivatives::default());
    }
}
