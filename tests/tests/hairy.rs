//! How many records there are: `--measured-reuse` on thousands of blades in a box, against the answers without a cache,
//! `--overlap` and `--smoothing`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use ambit_tests::Program;
use ambit_tests::programs::foreign;

const BLADES: u32 = 2500;
/// Rays a side.
const SIDE: u32 = 20;

/// A closed box with a lamp under its ceiling and blades on its floor.
fn meadow() -> String {
    let mut scene = "void plastic wall 0 0 5 .7 .7 .7 0 0\nvoid plastic leaf 0 0 5 .5 .6 .3 0 0\n\
                     void light lamp 0 0 3 20 20 20\n"
        .to_owned();
    let mut polygon = |modifier: &str, corners: &[[f64; 3]]| {
        write!(scene, "{modifier} polygon p 0 0 {}", 3 * corners.len()).expect("a text grows");
        for [x, y, z] in corners {
            write!(scene, " {x:.5} {y:.5} {z:.5}").expect("a text grows");
        }
        scene.push('\n');
    };
    for z in [0.0, 1.0] {
        polygon("wall", &[[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]);
        polygon("wall", &[[z, 0.0, 0.0], [z, 1.0, 0.0], [z, 1.0, 1.0], [z, 0.0, 1.0]]);
        polygon("wall", &[[0.0, z, 0.0], [0.0, z, 1.0], [1.0, z, 1.0], [1.0, z, 0.0]]);
    }
    polygon("lamp", &[[0.6, 0.4, 0.99], [0.6, 0.6, 0.99], [0.9, 0.6, 0.99], [0.9, 0.4, 0.99]]);
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 31)
    };
    for _ in 0..BLADES {
        let (x, y) = (0.15 + 0.7 * random(), 0.3 + 0.6 * random());
        let (across, along, lean, height) = (6.3 * random(), 6.3 * random(), 0.15 * random(), 0.18 + 0.12 * random());
        let (dx, dy) = (0.003 * across.cos(), 0.003 * across.sin());
        let tip = [x + lean * along.cos(), y + lean * along.sin(), height];
        polygon("leaf", &[[x - dx, y - dy, 0.001], [x + dx, y + dy, 0.001], tip]);
    }
    scene
}

/// Rays from the eye over the picture.
fn rays() -> String {
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(SIDE) - 0.5;
    let ray = |k: u32| format!("0.5 0.02 0.6 {} 0.8 {}", at(k % SIDE), -0.5 + at(k / SIDE));
    let rays: Vec<String> = (0..SIDE * SIDE).map(ray).collect();
    rays.join("\n") + "\n"
}

/// Brightness along every ray, and the hemisphere samples it took.
fn traced(octree: &Path, options: &str) -> (Vec<f64>, u64) {
    let answer = Program::new("rtrace")
        .line("-h -w- -ab 2 -as 0 -dt 0 -ds 0 -dj 0 --stats")
        .line(options)
        .arg(octree)
        .feed(rays().as_bytes())
        .well(options);
    let number = |word: &str| word.parse::<f64>().expect("a number");
    let values = answer.text().lines().map(|line| line.split_whitespace().map(number).sum()).collect();
    let (before, _) = answer.err.split_once(" hemisphere samples").expect("statistics were asked for");
    (values, before.rsplit(' ').next().and_then(|n| n.parse().ok()).expect("a number"))
}

/// RMS difference over the mean.
fn error(values: &[f64], reference: &[f64]) -> f64 {
    let squares: f64 = values.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum();
    let n = reference.len() as f64;
    (squares / n).sqrt() / (reference.iter().sum::<f64>() / n)
}

fn compiled(scratch: &Path) -> PathBuf {
    let octree = scratch.join("scene.oct");
    let frozen = Program::new("oconv").line("-f -").feed(meadow().as_bytes()).well("oconv").out;
    std::fs::write(&octree, frozen).expect("the scratch folder can be written");
    octree
}

