//! The classical derivatives of irradiance from samples in rings and sectors (Ward & Heckbert 1992, *Irradiance
//! Gradients*), for the spacing by the harmonic mean distance of the split sphere (Ward, Rubinstein, Clear 1988).
//!
//! The boundary between two cells moves with the nearer of the surfaces on either side:
//!
//! ```text
//! ∇ₜE = Σₖ { ûₖ (2π/N) Σⱼ sinθⱼ₋ cos²θⱼ₋ (Lⱼₖ − Lⱼ₋₁ₖ) / min(rⱼₖ, rⱼ₋₁ₖ)
//!          + v̂ₖ₋ Σⱼ (sinθⱼ₊ − sinθⱼ₋) (Lⱼₖ − Lⱼₖ₋₁) / min(rⱼₖ, rⱼₖ₋₁) }
//! ∇ᵣE = (π/MN) Σₖ v̂ₖ Σⱼ tanθⱼ Lⱼₖ
//! ```
//!
//! sinθⱼ₋ = √(j/M), sinθⱼ₊ = √((j+1)/M); û lies in a sector's middle, v̂ a right angle from it, v̂ₖ₋ a right angle from the
//! sector's first border. tanθⱼ is its mean over the ring, which sums to π/2 where the middle of the ring does not.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

/// ∇ₜE/E along the frame's u and v, 1/length. `values` are radiances over their mean (any constant less), ring by ring,
/// `distances` those of the samples.
pub(crate) fn translational(rings: usize, sectors: usize, values: &[f64], distances: &[f64]) -> [f64; 2] {
    let (m, n) = (rings as f64, sectors as f64);
    let mut sum = [0.0; 2];
    for k in 0..sectors {
        let before = (k + sectors - 1) % sectors;
        let (mut outward, mut around) = (0.0, 0.0);
        for j in 0..rings {
            let here = j * sectors + k;
            let across = |other: usize| (values[here] - values[other]) / distances[here].min(distances[other]);
            let inner = j as f64 / m;
            if j > 0 {
                outward += inner.sqrt() * (1.0 - inner) * across(here - sectors);
            }
            around += (((j + 1) as f64 / m).sqrt() - inner.sqrt()) * across(j * sectors + before);
        }
        let (middle, first) = (TAU * (k as f64 + 0.5) / n, TAU * k as f64 / n + FRAC_PI_2);
        sum[0] += TAU / n * outward * middle.cos() + around * first.cos();
        sum[1] += TAU / n * outward * middle.sin() + around * first.sin();
    }
    sum.map(|x| x * FRAC_1_PI)
}

/// ∇ᵣE/E as components of the turning axis along u and v, 1/radian.
pub(crate) fn rotational(rings: usize, sectors: usize, values: &[f64]) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for j in 0..rings {
        let tangent = mean_tangent(j, rings);
        for k in 0..sectors {
            let (s, c) = (TAU * (k as f64 + 0.5) / sectors as f64).sin_cos();
            let v = values[j * sectors + k] * tangent;
            sum[0] -= v * s;
            sum[1] += v * c;
        }
    }
    sum.map(|x| x / (rings * sectors) as f64)
}

/// The mean of tanθ over ring j of M, weighted by projected solid angle: ∫ √(u/(1−u)) du.
fn mean_tangent(j: usize, rings: usize) -> f64 {
    let integral = |u: f64| u.sqrt().asin() - (u * (1.0 - u)).max(0.0).sqrt();
    let m = rings as f64;
    m * (integral((j + 1) as f64 / m) - integral(j as f64 / m))
}

/// The harmonic mean of the sample distances, given their reciprocals; `None` if all are at infinity.
pub(crate) fn harmonic_mean(nearness: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = nearness.len() as f64;
    let sum: f64 = nearness.sum();
    (sum > 0.0).then(|| count / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Radiance at the middles of the cells from the azimuth and sin²θ.
    fn cells(rings: usize, sectors: usize, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let cell = |c: usize| {
            let (j, k) = ((c / sectors) as f64 + 0.5, (c % sectors) as f64 + 0.5);
            f(TAU * k / sectors as f64, j / rings as f64)
        };
        (0..rings * sectors).map(cell).collect()
    }

    #[test]
    fn the_split_sphere_is_exact_for_any_numbers() {
        // Bright for x > 0, radius 2, E = πL/2: dE/dx over E is 4/(πR), turning towards x gives 1/rad.
        for (rings, sectors) in [(4, 12), (8, 24), (16, 48)] {
            for scale in [1e-4, 1.0, 1e5] {
                let values = cells(rings, sectors, |azimuth, _| if azimuth.cos() > 0.0 { 2.0 } else { 0.0 });
                let distances = vec![2.0 * scale; values.len()];
                let [x, y] = translational(rings, sectors, &values, &distances);
                let expected = 4.0 / (std::f64::consts::PI * 2.0);
                assert!((x * scale - expected).abs() < 1e-12 && (y * scale).abs() < 1e-12, "{x} {y}");
                // A sector's middle stands for its arc: the sum over a half circle of cosines is off by (π/N)²/6 of itself.
                let [u, v] = rotational(rings, sectors, &values);
                let arc = std::f64::consts::PI / sectors as f64;
                assert!(u.abs() < 1e-12 && (v - arc / arc.sin()).abs() < 1e-9, "{u} {v}");
            }
        }
    }

    #[test]
    fn a_disk_overhead_moves_its_rim() {
        // A bright disk of radius b at height c fills half the projected hemisphere (b = c = 1: F = ½): straight below its
        // centre the gradient is 0. Beside it the formula is first order in the cells; here the cells follow the disk.
        let (rings, sectors) = (8, 24);
        let values = cells(rings, sectors, |_, u| if u < 0.5 { 2.0 } else { 0.0 });
        let distances: Vec<f64> = cells(rings, sectors, |_, u| if u < 0.5 { 1.0 / (1.0 - u).sqrt() } else { 1e10 });
        let [x, y] = translational(rings, sectors, &values, &distances);
        assert!(x.abs() < 1e-12 && y.abs() < 1e-12, "{x} {y}");
    }

    #[test]
    fn ring_means_sum_to_a_right_angle() {
        for rings in [3, 7, 40] {
            let sum: f64 = (0..rings).map(|j| mean_tangent(j, rings)).sum();
            assert!((sum / rings as f64 - FRAC_PI_2).abs() < 1e-12);
        }
    }

    #[test]
    fn uniform_surroundings_have_no_derivatives() {
        let distances = cells(5, 16, |azimuth, u| 0.1 + u + azimuth.cos().abs());
        let values = vec![1.0; distances.len()];
        assert_eq!(translational(5, 16, &values, &distances), [0.0; 2]);
        assert!(rotational(5, 16, &values).iter().all(|h| h.abs() < 1e-12));
    }
}
