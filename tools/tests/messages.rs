//! What a newcomer is told who mistakes a file or an option: Radiance's message first, then what may help.

use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A scene without an empty line, as a header must have one.
const SCENE: &str = "void light l 0 0 3 1 1 1\nl sphere s 0 0 4 0 5 0 1\n";

/// A folder with an empty file, scenes, an octree and a picture.
fn bench() -> TempDir {
    let folder = tempfile::tempdir().expect("a scratch folder can be made");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("it can be written");
    write("empty", b"");
    std::fs::create_dir(folder.path().join("folder")).expect("a folder can be made");
    write("placed.rad", b"void instance x 1 folder 0 0\n");
    write("s.rad", SCENE.as_bytes());
    write("apart.rad", format!("# one lamp\n\n{SCENE}").as_bytes());
    write("marked.rad", format!("\u{feff}{SCENE}").as_bytes());
    let wide: Vec<u8> = format!("\u{feff}{SCENE}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    write("wide.rad", &wide);
    write("s.oct", &run(&folder, env!("CARGO_BIN_EXE_oconv"), "s.rad", "").stdout);
    write("p.hdr", &run(&folder, env!("CARGO_BIN_EXE_rpict"), "-x 4 -y 4 s.oct", "").stdout);
    folder
}

fn run(folder: &TempDir, program: &str, line: &str, input: &str) -> Output {
    let mut command = Command::new(program);
    command.args(line.split_whitespace()).current_dir(folder.path()).env("RAYPATH", ".");
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("it runs");
    // A program may end before it has read everything.
    let _ = std::io::Write::write_all(&mut child.stdin.take().expect("a pipe"), input.as_bytes());
    child.wait_with_output().expect("it ends")
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn files_of_another_kind_are_named() {
    let folder = bench();
    let (oconv, rtrace) = (env!("CARGO_BIN_EXE_oconv"), env!("CARGO_BIN_EXE_rtrace"));
    for (program, line, text) in [
        (rtrace, "empty", "rtrace: fatal - (empty): not an octree (nothing in it)\n"),
        (rtrace, "folder", "rtrace: fatal - (folder): not an octree (a directory)\n"),
        (oconv, "-i folder", "oconv: fatal - (folder): not an octree (a directory)\n"),
        (oconv, "placed.rad", "oconv: fatal - (./folder): not an octree (a directory)\n"),
        (rtrace, "s.rad", "rtrace: fatal - (s.rad): not an octree (no header; oconv makes octrees of scene files)\n"),
        (
            rtrace,
            "apart.rad",
            "rtrace: fatal - (apart.rad): incompatible octree format (no header; oconv makes octrees of scene files)\n",
        ),
        (rtrace, "p.hdr", "rtrace: fatal - (p.hdr): not an octree (FORMAT=32-bit_rle_rgbe)\n"),
        (
            oconv,
            "s.oct",
            "oconv: fatal - (s.oct): undefined modifier \"oconv\"\noconv: at s.oct:2:1\noconv: this is a file of \
             FORMAT=Radiance_octree, not a scene; -i adds to an octree, and the primitive instance places one\n",
        ),
        (
            oconv,
            "p.hdr",
            "oconv: fatal - (p.hdr): undefined modifier \"oconv\"\noconv: at p.hdr:2:1\noconv: this is a file of \
             FORMAT=32-bit_rle_rgbe, not a scene\n",
        ),
        (
            oconv,
            "marked.rad",
            "oconv: fatal - (marked.rad): undefined modifier \"\u{feff}void\" (begins with a byte order mark: save the \
             file as UTF-8 without one)\noconv: at marked.rad:1:1\n",
        ),
    ] {
        let output = run(&folder, program, line, "");
        assert_eq!((output.status.code(), told(&output)), (Some(1), text.to_owned()), "{line}");
    }
    let output = run(&folder, oconv, "wide.rad", "");
    assert!(
        told(&output).contains(" (UTF-16: save the file as UTF-8 without a byte order mark)\n"),
        "{}",
        told(&output)
    );
}

#[test]
fn files_that_are_no_ambient_files_are_named_once() {
    let folder = bench();
    let (rtrace, lookamb) = (env!("CARGO_BIN_EXE_rtrace"), env!("CARGO_BIN_EXE_lookamb"));
    let output = run(&folder, rtrace, "-h -ab 1 -af s.rad s.oct", "");
    let problem = "bad header: expected an empty line at its end";
    assert_eq!(told(&output), format!("rtrace: fatal - bad/incompatible ambient file \"s.rad\": {problem}\n"));
    for (file, problem) in [
        ("empty", "bad header: expected some text (there is nothing in it)"),
        ("s.rad", problem),
        ("s.oct", "FORMAT=Radiance_octree (expected Radiance_ambval)"),
    ] {
        let output = run(&folder, lookamb, file, "");
        assert_eq!(told(&output), format!("lookamb: format error on input: {problem}\n"), "{file}");
    }
}

#[test]
fn mistaken_options_are_explained_on_a_second_line() {
    let folder = bench();
    for (program, name) in [(env!("CARGO_BIN_EXE_rtrace"), "rtrace"), (env!("CARGO_BIN_EXE_rpict"), "rpict")] {
        for (line, at, hint) in [
            ("s.oct -ab 1", "s.oct", "'s.oct' is taken for the octree, and options come before it"),
            ("s.oct s.oct", "s.oct", "'s.oct' is taken for the octree, and nothing may follow it"),
            ("-nosuch s.oct", "-nosuch", "there is no such option; --help lists them"),
            ("-dvx s.oct", "-dvx", "'-dv' does not take 'x'"),
            ("-w2 s.oct", "-w2", "'-w' does not take '2'"),
            ("-abx s.oct", "-abx", "'-ab' does not take 'x'"),
            ("-ab=2 s.oct", "-ab=2", "'-ab' does not take '=2'"),
            ("--ab=2 s.oct", "--ab=2", "'-ab' does not take '=2'"),
            ("--error=5% s.oct", "--error=5%", "'--error' does not take '=5%'"),
            ("-defaults1 s.oct", "-defaults1", "there is no such option; --help lists them"),
            ("--ab 1 s.oct", "--ab", "expected '-ab'"),
            ("-stats s.oct", "-stats", "expected '--stats'"),
            ("-ab two s.oct", "-ab", "'two' (expected an integer)"),
            ("-aa x s.oct", "-aa", "'x' (expected a number)"),
            ("-me 1 1 s.oct", "-me", "'s.oct' (expected a number)"),
            ("-ab", "-ab", "a value is missing"),
            ("-af Büro.amb s.oct", "-af", "'Büro.amb' (expected printable ASCII characters)"),
        ] {
            let output = run(&folder, program, line, "");
            let text = format!("{name}: fatal - command line error at '{at}'\n{name}: {hint}\n");
            assert!(output.status.code() == Some(1) && told(&output).starts_with(&text), "{}", told(&output));
        }
    }
    let text = told(&run(&folder, env!("CARGO_BIN_EXE_rpict"), "-vtxy s.oct", ""));
    assert!(text.contains("\nrpict: '-vt' does not take 'xy'\n"), "{text}");
    for (program, name) in [(env!("CARGO_BIN_EXE_oconv"), "oconv"), (env!("CARGO_BIN_EXE_obj2mesh"), "obj2mesh")] {
        let output = run(&folder, program, "-help", "");
        let text = format!("{name}: fatal - unknown option: '-help'\n{name}: --help lists the options\n");
        assert_eq!((output.status.code(), told(&output)), (Some(1), text));
    }
}

#[test]
fn places_in_expressions_are_marked_below_them() {
    let folder = bench();
    std::fs::write(folder.path().join("bad.cal"), "a = 1;\nf = 1 + ;\n").expect("it can be written");
    for (option, text) in [
        ("-e a=(1+", "rtrace: a=(1+\nrtrace:     ^ unexpected character\n"),
        ("-f bad.cal", "rtrace: ./bad.cal, line 2:\nrtrace: f = 1 + ;\nrtrace:         ^ unexpected character\n"),
    ] {
        let output = run(&folder, env!("CARGO_BIN_EXE_rtrace"), &format!("{option} s.oct"), "");
        assert_eq!((output.status.code(), told(&output).as_str()), (Some(1), text));
    }
}

/// What is said of rays that seem to be binary.
const BINARY: &str =
    "rtrace: warning - rays end at \"\\u{1}\\u{2}\\u{3}\" (expected a number; binary rays need -ff or -fd)\n";

#[test]
fn text_that_stops_being_rays_is_a_warning() {
    let folder = bench();
    let ray = "0 0 0 0 1 0\n";
    for (input, text, records) in [
        (ray.to_owned(), "", 1),
        (format!("{ray}0 0 0"), "rtrace: warning - last ray has 3 numbers of 6, and is left out\n", 1),
        ("0,0,0,0,1,0\n".to_owned(), "rtrace: warning - rays end at \"0,0,0,0,1,0\" (expected a number)\n", 0),
        ("\u{1}\u{2}\0\u{3}".to_owned(), BINARY, 0),
        (format!("# rays\n{ray}"), "rtrace: warning - rays end at \"#\" (expected a number)\n", 0),
    ] {
        let output = run(&folder, env!("CARGO_BIN_EXE_rtrace"), "-h s.oct", &input);
        assert_eq!((output.status.code(), told(&output).as_str()), (Some(0), text));
        assert_eq!(output.stdout.split_inclusive(|&b| b == b'\n').count(), records, "{input}");
        assert_eq!(told(&run(&folder, env!("CARGO_BIN_EXE_rtrace"), "-h -w s.oct", &input)), "", "{input}");
    }
}
