//! Records of hemispheres whose irradiance and derivatives are known in closed form, at scales from 1e-4 to 1e5.

mod around;

use ambit_ambient::Record;
use ambit_base::{DVec3, FAR, Rgb};
use around::{close, params, record_with, rectangle, world};

fn record(divisions: i32, position: DVec3, around: impl Fn(DVec3, DVec3) -> (f32, f64) + Sync) -> Record {
    record_with(params(divisions, 1), 1e3, position, around)
}

#[test]
fn uniform_surroundings_have_no_derivatives() {
    for divisions in [49, 256, 1024] {
        // A room whose walls are near on one side, all of the same radiance.
        let r = record(divisions, DVec3::ZERO, |_, d| (2.5, if d.x > 0.0 { 0.1 / d.x } else { 3.0 }));
        assert_eq!(r.value, Rgb::splat(2.5));
        // Radiance's rim artefact is 0.65/m here.
        assert!(r.gradient.iter().chain(&r.rotation).all(|g| g.abs() < 1e-6), "{r:?}");
        assert_eq!(r.radii, [200.0, 200.0]);
    }
}

#[test]
fn a_half_bright_sky_turns_but_does_not_shift() {
    let (mut value, mut turn, mut across) = (0.0, 0.0, 0.0);
    for seed in 0..20 {
        let sky = |_, d: DVec3| (if d.x > 0.0 { 1.0 } else { 0.0 }, FAR);
        let r = record_with(params(1024, seed), 10.0, DVec3::ZERO, sky);
        let [hx, hy] = world(&r, r.rotation);
        value += f64::from(r.value.x) / 20.0;
        turn += hy / 20.0;
        across += hx / 20.0;
        assert!(r.gradient[0].hypot(r.gradient[1]) < 2e-2 && r.radii[1] > 1.9, "{r:?}");
    }
    close(value, 0.5, 0.003, "E/π");
    close(turn, 1.0, 0.02, "rotational gradient");
    close(across, 0.0, 0.02, "rotational gradient across");
}

#[test]
fn the_split_sphere_has_its_gradient_at_every_scale() {
    // Below these scales the gradient limits the radii, and they limit it in turn.
    for scale in [1e2, 1e3, 1e5] {
        let (mut gx, mut gy) = (0.0, 0.0);
        for seed in 0..10 {
            let r = record_with(params(1024, seed), 2e4 * scale, DVec3::ZERO, |_, d| {
                (if d.x > 0.0 { 1.0 } else { 0.0 }, 2.0 * scale)
            });
            let [x, y] = world(&r, r.gradient);
            gx += x * scale / 10.0;
            gy += y * scale / 10.0;
        }
        close(gx, 4.0 / (2.0 * std::f64::consts::PI), 0.04, &format!("scale {scale}: gradient"));
        close(gy, 0.0, 0.03, &format!("scale {scale}: gradient across"));
    }
}

#[test]
fn a_rectangle_overhead_has_the_exact_radii() {
    // x, y, F, F_x, F_y, and the eigenvalues of H/F with the direction of the larger one in degrees (modulo 180).
    let table = [
        (0.0, 0.0, 0.3607375, 0.0, 0.0, -2.137620, -0.786485),
        (0.5, 0.2, 0.3103163, -0.1451822, -0.1319328, -1.979523, -0.948879),
        (1.2, 0.4, 0.1400982, -0.2035562, -0.1008210, -1.843659, 1.625110),
    ];
    for (x, y, f, fx, fy, big, small) in table {
        let r = record(65536, DVec3::new(x, y, 0.0), rectangle([-1.0, 1.0], [-0.5, 0.5], 1.0));
        close(f64::from(r.value.x), f, 0.003, "F");
        let [gx, gy] = world(&r, r.gradient);
        let (r0, r1) = ((4.0 / f64::abs(big)).powf(0.25), (4.0 / f64::abs(small)).powf(0.25));
        let limit = f / f64::hypot(fx, fy).max(1e-9);

        // Two per cent are lost to the floor and to the farthest-vertex rule, as in Radiance.
        if r0 < limit {
            close(gx, fx / f, 0.03, &format!("({x}, {y}) F_x/F"));
            close(gy, fy / f, 0.03, &format!("({x}, {y}) F_y/F"));
            close(f64::from(r.radii[0]), r0, 0.02, &format!("({x}, {y}) r₀"));
        }
        if x < 1.0 {
            close(f64::from(r.radii[1]), r1, 0.03, &format!("({x}, {y}) r₁"));
        }
    }
}

