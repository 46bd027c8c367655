//! Appending to an ambient file while others do the same.

use super::error::FileError;
use super::scan::records;
use super::segment;
use crate::codec::Layout;
use crate::components::Components;
use crate::record::Record;
use ambit_base::Notify;
use ambit_file::{FileLock, LockError, LockMode, name_of};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Bytes of records that wait before they are written: the C library's buffer, as in Radiance.
const BUFFERED: usize = 8192;

/// An ambient file open for appending. Nothing is written when this is dropped: call [`AmbientFile::sync`] before.
#[derive(Debug)]
pub struct AmbientFile {
    pub(super) file: Arc<File>,
    pub(super) name: String,
    pub(super) layout: Layout,
    pub(super) components: Components,
    /// Where the first record begins.
    pub(super) start: u64,
    /// The end of what has been read or written here.
    pub(super) end: u64,
    pub(super) locks: Locks,
    pub(super) waiting: Vec<Record>,
    /// The segment that takes the place of the file if its lock cannot be had.
    pub(super) spare: Spare,
}

/// What is known of the lock of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Locks {
    /// It works, and is waited for so long.
    Within(Duration),
    /// There is none, and none is needed: nobody else writes.
    Alone,
    /// It cannot be had, and others may be writing.
    Broken,
}

/// What a segment is made of.
#[derive(Debug)]
pub(super) struct Spare {
    /// The ambient file.
    pub(super) path: PathBuf,
    /// The name of this process.
    pub(super) owner: String,
    /// Header and magic number.
    pub(super) head: Vec<u8>,
    /// The segment, once there is one.
    pub(super) segment: Option<PathBuf>,
}

impl AmbientFile {
    /// Adds records; they are written once there are 122 (of three components). Returns what others have appended meanwhile.
    pub fn append(&mut self, records: &[Record], notify: &dyn Notify) -> Result<Vec<Record>, FileError> {
        self.waiting.extend_from_slice(records);
        if self.waiting.len() < BUFFERED / self.record_bytes() { Ok(Vec::new()) } else { self.sync(notify) }
    }

    /// Writes what waits and returns what others have appended.
    ///
    /// After an error the records still wait: a later call may succeed.
    pub fn sync(&mut self, notify: &dyn Notify) -> Result<Vec<Record>, FileError> {
        let mode = if self.waiting.is_empty() { LockMode::Shared } else { LockMode::Exclusive };
        let main = Arc::clone(&self.file);
        let mut held = None;
        if let Locks::Within(patience) = self.locks {
            held = lock(&main, mode, patience, &self.name, notify)?;
            if held.is_none() {
                self.locks = Locks::Broken;
            }
        }
        let mut length = main.metadata().map_err(io_error("read", &self.name))?.len();
        if length < self.start && self.locks != Locks::Broken {
            // What has been written is gone; what comes is safe elsewhere.
            notify.warn(&FileError::Truncated { file: self.name.clone() }.to_string());
            self.locks = Locks::Broken;
        }
        if self.locks == Locks::Broken {
            drop(held.take());
            if self.waiting.is_empty() {
                return Ok(Vec::new());
            }
            self.retreat(notify)?;
            length = self.start;
        }
        let file = Arc::clone(&self.file);
        if length < self.end {
            notify.warn(&format!("ambient file \"{}\" was shortened by another program", self.name));
            self.end = length - (length - self.start) % self.record_bytes() as u64;
        }
        let bytes = read_from(&file, self.end).map_err(io_error("read", &self.name))?;
        let (foreign, damaged, torn) = records(&bytes, self.layout, &self.components);
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
                // What is whole stays, what is not goes; the other records wait for another try.
                let length = file.metadata().map_or(end, |m| m.len());
                let whole = ((length.saturating_sub(end)) as usize / self.record_bytes()).min(self.waiting.len());
                self.end = end + (whole * self.record_bytes()) as u64;
                let _ = file.set_len(self.end);
                self.waiting.drain(..whole);
                let (file, records) = (self.name.clone(), self.waiting.len());
                return Err(FileError::Write { file, records, source });
            }
        }
        self.end = end + (self.waiting.len() * self.record_bytes()) as u64;
        self.waiting.clear();
        if let Some(lock) = held {
            lock.release().map_err(|e| lock_failed(e, &self.name))?;
        }
        Ok(foreign)
    }

    fn record_bytes(&self) -> usize {
        self.layout.record_bytes(&self.components)
    }

    /// Turns to a segment of the file.
    fn retreat(&mut self, notify: &dyn Notify) -> Result<(), FileError> {
        let (file, path) = segment::create(&self.spare.path, &self.spare.owner)
            .map_err(io_error("create a segment of", &self.name))?;
        if let Err(source) = (&file).write_all(&self.spare.head) {
            let _ = std::fs::remove_file(&path);
            let (file, records) = (self.name.clone(), self.waiting.len());
            return Err(FileError::Write { file, records, source });
        }
        let shown = name_of(&path).into_owned();
        notify.warn(&format!("values go to \"{shown}\", and to \"{}\" when it can be locked again", self.name));
        self.file = Arc::new(file);
        self.name = shown;
        self.layout = segment::LAYOUT;
        self.start = self.spare.head.len() as u64;
        self.end = self.start;
        self.locks = Locks::Alone;
        self.spare.segment = Some(path);
        Ok(())
    }

    /// Says that nothing more will be written; what waits is lost, so call [`AmbientFile::sync`] before.
    pub fn close(self) {
        if let Some(path) = self.spare.segment {
            // Under its old name it is read and merged as well, and only not removed.
            let _ = std::fs::rename(&path, segment::done(&path));
        }
    }

    /// Writes what waits at `end`, after cutting off what follows.
    pub(super) fn write(&self, end: u64, truncate: bool) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(self.waiting.len() * self.record_bytes());
        for record in &self.waiting {
            bytes.extend(self.layout.encode(record, &self.components));
        }
        if truncate {
            self.file.set_len(end)?;
        }
        let mut file = &*self.file;
        file.seek(SeekFrom::Start(end))?;
        file.write_all(&bytes)
    }
}

/// A lock, or a warning where the file system has none.
pub(super) fn lock<'f>(
    file: &'f Arc<File>,
    mode: LockMode,
    patience: Duration,
    name: &str,
    notify: &dyn Notify,
) -> Result<Option<FileLock<'f>>, FileError> {
    match FileLock::acquire_within(file, mode, patience) {
        Ok(Some(lock)) => Ok(Some(lock)),
        Ok(None) => {
            let seconds = patience.as_secs_f64();
            notify
                .warn(&format!("ambient file \"{name}\" is not shared: its lock was not granted in {seconds} seconds"));
            Ok(None)
        }
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
