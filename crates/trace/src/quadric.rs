//! Spheres, cones and rings: the nearest acceptable root of each.
//!
//! The quadratics are solved about the point of the ray nearest the surface's own centre rather than about the ray's
//! origin, which leaves their roots as they are and keeps their digits for rays that come from afar.
//! Radiance takes leading coefficients up to 1e-6 for zero, which misplaces or loses hits on cones by rays within a
//! thousandth of a radian of the axis; that is not followed.

use ambit_base::{DVec3, EPSILON};
use ambit_scene::{Cone, Ring, Sphere};

use crate::polygon;

/// Discriminants this close to zero are double roots, below they are none.
const TOUCHING: f64 = 1e-12;

/// A surface hit: distance, and a vector along the outward normal of any length: it takes a root and a division to
/// make a normal of it, which only the nearest hit needs ([`normal`]).
pub(crate) type Found = (f64, DVec3);

/// A cone, and what is needed of it for every ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    cone: Cone,
    /// Change of the radius along the axis.
    slope: f64,
}

impl Frustum {
    pub(crate) fn new(cone: Cone) -> Self {
        Self { cone, slope: (cone.r1 - cone.r0) / cone.length }
    }

    pub(crate) fn inward(&self) -> bool {
        self.cone.inward
    }
}

/// The unit normal of the front.
pub(crate) fn normal(out: DVec3, inward: bool) -> DVec3 {
    unit(if inward { -out } else { out })
}

/// Leading coefficients up to this are rounding errors: the line is parallel to the surface.
const PARALLEL: f64 = 1e-14;

/// Real roots of `a·t² + b·t + c`, ascending, without cancellation.
fn roots(a: f64, b: f64, c: f64) -> ([f64; 2], usize) {
    if a.abs() <= PARALLEL {
        return if b == 0.0 { ([0.0; 2], 0) } else { ([-c / b; 2], 1) };
    }
    let disc = b * b - 4.0 * a * c;
    if disc < -TOUCHING {
        return ([0.0; 2], 0);
    }
    if disc <= TOUCHING {
        return ([-b / (2.0 * a); 2], 1);
    }
    let q = -0.5 * (b + disc.sqrt().copysign(b));
    let (t0, t1) = (q / a, c / q);
    ([t0.min(t1), t0.max(t1)], 2)
}

/// The nearest root above ε, so from inside the far one.
pub(crate) fn sphere(s: &Sphere, origin: DVec3, direction: DVec3, bound: f64) -> Option<Found> {
    let shift = (s.centre - origin).dot(direction);
    let nearest = origin + direction * shift - s.centre;
    let r2 = s.radius * s.radius;
    let (t, n) = roots(1.0, 2.0 * nearest.dot(direction), nearest.dot(nearest) - r2);
    for &root in &t[..n] {
        let t = root + shift;
        if t > EPSILON {
            if t > bound {
                return None;
            }
            return Some((t, nearest + direction * root));
        }
    }
    None
}

/// Roots in ascending order, each above ε, within the bound and with an axial position inside the closed segment.
pub(crate) fn cone(f: &Frustum, origin: DVec3, direction: DVec3, bound: f64) -> Option<Found> {
    let Frustum { cone: c, slope } = f;
    let shift = (c.p0 - origin).dot(direction);
    let start = origin + direction * shift - c.p0;
    // Radial parts of start and direction, and the cone's radius along the ray, r(t) = r + t·dr.
    let (z, dz) = (start.dot(c.axis), direction.dot(c.axis));
    let (w, dw) = (start - c.axis * z, direction - c.axis * dz);
    let (r, dr) = (c.r0 + slope * z, slope * dz);
    let (t, n) = roots(dw.dot(dw) - dr * dr, 2.0 * (w.dot(dw) - r * dr), w.dot(w) - r * r);
    for &root in &t[..n] {
        let t = root + shift;
        if t <= EPSILON || t > bound {
            continue;
        }
        let height = z + root * dz;
        if !(0.0..=c.length).contains(&height) {
            continue;
        }
        // The gradient of |w|² − r²: outward, tilted against the axis by the slope.
        let out = w + dw * root - c.axis * (slope * (r + root * dr));
        let length2 = out.length_squared();
        if !(length2 > 0.0 && length2.is_finite()) {
            continue; // the apex
        }
        return Some((t, out));
    }
    None
}