#[test]
fn axes_are_right_for_curvatures_of_either_sign() {
    // (1.2, 0.4) beside the rectangle: the shorter radius lies at 116°, whatever the random frame.
    for seed in 0..6 {
        let around = rectangle([-1.0, 1.0], [-0.5, 0.5], 1.0);
        let r = record_with(params(65536, seed), 1e3, DVec3::new(1.2, 0.4, 0.0), around);
        let axis = r.u.y.atan2(r.u.x).to_degrees().rem_euclid(180.0);
        close(axis, 116.4, 6.0, "direction of the shorter radius");
    }
}

#[test]
fn a_rectangle_overhead_is_the_same_at_every_scale() {
    for scale in [1e-4, 1e-2, 1e2, 1e5] {
        let p = DVec3::new(0.5, 0.2, 0.0) * scale;
        let around = rectangle([-scale, scale], [-0.5 * scale, 0.5 * scale], scale);
        let r = record_with(params(16384, 3), 1e3 * scale, p, around);
        let [gx, gy] = world(&r, r.gradient).map(|g| g * scale);
        if scale > 1.0 {
            close(gx, -0.4679, 0.04, &format!("scale {scale}: F_x/F"));
            close(gy, -0.4252, 0.04, &format!("scale {scale}: F_y/F"));
        } else {
            // The gradient limits the radii, and then they it.
            close(gy / gx, 0.9087, 0.05, &format!("scale {scale}: direction"));
        }
        // Radiance's law has the dimension √length, and 1/gradient limits it where lengths are small.
        let expected = (1.19227 * scale.sqrt()).min(scale / 0.4679);
        let tolerance = if scale < 1.0 { 0.3 } else { 0.04 };
        close(f64::from(r.radii[0]) / expected, 1.0, tolerance, &format!("scale {scale}: r₀"));
    }
}

#[test]
fn a_sphere_overhead_has_its_gradients() {
    // Radius 0.5 with its centre at height 2, laterally at −X: F, F_x/F, and the relative rotational gradient X/c towards it.
    let (b, c) = (0.5f64, 2.0f64);
    for (x, f, fx) in [(0.5, 0.0570672, -0.352941), (1.0, 0.0447214, -0.6)] {
        let centre = DVec3::new(0.0, 0.0, c);
        let r = record(65536, DVec3::new(x, 0.0, 0.0), move |p, d| {
            let to = centre - p;
            let along = to.dot(d);
            let inside = b * b - (to.length_squared() - along * along);
            if inside > 0.0 && along > 0.0 { (1.0, along - inside.sqrt()) } else { (0.0, FAR) }
        });
        close(f64::from(r.value.x), f, 0.001, "F");
        let [gx, gy] = world(&r, r.gradient);
        close(gx, fx, 0.04, &format!("X = {x}: F_x/F"));
        close(gy, 0.0, 0.03, &format!("X = {x}: F_y/F"));
        let [hx, hy] = world(&r, r.rotation);
        close(hy, -x / c, 0.02, &format!("X = {x}: rotational gradient"));
        close(hx, 0.0, 0.02, &format!("X = {x}: rotational gradient across"));
    }
}

#[test]
fn a_wall_beside_the_point_has_its_gradient() {
    // A wall of height 1 and infinite width at x = 0, bright; the point at x = c. F, F'/F, F''/F.
    // From c = 2 it fills 13 rings of the grid, of which the farthest-vertex rule takes half a ring at the top.
    for (c, f, g, h, tolerance) in
        [(0.5, 0.2763932, -1.294427, 1.553313, 0.03), (2.0, 0.0527864, -0.847214, 1.016656, 0.07)]
    {
        let r = record(65536, DVec3::new(c, 0.0, 0.0), |p, d| {
            let t = -p.x / d.x;
            if d.x < 0.0 && d.z * t <= 1.0 { (1.0, t) } else { (0.0, FAR) }
        });
        close(f64::from(r.value.x), f, 0.002, "F");
        let expected: f64 = (4.0 / f64::abs(h)).powf(0.25);
        let limit = 1.0 / f64::abs(g);
        close(f64::from(r.radii[0]) / expected.min(limit), 1.0, tolerance, &format!("c = {c}: r₀"));
        // The axis across the wall is the shorter one; the second curvature is 0, so only the ratio limits it.
        assert!(r.u.x.abs() > 0.98, "{r:?}");
        close(f64::from(r.radii[1] / r.radii[0]), 2.0, 0.2, &format!("c = {c}: ratio"));
        let [gx, gy] = world(&r, r.gradient);
        close(gx * f64::from(r.radii[0]), g * expected.min(limit), 0.05, &format!("c = {c}: F'/F"));
        close(gy, 0.0, 0.05, &format!("c = {c}: across"));
    }
}

