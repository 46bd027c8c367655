//! Bad input: the message names what is wrong, the exit status is Radiance's (1 user error, 2 system error), nothing
//! panics, and nothing on disk is lost or left half written.

use std::fs::File;
use std::path::{Path, PathBuf};

use ambit_tests::programs::foreign;
use ambit_tests::{Answer, Fixture, Program};
use tempfile::TempDir;

/// A scratch folder with a small frozen octree `s.oct` in it.
struct Bench {
    folder: TempDir,
}

/// Rays that hit the small scene.
const RAYS: &[u8] = b"1 1 1 0 0 1\n1 1 1 0 0 -1\n";

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a scratch folder can be made");
        let octree = Fixture::named("cornell").compile(folder.path());
        std::fs::rename(octree, folder.path().join("s.oct")).expect("the octree was just made");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).expect("the scratch folder can be written");
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("the file was written before")
    }

    /// Runs `program arguments` in the folder.
    fn run(&self, line: &'static str, input: &[u8]) -> Answer {
        let (name, arguments) = line.split_once(' ').expect("a program and its arguments");
        let answer = Program::new(name).line(arguments).within(self.folder.path()).feed(input);
        sane(line, &answer);
        answer
    }

    /// Runs `program arguments` and checks how it fails: the exit status and every word of the message.
    fn fails(&self, line: &'static str, status: i32, words: &[&str]) -> Answer {
        let answer = self.run(line, RAYS);
        assert_eq!(answer.status, Some(status), "{line}: {}", answer.err);
        for word in words {
            assert!(answer.err.contains(word), "{line}: `{word}` is not in the message: {}", answer.err);
        }
        answer
    }

    /// Compiles scene text that is wrong and checks that no octree comes out, only header lines at most.
    fn bad_scene(&self, text: &str, words: &[&str]) {
        self.write("c.rad", text.as_bytes());
        let answer = self.fails("oconv c.rad", 1, words);
        assert!(answer.out.is_ascii() && answer.out.len() < 200, "an octree was written for: {text}");
    }
}

/// A program ends by itself, with one of its statuses, and no trace of a panic.
fn sane(what: &str, answer: &Answer) {
    let status = answer.status.unwrap_or_else(|| panic!("{what}: ended by a signal: {}", answer.err));
    assert!((0..=3).contains(&status), "{what}: exit status {status}: {}", answer.err);
    assert!(!answer.err.contains("panicked"), "{what}: {}", answer.err);
}

#[test]
fn files_that_are_missing() {
    let bench = Bench::new();
    bench.fails("oconv nosuch.rad", 2, &["nosuch.rad", "No such file"]);
    bench.fails("rtrace nosuch.oct", 2, &["nosuch.oct", "No such file"]);
    bench.fails("rpict nosuch.oct", 2, &["nosuch.oct", "No such file"]);
    bench.fails("rpict -vf nosuch.vf s.oct", 2, &["nosuch.vf", "No such file"]);
    bench.fails("rtrace -ab 1 -af nosuch/a.amb s.oct", 2, &["nosuch/a.amb", "No such file"]);
    bench.fails("rtrace -h", 1, &["missing octree"]);
}

#[test]
fn options_that_are_wrong() {
    let bench = Bench::new();
    bench.fails("oconv -q", 1, &["unknown option", "-q"]);
    bench.fails("rtrace -ab x s.oct", 1, &["command line error at '-ab'"]);
    bench.fails("rtrace -nosuch s.oct", 1, &["command line error at '-nosuch'"]);
    bench.fails("rpict -aa 1.2.3 s.oct", 1, &["command line error at '-aa'"]);
    bench.fails("rpict -vd 0 0 0 s.oct", 1, &["zero view direction"]);
}

#[test]
fn scene_text_that_is_wrong() {
    let bench = Bench::new();
    bench.bad_scene("void plastc m 0 0 5 .5 .5 .5 0 0\n", &["c.rad", "unknown type", "plastc"]);
    bench.bad_scene("nomod sphere s 0 0 4 0 0 3 1\n", &["c.rad", "undefined modifier", "nomod"]);
    bench.bad_scene("void plastic m 0 0 5.0 .5 .5 .5 0 0\n", &["c.rad", "plastic", "m"]);
    bench.bad_scene("void plastic m 0 0 5 .5 .5 x 0 0\n", &["c.rad", "plastic", "m"]);
    bench.bad_scene("void plastic m 0 0 5 .5 .5\n", &["c.rad", "plastic", "m"]);
    bench.bad_scene("void plastic m 0 0 5 1 1 1 0 0 m sphere ball 0 0 3 0 0 3\n", &["sphere", "ball"]);
    bench.bad_scene("void plastic m 0 0 5 1 1 1 0 0 m polygon tile 0 0 8 0 0 3 1 1 1 2 2\n", &["polygon", "tile"]);
    bench.bad_scene("void plastic\n", &["c.rad"]);
}

