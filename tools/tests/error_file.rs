//! Which messages go to the error file (`-e`): those about single options and the view come before it is opened, those
//! about what does not go together after it. Scripts look there for what went wrong.

use std::path::Path;
use std::process::{Command, Stdio};

/// What a program that fails prints on standard error and in its error file; no text where there is no such file.
fn told(folder: &Path, program: &str, line: &str) -> (String, String) {
    let log = folder.join("log");
    let _ = std::fs::remove_file(&log);
    let mut command = Command::new(program);
    command.args(["-e", "log"]).args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    let done = command.output().expect("it runs");
    assert_eq!(done.status.code(), Some(1), "{line}");
    let text = std::fs::read_to_string(&log).unwrap_or_default();
    let told = text.split_once("\n\n").map_or(String::new(), |(_, rest)| rest.to_owned());
    (String::from_utf8(done.stderr).expect("text"), told)
}

#[test]
fn what_does_not_go_together_is_told_in_the_error_file() {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let (rtrace, rpict) = (env!("CARGO_BIN_EXE_rtrace"), env!("CARGO_BIN_EXE_rpict"));
    for (program, line, message) in [
        (rtrace, "a.oct b.oct", "rtrace: fatal - command line error at 'a.oct'\n"),
        (rpict, "a.oct -ab 1", "rpict: fatal - command line error at 'a.oct'\n"),
        (rtrace, "-I -os a.oct", "rtrace: fatal - -I+ and -i+ options require some value output\n"),
        (rtrace, "-o a.oct", "rtrace: fatal - empty output specification\n"),
        (rtrace, "-fac -os a.oct", "rtrace: fatal - color format only with -ov, -or, -ox\n"),
        (rpict, "-P file a.oct", "rpict: fatal - persist option only for sequences\n"),
        (rpict, "-S 1", "rpict: fatal - missing octree argument\n"),
        (rpict, "-S 2 -r 1 -o x a.oct", "rpict: fatal - recover frame less than start frame\n"),
    ] {
        let (outside, inside) = told(scratch.path(), program, line);
        assert_eq!(outside, "", "{line}");
        assert!(inside.starts_with(message), "{line}: {inside}");
    }
    for (program, line, message) in [
        (rtrace, "-foo a.oct", "rtrace: fatal - command line error at '-foo'\n"),
        (rtrace, "-n 0 a.oct", "rtrace: fatal - bad number of processes\n"),
        (rpict, "-vh 0 a.oct", "rpict: fatal - illegal horizontal view size\n"),
        (rpict, "-cs 9 -cw 500 600 a.oct", "rpict: fatal - unsupported spectral sampling\n"),
    ] {
        let (outside, inside) = told(scratch.path(), program, line);
        assert!(outside.starts_with(message), "{line}: {outside}");
        assert_eq!(inside, "", "{line}");
        assert!(!scratch.path().join("log").exists(), "{line}: the file is opened afterwards");
    }
}
