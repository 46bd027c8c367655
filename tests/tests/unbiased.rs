//! `--unbiased` has all bounces in its expected value: closed rooms whose irradiance is a geometric series to the end.
//! Values are random; they are held against their own statistical error.

use std::f64::consts::PI;

use ambit_tests::Program;
use ambit_tests::programs::foreign;

/// Mean of the first channel at `points`, and the standard error of that mean.
fn mean(scene: &str, options: &str, points: &[String]) -> (f64, f64) {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    std::fs::write(&octree, Program::new("oconv").arg("-").feed(scene.as_bytes()).well("oconv").out)
        .expect("the scratch folder can be written");
    let input = points.join("\n") + "\n";
    let answer =
        Program::new("rtrace").line("-h -w- -I").line(options).arg(&octree).feed(input.as_bytes()).well("rtrace");
    let values: Vec<f64> = answer
        .text()
        .lines()
        .map(|line| line.split_whitespace().next().and_then(|w| w.parse().ok()).expect("a number first"))
        .collect();
    assert_eq!(values.len(), points.len());
    statistics(&values)
}

/// Mean, and its standard error.
fn statistics(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Holds a mean against what it should be: within four standard errors, which must be small themselves.
fn holds(what: &str, (mean, error): (f64, f64), want: f64) {
    assert!(error < 0.01 * want, "{what}: {mean} ± {error} says little about {want}");
    let off = (mean - want).abs();
    // Points of measurement are lifted by 1e-4 of the distance 10, and seven digits are printed.
    assert!(off <= 4.0 * error + 3e-5 * want, "{what}: {want} expected, {mean} ± {error} found");
}

/// A sphere of reflectance ρ with a small lamp in its centre; the direct irradiance at the sensors, and on its wall.
fn sphere(reflectance: f64) -> (String, [f64; 2]) {
    let scene = format!(
        "void plastic w 0 0 5 {reflectance} {reflectance} {reflectance} 0 0\nw bubble wall 0 0 4 0 0 0 10\n\
         void light l 0 0 3 1000 1000 1000\nl sphere lamp 0 0 4 0 0 0 .01\n"
    );
    (scene, [9.99, 10.0].map(|distance| PI * 1000.0 * (0.01_f64 / distance).powi(2)))
}

/// Points near the wall of that sphere, facing its centre.
fn sensors(count: u32) -> Vec<String> {
    let place = |k: u32| {
        let (z, azimuth) = (2.0 * (f64::from(k) + 0.5) / f64::from(count) - 1.0, 2.4 * f64::from(k));
        let (s, c) = azimuth.sin_cos();
        let (x, y) = ((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s);
        format!("{} {} {} {} {} {}", 9.99 * x, 9.99 * y, 9.99 * z, -x, -y, -z)
    };
    (0..count).map(place).collect()
}

#[test]
fn all_bounces_of_a_sphere_that_lights_itself() {
    if foreign() {
        return; // The option is ours.
    }
    for reflectance in [0.3, 0.5, 0.7, 0.9] {
        let (scene, [direct, wall]) = sphere(reflectance);
        // E = E_d + E_w (ρ + ρ² + …); with one bounce or three before paths are single, the expected value is the same.
        let want = direct + wall * reflectance / (1.0 - reflectance);
        for bounces in [1, 3] {
            let options = format!("--unbiased -ab {bounces} -ad 1024 -dj 0 -ds 0");
            holds(&format!("ρ = {reflectance}, -ab {bounces}"), mean(&scene, &options, &sensors(64)), want);
        }
    }
}

#[test]
fn without_it_the_series_ends_after_the_bounces() {
    if foreign() {
        return;
    }
    // The same options but for the roulette: E_d + ρ E_w, so the test above does see what it is about.
    let (scene, [direct, wall]) = sphere(0.7);
    let got = mean(&scene, "-aa 0 -as 0 -ar 0 -lr 0 -dt 0 -ab 1 -ad 1024 -dj 0 -ds 0", &sensors(64));
    holds("ρ = 0.7, one bounce", got, direct + 0.7 * wall);
}

#[test]
fn all_bounces_with_a_cache_before_them() {
    if foreign() {
        return;
    }
    // Everything is the same everywhere on the wall, so that interpolation adds no bias of its own; records of both
    // levels hold the endless series. Sensors share records, so the error is that between runs of other random numbers.
    let (scene, [direct, wall]) = sphere(0.7);
    let options = "-aa .3 -ab 2 -ad 256 -as 0 -ar 16 -lr 0 -dj 0 -ds 0 --unbounded-bounces";
    let runs: Vec<f64> =
        (0..16).map(|seed| mean(&scene, &format!("{options} --seed {seed}"), &sensors(16)).0).collect();
    holds("ρ = 0.7 with a cache", statistics(&runs), direct + wall * 0.7 / 0.3);
}

#[test]
fn a_floor_under_a_bright_ceiling() {
    if foreign() {
        return;
    }
    // A floor of reflectance ρ without end under a ceiling of radiance 1 that reflects nothing: the floor gets E = π, and
    // what faces the floor ρπ.
    let scene = "void plastic w 0 0 5 .8 .8 .8 0 0\nvoid glow g 0 0 4 1 1 1 0\n\
                 w ring floor 0 0 8 0 0 0 0 0 1 0 1e5\ng ring ceiling 0 0 8 0 0 1 0 0 -1 0 1e5\n";
    let points: Vec<String> = (0..64).map(|k| format!("{} 0 .5 0 0 -1", f64::from(k) * 0.37)).collect();
    // Facing the floor: E = ρ · π.
    holds("a floor under a bright ceiling", mean(scene, "--unbiased -ab 1 -ad 1024", &points), 0.8 * PI);
}

#[test]
fn textured_normals_are_exact() {
    if foreign() {
        return;
    }
    // A floor whose normal is tilted by 60° under half a sky: the first-order correction is far off; exactly,
    // light arrives from directions above both the floor and the tilted plane.
    let tilt = 60f64.to_radians();
    let scene = "void texfunc t 4 dx dy dz tilt.cal 0 0\nt plastic w 0 0 5 .5 .5 .5 0 0\nw ring floor 0 0 8 0 0 0 0 0 1 0 1e4\n\
         void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n";
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let definitions = format!("dx = {}; dy = 0; dz = 0;\n", tilt.tan());
    std::fs::write(scratch.path().join("tilt.cal"), definitions).expect("the scratch folder can be written");
    let octree = scratch.path().join("scene.oct");
    let compiled = Program::new("oconv").within(scratch.path()).arg("-").feed(scene.as_bytes()).well("oconv");
    std::fs::write(&octree, compiled.out).expect("the scratch folder can be written");
    let rays = "0 0 5 0 0 -1\n".repeat(64);
    let run = |options: &str| {
        let program = Program::new("rtrace").within(scratch.path()).line("-h -w-").line(options);
        let answer = program.arg(&octree).feed(rays.as_bytes()).well("rtrace");
        let values: Vec<f64> =
            answer.text().lines().map(|l| l.split_whitespace().next().unwrap().parse().unwrap()).collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    // A plane tilted by β sees the half of the sky above the floor's plane: E = π (1 + cos β)/2, radiance ρE/π.
    let want = 0.5 * (1.0 + tilt.cos()) / 2.0;
    let got = run("--unbiased -ab 1 -ad 1024");
    assert!((got - want).abs() < 0.01 * want, "{want} expected, {got} found");
    let first_order = run("-aa 0 -ab 1 -ad 1024 -as 0");
    assert!((first_order - want).abs() > 0.05 * want, "the first order gives {first_order} as well");
}

#[test]
fn surfaces_that_send_out_more_than_they_get_are_told_of() {
    if foreign() {
        return;
    }
    // The pattern makes three times as much of what passes the wall, which the outer wall sends back.
    let scene = "void brightfunc three 2 3 . 0 0 three trans t 0 0 7 1 1 1 0 0 .5 0 t bubble inner 0 0 4 0 0 0 2\n\
                 void plastic w 0 0 5 .9 .9 .9 0 0 w bubble outer 0 0 4 0 0 0 3\n\
                 void glow g 0 0 4 1 1 1 0 g sphere lamp 0 0 4 0 0 0 .1\n";
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    std::fs::write(&octree, Program::new("oconv").arg("-").feed(scene.as_bytes()).well("oconv").out)
        .expect("the scratch folder can be written");
    let answer = Program::new("rtrace").line("-h -w- -ab 2 --unbounded-bounces").arg(&octree).feed(b"0 0 .5 1 0 0\n");
    assert_eq!(answer.status, Some(1), "{}", answer.err);
    assert!(answer.err.contains("more than they receive"), "{}", answer.err);
}

#[test]
fn deeper_questions_get_no_more_bounces_than_are_left() {
    if foreign() {
        return; // Real Radiance mixes bounces.
    }
    let reflectance = 0.7;
    let (scene, [_, wall]) = sphere(reflectance);
    // Rays at the wall itself, so that what the eye sees and what hemispheres see share records.
    let outward = |line: String| {
        let n: Vec<f64> = line.split(' ').map(|w| w.parse().expect("a number")).collect();
        format!("{} {} {} {} {} {}", 0.5 * n[0], 0.5 * n[1], 0.5 * n[2], -n[3], -n[4], -n[5])
    };
    let rays: Vec<String> = sensors(400).into_iter().map(outward).collect();
    // What the upper half left in a file answers the hemispheres of the lower half.
    let upper = |ray: &&String| !ray.rsplit(' ').next().expect("six numbers").starts_with('-');
    let (upper, lower): (Vec<String>, Vec<String>) = rays.iter().cloned().partition(|ray| upper(&ray));
    assert!(upper.len() > 100 && lower.len() > 100);
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    for bounces in [2, 3] {
        let series = wall * (1..=bounces + 1).map(|k| reflectance.powi(k)).sum::<f64>() / PI;
        let options = format!("-I- -ab {bounces} -aa .1 -ad 256 -as 0 -ar 0 -lw 1e-6 -n 2");
        let (apart, error) = mean(&scene, &options, &rays);
        assert!(error < 2e-3 * series, "{error}");
        assert!((apart - series).abs() < 2e-3 * series, "{bounces} bounces: {apart} for {series}");
        let (mixed, _) = mean(&scene, &format!("{options} --bounces mixed"), &rays);
        assert!(mixed > 1.003 * series, "{bounces} bounces, mixed: {mixed} for {series}");

        let file = scratch.path().join(format!("{bounces}.amb"));
        let options = format!("{options} -af {}", file.display());
        mean(&scene, &options, &upper);
        let (continued, _) = mean(&scene, &options, &lower);
        assert!((continued - series).abs() < 2e-3 * series, "{bounces} bounces, from a file: {continued} for {series}");
    }
}
