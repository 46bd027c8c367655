//! How many threads the rendering programs use: what `-n` says, or `AMBIT_THREADS`, or the processors that there are.

use std::process::{Command, Output};

const PROGRAMS: [&str; 2] = [env!("CARGO_BIN_EXE_rtrace"), env!("CARGO_BIN_EXE_rpict")];

fn run(program: &str, threads: &str, line: &[&str]) -> Output {
    Command::new(program).env("AMBIT_THREADS", threads).args(line).output().expect("the program runs")
}

/// The threads that `-defaults` of rtrace tells.
fn told(threads: &str, line: &[&str]) -> String {
    let text = String::from_utf8(run(PROGRAMS[0], threads, line).stdout).expect("text");
    let told = text.lines().find_map(|l| l.strip_prefix("-n ")).expect("threads are told");
    told.split_whitespace().next().expect("a number").to_owned()
}

#[test]
fn the_environment_says_how_many_unless_the_command_line_does() {
    assert_eq!(told("3", &["-defaults"]), "3");
    assert_eq!(told("3", &["-n", "5", "-defaults"]), "5");
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get).to_string();
    assert_eq!(told("", &["-defaults"]), processors);
}

#[test]
fn what_is_no_number_of_threads_is_refused_where_it_is_asked_for() {
    for program in PROGRAMS {
        for threads in ["0", "-1", "two", "1.5"] {
            let answer = run(program, threads, &["missing.oct"]);
            let text = String::from_utf8_lossy(&answer.stderr).into_owned();
            assert_eq!(answer.status.code(), Some(1), "{program} {threads}: {text}");
            assert!(text.contains("bad AMBIT_THREADS"), "{text}");
            assert!(answer.stdout.is_empty());
            let answer = run(program, threads, &["-n", "5", "missing.oct"]);
            let text = String::from_utf8_lossy(&answer.stderr).into_owned();
            assert!(text.contains("missing.oct") && !text.contains("AMBIT_THREADS"), "{text}");
            assert!(run(program, threads, &["-version"]).status.success());
        }
        assert!(run(program, "1", &["-defaults"]).status.success());
    }
}

/// Batch systems limit the address space, of which a thread's stack takes much, though little memory.
#[test]
#[cfg(target_os = "linux")]
fn where_address_space_is_limited_there_are_fewer_threads_and_the_same_answer() {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    let scene = scratch.path().join("scene.rad");
    std::fs::write(&scene, "void glow g 0 0 4 1 2 3 0\ng sphere s 0 0 4 0 0 0 5\n").expect("a scene is written");
    let made = Command::new(env!("CARGO_BIN_EXE_oconv")).args(["-w", "-f"]).arg(&scene).output().expect("oconv runs");
    std::fs::write(&octree, made.stdout).expect("an octree is written");
    let limited = |limit: &str| {
        let line = "ulimit -v $1; echo 9 0 0 -1 0 0 | exec \"$2\" -h -n 16 \"$3\"";
        let mut shell = Command::new("sh");
        shell.args(["-c", line, "sh", limit, PROGRAMS[0]]).arg(&octree).output().expect("a shell runs")
    };
    for limit in ["unlimited", "3000000", "250000"] {
        let answer = limited(limit);
        let text = String::from_utf8_lossy(&answer.stderr).into_owned();
        assert!(answer.status.success(), "{limit}: {text}");
        assert_eq!(String::from_utf8_lossy(&answer.stdout).trim(), "1.000000e+00\t2.000000e+00\t3.000000e+00");
    }
    let answer = limited("50000");
    let text = String::from_utf8_lossy(&answer.stderr).into_owned();
    assert!(answer.status.code() == Some(2) && text.starts_with("rtrace: system - cannot start a thread"), "{text}");
}