#[test]
fn a_strip_overhead_has_its_gradient() {
    for (x, f, g, r0) in [(0.0, 0.5f64.sqrt(), 0.0, 1.51967), (0.5, 0.6396319, -0.425921, 1.47029)] {
        let r = record(65536, DVec3::new(x, 0.0, 0.0), rectangle([-1.0, 1.0], [-1e9, 1e9], 1.0));
        close(f64::from(r.value.x), f, 0.003, "F");
        let [gx, gy] = world(&r, r.gradient);
        close(gx, g, 0.03, &format!("X = {x}: F'/F"));
        close(gy, 0.0, 0.02, &format!("X = {x}: across"));
        close(f64::from(r.radii[0]), r0, 0.03, &format!("X = {x}: r₀"));
        assert!(r.u.x.abs() > 0.98 && r.radii[1] > 1.5 * r.radii[0] && r.radii[1] <= 2.001 * r.radii[0], "{r:?}");
    }
}

#[test]
fn black_hemispheres_have_radii_from_the_shape_of_what_is_seen() {
    // In a sphere of radius R the samples cover a disk that ends at sine ρ = 1 − 1/n from the normal; with its form factor's
    // curvature λ = 4ρ²(1 − ρ²)/R² the radius is (4/λ)^¼.
    for (divisions, n) in [(1024, 32.0), (4096, 64.0)] {
        for radius in [0.75, 3.0, 12.0] {
            let r = record(divisions, DVec3::ZERO, |_, _| (0.0, radius));
            assert_eq!(r.value, Rgb::ZERO);
            assert_eq!((r.gradient, r.rotation), ([0.0; 2], [0.0; 2]));
            let rho2 = f64::powi(1.0 - 1.0 / n, 2);
            let expected = radius.sqrt() / (rho2 * (1.0 - rho2)).powf(0.25);
            close(f64::from(r.radii[0]), expected, 0.02 * expected, "sphere");
        }
    }
}

#[test]
fn nothing_undefined_is_ever_stored() {
    type Case = (&'static str, fn(DVec3) -> (f32, f64));
    let cases: [Case; 8] = [
        ("touching", |_| (1.0, 0.0)),
        ("half touching", |d| (1.0, if d.x > 0.0 { 0.0 } else { 5.0 })),
        ("undefined radiance", |d| (if d.x > 0.5 { f32::NAN } else { 1.0 }, 1.0)),
        ("negative radiance", |d| (if d.x > 0.5 { -3.0 } else { 1.0 }, 1.0)),
        ("infinite radiance", |d| (if d.x > 0.5 { f32::INFINITY } else { 1.0 }, 1.0)),
        ("undefined distance", |d| (d.z as f32, if d.y > 0.0 { f64::NAN } else { 2.0 })),
        ("faint", |d| (if d.x > 0.0 { 1e-25 } else { 1e-28 }, 1.0)),
        ("huge and tiny distances", |d| (d.x.abs() as f32, if d.y > 0.3 { 1e-5 } else { 1e9 })),
    ];
    for (name, around) in cases {
        for edge in [1e-3, 1.0, 1e6] {
            let r = record_with(params(512, 4), edge, DVec3::ZERO, |_, d| around(d));
            assert!(r.is_plausible(), "{name}, edge {edge}: {r:?}");
        }
    }
}

#[test]
fn faint_light_has_the_same_derivatives() {
    let around = |l: f32| move |_: DVec3, d: DVec3| (if d.x > 0.0 { l } else { 0.1 * l }, 2.0);
    let bright = record(1024, DVec3::ZERO, around(1.0));
    let faint = record(1024, DVec3::ZERO, around(1e-12));
    for (a, b) in bright.gradient.iter().chain(&bright.radii).zip(faint.gradient.iter().chain(&faint.radii)) {
        assert!((a - b).abs() <= 1e-4 * a.abs().max(0.1), "{bright:?} {faint:?}");
    }
}
