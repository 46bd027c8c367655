//! The same bits from the same command, whatever the number of threads (`-n 1`, 2, 3, 8, 64): pictures, sensors and
//! ambient files. `tests/determinism/run` does so several times over, and with scenes of one's own.

use ambit_tests::programs::foreign;
use ambit_tests::{Fixture, Program};

/// Numbers of threads: one, a few, an odd number, and more than most machines have processors.
const THREADS: [u32; 5] = [1, 2, 3, 8, 64];
const LIGHT: &str = "-ab 2 -ad 128 -as 32 -aa .2 -ar 32 -ds .2 -dj .5 -ss 1";

/// What follows the header: its lines hold the command and the time of day.
fn body(bytes: &[u8]) -> Vec<u8> {
    let end = bytes.windows(2).position(|w| w == b"\n\n").expect("a header ends with an empty line");
    bytes[end + 2..].to_vec()
}

/// Runs a program with each number of threads and an ambient file of its own; returns outputs and ambient files.
fn with_threads(run: impl Fn(Program) -> Vec<u8>, name: &'static str) -> Vec<(Vec<u8>, Vec<u8>)> {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let one = |threads: u32| {
        let cache = scratch.path().join(format!("{threads}.amb"));
        let program = Program::new(name).line(LIGHT).line(&format!("-n {threads}")).arg("-af").arg(&cache);
        let out = run(program);
        (out, body(&std::fs::read(&cache).expect("an ambient file was asked for")))
    };
    THREADS.map(one).to_vec()
}

fn all_equal(what: &str, answers: &[(Vec<u8>, Vec<u8>)]) {
    let (out, cache) = &answers[0];
    assert!(!out.is_empty() && cache.len() > 67, "{what}: nothing came out");
    for (threads, (other, file)) in THREADS.iter().zip(answers).skip(1) {
        let first = out.iter().zip(other).position(|(a, b)| a != b);
        assert!(out == other, "{what}: -n {threads} differs from -n 1, first at byte {first:?} of {}", out.len());
        assert!(cache == file, "{what}: the ambient file of -n {threads} differs from that of -n 1");
    }
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    if foreign() {
        return; // rpict -n is ours.
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    for name in ["room", "lampbox", "leak", "optics"] {
        let fixture = Fixture::named(name);
        let octree = fixture.compile(scratch.path());
        let picture = |program: Program| {
            let view = program.arg("-vf").arg(&fixture.views[0]).line("-x 32 -y 32 -ps 2 -pt .05 -pj .7");
            let answer = view.within(&fixture.folder).arg(&octree).run().well(name);
            body(&answer.out)
        };
        all_equal(name, &with_threads(picture, "rpict"));
    }
}

#[test]
fn sensors_do_not_depend_on_the_number_of_threads() {
    if foreign() {
        return; // Radiance promises it for one process only.
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    for name in ["room", "lampbox", "leak", "optics"] {
        let fixture = Fixture::named(name);
        let octree = fixture.compile(scratch.path());
        let rays = std::fs::read(&fixture.sensors).expect("sensors are checked in");
        for stratified in ["-u-", "-u+"] {
            let sensors = |program: Program| {
                let program = program.line("-h -I").line(stratified).within(&fixture.folder);
                program.arg(&octree).feed(&rays).well("rtrace").out
            };
            all_equal(&format!("{name} {stratified}"), &with_threads(sensors, "rtrace"));
        }
    }
}

#[test]
fn systems_of_our_own_do_not_depend_on_the_number_of_threads() {
    if foreign() {
        return;
    }
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let fixture = Fixture::named("leak");
    let octree = fixture.compile(scratch.path());
    let rays = std::fs::read(&fixture.sensors).expect("sensors are checked in");
    let usual = |line: &str| {
        let answers = with_threads(
            |program| program.line("-h -I").line(line).arg(&octree).feed(&rays).well("rtrace").out,
            "rtrace",
        );
        all_equal(line, &answers);
        answers[0].0.clone()
    };
    let plain = usual("-ab 2");
    let ours =
        ["--neighbor-clamping", "--spacing classical", "--actual-weights", "--unbounded-bounces", "--overlap .9"];
    for line in ours {
        assert!(usual(line) != plain, "{line} changes nothing");
    }
}

#[test]
fn the_same_command_twice_gives_the_same_bits() {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let fixture = Fixture::named("lights");
    let octree = fixture.compile(scratch.path());
    let run = || {
        let view = Program::new("rpict").line(LIGHT).line("-x 64 -y 64 -vf").arg(&fixture.views[0]);
        body(&view.arg(&octree).run().well("rpict").out)
    };
    assert!(run() == run(), "two runs of one command differ");
}
