//! Rough lobes: what their samples add up to. Values are random; they are held against their own statistical error. The
//! expected ones are integrals over the lobe; Radiance's means are the same.

use ambit_tests::Program;

/// A rough mirror tilted by a texture.
fn mirror(tilt: f64, roughness: f64) -> String {
    format!("void texfunc t 4 {tilt} 0 0 . 0 0\nt plastic m 0 0 5 1 1 1 1 {roughness}\n")
}

/// Mean of `rays` rays along `direction` that meet a level surface of `material` under a sky of radiance `sky`, an
/// expression, and its standard error.
fn mean(sky: &str, material: &str, direction: [f64; 3], options: &str, rays: usize) -> (f64, f64) {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    let scene = format!(
        "void brightfunc f 2 {sky} .\n0 0\nf glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n{material}\
         m polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
    );
    std::fs::write(&octree, Program::new("oconv").arg("-").feed(scene.as_bytes()).well("oconv").out)
        .expect("the scratch folder can be written");
    let [x, y, z] = direction;
    let input = format!("{} {} {} {x} {y} {z}\n", -x, -y, -z).repeat(rays);
    let rtrace = Program::new("rtrace").line("-h -w- -u- -lw 1e-8 -st 0 -ab 0").line(options).arg(&octree);
    let answer = rtrace.feed(input.as_bytes()).well("rtrace");
    let first = |line: &str| -> f64 { line.split_whitespace().next().and_then(|w| w.parse().ok()).expect("a number") };
    let values: Vec<f64> = answer.text().lines().map(first).collect();
    assert_eq!(values.len(), rays);
    let n = rays as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn holds((mean, error): (f64, f64), want: f64) {
    assert!(error < 0.01 * want, "{mean} ± {error} says little about {want}");
    assert!((mean - want).abs() <= 4.0 * error + 3e-5 * want, "{want} expected, {mean} ± {error} found");
}

#[test]
fn several_samples_weigh_by_the_surfaces_own_normal() {
    for (tilt, roughness, direction, want) in [
        (0.1, 0.2, [0.0, 0.0, -1.0], 0.948_95),
        (0.3, 0.2, [0.5, 0.0, -1.0], 0.638_84),
        (-0.3, 0.2, [0.5, 0.0, -1.0], 1.012_87),
        (-0.4, 0.1, [1.0, 0.0, -1.0], 1.162_41),
    ] {
        holds(mean("1", &mirror(tilt, roughness), direction, "-ss 16", 1000), want);
    }
}

#[test]
fn a_single_sample_has_ten_independent_trials() {
    // Most trials enter the surface; the share of those that do not, p, and what is lost in spite of ten: (1 − p)^10.
    for (tilt, direction, p) in [(0.4, [2.0, 0.2, -1.0], 0.138_79), (0.5, [1.0, 0.0, -1.0], 0.290_82)] {
        let want = 1.0 - f64::powi(1.0 - p, 10);
        holds(mean("1", &mirror(tilt, 0.2), direction, "-ss 1", 20_000), want);
    }
}

#[test]
fn what_rough_trans_lets_through_spreads_along_the_surface() {
    // The slope lies in the surface, not across the ray, so that grazing rays spread less up and down. Of that spread the
    // sky's pattern, (Dz + .7)^2, shows the variance.
    let alpha = 0.2;
    let n = 400;
    let at = |i: usize| (i as f64 + 0.5) / n as f64;
    let seen = |x: f64, azimuth: f64| {
        let slope = alpha * (-x.ln()).sqrt();
        let (sine, cosine) = (std::f64::consts::TAU * azimuth).sin_cos();
        let d = [0.5f64.sqrt() + slope * cosine, slope * sine, -(0.5f64.sqrt())];
        let z = d[2] / d.iter().map(|c| c * c).sum::<f64>().sqrt();
        (z + 0.7).powi(2)
    };
    let want = (0..n).flat_map(|i| (0..n).map(move |j| seen(at(i), at(j)))).sum::<f64>() / (n * n) as f64;
    let trans = format!("void trans m 0 0 7 1 1 1 0 {alpha} 1 1\n");
    holds(mean("(Dz+.7)^2", &trans, [1.0, 0.0, -1.0], "-ss 1", 40_000), want);
}

#[test]
fn samples_leave_out_what_is_seen_through() {
    // Of a table whose peak is half of all light, straight on. The means are Radiance's, of 60 000 rays: ± 0.0006.
    let table = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/files/straight.xml");
    let pane = format!("void aBSDF m 5 \"{}\" 0 1 0 .\n0 0\n", table.display());
    for (x, want) in [(0.0, 0.54290), (0.5, 0.54866), (1.0, 0.55708)] {
        holds(mean("1", &pane, [x, 0.0, -1.0], "-ss 1", 20_000), want);
    }
}
