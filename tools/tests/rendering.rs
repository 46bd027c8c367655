//! rtrace and rpict as a script sees them, against what Radiance 6.0a answered (`recorded/`: standard output, with the
//! dates cut out). The scene has no random parts, so bytes must agree.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const SCENE: &str = include_str!("recorded/scene.rad");
const RAYS: &[u8] = include_bytes!("recorded/rays.txt");

/// A folder with the scene and its octree.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        std::fs::write(bench.path("scene.rad"), SCENE).unwrap();
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "scene.rad", b"");
        assert!(octree.status.success());
        std::fs::write(bench.path("scene.oct"), octree.stdout).unwrap();
        bench
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, program: &str, line: &str, input: &[u8]) -> Output {
        let mut command = Command::new(program);
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::piped());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let input = input.to_vec();
        // A program may end before it has read everything.
        let feeder = std::thread::spawn(move || drop(std::io::Write::write_all(&mut stdin, &input)));
        let output = child.wait_with_output().unwrap();
        feeder.join().unwrap();
        output
    }

    fn rtrace(&self, line: &str, input: &[u8]) -> Output {
        self.run(env!("CARGO_BIN_EXE_rtrace"), line, input)
    }

    fn rpict(&self, line: &str, input: &[u8]) -> Output {
        self.run(env!("CARGO_BIN_EXE_rpict"), line, input)
    }
}

/// Output with the dates cut out and the software named as Radiance names it.
fn masked(bytes: &[u8]) -> Vec<u8> {
    let own = format!(" (Ambit {})", env!("CARGO_PKG_VERSION"));
    let mut out = Vec::new();
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        let newline = line.ends_with(b"\n");
        if line.starts_with(b"CAPDATE=") || line.starts_with(b"GMT=") {
            let name = line.split(|&b| b == b'=').next().unwrap();
            out.extend_from_slice(name);
            out.push(b'=');
        } else if line.starts_with(b"SOFTWARE=") {
            out.extend_from_slice(String::from_utf8_lossy(line).trim_end().replace(&own, "").as_bytes());
        } else {
            out.extend_from_slice(line.strip_suffix(b"\n").unwrap_or(line));
        }
        if newline {
            out.push(b'\n');
        }
    }
    out
}

fn same(name: &str, made: &[u8], recorded: &[u8]) {
    let made = masked(made);
    let (left, right) = (String::from_utf8_lossy(&made), String::from_utf8_lossy(recorded));
    assert!(made == recorded, "{name}:\n{left}\ninstead of\n{right}");
}

macro_rules! recorded {
    ($name:literal) => {
        &include_bytes!(concat!("recorded/", $name))[..]
    };
}

#[test]
fn records_and_headers_are_those_of_rtrace() {
    let bench = Bench::new();
    for (line, recorded) in [
        ("-w -x 3 -y 2", recorded!("rtrace-header.out")),
        ("-h -oodvlLpsmM~wcrxRX", recorded!("rtrace-fields.out")),
        ("-h -ld -ov", recorded!("rtrace-limited.out")),
        ("-h -I -ov", recorded!("rtrace-irradiance.out")),
        ("-fac -x 3 -y 2", recorded!("rtrace-colour.out")),
        ("-fad -oo~sM -y 2", recorded!("rtrace-double.out")),
        ("-h -odsmM", recorded!("rtrace-cast.out")),
    ] {
        let answer = bench.rtrace(&format!("{line} scene.oct"), RAYS);
        assert_eq!(answer.status.code(), Some(0), "{line}");
        same(line, &answer.stdout, recorded);
    }
}

#[test]
fn pictures_are_those_of_rpict() {
    let bench = Bench::new();
    let views = b"VIEW= -vp 0 -1 0\n\nnothing\nVIEW= -vh 60\n";
    for (line, input, recorded) in [
        ("-w -vh 60 -vv 50 -pj 0 -x 40 -y 40", &b""[..], recorded!("rpict-plain.hdr")),
        ("-w -vta -vh 180 -vv 180 -pj 0 -x 24 -pXYZ -pa 2 -ps 1", b"", recorded!("rpict-xyz.hdr")),
        ("-w -x 0", b"", recorded!("rpict-empty.hdr")),
        ("-w -S 3 -pj 0 -x 20 -y 20", views, recorded!("rpict-sequence.hdr")),
    ] {
        let answer = bench.rpict(&format!("{line} scene.oct"), input);
        assert_eq!(answer.status.code(), Some(0), "{line}");
        same(line, &answer.stdout, recorded);
    }
}

