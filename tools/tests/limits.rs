//! Rays that end with the view (`-ld`): records serve all who look at a surface, and so do not end there.

use std::process::{Command, Stdio};

/// A translucent sheet above a bright ground that is farther than rays with `-ld` reach here.
const SCENE: &str = "\
void trans sheet 0 0 7 .8 .8 .8 0 0 .7 0
void glow bright 0 0 4 1 1 1 0
sheet polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0
bright polygon g 0 0 12 -90 -90 -5 90 -90 -5 90 90 -5 -90 90 -5
";

fn run(folder: &std::path::Path, program: &str, line: &str, input: &str) -> Vec<u8> {
    let mut command = Command::new(program);
    command.args(line.split_whitespace()).current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().expect("it runs");
    std::io::Write::write_all(&mut child.stdin.take().expect("a pipe"), input.as_bytes()).expect("it reads");
    child.wait_with_output().expect("it ends").stdout
}

#[test]
fn records_behind_sheets_do_not_end_with_the_ray() {
    let folder = tempfile::tempdir().expect("a scratch folder can be made");
    std::fs::write(folder.path().join("s.rad"), SCENE).expect("it can be written");
    let octree = run(folder.path(), env!("CARGO_BIN_EXE_oconv"), "s.rad", "");
    std::fs::write(folder.path().join("s.oct"), octree).expect("it can be written");
    let value = |options: &str| -> f64 {
        let line = format!("-h -w -ab 1 -ad 4096 {options} s.oct");
        let text = String::from_utf8(run(folder.path(), env!("CARGO_BIN_EXE_rtrace"), &line, "0 0 .5 0 0 -.6\n"));
        text.expect("text").split_whitespace().next().expect("a number").parse().expect("a number")
    };
    // What comes through: the sheet's colour times what it lets pass, of a ground that fills all but the edge of view.
    let through = 0.8 * 0.7;
    for options in ["-aa .1", "-aa .1 -ld", "-aa 0"] {
        let got = value(options);
        assert!((got / through - 1.0).abs() < 0.01, "{options}: {got}");
    }
    assert_eq!(value("-aa 0 -ld"), 0.0);
}