#[test]
fn hairy_surfaces_take_fewer_samples_at_no_greater_error() {
    if foreign() {
        return; // The option is ours.
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = compiled(scratch.path());
    let (reference, none) = traced(&octree, "-aa 0 -ad 1024 -lw 1e-7");
    assert!(none == 0 && reference.len() == (SIDE * SIDE) as usize);
    let cached = "-aa .2 -ar 64 -ad 128";
    let (plain, many) = traced(&octree, &format!("{cached} --measured-reuse off"));
    let (switched, fewer) = traced(&octree, &format!("{cached} --measured-reuse on"));
    let (before, after) = (error(&plain, &reference), error(&switched, &reference));
    println!("{many} samples, error {before}; with the switch {fewer} samples, error {after}");
    assert!(before < 0.1, "the reference is one: {before}");
    assert!(10 * fewer < 7 * many, "{fewer} of {many} samples");
    // An RMS of so many values is itself known to one part in √(2n).
    let known = 1.0 / f64::from(2 * SIDE * SIDE).sqrt();
    assert!(after <= before * (1.0 + known), "{after} instead of {before}");
    let (other, same) = traced(&octree, &format!("{cached} --measured-reuse on -n 5"));
    assert!(other == switched && same == fewer, "-n 5 changes the answers");
    // By itself, unless there is a file that others may want complete.
    assert!(traced(&octree, cached) == (switched, fewer), "it is not on by default");
    let file = scratch.path().join("a.amb");
    let (_, complete) = traced(&octree, &format!("{cached} -af {}", file.display()));
    assert!(10 * complete > 9 * many, "{complete} samples for a file, {many} without the switch");
}

/// The switch must leave alone what is well reused: a plain box.
#[test]
fn plain_surfaces_are_hardly_touched() {
    if foreign() {
        return;
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = ambit_tests::Fixture::named("cornell").compile(scratch.path());
    let sensors = std::fs::read(ambit_tests::Fixture::named("cornell").sensors).expect("sensors are checked in");
    let run = |option: &str| {
        let program = Program::new("rtrace").line("-h -w- -I -ab 3 -ad 256 -as 0 -aa .2 -ar 64 --stats").line(option);
        let err = program.arg(&octree).feed(&sensors).well(option).err;
        let (before, _) = err.split_once(" hemisphere samples").expect("statistics were asked for");
        before.rsplit(' ').next().and_then(|n| n.parse::<f64>().ok()).expect("a number")
    };
    let (without, with) = (run("--measured-reuse off"), run("--measured-reuse on"));
    println!("{without} samples, {with} with the switch");
    assert!((with / without - 1.0).abs() < 0.02, "{with} samples instead of {without}");
}

/// Sensors on a grid over the box's floor.
fn grid() -> String {
    let point = |k: u32| format!("{} {} .001 0 0 1", 0.1 + 0.04 * f64::from(k % 20), 0.1 + 0.04 * f64::from(k / 20));
    let points: Vec<String> = (0..400).map(point).collect();
    points.join("\n") + "\n"
}

/// The overlap that is asked for decides how many records there are.
#[test]
fn overlap_is_an_option() {
    if foreign() {
        return;
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = ambit_tests::Fixture::named("cornell").compile(scratch.path());
    let grid = grid();
    let run = |line: &str| {
        let program = Program::new("rtrace").line("-h -w- -I -ab 1 -ad 64 -as 0 -aa .3 -ar 64 --stats").line(line);
        program.arg(&octree).feed(grid.as_bytes())
    };
    let made = |line: &str| {
        let err = run(line).well(line).err;
        let (before, _) = err.split_once(" records").expect("statistics were asked for");
        before.rsplit(' ').next().and_then(|n| n.parse::<u64>().ok()).expect("a number")
    };
    let counts = ["--overlap 0", "--overlap .3", "--overlap .6"].map(made);
    println!("{counts:?} records");
    assert!(counts[0] > 5 && counts[0] < counts[1] && counts[1] < counts[2], "{counts:?}");
    assert_eq!(made(""), counts[1], ".3 unless given");
    for wrong in ["--overlap 1", "--overlap -.1"] {
        let answer = run(wrong);
        assert!(answer.status == Some(1) && answer.err.contains("'--overlap'"), "{wrong}: {}", answer.err);
    }
}

/// Values smooth each other unless that is switched off, or their file is not of this program.
#[test]
fn smoothing_is_an_option_and_spares_the_files_of_others() {
    if foreign() {
        return;
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = ambit_tests::Fixture::named("cornell").compile(scratch.path());
    let grid = grid();
    let file = |name: &str| scratch.path().join(name);
    let run = |line: &str, name: &str| {
        let program = Program::new("rtrace").line("-h -w- -I -ab 1 -ad 64 -as 0 -aa .3 -ar 64").line(line);
        program.arg("-af").arg(file(name)).arg(&octree).feed(grid.as_bytes())
    };
    run("", "own.amb").well("making the file");
    let smooth = run("--reuse read-only", "own.amb").well("reading it").out;
    let numbers = |text: &[u8]| -> Vec<f64> {
        String::from_utf8_lossy(text).split_whitespace().map(|w| w.parse().expect("a number")).collect()
    };
    let apart = |a: &[u8], b: &[u8]| {
        let (a, b) = (numbers(a), numbers(b));
        a.iter().zip(&b).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max)
    };
    let plain = run("--smoothing 1 --reuse append", "own.amb").well("without smoothing").out;
    assert!(apart(&plain, &smooth) > 1e-3, "smoothing does something");
    // The same file as if Radiance had made it.
    let bytes = std::fs::read(file("own.amb")).expect("the file is there");
    let end = bytes.windows(2).position(|w| w == b"\n\n").expect("a header ends");
    let lines = bytes[..end].split(|&b| b == b'\n').filter(|line| !line.starts_with(b"AMBIT_"));
    let header = lines.collect::<Vec<_>>().join(&b'\n');
    std::fs::write(file("other.amb"), [&header, &bytes[end..]].concat()).expect("it can be written");
    let other = run("", "other.amb").well("with a file of another program").out;
    assert!(apart(&other, &plain) < 1e-6, "{}", apart(&other, &plain));
    for wrong in ["--smoothing .9", "--smoothing 3"] {
        let answer = run(wrong, "own.amb");
        assert!(answer.status == Some(1) && answer.err.contains("'--smoothing'"), "{wrong}: {}", answer.err);
    }
}
