//! Appending to an ambient file while others do the same.

use super::error::FileError;
use super::scan::records;
use crate::codec::{Layout, RECORD_BYTES};
use crate::record::Record;
use ambit_base::Notify;
use ambit_file::{FileLock, LockError, LockMode};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Records that wait before they are written: what fits the C library's buffer of 8192 bytes, as in Radiance.
const BUFFERED: usize = 8192 / RECORD_BYTES;

/// An ambient file open for appending. Nothing is written when this is dropped: call [`AmbientFile::sync`] before.
#[derive(Debug)]
pub struct AmbientFile {
    pub(super) file: File,
    pub(super) name: String,
    pub(super) layout: Layout,
    /// Where the first record begins.
    pub(super) start: u64,
    /// The end of what has been read or written here.
    pub(super) end: u64,
    /// False on file systems without locks, where this process created the file and writes alone.
    pub(super) locks: bool,
    pub(super) waiting: Vec<Record>,
}

impl AmbientFile {
    /// Adds records; they are written once there are 122. Returns what others have appended meanwhile.
    pub fn append(&mut self, records: &[Record], notify: &dyn Notify) -> Result<Vec<Record>, FileError> {
        self.waiting.extend_from_slice(records);
        if self.waiting.len() < BUFFERED { Ok(Vec::new()) } else { self.sync(notify) }
    }

    /// Writes what waits and returns what others have appended.
    ///
    /// After an error the records still wait: a later call may succeed.
    pub fn sync(&mut self, notify: &dyn Notify) -> Result<Vec<Record>, FileError> {
        let mode = if self.waiting.is_empty() { LockMode::Shared } else { LockMode::Exclusive };
        let lock = if self.locks { lock(&self.file, mode, &self.name, notify)? } else { None };
        let length = self.file.metadata().map_err(io_error("read", &self.name))?.len();
        if length < self.start {
            return Err(FileError::Truncated { file: self.name.clone() });
        }
        if length < self.end {
            notify.warn(&format!("ambient file \"{}\" was shortened by another program", self.name));
            self.end = length - (length - self.start) % RECORD_BYTES as u64;
        }
        let bytes = read_from(&self.file, self.end).map_err(io_error("read", &self.name))?;
        let (foreign, damaged, torn) = records(&bytes, self.layout);
        if damaged > 0 {
            notify.warn(&skipped(damaged, &self.name));
        }
        let end = self.end + (bytes.len() - torn) as u64;
        if !self.waiting.is_empty() {
            if torn > 0 {
                // Nobody is writing now: whoever wrote this was stopped.
                notify.warn(&cut(torn, &self.name));
            }
            let written = self.write(end, torn > 0);
            if let Err(source) = written {
                // What is whole stays, what is not goes; the records wait for another try.
                let _ = self.file.set_len(end);
                let (file, records) = (self.name.clone(), self.waiting.len());
                return Err(FileError::Write { file, records, source });
            }
        }
        self.end = end + (self.waiting.len() * RECORD_BYTES) as u64;
        self.waiting.clear();
        if let Some(lock) = lock {
            lock.release().map_err(|e| lock_failed(e, &self.name))?;
        }
        Ok(foreign)
    }

    /// Writes what waits at `end`, after cutting off what follows.
    pub(super) fn write(&self, end: u64, truncate: bool) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(self.waiting.len() * RECORD_BYTES);
        for record in &self.waiting {
            bytes.extend(self.layout.encode(record));
        }
        if truncate {
            self.file.set_len(end)?;
        }
        let mut file = &self.file;
        file.seek(SeekFrom::Start(end))?;
        file.write_all(&bytes)
    }
}

/// A lock, or a warning where the file system has none.
pub(super) fn lock<'f>(
    file: &'f File,
    mode: LockMode,
    name: &str,
    notify: &dyn Notify,
) -> Result<Option<FileLock<'f>>, FileError> {
    match FileLock::acquire(file, mode) {
        Ok(lock) => Ok(Some(lock)),
        Err(e @ (LockError::Unsupported(_) | LockError::Unavailable(_))) => {
            notify.warn(&format!("ambient file \"{name}\" is not shared: {e}"));
            Ok(None)
        }
        Err(e) => Err(lock_failed(e, name)),
    }
}

pub(super) fn lock_failed(error: LockError, name: &str) -> FileError {
    let source = match error {
        LockError::Unsupported(e) | LockError::Unavailable(e) | LockError::Deadlock(e) | LockError::Other(e) => e,
    };
    FileError::Io { action: "lock", file: name.to_owned(), source }
}

pub(super) fn io_error(action: &'static str, name: &str) -> impl FnOnce(io::Error) -> FileError {
    move |source| FileError::Io { action, file: name.to_owned(), source }
}

/// The bytes from `offset` to the end, through the one descriptor: closing another would drop the lock.
pub(super) fn read_from(mut file: &File, offset: u64) -> io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(offset))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

pub(super) fn skipped(damaged: usize, name: &str) -> String {
    format!("ignoring {damaged} values in ambient file \"{name}\" (corrupted)")
}

pub(super) fn cut(torn: usize, name: &str) -> String {
    format!("ignoring the last {torn} bytes of ambient file \"{name}\" (an incomplete value)")
}
