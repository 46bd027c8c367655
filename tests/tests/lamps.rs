//! Many lamps: where hemisphere samples end few are looked at and fewer tested (`crates/render/src/sources/few.rs`), which
//! must not show in the mean. Values are random; they are held against their own statistical error.

use ambit_tests::Program;
use std::fmt::Write;

/// A low room with 49 lamps of every kind and columns between them.
fn hall() -> String {
    let mut scene = String::from(
        "void plastic w 0 0 5 .6 .5 .4 0 0\n\
         w polygon floor 0 0 12 0 0 0 21 0 0 21 21 0 0 21 0\n\
         w polygon ceiling 0 0 12 0 0 3 0 21 3 21 21 3 21 0 3\n\
         w polygon south 0 0 12 0 0 0 0 0 3 21 0 3 21 0 0\n\
         w polygon north 0 0 12 0 21 0 21 21 0 21 21 3 0 21 3\n\
         w polygon west 0 0 12 0 0 0 0 21 0 0 21 3 0 0 3\n\
         w polygon east 0 0 12 21 0 0 21 0 3 21 21 3 21 21 0\n\
         void light panel 0 0 3 90 80 70\n\
         void spotlight spot 0 0 7 5000 5000 5000 60 0 0 -1\n\
         void brightfunc wing 2 .2+Dx*Dx .  0 0\nwing light globe 0 0 3 300 200 100\n\
         void light tube 0 0 3 60 60 60\n",
    );
    for i in 0..49 {
        let (x, y) = (1.5 + f64::from(i % 7) * 3.0, 1.5 + f64::from(i / 7) * 3.0);
        let lamp = match i % 4 {
            0 => format!(
                "panel polygon l{i} 0 0 12 {x} {y} 2.9 {x} {} 2.9 {} {} 2.9 {} {y} 2.9",
                y + 0.5,
                x + 0.5,
                y + 0.5,
                x + 0.5
            ),
            1 => format!("spot ring l{i} 0 0 8 {x} {y} 2.9 0 0 -1 0 .05"),
            2 => format!("globe sphere l{i} 0 0 4 {x} {y} 2.2 .1"),
            _ => format!("tube cylinder l{i} 0 0 7 {x} {y} 2.6 {} {y} 2.6 .03", x + 1.2),
        };
        writeln!(
            scene,
            "{lamp}\nw cylinder c{i} 0 0 7 {0} {1} 0 {0} {1} {2} .3",
            x + 1.2,
            y + 0.9,
            1.0 + f64::from(i % 3)
        )
        .expect("a string takes all");
    }
    scene
}

/// Irradiance at points of the hall, first channel.
fn irradiance(options: &str, points: &str) -> Vec<f64> {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    std::fs::write(&octree, Program::new("oconv").arg("-").feed(hall().as_bytes()).well("oconv").out)
        .expect("the scratch folder can be written");
    let answer =
        Program::new("rtrace").line("-h -w- -I").line(options).arg(&octree).feed(points.as_bytes()).well("rtrace");
    let first = |line: &str| line.split_whitespace().next().and_then(|w| w.parse().ok()).expect("a number first");
    answer.text().lines().map(first).collect()
}

#[test]
fn few_lamps_stand_for_all() {
    let point = |i: u32| {
        let (x, y) = (f64::from(i % 20) + 0.63, 2.5 * f64::from(i / 20) + 0.41);
        let up = if i.is_multiple_of(3) { (2.95, -1) } else { (0.05, 1) };
        format!("{x} {y} {} 0 0 {}\n", up.0, up.1)
    };
    let points: String = (0..160).map(point).collect();
    // All shadows are tested at the sensors themselves, and with -dt 0 all of all lamps everywhere.
    let common = "-ab 1 -aa 0 -as 0 -ad 100 -dc 1 -lw 0 -lr 4";
    let few = irradiance(&format!("{common} -dt 1e-9"), &points);
    let all = irradiance(&format!("{common} -dt 0"), &points);
    let n = few.len() as f64;
    assert_eq!((few.len(), all.len()), (160, 160));
    let mean = all.iter().sum::<f64>() / n;
    let off: Vec<f64> = few.iter().zip(&all).map(|(f, a)| (f - a) / mean).collect();
    let bias = off.iter().sum::<f64>() / n;
    let error = (off.iter().map(|d| (d - bias).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    assert!(error > 0.0 && error < 4e-3, "{error}");
    assert!(bias.abs() < 4.0 * error, "{bias} ± {error}");
}

#[test]
fn the_choice_does_not_depend_on_threads() {
    let point = |i: u32| format!("{} {} .05 0 0 1\n", f64::from(i % 10) * 2.0 + 0.7, f64::from(i / 10) * 3.0 + 0.4);
    let points: String = (0..60).map(point).collect();
    let with = |threads| irradiance(&format!("-n {threads} -ab 2 -aa .3 -ad 64 -as 16"), &points);
    assert_eq!(with(1), with(3));
}
