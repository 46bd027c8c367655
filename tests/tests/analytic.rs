//! Irradiance that has a closed form: configuration factors, the closed room, the sphere that lights itself.
//!
//! With emitters of radiance L that are seen by indirect rays only (a `glow` of radius 0), a black receiver has the
//! irradiance E = π·F·L, where F is the configuration factor. Formulas after Howell, "A Catalog of Radiation Heat
//! Transfer Configuration Factors". Each case is run without the cache (`-aa 0`) and with it, where the one record
//! that is made must hold the same value.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use ambit_tests::Program;

/// Samples of one hemisphere; the noise of a stratified estimate is then well below [`TOLERANCE`].
const SAMPLES: &str = "-ab 1 -ad 65536 -as 0 -ar 0 -lw 1e-9 -av 0 0 0";

/// Relative error allowed, three or more standard deviations of the worst case below.
const TOLERANCE: f64 = 0.005;

/// Irradiance in the first channel at each of the points (position and normal a line) of a scene.
fn irradiance(scene: &str, options: &str, points: &str) -> Vec<f64> {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    let compiled = Program::new("oconv").arg("-").feed(scene.as_bytes()).well("oconv");
    std::fs::write(&octree, compiled.out).expect("the scratch folder can be written");
    let answer =
        Program::new("rtrace").line("-h -w- -I").line(options).arg(&octree).feed(points.as_bytes()).well("rtrace");
    let first = |line: &str| line.split_whitespace().next().and_then(|w| w.parse().ok()).expect("a number first");
    answer.text().lines().map(first).collect()
}

/// Runs a scene with and without the cache at points given with the configuration factor expected there.
fn factors(scene: &str, cases: &[(&str, f64)]) {
    for accuracy in ["-aa 0", "-aa .05"] {
        for &(point, factor) in cases {
            let got = irradiance(scene, &format!("{SAMPLES} {accuracy}"), &format!("{point}\n"))[0];
            let want = PI * factor;
            assert!((got - want).abs() <= TOLERANCE * want, "{accuracy} at {point}: {want} expected, {got} found");
        }
    }
}

const GLOW: &str = "void glow g 0 0 4 1 1 1 0\n";

#[test]
fn sky_over_black_ground() {
    let scene = format!("{GLOW} g source sky 0 0 4 0 0 1 180");
    factors(&scene, &[("0 0 0 0 0 1", 1.0), ("0 0 0 1 0 0", 0.5), ("0 0 0 .6 0 .8", 0.9)]);
}

#[test]
fn coaxial_and_shifted_disk() {
    // F = (1 - (d² + c² - b²) / sqrt((d² + c² + b²)² - 4 b² d²)) / 2 for radius b, height c, distance from the axis d.
    let scene = format!("{GLOW} g ring disk 0 0 8 0 0 1 0 0 -1 0 1");
    factors(&scene, &[("0 0 0 0 0 1", 0.5), ("0.5 0 0 0 0 1", 0.437_982_6), ("1 0 0 0 0 1", 0.276_393_2)]);
}

#[test]
fn sphere_above_a_plane() {
    // F = b² c / (c² + x²)^(3/2), radius b = 1/2, height c = 2.
    let scene = format!("{GLOW} g sphere ball 0 0 4 0 0 2 .5");
    factors(&scene, &[("0 0 0 0 0 1", 0.0625), ("0 1 0 0 0 1", 0.044_721_4)]);
}

#[test]
fn parallel_rectangle() {
    let scene = format!("{GLOW} g polygon r 0 0 12 -1 -.5 1 -1 .5 1 1 .5 1 1 -.5 1");
    factors(&scene, &[("0 0 0 0 0 1", 0.360_737_5), (".5 .2 0 0 0 1", 0.310_316_3), ("1.2 .4 0 0 0 1", 0.140_098_2)]);
}

#[test]
fn perpendicular_wall() {
    let scene = format!("{GLOW} g polygon w 0 0 12 0 -1 0 0 -1 1 0 1 1 0 1 0");
    factors(&scene, &[("-.1 0 0 0 0 1", 0.443_477_3), ("-.5 0 0 0 0 1", 0.248_537_8), ("-1 0 0 0 0 1", 0.111_468_4)]);
}

#[test]
fn long_strip_overhead() {
    // F = ((1 - x) / sqrt((1 - x)² + 1) + (1 + x) / sqrt((1 + x)² + 1)) / 2, half width 1, height 1.
    let scene = format!("{GLOW} g polygon s 0 0 12 -1 -5000 1 -1 5000 1 1 5000 1 1 -5000 1");
    factors(&scene, &[("0 0 0 0 0 1", FRAC_1_SQRT_2), ("1 0 0 0 0 1", 0.447_213_6)]);
}

#[test]
fn closed_room_with_constant_ambient_value() {
    // -av A after k bounces between walls of reflectance ρ: E = π A ρᵏ at any point, whatever the sampling.
    let walls = "void plastic w 0 0 5 .5 .5 .5 0 0\n\
                 w polygon a 0 0 12 0 0 0 2 0 0 2 2 0 0 2 0\nw polygon b 0 0 12 0 0 2 0 2 2 2 2 2 2 0 2\n\
                 w polygon c 0 0 12 0 0 0 0 0 2 2 0 2 2 0 0\nw polygon d 0 0 12 0 2 0 2 2 0 2 2 2 0 2 2\n\
                 w polygon e 0 0 12 0 0 0 0 2 0 0 2 2 0 0 2\nw polygon f 0 0 12 2 0 0 2 0 2 2 2 2 2 2 0\n";
    for (bounces, power) in [(0, 1.0), (1, 0.5), (2, 0.25), (3, 0.125)] {
        let options = format!("-ab {bounces} -ad 64 -as 0 -aa 0 -lr 8 -lw 1e-9 -av 2 2 2");
        let got = irradiance(walls, &options, ".3 .4 .0001 0 0 1\n1 1 .7 .6 0 .8\n");
        for value in got {
            // -I puts a point's own irradiance before the first bounce.
            let want = PI * 2.0 * power;
            assert!((value - want).abs() <= 1e-3 * want, "{bounces} bounces: {want} expected, {value} found");
        }
    }
}

#[test]
fn sphere_that_lights_itself() {
    // A small lamp in the centre of a sphere of reflectance ρ: E = E_d (1 + ρ + … + ρᵏ) everywhere on the wall.
    let scene = "void plastic w 0 0 5 .7 .7 .7 0 0\nw bubble wall 0 0 4 0 0 0 10\n\
                 void light l 0 0 3 1000 1000 1000\nl sphere lamp 0 0 4 0 0 0 .01\n";
    let direct = PI * 1000.0 * (0.01 / 9.99_f64).powi(2);
    for (bounces, sum) in [(0, 1.0), (1, 1.7), (2, 2.19), (3, 2.533)] {
        let options = format!("-ab {bounces} -ad 1024 -as 0 -aa 0 -lr 8 -lw 1e-9 -av 0 0 0 -dj 0 -ds 0");
        // Beyond one bounce the full tree of rays grows fast: fewer samples, the same mean.
        let options = if bounces > 1 { options.replace("-ad 1024", "-ad 64") } else { options };
        let got = irradiance(scene, &options, "9.99 0 0 -1 0 0\n")[0];
        let want = direct * sum;
        assert!((got - want).abs() <= 0.01 * want, "{bounces} bounces: {want} expected, {got} found");
    }
}
