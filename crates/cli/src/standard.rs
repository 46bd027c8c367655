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
    mask_in(|block| rustix::io::read(&file, block).ok())
}

/// The mask of ignored signals in the text of `/proc/self/status`, which `read` gives piece by piece. Groups, of which
/// there may be thousands, are listed before it on one line: of every line only the beginning is kept.
fn mask_in(mut read: impl FnMut(&mut [u8]) -> Option<usize>) -> Option<u64> {
    let (mut block, mut line, mut length) = ([0; 4096], [0; 64], 0);
    loop {
        let count = read(&mut block).filter(|&count| count > 0)?;
        for &byte in &block[..count] {
            if byte != b'\n' {
                if let Some(place) = line.get_mut(length) {
                    *place = byte;
                    length += 1;
                }
                continue;
            }
            if let Some(mask) = line[..length].strip_prefix(b"SigIgn:") {
                return u64::from_str_radix(std::str::from_utf8(mask).ok()?.trim(), 16).ok();
            }
            length = 0;
        }
    }
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

    /// What is found in a text that comes in pieces of such a length.
    fn found(text: &str, piece: usize) -> Option<u64> {
        let mut left = text.as_bytes();
        mask_in(|block| {
            let count = piece.min(left.len()).min(block.len());
            block[..count].copy_from_slice(&left[..count]);
            left = &left[count..];
            Some(count)
        })
    }

    #[test]
    fn the_mask_is_found_behind_any_number_of_groups() {
        for groups in [0, 1, 10_000] {
            let groups = "4294967295 ".repeat(groups);
            let status = format!("Name:\tx\nGroups:\t{groups}\nSigBlk:\t0000000000000001\nSigIgn:\t0000000000001000\n");
            assert_eq!(found(&status, 4096), Some(1 << 12));
            assert_eq!(found(&status, 7), Some(1 << 12));
        }
        assert_eq!(found("SigBlk:\t0000000000000001\n", 4096), None);
    }
}
