//! obj2mesh: meshes byte for byte as Radiance 6.0a made them of the files in `recorded/obj2mesh`, and its errors.

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder with the files of the tests.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        for file in ["house.obj", "house.mat"] {
            std::fs::copy(recorded(file), bench.0.path().join(file)).unwrap();
        }
        bench.write("hills.obj", &hills());
        bench
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    fn run(&self, line: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_obj2mesh"));
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::null());
        command.output().unwrap()
    }

    /// Standard error of a run that ends with a status.
    fn says(&self, line: &str, status: i32) -> String {
        let answer = self.run(line);
        assert_eq!(answer.status.code(), Some(status), "{line}");
        assert_eq!(answer.stdout.is_empty(), status != 0, "{line}");
        String::from_utf8(answer.stderr).unwrap()
    }
}

fn recorded(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recorded/obj2mesh").join(name)
}

/// Quadrilaterals that are not flat, partly with normals: more vertices than fit one patch.
fn hills() -> String {
    const N: usize = 18;
    let mut text = String::new();
    for k in 0..N * N {
        let (i, j) = (k / N, k % N);
        writeln!(text, "v {i} {j} .{}", (i * 7 + j * 13) % 5).unwrap();
    }
    for k in 0..7 {
        writeln!(text, "vn {} {} 6", k - 3, 2 * k - 7).unwrap();
    }
    for i in 0..N - 1 {
        for j in 0..N - 1 {
            let corner = i * N + j + 1;
            let corners = [corner, corner + N, corner + N + 1, corner + 1];
            let words = corners.map(|k| if (i + j) % 3 == 0 { k.to_string() } else { format!("{k}//{}", k % 7 + 1) });
            writeln!(text, "f {}", words.join(" ")).unwrap();
        }
    }
    text
}

#[test]
fn meshes_are_those_of_radiance() {
    let bench = Bench::new();
    for (line, file) in [
        ("-a house.mat house.obj", "house.rtm"),
        ("-n 3 -r 100 -v house.obj", "house-fine.rtm"),
        ("hills.obj", "hills.rtm"),
    ] {
        let answer = bench.run(line);
        assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
        assert!(answer.stdout == std::fs::read(recorded(file)).unwrap(), "{line} differs from {file}");
    }
    // The output file may be named; the header does not tell it.
    assert!(bench.run("hills.obj out.rtm").stdout.is_empty());
    assert_eq!(std::fs::read(bench.0.path().join("out.rtm")).unwrap(), std::fs::read(recorded("hills.rtm")).unwrap());
}

#[test]
fn what_is_left_out_is_told() {
    let bench = Bench::new();
    let text = bench.says("-v -a house.mat house.obj", 0);
    for line in [
        "obj2mesh: warning - 3 of 44 statements unrecognized\n",
        "obj2mesh: warning - zero area for polygon \"t23\"\n",
        "obj2mesh: warning - degenerate triangle\n",
        "Mesh statistics:\n\t4 materials\n\t1 patches (0.00 MBytes)\n\t24 vertices (33.3% w/ normals, 33.3% w/ uv)\n",
        "\t18 triangles (100.0% local, 0.0% joiner)\n",
    ] {
        assert!(text.contains(line), "{line:?} is not in {text}");
    }
    assert_eq!(bench.says("-w house.obj", 0), "");
}

#[test]
fn errors_name_file_and_line() {
    let bench = Bench::new();
    let corners = "v 0 0 0\nv 4 0 0\nv 0 4 0\n";
    for (statement, text) in [
        ("v 1 x 2", "bad.obj: Wavefront syntax error near line 4: bad vertex"),
        ("v 1 2", "bad.obj: Wavefront syntax error near line 4: bad vertex"),
        ("vn 1", "bad.obj: Wavefront syntax error near line 4: bad normal"),
        ("vn 0 0 0", "bad.obj: Wavefront syntax error near line 4: zero normal"),
        ("f 1 2", "bad.obj: Wavefront syntax error near line 4: too few vertices"),
        ("f 1 \\\n2 9", "bad.obj: Wavefront syntax error near line 5: bad triangle"),
        ("f 1 2 3 -9", "bad.obj: Wavefront syntax error near line 4: bad face"),
        ("f 1/2 2 3", "bad.obj: Wavefront syntax error near line 4: bad triangle"),
        ("usemtl none\nf 1 2 3", "bad.obj: undefined modifier \"none\""),
        ("f 1 2 3\nusemtl tile\nf 1 2 3", "bad local triangle material"),
        ("f 1 2 2", "no polygons in mesh"),
    ] {
        bench.write("bad.obj", &format!("{corners}{statement}\n"));
        let said = bench.says("-a house.mat bad.obj", 1);
        assert_eq!(said.lines().last(), Some(&*format!("obj2mesh: fatal - {text}")), "{statement}");
    }
    assert_eq!(bench.says("none.obj", 1), "obj2mesh: fatal - cannot open \"none.obj\"\n");
    let unknown = "obj2mesh: fatal - unknown option: '-q'\nobj2mesh: --help lists the options\n";
    assert_eq!(bench.says("-q", 1), unknown);
    assert_eq!(bench.says("a b c", 1), "obj2mesh: fatal - too many file arguments\n");
    assert!(
        bench.says("-a none.mat hills.obj", 2).starts_with("obj2mesh: system - cannot open scene file \"none.mat\"")
    );
    assert!(bench.says("hills.obj none/out.rtm", 2).starts_with("obj2mesh: system - cannot open output file"));
}
