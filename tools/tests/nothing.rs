//! Octrees of nothing: without scene files, or of files without surfaces. Packages start with one and add scene files to it.
//! And surfaces that are nothing.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

const OCONV: &str = env!("CARGO_BIN_EXE_oconv");

fn made(folder: &Path, line: &[&str]) -> Vec<u8> {
    let done = Command::new(OCONV).arg("-w").args(line).current_dir(folder).output().expect("oconv runs");
    assert!(done.status.success(), "{line:?}: {}", String::from_utf8_lossy(&done.stderr));
    done.stdout
}

fn seen(folder: &Path, octree: &str) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_rtrace"));
    program.args(["-h", "-w", octree]).current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut running = program.spawn().expect("rtrace runs");
    running.stdin.take().expect("a pipe").write_all(b"9 0 0 -1 0 0\n").expect("rtrace reads");
    let done = running.wait_with_output().expect("rtrace ends");
    assert!(done.status.success(), "{octree}");
    String::from_utf8(done.stdout).expect("text").trim().to_owned()
}

#[test]
fn octrees_of_nothing_are_read_and_added_to() {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let folder = scratch.path();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).expect("a file is written");
    write("lamp.rad", b"void glow g 0 0 4 1 2 3 0\ng sphere s 0 0 4 0 0 0 5\n");
    write("paint.rad", b"void plastic p 0 0 5 1 1 1 0 0\n");
    let starts: [(&str, &[&str]); 3] = [("bare", &[]), ("frozen", &["-f"]), ("painted", &["paint.rad"])];
    for (name, line) in starts {
        write(name, &made(folder, line));
        assert_eq!(seen(folder, name), "0.000000e+00\t0.000000e+00\t0.000000e+00", "{name}");
        write("lit", &made(folder, &["-i", name, "lamp.rad"]));
        assert_eq!(seen(folder, "lit"), "1.000000e+00\t2.000000e+00\t3.000000e+00", "{name}");
        write("thawed", &made(folder, &["-f", "-i", name]));
        assert_eq!(seen(folder, "thawed"), "0.000000e+00\t0.000000e+00\t0.000000e+00", "{name}");
    }
    // One that ends in the midst is still refused.
    let whole = made(folder, &["-f", "lamp.rad"]);
    write("torn", &whole[..whole.len() - 20]);
    assert!(
        !Command::new(OCONV)
            .args(["-w", "-i", "torn"])
            .current_dir(folder)
            .output()
            .expect("oconv runs")
            .status
            .success()
    );
}

/// Packages take what is on standard error for an error: each is told once, by the program that leaves it out.
#[test]
fn of_surfaces_that_are_never_hit_oconv_alone_tells() {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let write = |name: &str, text: &str| std::fs::write(scratch.path().join(name), text).expect("a file is written");
    write(
        "odd.rad",
        "void light l 0 0 3 1 2 3\nl sphere lamp 0 0 4 0 0 7 .1\nvoid plastic g 0 0 5 .5 .5 .5 0 0\ng polygon line 0 0 9 0 0 0 1 0 0 2 0 0\ng sphere dot 0 0 4 0 0 0 0\n\
         g ring none 0 0 8 0 0 3 0 0 1 .5 .5\ng sphere inside 0 0 4 0 0 9 -1\n",
    );
    let done = Command::new(OCONV).arg("odd.rad").current_dir(scratch.path()).output().expect("oconv runs");
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    for text in ["zero area for polygon \"line\"", "zero radius for sphere \"dot\"", "illegal radii for ring \"none\""]
    {
        assert!(told.contains(text), "{told}");
    }
    std::fs::write(scratch.path().join("odd.oct"), done.stdout).expect("an octree is written");
    let mut program = Command::new(env!("CARGO_BIN_EXE_rtrace"));
    let ran = program.args(["-h", "odd.oct"]).current_dir(scratch.path()).stdin(Stdio::null()).output();
    let told = String::from_utf8(ran.expect("rtrace runs").stderr).expect("text");
    assert_eq!(told, "rtrace: warning - negative radius for sphere \"inside\"\n");
}
