//! Classical spacing: the harmonic mean distance, and the gradients of rings and sectors, against closed forms at scales
//! from 1e-4 to 1e5 and a million units from the origin.

mod around;

use ambit_ambient::{Params, Record, Spacing, Systems};
use ambit_base::{DVec3, FAR, Rgb};
use around::{close, params, record_with, rectangle, world};
use std::f64::consts::PI;

const SCALES: [f64; 5] = [1e-4, 1e-2, 1.0, 1e2, 1e5];

fn classical(divisions: i32, seed: u64) -> Params {
    let systems = Systems { spacing: Spacing::Classical, ..Systems::default() };
    Params { systems, ..params(divisions, seed) }
}

fn record(
    divisions: i32,
    seed: u64,
    scale: f64,
    position: DVec3,
    around: impl Fn(DVec3, DVec3) -> (f32, f64) + Sync,
) -> Record {
    record_with(classical(divisions, seed), 1e3 * scale, position, around)
}

/// Relative error of a mean over 16384 stratified samples: three times N^−¾, which is what is left where the integrand is
/// continuous in each cell.
const STRATIFIED: f64 = 0.002;

#[test]
fn radii_are_harmonic_mean_distances() {
    for scale in SCALES {
        for origin in [DVec3::ZERO, DVec3::splat(1e6)] {
            let radius = |brightness: f32, distance: &(dyn Fn(DVec3) -> f64 + Sync)| {
                let r = record(16384, 1, scale, origin, |_, d| (brightness, distance(d) * scale));
                assert_eq!(r.radii[0], r.radii[1]);
                assert_eq!(r.value, Rgb::splat(brightness));
                f64::from(r.radii[0]) / scale
            };
            // Without light they are the same.
            for brightness in [0.0, 3.0] {
                // No sample differs from the next: what is left is rounding to f32 in file and sum.
                close(radius(brightness, &|_| 2.0), 2.0, 1e-5, "sphere of radius 2");
                let mean = |distance: &(dyn Fn(DVec3) -> f64 + Sync), want: f64, what| {
                    close(radius(brightness, distance), want, STRATIFIED * want, what);
                };
                mean(&|d: DVec3| 1.0 / d.z, 1.5, "ceiling at height 1");
                let wall = |d: DVec3| if d.x > 0.0 { 1.0 / d.x } else { FAR / scale };
                mean(&wall, 1.5 * PI, "wall at distance 1");
                mean(&|d: DVec3| 1.0 / d.x.abs(), 0.75 * PI, "between two walls");
            }
        }
    }
}

/// Records whose noise is averaged.
const RUNS: u64 = 20;

/// 1024 samples make 57 sectors; light at an edge acts where the nearest borders of sectors are, which makes its mean the
/// smaller by sinc²(π/57), 1 − (π/57)²/3.
const SECTORS: f64 = 1e-3;

/// Holds the mean of runs to what it should be: within four of its standard errors, which must themselves be small, and
/// what sectors make of it.
fn holds(runs: &[f64], want: f64, most: f64, what: &str) {
    let n = runs.len() as f64;
    let mean = runs.iter().sum::<f64>() / n;
    let error = (runs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    println!("{what}: {mean} ± {error} for {want}");
    assert!(error < most, "{what}: {mean} ± {error} says little about {want}");
    assert!((mean - want).abs() <= 4.0 * error + SECTORS * want, "{what}: {mean} ± {error} for {want}");
}

#[test]
fn the_split_sphere_has_its_gradients_and_limits() {
    for scale in SCALES {
        for origin in [DVec3::ZERO, DVec3::new(1e6, -1e6, 1e6)] {
            let runs: Vec<[f64; 4]> = (0..RUNS)
                .map(|seed| {
                    let bright = |_, d: DVec3| (if d.x > 0.0 { 1.0 } else { 0.0 }, 2.0 * scale);
                    let r = record(1024, seed, scale, origin, bright);
                    let ([x, y], [_, h]) = (world(&r, r.gradient), world(&r, r.rotation));
                    [x * scale, y * scale, h, f64::from(r.radii[0]) / scale]
                })
                .collect();
            let of = |k: usize| runs.iter().map(|r| r[k]).collect::<Vec<f64>>();
            let what = format!("scale {scale}, origin {origin}");
            // ½ · 4/(πR) over the value, ½.
            holds(&of(0), 4.0 / (PI * 2.0), 0.005, &format!("{what}: gradient"));
            holds(&of(1), 0.0, 0.005, &format!("{what}: across"));
            holds(&of(2), 1.0, 0.005, &format!("{what}: rotational"));
            // R ≤ E/|∇E|, which is πR/4 here.
            holds(&of(3), PI / 2.0, 0.005, &format!("{what}: radius"));
        }
    }
}

#[test]
fn a_rectangle_overhead_has_its_gradient() {
    for (x, y, f, fx, fy) in [
        (0.0, 0.0, 0.3607375, 0.0, 0.0),
        (0.5, 0.2, 0.3103163, -0.1451822, -0.1319328),
        (1.2, 0.4, 0.1400982, -0.2035562, -0.1008210),
    ] {
        let (mut gx, mut gy) = (0.0, 0.0);
        for seed in 0..8 {
            let around = rectangle([-1.0, 1.0], [-0.5, 0.5], 1.0);
            let r = record(16384, seed, 1.0, DVec3::new(x, y, 0.0), around);
            close(f64::from(r.value.x), f, 0.01 * f, "F");
            let [x, y] = world(&r, r.gradient);
            gx += x / 8.0;
            gy += y / 8.0;
        }
        // Where light ends at an edge, cells that the edge cuts move as a whole, noise of 3 % of 1/height is left of 8 runs.
        close(gx, fx / f, 0.05, &format!("({x}, {y}) F_x/F"));
        close(gy, fy / f, 0.05, &format!("({x}, {y}) F_y/F"));
    }
}

#[test]
fn corners_do_not_reach_below_the_smallest_radius() {
    // 1 mm from a wall: R₀ = 4.7 mm, R₋ = S/64.
    let options = Params { resolution: 64, ..classical(1024, 1) };
    let r = record_with(options, 4.0, DVec3::ZERO, |_, d| {
        let distance = if d.x > 0.0 { 1e-3 / d.x } else { 3.0 };
        (if d.x > 0.0 { 1.0 } else { 0.2 }, distance)
    });
    assert_eq!(r.radii, [0.0625; 2]);
    let steepness = f64::from(r.gradient[0].hypot(r.gradient[1]));
    assert!(steepness * 0.0625 <= 1.0 + 1e-6, "{steepness}");
}