#[test]
fn threads_do_not_change_pictures() {
    let bench = Bench::new();
    let picture = |n: u32| bench.rpict(&format!("-n {n} -vh 60 -vv 50 -x 60 -y 60 scene.oct"), b"").stdout;
    let start = |p: Vec<u8>| p[p.windows(2).position(|w| w == b"\n\n").unwrap()..].to_vec();
    let one = start(picture(1));
    assert!(one.len() > 1000);
    assert_eq!(one, start(picture(3)));
}

#[test]
fn interrupted_pictures_are_completed() {
    let bench = Bench::new();
    let view = "-w -vh 60 -vv 50 -x 60 -y 60";
    assert!(bench.rpict(&format!("{view} -z whole.z -o whole.hdr scene.oct"), b"").status.success());
    let whole = std::fs::read(bench.path("whole.hdr")).unwrap();
    let depths = std::fs::read(bench.path("whole.z")).unwrap();
    std::fs::write(bench.path("part.hdr"), &whole[..whole.len() * 2 / 3]).unwrap();
    std::fs::write(bench.path("part.z"), &depths[..depths.len() * 2 / 3]).unwrap();
    let answer = bench.rpict("-t 9 -z part.z -ro part.hdr scene.oct", b"");
    assert!(answer.status.success());
    let report = String::from_utf8(answer.stderr).unwrap();
    let report = report.strip_prefix("rpict: warning - no light sources found\n").unwrap();
    assert!(report.starts_with("rpict: 0 rays, ") && !report.starts_with("rpict: 0 rays, 0.00%"), "{report}");
    assert!(report.contains(" 100.00% after "), "{report}");
    let body = |p: &[u8]| p[p.windows(2).position(|w| w == b"\n\n").unwrap()..].to_vec();
    let pixels = |p: &[u8]| {
        let mut reader = ambit_file::PictureReader::new(p, "picture").unwrap();
        let mut rows = 0;
        while reader.next_codes().unwrap().is_some() {
            rows += 1;
        }
        rows
    };
    let again = std::fs::read(bench.path("part.hdr")).unwrap();
    assert_eq!(pixels(&again), pixels(&whole));
    // The lines that were there are still the same.
    let (a, b) = (body(&whole), body(&again));
    assert_eq!(a[..a.len() / 2], b[..a.len() / 2]);
    assert_eq!(std::fs::read(bench.path("part.z")).unwrap().len(), depths.len());
    // What was renamed meanwhile is gone.
    let spare = std::fs::read_dir(bench.0.path())
        .unwrap()
        .filter(|e| e.as_ref().is_ok_and(|e| e.file_name().to_string_lossy().starts_with("rf")));
    assert_eq!(spare.count(), 0);
}

#[test]
fn sizes_and_pixels_of_odd_pictures() {
    let bench = Bench::new();
    let start = |line: &str| {
        let picture = bench.rpict(&format!("{line} scene.oct"), b"").stdout;
        let end = picture.windows(3).position(|w| w == b"+X ").unwrap() + 11;
        String::from_utf8(picture[..end].to_vec()).unwrap()
    };
    // Nothing in one direction is nothing at all.
    assert!(start("-w -vtl -vh 1000 -x 8 -y 8").ends_with("\n\n-Y        0 +X        0"));
    let wide = bench.rpict("-w -pa 0 -x 70000 -y 1 scene.oct", b"");
    let text = "rpict: fatal - a picture of 70000 by 1 pixels (more than 65535 across) is not supported\n";
    assert_eq!(wide.status.code(), Some(1));
    assert!(wide.stdout.is_empty() && String::from_utf8_lossy(&wide.stderr).starts_with(text));
    // What is recovered has the pixels that view and size come to.
    let whole = bench.rpict("-w -vh 90 -vv 75 -x 20 -y 20 scene.oct", b"").stdout;
    assert!(!String::from_utf8_lossy(&whole).contains("PIXASPECT"));
    std::fs::write(bench.path("part.hdr"), &whole[..whole.len() / 2]).unwrap();
    assert!(start("-w -r part.hdr").contains("\nPIXASPECT=1.023103\n"));
}

