//! Area-preserving maps between the unit square, the unit disk and the hemisphere
//! (Shirley & Chiu 1997, *A Low Distortion Map Between Disk and Square*).

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// From the unit square to the unit disk, concentrically.
#[inline]
pub fn square_to_disk(x: f64, y: f64) -> [f64; 2] {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let (r, phi) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * b / a)
    } else if b == 0.0 {
        (0.0, 0.0)
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * a / b)
    };
    let (s, c) = phi.sin_cos();
    [r * c, r * s]
}

/// The inverse of [`square_to_disk`].
pub fn disk_to_square(p: f64, q: f64) -> [f64; 2] {
    let r = p.hypot(q);
    let mut phi = q.atan2(p);
    if phi < -FRAC_PI_4 {
        phi += 2.0 * std::f64::consts::PI;
    }
    let (a, b) = if phi < FRAC_PI_4 {
        (r, phi * r / FRAC_PI_4)
    } else if phi < 3.0 * FRAC_PI_4 {
        (-(phi - FRAC_PI_2) * r / FRAC_PI_4, r)
    } else if phi < 5.0 * FRAC_PI_4 {
        (-r, -(phi - 2.0 * FRAC_PI_2) * r / FRAC_PI_4)
    } else {
        ((phi - 3.0 * FRAC_PI_2) * r / FRAC_PI_4, -r)
    };
    [(a + 1.0) * 0.5, (b + 1.0) * 0.5]
}

/// From the unit square to directions with cosine density about +z.
#[inline]
pub fn cosine_hemisphere(x: f64, y: f64) -> DVec3 {
    let [p, q] = square_to_disk(x, y);
    DVec3::new(p, q, (1.0 - p * p - q * q).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disk_and_square_are_inverse() {
        for i in 0..64 {
            for j in 0..64 {
                let (x, y) = ((f64::from(i) + 0.37) / 64.0, (f64::from(j) + 0.61) / 64.0);
                let [p, q] = square_to_disk(x, y);
                assert!(p * p + q * q <= 1.0 + 1e-12);
                let [a, b] = disk_to_square(p, q);
                assert!((a - x).abs() < 1e-12 && (b - y).abs() < 1e-12, "{x} {y} -> {a} {b}");
            }
        }
    }
}
