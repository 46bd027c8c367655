//! Finding and running the programs under test.
//!
//! The folder is the one that `AMBIT_TOOLS_DIR` names (any programs of these names will do, real Radiance's included;
//! `RAYPATH` is then handed on), or else the build folder of the running test, where the programs are built first.

use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// The workspace's root folder.
///
/// # Panics
/// Never: the package lies in the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests are a folder of the workspace")
}

/// True if the programs under test are not this workspace's own.
pub fn foreign() -> bool {
    std::env::var_os("AMBIT_TOOLS_DIR").is_some()
}

/// The folder of the programs under test; builds them on first use if they are our own.
///
/// # Panics
/// If the programs cannot be built.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| match std::env::var_os("AMBIT_TOOLS_DIR") {
        Some(dir) => PathBuf::from(dir),
        None => build(),
    })
}

/// Builds the programs in the profile of the running test (which lies in `<profile>/deps/`).
fn build() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    let profile = test.ancestors().nth(2).expect("a test lies two folders below its profile's").to_path_buf();
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root()).args(["build", "--quiet", "--locked", "-p", "ambit-tools", "--bins"]);
    cargo.arg("--target-dir").arg(profile.parent().expect("a profile lies in the target folder"));
    if !profile.ends_with("debug") {
        cargo.arg("--profile").arg(profile.file_name().expect("a profile's folder has its name"));
    }
    let status = cargo.status().expect("cargo can be started");
    assert!(status.success(), "building the programs failed");
    profile
}

/// One run of a program, to be filled in and started.
#[derive(Debug)]
pub struct Program {
    command: Command,
    name: &'static str,
    onto: Option<std::fs::File>,
}

/// What a program printed and how it ended.
#[derive(Debug)]
pub struct Answer {
    /// Exit status; `None` if a signal ended the program.
    pub status: Option<i32>,
    /// Bytes of standard output.
    pub out: Vec<u8>,
    /// Text of standard error.
    pub err: String,
}

impl Program {
    /// The program of this name, without arguments, in the current folder.
    pub fn new(name: &'static str) -> Self {
        let mut command = Command::new(folder().join(name));
        if !foreign() {
            command.env_remove("RAYPATH");
        }
        Self { command, name, onto: None }
    }

    /// Adds the arguments of a command line, given as one text and split at blanks.
    pub fn line(mut self, line: &str) -> Self {
        self.command.args(line.split_whitespace());
        self
    }

    /// Adds one argument as it is.
    pub fn arg(mut self, arg: impl AsRef<OsStr>) -> Self {
        self.command.arg(arg);
        self
    }

    /// Sets the working folder.
    pub fn within(mut self, folder: &Path) -> Self {
        self.command.current_dir(folder);
        self
    }

    /// Sends standard output to this file instead of keeping it.
    pub fn onto(mut self, file: std::fs::File) -> Self {
        self.onto = Some(file);
        self
    }

    /// Runs the program with nothing on standard input.
    pub fn run(self) -> Answer {
        self.feed(b"")
    }

    /// Runs the program with `input` on standard input.
    ///
    /// # Panics
    /// If the program cannot be started.
    pub fn feed(mut self, input: &[u8]) -> Answer {
        self.command.stdin(Stdio::piped()).stderr(Stdio::piped());
        self.command.stdout(self.onto.map_or_else(Stdio::piped, Stdio::from));
        let mut child = self.command.spawn().unwrap_or_else(|e| panic!("{} cannot be started: {e}", self.name));
        let mut pipe = child.stdin.take().expect("standard input was asked for");
        let input = input.to_vec();
        // A writer of its own: a program that answers before it has read everything must not block both sides.
        // A program that ends early closes the pipe, which is its right: the error is of no interest.
        let writer = std::thread::spawn(move || drop(pipe.write_all(&input)));
        let output = child.wait_with_output().expect("a started program can be waited for");
        writer.join().expect("the writer does not panic");
        Answer::from(output)
    }
}

impl From<Output> for Answer {
    fn from(output: Output) -> Self {
        let err = String::from_utf8_lossy(&output.stderr).into_owned();
        Self { status: output.status.code(), out: output.stdout, err }
    }
}

impl Answer {
    /// Standard output as text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.out).into_owned()
    }

    /// This answer, after making sure that the program ended well.
    ///
    /// # Panics
    /// If the exit status is not 0.
    pub fn well(self, what: &str) -> Self {
        assert_eq!(self.status, Some(0), "{what}: {}", self.err);
        self
    }
}
