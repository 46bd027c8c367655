//! Commands in scene text: `!genbox …` lines whose standard output is scene text.

use std::io;

/// What a command left behind.
#[derive(Clone, Debug, Default)]
pub struct CommandOutput {
    /// Everything it wrote to standard output.
    pub text: Vec<u8>,
    /// True if it ended with status 0.
    pub success: bool,
}

/// Runs the commands of scene text; tools use [`Shell`], tests their own.
pub trait Runner {
    /// Runs a command (without its `!`).
    ///
    /// # Errors
    /// If it cannot be started at all.
    fn run(&mut self, command: &[u8]) -> io::Result<CommandOutput>;
}

/// Hands commands to `/bin/sh -c` in the present working directory; they inherit standard input and standard error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shell;

impl Runner for Shell {
    fn run(&mut self, command: &[u8]) -> io::Result<CommandOutput> {
        use std::os::unix::ffi::OsStrExt;
        use std::os::unix::process::CommandExt;
        use std::process::{Command, Stdio};
        let output = Command::new("/bin/sh")
            .arg0("sh")
            .arg("-c")
            .arg(std::ffi::OsStr::from_bytes(command))
            .stdin(Stdio::inherit())
            .stderr(Stdio::inherit())
            .stdout(Stdio::piped())
            .spawn()?
            .wait_with_output()?;
        Ok(CommandOutput { text: output.stdout, success: output.status.success() })
    }
}

/// Refuses every command; for text that must not run any.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCommands;

impl Runner for NoCommands {
    fn run(&mut self, _: &[u8]) -> io::Result<CommandOutput> {
        Err(io::Error::new(io::ErrorKind::PermissionDenied, "commands are not allowed here"))
    }
}