/// Radii inclusive.
pub(crate) fn ring(r: &Ring, origin: DVec3, direction: DVec3, bound: f64) -> Option<Found> {
    let t = polygon::plane(r.normal, r.normal.dot(r.centre), origin, direction)?;
    if t > bound {
        return None;
    }
    let d2 = (origin + direction * t - r.centre).length_squared();
    (d2 >= r.r0 * r.r0 && d2 <= r.r1 * r.r1).then_some((t, r.normal))
}

fn unit(v: DVec3) -> DVec3 {
    v.normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAR_AWAY: f64 = 1e10;

    #[test]
    fn spheres_are_hit_from_outside_and_inside() {
        let s = Sphere { centre: DVec3::new(1.0, 2.0, 3.0), radius: 2.0, inward: false };
        let (t, out) = sphere(&s, DVec3::new(1.0, 2.0, 10.0), DVec3::NEG_Z, FAR_AWAY).unwrap();
        assert_eq!((t, normal(out, false)), (5.0, DVec3::Z));
        let (t, out) = sphere(&s, s.centre, DVec3::X, FAR_AWAY).unwrap();
        assert_eq!((t, normal(out, false), normal(out, true)), (2.0, DVec3::X, DVec3::NEG_X));
        // From the surface outward: the root at 0 is refused and there is no other.
        assert!(sphere(&s, DVec3::new(3.0, 2.0, 3.0), DVec3::X, FAR_AWAY).is_none());
        assert!(sphere(&s, DVec3::new(3.0, 2.0, 3.0), DVec3::NEG_X, FAR_AWAY).is_some());
    }

    #[test]
    fn a_distant_origin_keeps_its_digits() {
        let s = Sphere { centre: DVec3::ZERO, radius: 1e-3, inward: false };
        let d = DVec3::new(3.0, -2.0, 1.0).normalize();
        let (t, _) = sphere(&s, d * -1e6, d, FAR_AWAY).unwrap();
        assert!((t - (1e6 - 1e-3)).abs() < 1e-9);
    }

    #[test]
    fn cones_are_open_at_their_ends_and_straight_between() {
        let c = Frustum::new(Cone {
            p0: DVec3::ZERO,
            p1: DVec3::new(0.0, 0.0, 2.0),
            r0: 1.0,
            r1: 2.0,
            axis: DVec3::Z,
            length: 2.0,
            inward: false,
        });
        let (t, out) = cone(&c, DVec3::new(5.0, 0.0, 1.0), DVec3::NEG_X, FAR_AWAY).unwrap();
        assert!((t - 3.5).abs() < 1e-12);
        let expected = DVec3::new(2.0, 0.0, -1.0).normalize();
        assert!((normal(out, false) - expected).length() < 1e-12);
        // Down through the open end on to the flank from inside.
        let (t, out) = cone(&c, DVec3::new(1.5, 0.0, 5.0), DVec3::NEG_Z, FAR_AWAY).unwrap();
        assert!((t - 4.0).abs() < 1e-12 && (normal(out, false) - expected).length() < 1e-12);
        assert!(cone(&c, DVec3::new(0.5, 0.0, 5.0), DVec3::NEG_Z, FAR_AWAY).is_none());
    }

    #[test]
    fn both_radii_of_a_ring_are_hit() {
        let r = Ring { centre: DVec3::ZERO, normal: DVec3::Z, r0: 1.0, r1: 2.0 };
        let hit = |x: f64| ring(&r, DVec3::new(x, 0.0, 1.0), DVec3::NEG_Z, FAR_AWAY).is_some();
        assert!(hit(1.0) && hit(2.0) && hit(1.5) && !hit(0.999) && !hit(2.001));
        assert!(ring(&r, DVec3::new(1.5, 0.0, 1.0), DVec3::X, FAR_AWAY).is_none());
    }
}
