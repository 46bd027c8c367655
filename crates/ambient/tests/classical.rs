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
                close(radius(brightness, &|_| 2.0), 2.0, 1e-5, "sphere of radius 2");
                close(radius(brightness, &|d| 1.0 / d.z), 1.5, 0.003, "ceiling at height 1");
                let wall = |d: DVec3| if d.x > 0.0 { 1.0 / d.x } else { FAR / scale };
                close(radius(brightness, &wall), 1.5 * PI, 0.01, "wall at distance 1");
                close(radius(brightness, &|d| 1.0 / d.x.abs()), 0.75 * PI, 0.005, "between two walls");
            }
        }
    }
}

/// Records whose noise is averaged.
const RUNS: u64 = 20;

#[test]
fn the_split_sphere_has_its_gradients_and_limits() {
    for scale in SCALES {
        for origin in [DVec3::ZERO, DVec3::new(1e6, -1e6, 1e6)] {
            let (mut gradient, mut across, mut turn, mut radius) = (0.0, 0.0, 0.0, 0.0);
            for seed in 0..RUNS {
                let bright = |_, d: DVec3| (if d.x > 0.0 { 1.0 } else { 0.0 }, 2.0 * scale);
                let r = record(1024, seed, scale, origin, bright);
                let ([x, y], [_, h]) = (world(&r, r.gradient), world(&r, r.rotation));
                let mean = |x: f64| x / RUNS as f64;
                gradient += mean(x * scale / f64::from(r.value.x));
                across += mean(y * scale);
                turn += mean(h);
                radius += mean(f64::from(r.radii[0]) / scale);
            }
            let what = format!("scale {scale}, origin {origin}");
            // The gradient is that of the value, whose noise (0.5 ± 0.015) goes into it: ½ · 4/(πR) over the value.
            close(gradient, 2.0 * 4.0 / (PI * 2.0), 0.06, &format!("{what}: gradient"));
            close(across, 0.0, 0.03, &format!("{what}: across"));
            close(turn, 1.0, 0.03, &format!("{what}: rotational"));
            // R ≤ E/|∇E|, which is πR/4 here.
            close(radius, PI / 2.0, 0.05, &format!("{what}: radius"));
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
