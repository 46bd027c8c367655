//! Commands in scene text: `!genbox …` lines whose standard output is scene text.

use crate::xform;
use ambit_file::SearchPath;
use std::ffi::OsStr;
use std::io;
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

    /// Runs a command in a folder; so many others have asked for it, one after the other.
    pub(crate) fn run_in(self, command: &[u8], folder: &Path, depth: usize) -> io::Result<CommandOutput> {
        match xform::expand(command, folder, depth, self) {
            Some(text) => Ok(CommandOutput { text, success: true }),
            None => shell(command, folder),
        }
    }
}

impl Runner for Commands<'_> {
    fn run(&mut self, command: &[u8]) -> io::Result<CommandOutput> {
        self.run_in(command, Path::new(""), 0)
    }
}

fn shell(command: &[u8], folder: &Path) -> io::Result<CommandOutput> {
    let mut shell = Command::new("/bin/sh");
    shell.arg0("sh").arg("-c").arg(OsStr::from_bytes(command));
    if folder != "" {
        shell.current_dir(folder);
    }
    let streams = shell.stdin(Stdio::inherit()).stderr(Stdio::inherit()).stdout(Stdio::piped());
    let output = streams.spawn()?.wait_with_output()?;
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