#[test]
fn trees_have_no_number_of_components() {
    let bench = Bench::new();
    for (fields, lines) in [("vs", 1), ("vts", 0), ("vt", 1), ("ot", 1), ("ts", 0), ("Tv", 0)] {
        let answer = bench.rtrace(&format!("-w -o{fields} scene.oct"), b"");
        let text = String::from_utf8(answer.stdout).unwrap();
        assert_eq!(text.matches("\nNCOMP=").count(), lines, "{fields}: {text}");
    }
}

#[test]
fn ambient_files_name_the_program_that_made_them() {
    let bench = Bench::new();
    for (answer, file, line) in [
        (bench.rtrace("-w -ab 1 -af one.amb scene.oct", b""), "one.amb", "#?RADIANCE\nrtrace -av 0 0 0 -aw 0 -ab 1 "),
        (
            bench.rpict("-w -x 4 -ab 1 -af two.amb scene.oct", b""),
            "two.amb",
            "#?RADIANCE\nrpict -av 0 0 0 -aw 0 -ab 1 ",
        ),
    ] {
        assert!(answer.status.success());
        assert!(std::fs::read(bench.path(file)).unwrap().starts_with(line.as_bytes()), "{file}");
    }
}

#[test]
fn rays_that_are_only_cast_need_no_light() {
    let bench = Bench::new();
    let warning = "rtrace: warning - no light sources found\n";
    for (line, text) in [("-h -osL scene.oct", ""), ("-h -osLv scene.oct", warning)] {
        assert_eq!(String::from_utf8_lossy(&bench.rtrace(line, RAYS).stderr), text, "{line}");
    }
}

#[test]
fn rays_between_mirrors_do_not_overflow_the_stack() {
    let bench = Bench::new();
    // Two mirrors face each other; perfect ones never let a ray go.
    for reflectance in ["0.995", "1"] {
        let scene = format!(
            "void metal m 0 0 5 {reflectance} {reflectance} {reflectance} 1 0 \
             m ring low 0 0 8 0 0 0 0 0 1 0 9 m ring high 0 0 8 0 0 1 0 0 -1 0 9"
        );
        std::fs::write(bench.path("mirrors.rad"), scene).unwrap();
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "mirrors.rad", b"").stdout;
        std::fs::write(bench.path("mirrors.oct"), octree).unwrap();
        for threads in [1, 2] {
            let line = format!("-h -w -lr 0 -n {threads} mirrors.oct");
            let answer = bench.rtrace(&line, "0 0 .5 .00001 0 1\n".repeat(32).as_bytes());
            let lines = String::from_utf8_lossy(&answer.stdout).lines().count();
            assert_eq!((answer.status.code(), lines), (Some(0), 32), "{reflectance} {threads}");
        }
    }
}

#[test]
fn names_keep_their_bytes() {
    let bench = Bench::new();
    // Two names in Latin-1 that differ in one letter, neither of which is UTF-8.
    let scene = b"void glow gr\xfcn 0 0 4 0 1 0 0 void glow gr\xe4n 0 0 4 1 0 0 0 gr\xfcn sphere s\xf6 0 0 4 0 0 0 1";
    std::fs::write(bench.path("latin.rad"), scene).unwrap();
    for option in ["", "-f "] {
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), &format!("{option}latin.rad"), b"").stdout;
        std::fs::write(bench.path("latin.oct"), octree).unwrap();
        let answer = bench.rtrace("-h -w -osm~v latin.oct", b"0 0 3 0 0 -1");
        let line = b"s\xf6\tgr\xfcn\t~\t0.000000e+00\t1.000000e+00\t0.000000e+00\t\n";
        assert_eq!(answer.stdout, line, "{}", String::from_utf8_lossy(&answer.stdout));
    }
}

