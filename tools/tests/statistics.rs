//! `--stats`: what is said at the end, and that saying it changes nothing.

use std::fs;
use std::process::{Command, Output, Stdio};

const SCENE: &str = "\
void plastic grey 0 0 5 .7 .7 .7 0 0
void glow lamp 0 0 4 5 5 5 0
grey polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0
grey polygon wall 0 0 12 0 0 0 0 3 0 0 3 2.5 0 0 2.5
lamp polygon light 0 0 12 1.5 1 2.4 1.5 2 2.4 2.5 2 2.4 2.5 1 2.4
";
const LIGHT: &str = "-ab 2 -ad 64 -as 0 -aa .2 -ar 32 -af a.amb";
const VIEW: &str = "-vp 2 1.5 2 -vd 0 .1 -1 -vh 60 -vv 60 -x 16 -y 16";

fn run(folder: &tempfile::TempDir, program: &str, line: &str, input: &str) -> Output {
    let mut command = Command::new(program);
    command.args(line.split_whitespace()).current_dir(folder.path()).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let _ = std::io::Write::write_all(&mut stdin, input.as_bytes());
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

fn said(output: &Output) -> Vec<String> {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.lines().filter_map(|l| Some(l.split_once("statistics - ")?.1.to_owned())).collect()
}

/// The first number of a line.
fn first(line: &str) -> u64 {
    line.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn a_run_says_what_it_took() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.rad"), SCENE).unwrap();
    let octree = run(&folder, env!("CARGO_BIN_EXE_oconv"), "s.rad", "");
    fs::write(folder.path().join("s.oct"), octree.stdout).unwrap();
    let rays = (0..2000).map(|i| format!("{} 1.2 0 0 0 1\n", 0.002 * f64::from(i))).collect::<Vec<_>>().concat();
    let rtrace =
        |more: &str| run(&folder, env!("CARGO_BIN_EXE_rtrace"), &format!("-h -I -u- {LIGHT} {more} s.oct"), &rays);
    let forget = || fs::remove_file(folder.path().join("a.amb")).unwrap();
    let quiet = rtrace("");
    assert!(quiet.stderr.is_empty());
    forget();
    let one = rtrace("--stats -n 1");
    assert_eq!(one.stdout, quiet.stdout);
    let lines = said(&one);
    assert_eq!(lines.len(), 5, "{lines:?}");
    assert!(first(&lines[0]) > 10 && lines[0].ends_with(", 0 from the ambient file"), "{lines:?}");
    assert!(first(&lines[1]) > 500 && lines[1].contains("% answered by records"), "{lines:?}");
    assert!(first(&lines[2]) > 64 * 10 && lines[2].contains("hemisphere samples"), "{lines:?}");
    assert!(lines[3].contains("interpolation error by level "), "{lines:?}");
    let times = lines[4].split_once("by model ").unwrap().1;
    let numbers: Vec<f64> = times.split([' ', '(', ',']).filter_map(|w| w.parse().ok()).collect();
    // Seconds on 1, 2, 8, 64 cores, and what a step costs.
    assert_eq!((numbers.len(), numbers[2], numbers[4], numbers[6]), (8, 2.0, 8.0, 64.0), "{times}");
    assert!(numbers[0] > 0.0 && numbers[1] > 0.0, "{times}");
    // A second run makes none: all come from the file.
    let again = said(&rtrace("--stats -n 2"));
    let (made, loaded) = again[0].split_once(" made, ").unwrap();
    assert_eq!(made, "0 records");
    assert_eq!(first(loaded), first(&lines[0]));
    forget();
    let picture = |more: &str| run(&folder, env!("CARGO_BIN_EXE_rpict"), &format!("{LIGHT} {VIEW} {more} s.oct"), "");
    assert_eq!(said(&picture("")).len(), 0);
    assert_eq!(said(&picture("--stats")).len(), 5);
    forget();
    // Reports do not time every task: that would cost a tenth of the run.
    let reported = picture("-t 1000");
    let lines = said(&reported);
    assert_eq!(lines.len(), 4);
    assert!(
        first(&lines[0]) > 10 && first(&lines[2]) > 64 * 10 && lines[3].contains("interpolation error by level "),
        "{lines:?}"
    );
    // The last line says that the picture is done, as scripts expect.
    let text = String::from_utf8(reported.stderr).unwrap();
    assert!(text.lines().last().unwrap().contains(" rays, 100.00% after "), "{text}");
    assert_eq!(said(&picture("-t 1000 -ab 0")).len(), 0);
}
