//! Signals while rtrace waits for input: what it has read is answered, as by Radiance 6.0a, whose last records are written
//! when it ends.

use std::io::Write;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Less than a program may take to close its files.
const SOON: Duration = Duration::from_secs(8);

fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.rad"), "void glow M 0 0 4 1 2 3 0\nM sphere f 0 0 4 0 0 0 1\n").unwrap();
    let octree = Command::new(env!("CARGO_BIN_EXE_oconv")).arg("s.rad").current_dir(folder.path()).output().unwrap();
    std::fs::write(folder.path().join("s.oct"), octree.stdout).unwrap();
    folder
}

#[test]
fn rays_that_were_read_are_answered_before_the_end() {
    let folder = scene();
    for (line, count) in [("-h", 5), ("-h", 300), ("-h -otv", 300), ("-h -x 7", 300), ("-h -ab 1 -af a.amb", 300)] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtrace"));
        command.args(line.split_whitespace()).args(["-w", "s.oct"]).current_dir(folder.path());
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut input = child.stdin.take().unwrap();
        input.write_all(&b"0 0 5 0 0 -1\n".repeat(count)).unwrap();
        std::thread::sleep(Duration::from_millis(700));
        let start = Instant::now();
        assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
        // Its input stays open.
        let output = child.wait_with_output().unwrap();
        drop(input);
        assert!(start.elapsed() < SOON, "{line}: {:?}", start.elapsed());
        assert_eq!(output.status.code(), Some(3), "{line}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "rtrace: signal - Terminate\n", "{line}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.lines().count(), count, "{line}");
        assert!(text.lines().all(|l| l == "1.000000e+00\t2.000000e+00\t3.000000e+00\t"), "{line}");
    }
}
