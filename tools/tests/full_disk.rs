//! An ambient file that cannot grow: the answers come out all the same, a message tells, and the file stays whole.

use std::fs;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const ROOM: &str = "\
void plastic grey 0 0 5 .7 .7 .7 0 0
void glow lamp 0 0 4 5 5 5 0
lamp polygon light 0 0 12 1.5 1 2.4 1.5 2 2.4 2.5 2 2.4 2.5 1 2.4
grey polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0
grey polygon ceiling 0 0 12 0 0 2.5 0 3 2.5 4 3 2.5 4 0 2.5
grey polygon wall 0 0 12 0 0 0 0 3 0 0 3 2.5 0 0 2.5
";

fn bench() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.rad"), ROOM).unwrap();
    let octree = Command::new(env!("CARGO_BIN_EXE_oconv")).arg("s.rad").current_dir(folder.path()).output().unwrap();
    assert!(octree.status.success());
    fs::write(folder.path().join("s.oct"), octree.stdout).unwrap();
    folder
}

/// Runs rtrace from a shell, after `before`.
fn rtrace(folder: &TempDir, before: &str) -> Output {
    let options = "-h -I -u- -ab 2 -ad 64 -as 0 -aa .1 -ar 64 -af a.amb s.oct";
    let line = format!("{before} exec {} {options}", env!("CARGO_BIN_EXE_rtrace"));
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(folder.path()).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let ray = |i: i32| format!("{} {} 0 0 0 1\n", 0.2 + 0.06 * f64::from(i), 0.04 * f64::from(i));
    let rays = (0..60).map(ray).collect::<Vec<_>>().concat();
    let _ = std::io::Write::write_all(&mut stdin, rays.as_bytes());
    drop(stdin);
    child.wait_with_output().unwrap()
}

/// The number of records of the ambient file, which must be whole.
fn records(folder: &TempDir) -> usize {
    let bytes = fs::read(folder.path().join("a.amb")).unwrap();
    let start = bytes.windows(2).position(|w| w == b"\n\n").unwrap() + 4;
    assert_eq!((bytes.len() - start) % 67, 0, "an incomplete record");
    (bytes.len() - start) / 67
}

#[test]
fn a_file_that_cannot_grow_costs_a_message() {
    let folder = bench();
    let whole = rtrace(&folder, "");
    assert!(whole.status.success());
    let all = records(&folder);
    assert!(all > 200, "{all} records");
    fs::remove_file(folder.path().join("a.amb")).unwrap();
    // A limit of 4 or 8 KiB, by shell; the signal that goes with it is ignored, as on a disk that is full.
    let limited = rtrace(&folder, "trap '' XFSZ; ulimit -f 8;");
    let text = String::from_utf8_lossy(&limited.stderr).into_owned();
    assert_eq!(limited.status.code(), Some(2), "{text}");
    assert_eq!(limited.stdout, whole.stdout, "every answer is there");
    assert!(text.contains("records to ambient file \"a.amb\": File too large"), "{text}");
    let kept = records(&folder);
    assert!(kept > 40 && kept < all, "what fits is kept: {kept} of {all}");
    // With room again the file goes on from there.
    let after = rtrace(&folder, "");
    assert!(after.status.success() && after.stderr.is_empty(), "{}", String::from_utf8_lossy(&after.stderr));
    assert!(records(&folder) > 200);
}

#[test]
fn devices_and_folders_are_no_ambient_files() {
    let folder = bench();
    for name in ["/dev/full", "/dev/null", "."] {
        std::os::unix::fs::symlink(name, folder.path().join("a.amb")).unwrap();
        let answer = rtrace(&folder, "");
        let text = String::from_utf8_lossy(&answer.stderr).into_owned();
        assert_eq!(answer.status.code(), Some(1), "{name}: {text}");
        assert!(text.contains("bad/incompatible ambient file \"a.amb\": not a regular file"), "{name}: {text}");
        fs::remove_file(folder.path().join("a.amb")).unwrap();
    }
}