#[test]
fn frames_that_exist_are_not_made_again() {
    let bench = Bench::new();
    let views = b"VIEW= -vh 50\nVIEW= -vh 60\nVIEW= -vh 70\n";
    std::fs::write(bench.path("f02.hdr"), "mine").unwrap();
    let line = "-w -S 1 -x 20 -y 20 -o f%02d.hdr scene.oct";
    assert!(bench.rpict(line, views).status.success());
    assert_eq!(std::fs::read(bench.path("f02.hdr")).unwrap(), b"mine");
    let third = std::fs::read(bench.path("f03.hdr")).unwrap();
    assert!(String::from_utf8_lossy(&third).contains("FRAME=3\nVIEW= -vtv"));
    let again = bench.rpict(&line.replace("-w ", ""), views);
    let warnings = "rpict: warning - no light sources found\nrpict: warning - no output produced\n";
    assert_eq!(String::from_utf8_lossy(&again.stderr), warnings);
}

#[test]
fn sequences_begin_with_what_pictures_share_and_need_a_view() {
    let bench = Bench::new();
    let none = bench.rpict("-w -S 1 -x 20 -y 20 scene.oct", b"VIEW= nothing\n");
    let lines = "#?RADIANCE\noconv scene.rad\nrpict -w -S 1 -x 20 -y 20\nSOFTWARE= RADIANCE 6.0a\n";
    assert_eq!((String::from_utf8_lossy(&masked(&none.stdout)).as_ref(), none.status.code()), (lines, Some(0)));
    let two = bench.rpict("-w -S 1 -x 20 -y 20 scene.oct", b"VIEW= -vh 50\nVIEW= -vh 60\n").stdout;
    let text = String::from_utf8_lossy(&two);
    assert!(text.contains("\nFRAME=1\nVIEW= ") && text.contains("FRAME=2\nVIEW= "));
    assert_eq!(text.matches("SOFTWARE=").count(), 1);
    // What the views change must be one itself.
    let line = "-w -S 1 -vh 0 -x 20 -y 20 scene.oct";
    assert_eq!(bench.rpict(line, b"VIEW= -vh 50\n").status.code(), Some(1));
}

#[test]
fn single_pictures_have_number_0_and_empty_ones_no_distances() {
    let bench = Bench::new();
    assert!(bench.rpict("-w -x 20 -y 20 -o g%02d.hdr -z g%d.z scene.oct", b"").status.success());
    let picture = std::fs::read(bench.path("g00.hdr")).unwrap();
    assert!(!String::from_utf8_lossy(&picture).contains("FRAME="));
    assert_eq!(std::fs::read(bench.path("g0.z")).unwrap().len(), 20 * 20 * 4);
    let empty = bench.rpict("-x 0 -o h.hdr -z h.z scene.oct", b"");
    assert!(empty.status.success());
    assert!(String::from_utf8_lossy(&empty.stderr).contains("warning - empty output picture"));
    assert!(bench.path("h.hdr").exists() && !bench.path("h.z").exists());
}

/// Programs that render a sequence together would meet here: one asks whether a picture exists, then another begins it.
#[test]
#[cfg(unix)]
fn frames_that_others_begin_meanwhile_are_left_to_them() {
    let bench = Bench::new();
    // Not there for who asks, but for who opens it to write a new file.
    std::os::unix::fs::symlink("nowhere", bench.path("f02.hdr")).unwrap();
    let answer =
        bench.rpict("-w -S 1 -x 20 -y 20 -o f%02d.hdr scene.oct", b"VIEW= -vh 50\nVIEW= -vh 60\nVIEW= -vh 70\n");
    assert_eq!(String::from_utf8_lossy(&answer.stderr), "");
    assert!(answer.status.success());
    assert!(bench.path("f03.hdr").exists() && !bench.path("nowhere").exists());
}

