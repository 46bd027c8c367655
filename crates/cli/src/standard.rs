//! Standard output that tells when nothing can be written. Rust's own opens `/dev/null` in the place of one that is
//! closed, before a program begins, and a run's results would go there without a word. And Rust's start ignores SIGPIPE, so
//! that nobody could tell any more whether the parent did.

use rustix::io::Errno;
use signal_hook::consts::SIGPIPE;
use std::fs::File;
use std::io::{self, Write};
use std::os::fd::AsFd;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// True if standard output was closed when the process began.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// The signals that were ignored then.
static IGNORED: AtomicU64 = AtomicU64::new(0);

/// Runs before Rust's start, and does nothing but ask the system.
#[ctor::ctor(unsafe)]
fn look() {
    let open = rustix::io::fcntl_getfd(rustix::stdio::stdout());
    CLOSED.store(open.is_err(), Ordering::Relaxed);
    IGNORED.store(ignored_mask().unwrap_or(0), Ordering::Relaxed);
}

/// The mask of ignored signals, where `/proc` tells. It asks the system alone: no memory is allocated yet.
fn ignored_mask() -> Option<u64> {
    use rustix::fs::{Mode, OFlags, open};
    let file = open("/proc/self/status", OFlags::RDONLY | OFlags::CLOEXEC, Mode::empty()).ok()?;
    // Groups are listed before it: there is room for a thousand with long numbers.
    let mut bytes = [0; 1 << 14];
    let mut length = 0;
    while length < bytes.len() {
        match rustix::io::read(&file, &mut bytes[length..]).ok()? {
            0 => break,
            n => length += n,
        }
    }
    mask_in(&bytes[..length])
}

/// The mask of ignored signals in the text of `/proc/self/status`.
fn mask_in(status: &[u8]) -> Option<u64> {
    let mut lines = status.split(|&b| b == b'\n');
    let mask = lines.find_map(|line| line.strip_prefix(b"SigIgn:"))?;
    u64::from_str_radix(std::str::from_utf8(mask).ok()?.trim(), 16).ok()
}

/// True if the parent had this signal ignored when the process began.
pub(crate) fn starts_ignoring(signal: i32) -> bool {
    IGNORED.load(Ordering::Relaxed) & (1 << (signal - 1)) != 0
}

/// True if a pipe that nobody reads ends programs, false if the parent had that signal ignored: then it is an error like
/// others.
pub fn broken_pipes_end() -> bool {
    !starts_ignoring(SIGPIPE)
}

/// Standard output, without a buffer.
#[derive(Debug)]
pub struct StandardOutput {
    file: io::Result<File>,
    /// A pipe that nobody reads ends the program.
    ends: bool,
}

impl StandardOutput {
    /// The process's own. That it is closed shows when something is written.
    pub fn new() -> Self {
        let closed = CLOSED.load(Ordering::Relaxed);
        let open = || io::stdout().as_fd().try_clone_to_owned().map(File::from);
        Self { file: if closed { Err(Errno::BADF.into()) } else { open() }, ends: false }
    }

    /// The same, but when it is a pipe that nobody reads any more, the program ends without a word, as by a signal that
    /// it does not handle; unless [`broken_pipes_end`] says otherwise.
    pub fn ending() -> Self {
        Self { ends: broken_pipes_end(), ..Self::new() }
    }
}

impl Default for StandardOutput {
    fn default() -> Self {
        Self::new()
    }
}

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = match &mut self.file {
            Ok(file) => file.write(bytes),
            Err(_) if bytes.is_empty() => Ok(0),
            Err(e) => Err(e.raw_os_error().map_or_else(|| e.kind().into(), io::Error::from_raw_os_error)),
        };
        if self.ends && written.as_ref().is_err_and(|e| e.kind() == io::ErrorKind::BrokenPipe) {
            // It comes back only if the system refuses.
            let _ = signal_hook::low_level::emulate_default_handler(SIGPIPE);
        }
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Prints a text that a program answers with instead of working. Who cannot read it misses nothing, and no error tells.
pub fn answer(text: &[u8]) {
    let _ = StandardOutput::ending().write_all(text);
}

#[cfg(test)]
mod tests {
    use super::mask_in;

    #[test]
    fn the_mask_is_found_behind_any_number_of_groups() {
        let groups = "100000 ".repeat(2000);
        let status = format!("Name:\tx\nGroups:\t{groups}\nSigBlk:\t0000000000000001\nSigIgn:\t0000000000001000\n");
        assert_eq!(mask_in(status.as_bytes()), Some(1 << 12));
        assert_eq!(mask_in(b"SigBlk:\t0000000000000001\n"), None);
    }
}
