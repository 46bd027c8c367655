//! Commands in scene text: `!genbox …` lines whose standard output is scene text.

use crate::xform::{self, Expansion};
use ambit_file::SearchPath;
use std::ffi::OsStr;
use std::io::{self, Write};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};

/// What a command left behind.
#[derive(Clone, Debug, Default)]
pub struct CommandOutput {
    /// Everything it wrote to standard output.
    pub text: Vec<u8>,
    /// True if it ended with status 0.
    pub success: bool,
}

/// Runs the commands of scene text; tools use [`Commands`], tests their own.
pub trait Runner {
    /// Runs a command (without its `!`).
    ///
    /// # Errors
    /// If it cannot be started at all.
    fn run(&mut self, command: &[u8]) -> io::Result<CommandOutput>;
}

/// Hands commands to `/bin/sh -c` in the present working directory; they inherit standard input and standard error. What
/// `xform` would do is done without it where that is plain.
#[derive(Clone, Copy, Debug)]
pub struct Commands<'a> {
    /// Where `xform` finds its files.
    pub(crate) search: &'a SearchPath,
}

impl<'a> Commands<'a> {
    /// Commands whose files are found along this path.
    pub fn new(search: &'a SearchPath) -> Self {
        Self { search }
    }

    /// Runs a command that so many others have asked for, one after the other; names of files are relative to `folder`.
    /// `None` if it was given up half-way, which those that asked for it have to tell.
    pub(crate) fn run_in(self, command: &[u8], folder: &Path, depth: usize) -> io::Result<Option<CommandOutput>> {
        match xform::expand(command, folder, depth, self)? {
            Expansion::Done(output) => Ok(Some(output)),
            Expansion::GivenUp if depth > 0 => Ok(None),
            Expansion::GivenUp | Expansion::Untouched => shell(command, folder, None).map(Some),
        }
    }
}

impl Runner for Commands<'_> {
    fn run(&mut self, command: &[u8]) -> io::Result<CommandOutput> {
        Ok(self.run_in(command, Path::new(""), 0)?.unwrap_or_default())
    }
}

/// Has a shell run a command in a folder; it reads `input`, or what this program reads.
pub(crate) fn shell(command: &[u8], folder: &Path, input: Option<&[u8]>) -> io::Result<CommandOutput> {
    let mut shell = Command::new("/bin/sh");
    shell.arg0("sh").arg("-c").arg(OsStr::from_bytes(command));
    if folder != "" {
        shell.current_dir(folder);
    }
    let stdin = if input.is_some() { Stdio::piped() } else { Stdio::inherit() };
    let mut child = shell.stdin(stdin).stderr(Stdio::inherit()).stdout(Stdio::piped()).spawn()?;
    let pipe = child.stdin.take();
    let output = std::thread::scope(|scope| {
        if let (Some(mut pipe), Some(input)) = (pipe, input) {
            // It need not read all.
            scope.spawn(move || drop(pipe.write_all(input)));
        }
        child.wait_with_output()
    })?;
    Ok(CommandOutput { text: output.stdout, success: output.status.success() })
}

/// Refuses every command; for text that must not run any.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCommands;

impl Runner for NoCommands {
    fn run(&mut self, _: &[u8]) -> io::Result<CommandOutput> {
        Err(io::Error::new(io::ErrorKind::PermissionDenied, "commands are not allowed here"))
    }
}