#[test]
fn errors_have_their_class_and_status() {
    let bench = Bench::new();
    let first = |output: &Output| String::from_utf8_lossy(&output.stderr).lines().next().unwrap_or_default().to_owned();
    for (line, text, status) in [
        ("-ab1 scene.oct", "rtrace: fatal - command line error at '-ab1'", 1),
        ("", "rtrace: fatal - missing octree argument", 1),
        (
            "-oq scene.oct",
            "rtrace: fatal - unrecognized output option 'q' (expected letters of odrRxXvVlLcpnNswWmM~tT)",
            1,
        ),
        ("-fac -op scene.oct", "rtrace: fatal - color format only with -ov, -or, -ox", 1),
        ("-fac -pY scene.oct", "rtrace: fatal - color format incompatible with -pY, -pS, -pM", 1),
        ("-I -op scene.oct", "rtrace: fatal - -I+ and -i+ options require some value output", 1),
        ("-cs 2 scene.oct", "rtrace: fatal - unsupported spectral sampling", 1),
        ("@nofile", "rtrace: system - cannot expand '@nofile': No such file or directory", 2),
        ("none.oct", "rtrace: system - cannot open octree file \"none.oct\": No such file or directory", 2),
        (
            "-e /nonexistent/x scene.oct",
            "rtrace: system - cannot open error file \"/nonexistent/x\": No such file or directory",
            2,
        ),
        ("-features Nope", "rtrace: missing feature - Nope", 1),
        ("-P file", "rtrace: fatal - persist mode (-P, -PP) without an octree is not supported", 1),
        ("-ovt scene.oct", "", 0),
        ("-fac -otv scene.oct", "rtrace: fatal - color format only with -ov, -or, -ox", 1),
    ] {
        let answer = bench.rtrace(line, b"");
        if status != 0 {
            assert_eq!(first(&answer), text);
        }
        assert_eq!(answer.status.code(), Some(status), "{line}");
    }
    let answer = bench.rpict("-vu 0 1 0 scene.oct", b"");
    let lines: Vec<String> = String::from_utf8_lossy(&answer.stderr).lines().map(String::from).collect();
    assert_eq!(lines[0], "rpict: fatal - view up parallel to view direction");
    assert!(lines[1].starts_with("rpict: 0 rays, 0.00% after 0.000u 0.000s 0.000r hours on "));
    for (line, text) in [
        ("-vtz scene.oct", "rpict: fatal - unknown view type 'z' (expected one of: v, l, c, h, a, s)"),
        ("-PP file scene.oct", "rpict: fatal - persist option only for sequences"),
        ("-S 1 -r old.hdr -P file scene.oct", "rpict: fatal - persist option used with recover file"),
        ("-S 1 -PP file", "rpict: fatal - persist mode (-P, -PP) without an octree is not supported"),
        ("-S 1", "rpict: fatal - missing octree argument"),
    ] {
        assert_eq!(first(&bench.rpict(line, b"")), text);
    }
    let answer = bench.rpict("-o scene.rad scene.oct", b"");
    assert!(String::from_utf8_lossy(&answer.stderr).contains("cannot open output file \"scene.rad\": File exists\n"));
    assert_eq!(answer.status.code(), Some(2));
}

#[test]
fn error_files_take_messages() {
    let bench = Bench::new();
    let answer = bench.rtrace("-e log -y 2 scene.oct", b"0 0 0 0 1 0");
    assert!(answer.status.success() && answer.stderr.is_empty());
    let log = std::fs::read_to_string(bench.path("log")).unwrap();
    assert!(log.starts_with("**************\n*** PID "), "{log}");
    assert!(log.contains(": rtrace -e log -y 2 scene.oct\n\n"), "{log}");
    assert!(log.ends_with("rtrace: warning - unexpected EOF on input\n"), "{log}");
}

