//! Derivatives of irradiance from hemisphere samples: the sample points form a triangle mesh of constant radiance a
//! triangle, whose irradiance is differentiated exactly (occlusion-aware Hessian of Schwarzhaupt, Jensen, Jarosz 2012;
//! form-factor derivatives of Holzschuch & Sillion 1998). A triangle has the radiance of its farthest vertex, so that
//! edges of near occluders move, not what is behind them.
//!
//! With r = a − x, s = b − x, e = b − a, c = r × s along an edge a→b and γ the angle between r and s,
//!
//! ```text
//! Iₖ = ∫₀¹ dt/|r + te|²ᵏ    Jₖ = ∫₀¹ t dt/|r + te|²ᵏ    Kₖ = ∫₀¹ t² dt/|r + te|²ᵏ    q = I₂ r + J₂ e
//! F  = (1/2π) Σ (N·c) I₁
//! ∇F = (1/2π) Σ [ I₁ (N×e) + 2 (N·c) q ]
//! H  = (1/π)  Σ [ (N×e)qᵀ + q(N×e)ᵀ + (N·c)(4(I₃ rrᵀ + J₃(reᵀ+erᵀ) + K₃ eeᵀ) − I₂·1) ]
//! ```
//!
//! All in the hemisphere's frame with x at the origin, so N = z. An inner edge counts with the difference of its two
//! triangles' radiances. Radiances enter less their mean, as if the mesh continued to the horizon with the mean: uniform
//! surroundings then have no gradient, where Radiance's open rim gives up to 0.65/m near walls.

use ambit_base::DVec3;
use std::f64::consts::FRAC_1_PI;

/// Edges whose plane passes this close to the point, relative to their length, are skipped: they contribute nothing.
const DEGENERATE: f64 = 1e-12;

/// First and second derivatives of a form factor with respect to the receiver's position in its tangent plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Derivatives {
    /// Along u and v, 1/length.
    pub(crate) gradient: [f64; 2],
    /// uu, uv, vv, 1/length².
    pub(crate) hessian: [f64; 3],
}

impl Derivatives {
    /// Adds `weight` times the contribution of the edge from `r` to `s`.
    pub(crate) fn add_edge(&mut self, r: DVec3, s: DVec3, weight: f64) {
        let e = s - r;
        let c = r.cross(s);
        let (c2, r2, s2, e2) = (c.length_squared(), r.length_squared(), s.length_squared(), e.length_squared());
        if c2.is_nan() || c2 <= DEGENERATE * DEGENERATE * r2 * s2 || e2 == 0.0 {
            return;
        }
        let (er, es) = (e.dot(r), e.dot(s));
        let length = c2.sqrt();
        // The arctangent of two arguments keeps all digits at small and at right angles.
        let i1 = length.atan2(r.dot(s)) / length;
        let (ir2, is2, ic2, ie2) = (1.0 / r2, 1.0 / s2, 1.0 / c2, 1.0 / e2);
        let i2 = (es * is2 - er * ir2 + e2 * i1) * (0.5 * ic2);
        let j2 = (0.5 * (ir2 - is2) - er * i2) * ie2;
        let i3 = (es * is2 * is2 - er * ir2 * ir2 + 3.0 * e2 * i2) * (0.25 * ic2);
        let j3 = (0.25 * (ir2 * ir2 - is2 * is2) - er * i3) * ie2;
        let k3 = (i2 - r2 * i3 - 2.0 * er * j3) * ie2;
        // N × e for N = z.
        let (ex, ey) = (-e.y, e.x);
        let (qx, qy) = (i2 * r.x + j2 * e.x, i2 * r.y + j2 * e.y);
        let half = 0.5 * FRAC_1_PI * weight;
        self.gradient[0] += half * (i1 * ex + 2.0 * c.z * qx);
        self.gradient[1] += half * (i1 * ey + 2.0 * c.z * qy);
        let quadratic =
            |ra: f64, ea: f64, rb: f64, eb: f64| 4.0 * (i3 * ra * rb + j3 * (ra * eb + ea * rb) + k3 * ea * eb);
        let whole = FRAC_1_PI * weight;
        self.hessian[0] += whole * (2.0 * ex * qx + c.z * (quadratic(r.x, e.x, r.x, e.x) - i2));
        self.hessian[1] += whole * (ex * qy + ey * qx + c.z * quadratic(r.x, e.x, r.y, e.y));
        self.hessian[2] += whole * (2.0 * ey * qy + c.z * (quadratic(r.y, e.y, r.y, e.y) - i2));
    }

