//! Messages on standard error, and the error file that takes its place.

use crate::failure::Failure;
use ambit_base::Notify;
use ambit_file::{bytes_of, path_of};
use std::fs::OpenOptions;
use std::io::{self, Write};

/// Prints a line on standard error, names as the bytes they are; a closed standard error is no reason to stop.
pub fn say(line: impl std::fmt::Display) {
    let _ = io::stderr().write_all(&bytes_of(&format!("{line}\n")));
}

/// Prints `PROGRAM: CLASS - TEXT` on standard error.
#[derive(Clone, Debug)]
pub struct ConsoleMessages {
    /// Base name of the running program.
    pub program: String,
    /// False drops warnings (`-w-`).
    pub warnings: bool,
}

impl ConsoleMessages {
    /// Prints one message.
    pub fn print(&self, text: impl std::fmt::Display) {
        say(format_args!("{}: {text}", self.program));
    }

    /// Prints why the program stops, and what may help.
    pub fn fail(&self, failure: &Failure) {
        // Several lines show where in one of them the reason is: without a class word, as in Radiance, so that the mark
        // stands below the place.
        if failure.text.contains('\n') {
            failure.text.lines().for_each(|line| self.print(line));
        } else {
            self.print(failure);
        }
        if let Some(hint) = &failure.hint {
            self.print(hint);
        }
    }
}

impl Notify for ConsoleMessages {
    fn warn(&self, text: &str) {
        if self.warnings {
            self.print(format_args!("warning - {text}"));
        }
    }
}

/// Makes standard error append to a file (`-e`) and records there which run this is: `command` is the whole command
/// line.
///
/// # Errors
/// If the file can not be opened or written.
pub fn attach_error_file(file: &str, command: &[u8]) -> io::Result<()> {
    let mut log = OpenOptions::new().append(true).create(true).open(path_of(file))?;
    let head = format!("**************\n*** PID {:5}: ", std::process::id());
    log.write_all(&[head.as_bytes(), command, b"\n\n"].concat())?;
    Ok(rustix::stdio::dup2_stderr(&log)?)
}
