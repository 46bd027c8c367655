//! `--reuse` as a script sees it: ambient files of the same scene, of a changed one, and without a fingerprint.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A room with a lamp, a grating of shelves, and a pattern from a function file.
const ROOM: &str = "\
void brightfunc grain 2 grain grain.cal 0 0
grain plastic grey 0 0 5 .7 .7 .7 0 0
void plastic red 0 0 5 .6 .2 .2 0 0
void glow lamp 0 0 4 5 5 5 0
void plastic unused 0 0 5 .1 .1 .1 0 0
grey polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0
grey polygon ceiling 0 0 12 0 0 2.5 0 3 2.5 4 3 2.5 4 0 2.5
red polygon wall 0 0 12 0 0 0 0 3 0 0 3 2.5 0 0 2.5
grey polygon wall2 0 0 12 4 0 0 4 0 2.5 4 3 2.5 4 3 0
red sphere ball 0 0 4 1 1 .5 .3
lamp polygon light 0 0 12 1.5 1 2.4 1.5 2 2.4 2.5 2 2.4 2.5 1 2.4
";
const GRAIN: &str = "grain = 1 - .1*Px;\n";
/// Points that face the floor: all their light is reflected.
const RAYS: &str = "2 1.5 1 0 0 -1\n.5 .5 1 0 0 -1\n3 2 1 0 0 -1\n";
const OPTIONS: &str = "-h -I -u- -ab 2 -ad 64 -as 0 -aa .2 -ar 32 -af a.amb";

struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        fs::write(bench.path("grain.cal"), GRAIN).unwrap();
        bench.scene("s", ROOM);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Makes the octree `name.oct` of a scene.
    fn scene(&self, name: &str, text: &str) {
        fs::write(self.path(&format!("{name}.rad")), text).unwrap();
        let octree = self.run(env!("CARGO_BIN_EXE_oconv"), &format!("{name}.rad"), "");
        assert!(octree.status.success(), "{}", errors(&octree));
        fs::write(self.path(&format!("{name}.oct")), octree.stdout).unwrap();
    }

    fn run(&self, program: &str, line: &str, input: &str) -> Output {
        let mut command = Command::new(program);
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::piped());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        // A program may end before it has read everything.
        let _ = std::io::Write::write_all(&mut stdin, input.as_bytes());
        drop(stdin);
        child.wait_with_output().unwrap()
    }

    fn rtrace(&self, more: &str, octree: &str) -> Output {
        self.run(env!("CARGO_BIN_EXE_rtrace"), &format!("{OPTIONS} {more} {octree}.oct"), RAYS)
    }

    /// What a run says about the ambient file of the room; it must succeed.
    fn warnings(&self, more: &str, octree: &str) -> String {
        let output = self.rtrace(more, octree);
        assert!(output.status.success(), "{}", errors(&output));
        errors(&output)
    }

    fn files(&self) -> usize {
        let names = fs::read_dir(self.0.path()).unwrap().map(|f| f.unwrap().file_name());
        names.filter(|n| n.to_string_lossy().starts_with("a.amb")).count()
    }
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn the_same_scene_under_other_names_is_reused() {
    let bench = Bench::new();
    let first = bench.rtrace("", "s");
    assert_eq!(errors(&first), "");
    let size = fs::metadata(bench.path("a.amb")).unwrap().len();
    assert!(size > 2000);
    // Another order of files and names, other unused modifiers, a frozen octree, a file found elsewhere.
    let mut lines: Vec<&str> = ROOM.lines().filter(|l| !l.contains("unused")).collect();
    let surfaces = lines.split_off(4);
    lines.extend(surfaces.iter().rev());
    fs::create_dir(bench.path("lib")).unwrap();
    fs::write(bench.path("lib/g.cal"), GRAIN).unwrap();
    let text = lines.join("\n").replace("red", "rouge").replace("grain.cal", "./lib/g.cal");
    bench.scene("same", &text);
    assert_eq!(bench.warnings("", "same"), "");
    let frozen = bench.run(env!("CARGO_BIN_EXE_oconv"), "-f s.rad", "");
    fs::write(bench.path("frozen.oct"), frozen.stdout).unwrap();
    assert_eq!(bench.warnings("--reuse strict -n 1", "frozen"), "");
    assert_eq!(bench.files(), 1);
}

#[test]
fn what_changed_is_named() {
    let bench = Bench::new();
    bench.warnings("", "s");
    let before = fs::read(bench.path("a.amb")).unwrap();
    let changes: [(&str, &str, &str); 6] = [
        (".6 .2 .2", ".18 .06 .06", "other materials, materials of surfaces"),
        ("red sphere", "grey sphere", "other materials of surfaces"),
        ("1 1 .5 .3", "1 1 .5 .4", "other geometry, materials of surfaces"),
        ("5 5 5 0", "5 5 4 0", "other light sources"),
        ("1.5 1 2.4", "1.4 1 2.4", "other light sources"),
        ("grain.cal 0", "other.cal 0", "other materials, materials of surfaces"),
    ];
    fs::write(bench.path("other.cal"), "grain = 1 - .2*Px;\n").unwrap();
    for (from, to, named) in changes {
        assert!(ROOM.contains(from));
        bench.scene("changed", &ROOM.replace(from, to));
        let heard = bench.warnings("", "changed");
        assert!(heard.contains(&format!("does not fit: {named};")), "{to}: {heard}");
        let strict = bench.rtrace("--reuse strict", "changed");
        assert_eq!(strict.status.code(), Some(1));
        assert!(strict.stdout.is_empty() && errors(&strict).contains(named), "{}", errors(&strict));
    }
    for (option, named) in [("-ab 3", "-ab (2 there, 3 here)"), ("-ae red", "list of modifiers (-ae, -ai)")] {
        let heard = bench.warnings(option, "s");
        assert!(heard.contains(&format!("does not fit: other {named};")), "{heard}");
    }
    let heard = bench.warnings("-ad 65", "s");
    assert!(heard.contains("-ad (64 there, 65 here); its values are used"), "{heard}");
    // Nothing but the run with -ad 65 wrote to it.
    let after = fs::read(bench.path("a.amb")).unwrap();
    assert!(after.starts_with(&before));
}

