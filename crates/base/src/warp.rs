//! Area-preserving maps between the unit square and the unit disk, which is a hemisphere seen from above
//! (Shirley & Chiu 1997, *A Low Distortion Map Between Disk and Square*).

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// From the unit square to the unit disk, concentrically.
#[inline]
pub fn square_to_disk(x: f64, y: f64) -> [f64; 2] {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a.abs() > b.abs() {
        let (s, c) = sin_cos(FRAC_PI_4 * (b / a));
        [a * c, a * s]
    } else if b == 0.0 {
        [0.0; 2]
    } else {
        let (s, c) = sin_cos(FRAC_PI_4 * (a / b));
        [b * s, b * c]
    }
}

/// Sine and cosine of an angle of at most π/4, radians: series whose first missing terms are below 1e-16. The library's
/// general function costs several times as much, and this map is called for every sample.
#[inline]
fn sin_cos(x: f64) -> (f64, f64) {
    let series = |terms: [f64; 7], y: f64| terms.into_iter().rev().fold(0.0, |sum, t| sum * y + t);
    let y = x * x;
    (x * (1.0 + y * series(SINE, y)), 1.0 + y * series(COSINE, y))
}

/// (−1)ᵏ/(2k + 1)! from k = 1 on.
const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
/// (−1)ᵏ/(2k)! from k = 1 on.
const COSINE: [f64; 7] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
];

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_exact_to_rounding() {
        for k in -1000..=1000 {
            let x = FRAC_PI_4 * f64::from(k) / 1000.0;
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() < 2.5e-16 && (c - x.cos()).abs() < 2.5e-15, "{x}");
        }
    }

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