    /// True if every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.gradient.iter().chain(&self.hessian).all(|x| x.is_finite())
    }
}

/// Derivatives of the mesh over an n × n grid of points (row by row, first index along v, second along u).
/// `values` are relative radiances less their mean.
pub(crate) fn mesh(n: usize, points: &[DVec3], values: &[f64]) -> Derivatives {
    let distances: Vec<f64> = points.iter().map(|p| p.length_squared()).collect();
    let farthest = |a: usize, b: usize, c: usize| {
        let ab = if distances[b] > distances[a] { b } else { a };
        values[if distances[c] > distances[ab] { c } else { ab }]
    };
    // Quads are cut along (i,j+1)–(i+1,j).
    let at = |i: usize, j: usize| i * n + j;
    let near = |i: usize, j: usize| farthest(at(i, j), at(i, j + 1), at(i + 1, j));
    let far = |i: usize, j: usize| farthest(at(i + 1, j + 1), at(i + 1, j), at(i, j + 1));
    let mut sum = Derivatives::default();
    let mut edge = |a: usize, b: usize, weight: f64| {
        if weight != 0.0 {
            sum.add_edge(points[a], points[b], weight);
        }
    };
    let mut above = vec![0.0; n];
    for i in 0..n {
        let mut left = 0.0;
        for j in 0..n {
            let quad = i + 1 < n && j + 1 < n;
            let (first, second) = if quad { (near(i, j), far(i, j)) } else { (0.0, 0.0) };
            if j + 1 < n {
                edge(at(i, j), at(i, j + 1), first - above[j]);
            }
            if i + 1 < n {
                edge(at(i, j), at(i + 1, j), left - first);
            }
            if quad {
                edge(at(i, j + 1), at(i + 1, j), first - second);
            }
            above[j] = second;
            left = second;
        }
    }
    sum
}

/// Rotational gradient from the same cells: the mean of v·tanθ times the unit vector at azimuth + 90°, as components
/// along u and v, 1/radian.
///
/// The mean of tan²θ over the hemisphere diverges, so tanθ is replaced by its mean over the cell's ring of the disk,
/// [asin ρ − ρ√(1−ρ²)] between the ring's radii over the difference of ρ².
pub(crate) fn rotational(n: usize, points: &[DVec3], values: &[f64]) -> [f64; 2] {
    let integral = |rho: f64| rho.min(1.0).asin() - rho * (1.0 - rho * rho).max(0.0).sqrt();
    let mut rings = vec![0.0; n];
    for (k, tangent) in rings.iter_mut().enumerate() {
        // Column k spans these coordinates of [−1, 1].
        let (a, b) = (2.0 * k as f64 / n as f64 - 1.0, 2.0 * (k + 1) as f64 / n as f64 - 1.0);
        let (outer, inner) = (a.abs().max(b.abs()), if a * b < 0.0 { 0.0 } else { a.abs().min(b.abs()) });
        *tangent = (integral(outer) - integral(inner)) / (outer * outer - inner * inner);
    }
    let mut h = [0.0; 2];
    for (cell, (p, v)) in points.iter().zip(values).enumerate() {
        let rho = p.x.hypot(p.y);
        if rho > 0.0 {
            // Outer rings have the larger tangent.
            let tangent = rings[cell / n].max(rings[cell % n]);
            h[0] -= v * tangent * p.y / rho;
            h[1] += v * tangent * p.x / rho;
        }
    }
    h.map(|x| x / (n * n) as f64)
}
