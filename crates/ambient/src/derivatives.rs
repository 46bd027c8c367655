//! Derivatives of the irradiance from polygons of constant radiance, edge by edge and exactly (form-factor derivatives of
//! Holzschuch & Sillion 1998).
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
//! All in the hemisphere's frame with x at the origin, so N = z.
//!
//! These closed forms are what [`crate::edges`] is tested with.

/// First and second derivatives of a form factor with respect to the receiver's position in its tangent plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Derivatives {
    /// Along u and v, 1/length.
    pub(crate) gradient: [f64; 2],
    /// uu, uv, vv, 1/length².
    pub(crate) hessian: [f64; 3],
}

impl Derivatives {
    /// True if every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.gradient.iter().chain(&self.hessian).all(|x| x.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::DVec3;
    use std::f64::consts::FRAC_1_PI;

    /// Edges whose plane passes this close to the point, relative to their length, contribute nothing.
    const DEGENERATE: f64 = 1e-12;

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
            let i1 = c2.sqrt().atan2(r.dot(s)) / c2.sqrt();
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
    }

    /// F, ∇F and H of a polygon of unit radiance seen from the origin.
    fn polygon(corners: &[DVec3]) -> Derivatives {
        let mut d = Derivatives::default();
        for (k, &a) in corners.iter().enumerate() {
            d.add_edge(a, corners[(k + 1) % corners.len()], 1.0);
        }
        d
    }

    fn rectangle(x: f64, y: f64, scale: f64) -> Derivatives {
        let corner = |a: f64, b: f64| DVec3::new(a - x, b - y, 1.0) * scale;
        polygon(&[corner(-1.0, -0.5), corner(1.0, -0.5), corner(1.0, 0.5), corner(-1.0, 0.5)])
    }

    fn close(got: f64, expected: f64, tolerance: f64) {
        assert!((got - expected).abs() <= tolerance, "{got} instead of {expected}");
    }

    #[test]
    fn a_parallel_rectangle_has_exact_derivatives_at_every_scale() {
        for scale in [1e-4, 1e-2, 1.0, 1e2, 1e5] {
            for (x, y, g, h) in [
                (0.0, 0.0, [0.0, 0.0], [-0.2837146, 0.0, -0.7711198]),
                (0.5, 0.2, [-0.1451822, -0.1319328], [-0.3088712, 0.0663590, -0.5998597]),
                (1.5, 0.3, [-0.1587352, -0.0423258], [0.2334342, 0.1012942, -0.1158869]),
                (1.2, 0.4, [-0.2035562, -0.1008210], [0.1315145, 0.1936081, -0.1621327]),
            ] {
                let d = rectangle(x, y, scale);
                (0..2).for_each(|k| close(d.gradient[k] * scale, g[k], 1e-7));
                (0..3).for_each(|k| close(d.hessian[k] * scale * scale, h[k], 1e-7));
            }
        }
    }

    #[test]
    fn a_perpendicular_wall_has_exact_derivatives() {
        for (c, fx, hxx, hyy) in [
            (0.1, -0.5591066, 0.1817500, -0.0466501),
            (0.5, -0.3925594, 0.5264022, -0.1408423),
            (1.0, -0.1753691, 0.3072634, -0.0884194),
            (2.0, -0.0331935, 0.0497352, -0.0155618),
        ] {
            let corner = |y: f64, z: f64| DVec3::new(-c, y, z);
            let d = polygon(&[corner(1.0, 0.0), corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, 0.0)]);
            let sign = d.gradient[0].signum() * f64::signum(fx);
            close(sign * d.gradient[0], fx, 1e-7);
            close(sign * d.hessian[0], hxx, 1e-7);
            close(sign * d.hessian[2], hyy, 1e-7);
        }
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let step = 1e-5;
        for (x, y) in [(0.1, -0.3), (0.9, 0.8), (-1.7, 0.2)] {
            let d = rectangle(x, y, 1.0);
            let (right, left) = (rectangle(x + step, y, 1.0), rectangle(x - step, y, 1.0));
            close(d.hessian[0], (right.gradient[0] - left.gradient[0]) / (2.0 * step), 1e-8);
            close(d.hessian[1], (right.gradient[1] - left.gradient[1]) / (2.0 * step), 1e-8);
        }
    }

    #[test]
    fn coincident_and_collinear_points_add_nothing() {
        let mut d = Derivatives::default();
        let p = DVec3::new(0.1, 0.2, 0.3);
        d.add_edge(p, p, 1.0);
        d.add_edge(p, p * 2.0, 1.0);
        d.add_edge(p * 1e9, p * 1e-6, 1.0);
        assert_eq!(d, Derivatives::default());
    }
}