#[test]
fn materials_that_are_wrong_are_named_when_hit() {
    let bench = Bench::new();
    let scene = |material: &str| format!("{material} m sphere s 0 0 4 0 0 0 5\n");
    for (material, status, words) in [
        ("void plastic m 0 0 4 .5 .5 .5 0", 1, ["plastic", "\"m\""]),
        ("void brightfunc p 2 x nosuch.cal 0 0 p plastic m 0 0 5 1 1 1 0 0", 2, ["nosuch.cal", ""]),
        ("void brightdata p 4 noop nosuch.dat . Px 0 0 p plastic m 0 0 5 1 1 1 0 0", 2, ["nosuch.dat", ""]),
    ] {
        bench.write("m.rad", scene(material).as_bytes());
        let octree = bench.run("oconv -f m.rad", b"");
        if octree.status == Some(0) {
            bench.write("m.oct", &octree.out);
            let line = "rtrace -h -av 1 1 1 m.oct";
            // What cannot be rendered yet is refused before its file is looked for.
            if !bench.run(line, RAYS).err.contains("unsupported") {
                bench.fails(line, status, &words);
            }
        } else {
            // Refusing it at once is as good.
            assert!(words.iter().all(|w| octree.err.contains(w)), "{material}: {}", octree.err);
        }
    }
}

#[test]
fn octrees_that_are_cut_short() {
    if foreign() {
        return; // Radiance's own programs crash on some of these.
    }
    let bench = Bench::new();
    let whole = bench.read("s.oct");
    for part in 0..24 {
        let length = whole.len() * part / 24;
        bench.write("t.oct", &whole[..length]);
        for line in ["rtrace -h t.oct", "rpict -x 4 -y 4 t.oct", "oconv -i t.oct"] {
            let answer = bench.run(line, RAYS);
            assert!(matches!(answer.status, Some(1 | 2)), "{line} with {length} bytes: {:?}", answer.status);
            assert!(!answer.err.trim().is_empty(), "{line} with {length} bytes says nothing");
            assert!(answer.err.contains("t.oct"), "{line} with {length} bytes: {}", answer.err);
        }
    }
    bench.write("text.oct", b"void plastic m 0 0 5 1 1 1 0 0\n");
    bench.fails("rtrace -h text.oct", 1, &["text.oct"]);
}

/// As in Radiance, the output of a command that fails is used if it is an octree, with a warning; else that it is none is
/// all that matters.
#[test]
fn commands_that_fail_are_told_of_once_they_have_given_an_octree() {
    let bench = Bench::new();
    bench.write("s.rad", b"void glow g 0 0 4 1 2 3 0\ng sphere f 0 0 4 0 0 0 1\n");
    let octree = bench.run("oconv s.rad", b"");
    bench.write("s.oct", &octree.out);
    bench.write("good", b"cat s.oct; exit 3");
    bench.write("bad", b"echo x; exit 3");
    for line in ["oconv -i !sh${IFS}./good", "rtrace !sh${IFS}./good", "rpict -x 4 -y 4 !sh${IFS}./good"] {
        let answer = bench.run(line, b"");
        assert_eq!(answer.status, Some(0), "{line}: {}", answer.err);
        let program = line.split(' ').next().unwrap();
        assert!(
            answer.err.starts_with(&format!("{program}: warning - bad status from \"!sh")),
            "{line}: {}",
            answer.err
        );
    }
    for line in ["oconv -i !sh${IFS}./bad", "rtrace !sh${IFS}./bad", "rpict !sh${IFS}./bad", "oconv -i .", "rtrace ."] {
        let answer = bench.fails(line, 1, &["fatal", "not an octree"]);
        assert!(!answer.err.contains("warning"), "{line}: {}", answer.err);
    }
}

#[test]
fn octrees_that_are_damaged() {
    if foreign() {
        return; // Radiance's own programs may crash on damaged bytes.
    }
    let bench = Bench::new();
    let whole = bench.read("s.oct");
    let start = whole.windows(2).position(|w| w == b"\n\n").expect("a header ends with an empty line");
    // Every so many bytes set to a pattern: the programs refuse the file or live with it, but end in order.
    for (step, pattern) in [(7, 0xff), (11, 0x80), (5, 0x00), (13, 0x7f)] {
        for offset in (start..whole.len()).step_by(whole.len() / 12) {
            let mut bytes = whole.clone();
            for byte in bytes[offset..].iter_mut().take(64).step_by(step) {
                *byte = pattern;
            }
            bench.write("d.oct", &bytes);
            bench.run("rtrace -h -w d.oct", RAYS);
        }
    }
}

