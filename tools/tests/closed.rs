//! Standard output that is closed, full, or a pipe that nobody reads: messages and exit statuses are those of Radiance 6.0a.

use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const SCENE: &str = "void glow M 0 0 4 1 2 3 0\nM sphere f 0 0 4 0 0 0 1\n";

/// Status (128 and more for signals) and standard error of a shell's line, in which words with `$` stand for programs.
fn shell(folder: &TempDir, line: &str) -> (i32, String) {
    let mut command = Command::new("/bin/sh");
    command.args(["-c", line]).current_dir(folder.path()).stdin(Stdio::null()).stdout(Stdio::piped());
    for (name, program) in [
        ("oconv", env!("CARGO_BIN_EXE_oconv")),
        ("rpict", env!("CARGO_BIN_EXE_rpict")),
        ("rtrace", env!("CARGO_BIN_EXE_rtrace")),
        ("lookamb", env!("CARGO_BIN_EXE_lookamb")),
        ("ambrec", env!("CARGO_BIN_EXE_ambrec")),
        ("obj2mesh", env!("CARGO_BIN_EXE_obj2mesh")),
        ("topng", env!("CARGO_BIN_EXE_topng")),
        ("raderr", env!("CARGO_BIN_EXE_raderr")),
    ] {
        command.env(name, program);
    }
    let output = command.output().unwrap();
    let status = output.status.code().unwrap_or_else(|| 128 + output.status.signal().unwrap());
    (status, String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A scene, an ambient file of one record and a triangle.
fn bench() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.rad"), SCENE).unwrap();
    std::fs::write(folder.path().join("t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert_eq!(shell(&folder, "$oconv s.rad > s.oct").0, 0);
    let ray = "echo 3 0 0 -1 0 0 | $rtrace -w -h -I -ab 1 -ad 16 -aa .1 -af a.amb s.oct > /dev/null";
    assert_eq!(shell(&folder, ray), (0, String::new()));
    folder
}

#[test]
fn results_that_cannot_be_written_are_errors_and_answers_are_not() {
    let folder = bench();
    for (target, why) in [(">&-", "Bad file descriptor"), (">/dev/full", "No space left on device")] {
        for (line, words) in [
            ("echo 0 0 5 0 0 -1 | $rtrace -w -h s.oct", "rtrace: system - write error: "),
            ("yes '0 0 5 0 0 -1' | $rtrace -w -h -faf s.oct", "rtrace: system - write error: "),
            ("$rtrace -w s.oct", "rtrace: system - write error: "),
            ("$oconv s.rad", "oconv: system - output error in writeoct: "),
            ("$oconv -f s.rad", "oconv: system - output error in writeoct: "),
            ("$rpict -w -x 8 -y 8 s.oct", "rpict: system - error writing picture header: "),
        ] {
            let (status, text) = shell(&folder, &format!("{line} {target}"));
            assert_eq!(status, 2, "{line} {target}: {text}");
            assert!(text.contains(&format!("{words}{why}")), "{line} {target}: {text}");
        }
        for (line, status, words) in [
            ("$lookamb a.amb", 1, "lookamb: cannot write output: "),
            ("$lookamb -h -d a.amb | $lookamb -r -h -d", 1, "lookamb: cannot write output: "),
            ("$ambrec stats a.amb", 2, "ambrec: cannot write output: "),
            ("$ambrec export a.amb", 2, "ambrec: cannot write output: "),
            ("$obj2mesh t.obj", 2, "obj2mesh: system - output error in writescene: "),
        ] {
            assert_eq!(
                shell(&folder, &format!("{line} {target}")),
                (status, format!("{words}{why}\n")),
                "{line} {target}"
            );
        }
        // Nothing to write, or nothing that matters.
        for line in [
            "$rtrace -w -h s.oct",
            "$rtrace -defaults",
            "$rpict -version",
            "$rtrace -features",
            "$oconv --help",
            "$lookamb --help",
            "$lookamb --version",
            "$topng --help",
            "$raderr --help",
            "$raderr --man",
            "$ambrec --version",
            "$ambrec man",
            "$obj2mesh --help",
        ] {
            assert_eq!(shell(&folder, &format!("{line} {target}")), (0, String::new()), "{line} {target}");
        }
    }
}

#[test]
fn pipes_that_nobody_reads_end_programs() {
    let folder = bench();
    for (line, status, words) in [
        ("yes '0 0 5 0 0 -1' | $rtrace -w -h s.oct", 3, "rtrace: signal - Broken pipe\n"),
        ("$rpict -w -x 8 -y 8 s.oct", 3, "rpict: signal - Broken pipe\n"),
        (
            "trap '' PIPE; yes '0 0 5 0 0 -1' 2> /dev/null | $rtrace -w -h s.oct",
            2,
            "rtrace: system - write error: Broken pipe\n",
        ),
        ("trap '' PIPE; $rpict -w -x 8 -y 8 s.oct", 2, "rpict: system - error writing picture header: Broken pipe\n"),
        ("trap '' PIPE; $oconv -f s.rad", 2, "oconv: system - output error in writeoct: Broken pipe\n"),
        ("$oconv -f s.rad", 141, ""),
        ("$rtrace -defaults", 141, ""),
        ("$rpict -version", 141, ""),
        ("$lookamb a.amb", 141, ""),
        ("$lookamb --help", 141, ""),
        ("$ambrec stats a.amb", 141, ""),
        ("$ambrec man", 141, ""),
        ("$obj2mesh t.obj", 141, ""),
        ("$topng --help", 141, ""),
        ("$raderr --man", 141, ""),
    ] {
        // `true` has ended by then.
        let (_, text) = shell(&folder, &format!("(sleep .2; {line}; echo $? > status) | true; sleep .4"));
        let ended = std::fs::read_to_string(folder.path().join("status")).unwrap();
        assert_eq!(ended.trim(), status.to_string(), "{line}: {text}");
        assert!(text.starts_with(words) && words.is_empty() == text.is_empty(), "{line}: {text}");
    }
}