/// `rad` and files of options name an ambient file in runs without interreflection, too, before or after others.
#[test]
fn runs_without_interreflection_leave_files_alone() {
    let bench = Bench::new();
    let unlit = "rtrace: warning - no light sources found\n";
    assert_eq!(bench.warnings("-ab 0", "s"), unlit);
    assert_eq!(bench.files(), 0);
    assert_eq!(bench.warnings("", "s"), "");
    let kept = fs::read(bench.path("a.amb")).unwrap();
    assert!(kept.len() > 2000);
    assert_eq!(bench.warnings("-ab 0", "s"), unlit);
    assert_eq!(bench.files(), 1);
    assert!(fs::read(bench.path("a.amb")).unwrap() == kept);
    // What is averaged with records asks for them.
    assert!(bench.warnings("-ab 0 -aw 4", "s").contains("does not fit: other -ab (2 there, 0 here), -aw"));
}

#[test]
fn relays_of_light_count_only_where_there_are_mirrors() {
    let bench = Bench::new();
    bench.warnings("", "s");
    assert_eq!(bench.warnings("-dr 0", "s"), "");
    let bench = Bench::new();
    bench.scene("m", &format!("{ROOM}void mirror glass 0 0 3 .9 .9 .9\nglass ring round 0 0 8 3.9 1 1 -1 0 0 0 .4\n"));
    bench.warnings("", "m");
    let heard = bench.warnings("-dr 0", "m");
    assert!(heard.contains("does not fit: other virtual light sources (-dr)"), "{heard}");
}

/// The same file after all reflectances were cut to 30 %: real Radiance uses it without a word.
#[test]
fn a_stale_file_is_found_out() {
    let bench = Bench::new();
    let old = bench.rtrace("", "s");
    let darker = ROOM.replace(".7 .7 .7", ".21 .21 .21").replace(".6 .2 .2", ".18 .06 .06");
    bench.scene("dark", &darker);
    let unused = bench.rtrace("--reuse off", "dark");
    assert_eq!(errors(&unused), "");
    let auto = bench.rtrace("", "dark");
    assert!(errors(&auto).contains("a.amb\" does not fit: other materials"), "{}", errors(&auto));
    let append = bench.rtrace("--reuse append", "dark");
    assert_eq!(errors(&append), "");
    let value = |o: &Output| -> f64 {
        let text = String::from_utf8_lossy(&o.stdout).into_owned();
        text.split_whitespace().map(|w| w.parse::<f64>().unwrap()).sum()
    };
    let (old, unused, auto, append) = (value(&old), value(&unused), value(&auto), value(&append));
    // The file beside it stores quantised records, by up to 1/256 off.
    assert!((auto / unused - 1.0).abs() < 0.01, "{auto} {unused}");
    assert!(append > 2.0 * auto && append > 0.95 * old, "the stale records do show: {append} {auto} {old}");
    // The second run reads what the first one kept beside the stale file.
    let size = |bench: &Bench| -> u64 {
        let files = fs::read_dir(bench.0.path()).unwrap().map(Result::unwrap);
        files
            .filter(|f| f.file_name().to_string_lossy().starts_with("a.amb."))
            .map(|f| f.metadata().unwrap().len())
            .sum()
    };
    let first = size(&bench);
    assert!(first > 2000);
    bench.warnings("", "dark");
    assert_eq!((size(&bench), bench.files()), (first, 2));
    // Other wavelengths are no other light: they have no file of their own there, either.
    let others = bench.warnings("-cw 400 700", "dark");
    assert!(others.contains("wavelength sampling: \"a.amb.") && others.contains("converted"), "{others}");
    assert_eq!(bench.files(), 2);
}

#[test]
fn files_without_fingerprint_are_used_and_off_leaves_them_alone() {
    let bench = Bench::new();
    bench.warnings("", "s");
    let bytes = fs::read(bench.path("a.amb")).unwrap();
    let start = bytes.windows(5).position(|w| w == b"AMBIT").unwrap();
    let end = bytes.windows(10).position(|w| w == b"WAVELENGTH").unwrap();
    let plain = [&bytes[..start], &bytes[end..]].concat();
    fs::write(bench.path("a.amb"), &plain).unwrap();
    bench.scene("changed", &ROOM.replace(".6 .2 .2", ".18 .06 .06"));
    assert_eq!(bench.warnings("", "changed"), "");
    let refused = bench.rtrace("--reuse strict", "s");
    assert!(refused.status.code() == Some(1) && errors(&refused).contains("no fingerprint"), "{}", errors(&refused));
    let now = fs::read(bench.path("a.amb")).unwrap();
    for how in ["off", "read-only"] {
        assert_eq!(bench.warnings(&format!("--reuse {how}"), "s"), "");
        assert_eq!(fs::read(bench.path("a.amb")).unwrap(), now);
    }
    let wrong = bench.rtrace("--reuse perhaps", "s");
    let text = "rtrace: fatal - command line error at '--reuse': 'perhaps' (expected one of: auto, strict, append, \
                read-only, off)\n";
    assert_eq!(errors(&wrong), text);
}