#[test]
fn rays_that_are_not_numbers() {
    let bench = Bench::new();
    let finite = |what: &str, answer: &Answer, lines: usize| {
        let text = answer.text();
        let numbers = text.split_whitespace().map(|w| w.parse::<f64>().unwrap_or(f64::NAN));
        assert!(numbers.clone().all(f64::is_finite), "{what}: {text}");
        assert!(text.lines().count() >= lines, "{what}: the good rays before were not answered: {text}");
    };
    for bad in ["nan 0 0 0 0 1", "x 1 1 0 0 1", "1 1 1 0 0", "inf 1 1 0 0 1", "1 1 1 nan nan nan"] {
        let answer = bench.run("rtrace -h s.oct", format!("1 1 1 0 0 1\n{bad}\n").as_bytes());
        finite(bad, &answer, 1);
    }
    let bits = |rays: &[[f64; 6]]| rays.iter().flatten().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let good = [1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    for bad in [[1.0, 1.0, 1.0, f64::NAN, 0.0, 1.0], [f64::INFINITY, 1.0, 1.0, 0.0, 0.0, 1.0], [0.0; 6]] {
        let answer = bench.run("rtrace -h -fda s.oct", &bits(&[good, bad, good]));
        // Radiance itself forgets answered rays here.
        finite(&format!("{bad:?}"), &answer, usize::from(!foreign()));
    }
    // A zero direction is a mark in the stream, answered with zeros.
    let answer = bench.run("rtrace -h s.oct", b"1 1 1 0 0 0\n1 1 1 0 0 1\n");
    assert_eq!((answer.status, answer.text().lines().count()), (Some(0), 2), "{}", answer.err);
}

#[test]
fn full_disk() {
    let bench = Bench::new();
    let source = Fixture::named("cornell").folder.join("scene.rad");
    for (name, arguments) in
        [("rtrace", "s.oct"), ("rpict", "-x 8 -y 8 s.oct"), ("oconv", source.to_str().expect("a plain path"))]
    {
        let full = File::create("/dev/full").expect("a device of every Linux");
        let program = Program::new(name).line(arguments).within(bench.folder.path()).onto(full);
        let answer = program.feed(RAYS);
        sane(name, &answer);
        assert_eq!(answer.status, Some(2), "{name}: {}", answer.err);
        assert!(answer.err.contains("No space left on device"), "{name}: {}", answer.err);
    }
}

/// Options under which the small scene leaves some hundred records.
const FILLING: &str = "rtrace -h -I -ab 2 -ad 64 -as 0 -aa .1 -ar 64 -af a.amb s.oct";

/// Header length and number of records of an ambient file; panics if it does not hold whole records.
fn records(file: &Path) -> (usize, usize) {
    let bytes = std::fs::read(file).expect("an ambient file was made");
    let header = bytes.windows(2).position(|w| w == b"\n\n").expect("a header ends with an empty line") + 2;
    // Two bytes of magic, then 64 bytes and a colour of 3 channels each.
    let rest = bytes.len() - header - 2;
    assert_eq!(rest % 67, 0, "{} bytes beyond the last whole record", rest % 67);
    (header, rest / 67)
}

fn sensors() -> Vec<u8> {
    std::fs::read(Fixture::named("cornell").sensors).expect("sensors are checked in")
}

#[test]
fn ambient_files_that_are_foreign_stay_as_they_are() {
    let bench = Bench::new();
    for garbage in [&b"void plastic m 0 0 5 1 1 1 0 0\n"[..], b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\nxxxxxxxxxxxx"] {
        bench.write("a.amb", garbage);
        let answer = bench.fails("rtrace -h -I -ab 1 -af a.amb s.oct", 1, &["ambient file"]);
        assert!(foreign() || answer.err.contains("a.amb"), "the file is not named: {}", answer.err);
        assert_eq!(bench.read("a.amb"), garbage, "a file that is none of ours was changed");
    }
}

#[test]
fn ambient_files_with_a_torn_tail_lose_only_the_tail() {
    let bench = Bench::new();
    assert_eq!(bench.run(FILLING, &sensors()).status, Some(0));
    let whole = bench.read("a.amb");
    let (_, count) = records(&bench.path("a.amb"));
    assert!(count > 20, "only {count} records");
    bench.write("a.amb", &whole[..whole.len() - 30]);
    let answer = bench.run(FILLING, &sensors());
    assert_eq!(answer.status, Some(0), "{}", answer.err);
    if foreign() {
        return; // Radiance 6.0a damages valid records while repairing.
    }
    let now = bench.read("a.amb");
    let kept = whole.len() - 67;
    assert_eq!(&now[..kept], &whole[..kept], "records before the torn one were changed");
    assert!(records(&bench.path("a.amb")).1 >= count - 1);
}

#[test]
fn a_killed_run_leaves_whole_records() {
    let bench = Bench::new();
    // Killed after ever longer times, the file goes on from run to run.
    for pause in [20, 60, 150] {
        let mut command = std::process::Command::new(ambit_tests::programs::folder().join("rtrace"));
        let slower = FILLING.replace("-ad 64", "-ad 1024");
        command.args(slower.split(' ').skip(1)).current_dir(bench.folder.path());
        command.stdin(std::process::Stdio::piped()).stdout(std::process::Stdio::null());
        let mut child = command.spawn().expect("rtrace can be started");
        let mut pipe = child.stdin.take().expect("asked for");
        std::io::Write::write_all(&mut pipe, &sensors()).ok();
        std::thread::sleep(std::time::Duration::from_millis(pause));
        child.kill().ok();
        child.wait().expect("a started program can be waited for");
        if bench.path("a.amb").exists() && !bench.read("a.amb").is_empty() {
            records(&bench.path("a.amb"));
        }
    }
    let answer = bench.run(FILLING, &sensors());
    assert_eq!(answer.status, Some(0), "{}", answer.err);
    assert_eq!(answer.text().lines().count(), 81);
}

/// What modifiers read besides the scene: each fault is told with the file and the line, or the part of it.
#[test]
fn files_of_modifiers_are_named_with_their_line() {
    let bench = Bench::new();
    let surface = "m polygon p 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2 m polygon q 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0";
    let scenes = [
        ("void brightfunc b 2 a f.cal 0 0 b glow m 0 0 4 1 1 1 0", "f.cal"),
        ("void brightdata b 4 noop d.dat . Px 0 0 b glow m 0 0 4 1 1 1 0", "d.dat"),
        ("void BSDF m 6 0 b.xml 0 1 0 . 0 0", "b.xml"),
        ("void brighttext b 3 f.fnt . ABC 0 11 0 0 0 1 0 0 0 -1 0 1 0 b glow m 0 0 4 1 1 1 0", "f.fnt"),
        ("void colorpict b 7 red green blue p.hdr . Px Py 0 0 b glow m 0 0 4 1 1 1 0", "p.hdr"),
        ("void specpict b 5 noop p.hsr . Px Py 0 0 b glow m 0 0 4 1 1 1 0", "p.hsr"),
    ];
    let faults: [(&str, &[u8], &str); 20] = [
        ("f.cal", b"a = 1 +;", "line 1"),
        ("f.cal", b"\n\na = (1;", "line 3"),
        ("f.cal", b"{ open\na = 1;", "line 2"),
        ("d.dat", b"", "d.dat:1:1"),
        ("d.dat", b"1\n0 1 2\n1 x", "d.dat:3:3"),
        ("d.dat", b"1\n0 1 0\n1 2", "d.dat:2:5"),
        ("d.dat", b"2\n0 1 99999999\n0 1 99999999\n1", "d.dat:4:1"),
        ("b.xml", b"", "b.xml:1:1"),
        ("b.xml", b"<WindowElement>\n<Optical>\n</WindowElement>", "b.xml:3:1"),
        ("b.xml", b"<Other/>", "WindowElement"),
        ("f.fnt", b"65 x", "f.fnt:1:4"),
        ("f.fnt", b"65 3\n0 0 1 1 2 999", "f.fnt:2:11"),
        ("f.fnt", b"300 3\n0 0 1 1 2 9", "f.fnt:1:1"),
        ("p.hdr", b"", "bad header"),
        ("p.hdr", b"#?RADIANCE\nFORMAT=other\n\n-Y 2 +X 2\n", "FORMAT=other"),
        ("p.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", "resolution"),
        ("p.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n", "scanline 0"),
        ("p.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1000000000\n", "1000000000"),
        ("p.hsr", b"#?RADIANCE\nFORMAT=Radiance_spectra\n\n-Y 2 +X 2\n", "NCOMP=3"),
        ("p.hsr", b"#?RADIANCE\nNCOMP=4\nFORMAT=Radiance_spectra\n\n-Y 2 +X 2\n", "WAVELENGTH_SPLITS"),
    ];
    for (file, bytes, place) in faults {
        let (scene, _) = scenes.iter().find(|s| s.1 == file).expect("each file has a scene");
        bench.write("m.rad", format!("{scene}\n{surface}").as_bytes());
        let octree = bench.run("oconv m.rad", b"");
        assert_eq!(octree.status, Some(0), "{}", octree.err);
        bench.write("m.oct", &octree.out);
        bench.write(file, bytes);
        let place = if foreign() { "" } else { place };
        bench.fails("rtrace -h -w -ab 0 m.oct", 1, &[if foreign() { "" } else { file }, place]);
    }
}