#[test]
#[cfg(unix)]
fn a_signal_ends_a_picture_in_order() {
    let bench = Bench::new();
    let program = Path::new(env!("CARGO_BIN_EXE_rpict"));
    let mut command = Command::new(program);
    command.args("-w -x 6000 -y 6000 -ps 1 -o big.hdr scene.oct".split_whitespace()).current_dir(bench.0.path());
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    // Until the first lines are out.
    let size = || std::fs::metadata(bench.path("big.hdr")).map_or(0, |m| m.len());
    for _ in 0..2000 {
        if size() > 1000 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(size() > 1000);
    assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
    let answer = child.wait_with_output().unwrap();
    assert_eq!(answer.status.code(), Some(3));
    let text = String::from_utf8_lossy(&answer.stderr);
    assert!(text.starts_with("rpict: signal - Terminate\nrpict: "), "{text}");
}

#[test]
fn man_pages_and_help_are_there() {
    let bench = Bench::new();
    for answer in [bench.rpict("--man", b""), bench.rtrace("--man", b"")] {
        assert!(String::from_utf8_lossy(&answer.stdout).contains("\n.TH "));
    }
    assert!(String::from_utf8_lossy(&bench.rtrace("--help", b"").stdout).contains("Usage: rtrace "));
    assert!(bench.rtrace("-version", b"").stdout.starts_with(b"RADIANCE "));
    for (name, program) in [
        ("oconv", env!("CARGO_BIN_EXE_oconv")),
        ("obj2mesh", env!("CARGO_BIN_EXE_obj2mesh")),
        ("lookamb", env!("CARGO_BIN_EXE_lookamb")),
    ] {
        let answer = bench.run(program, "--help", b"");
        assert!(answer.status.success() && answer.stderr.is_empty(), "{name}");
        assert!(String::from_utf8_lossy(&answer.stdout).starts_with(&format!("Usage: {name} ")), "{name}");
    }
}

/// As in `rpict -z >(gzip > distances.gz)`.
#[test]
fn distances_go_into_a_pipe() {
    let bench = Bench::new();
    let piped = bench.rpict("-w -x 16 -y 16 -z /dev/stderr scene.oct", b"");
    let filed = bench.rpict("-w -x 16 -y 16 -z file.z scene.oct", b"");
    assert!(piped.status.success() && filed.status.success());
    assert_eq!(piped.stderr.len(), 16 * 16 * 4);
    assert_eq!(piped.stderr, std::fs::read(bench.path("file.z")).unwrap());
}

/// Programs that turn pictures (pflip, protate) change the order of pixels in their resolution string.
#[test]
fn pictures_that_were_turned_are_not_gone_on_with() {
    let bench = Bench::new();
    let whole = bench.rpict("-w -vh 90 -vv 75 -x 20 -y 20 scene.oct", b"").stdout;
    let at = whole.windows(4).position(|w| w == b"\n-Y ").expect("a resolution string") + 1;
    let (height, width) = (15, 20);
    assert!(whole[at..].starts_with(format!("-Y {height:8} +X {width:8}\n").as_bytes()));
    for (turned, width, height) in
        [("-Y       15 -X       20", 20, 15), ("+Y       15 +X       20", 20, 15), ("+X       20 +Y       15", 15, 20)]
    {
        let file = [&whole[..at], turned.as_bytes(), &whole[at + turned.len()..]].concat();
        std::fs::write(bench.path("turned.hdr"), file).unwrap();
        let done = bench.rpict("-r turned.hdr -o new.hdr scene.oct", b"");
        assert!(done.status.success());
        let told = String::from_utf8(done.stderr).unwrap();
        assert!(told.contains("bad recover file \"turned.hdr\" - not removed"), "{told}");
        assert!(bench.path("turned.hdr").exists());
        let size = format!("\n-Y {height:8} +X {width:8}\n");
        let new = std::fs::read(bench.path("new.hdr")).unwrap();
        assert!(new.windows(size.len()).any(|w| w == size.as_bytes()), "{turned}");
        std::fs::remove_file(bench.path("new.hdr")).unwrap();
    }
    std::fs::write(bench.path("other.hdr"), &whole).unwrap();
    let done = bench.rpict("-pXYZ -r other.hdr scene.oct", b"");
    assert!(String::from_utf8_lossy(&done.stderr).contains("bad recover file \"other.hdr\" - not removed"));
    let pixels = |picture: &[u8]| picture[picture.windows(4).position(|w| w == b"\n-Y ").unwrap()..].to_vec();
    let anew = bench.rpict("-w -pXYZ -vh 90 -vv 75 -x 20 -y 20 scene.oct", b"").stdout;
    assert_eq!(pixels(&done.stdout), pixels(&anew));
}
