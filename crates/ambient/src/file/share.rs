//! Opening an ambient file and appending to it while others do the same.

use super::error::FileError;
use super::scan::{Contents, FORMAT, records, scan};
use crate::codec::{Layout, RECORD_BYTES};
use crate::record::Record;
use ambit_base::Notify;
use ambit_file::{FileLock, Header, LockError, LockMode};
use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::Duration;

/// Records that wait before they are written: what fits the C library's buffer of 8192 bytes, as in Radiance.
const BUFFERED: usize = 8192 / RECORD_BYTES;
/// How often an empty file is looked at again: its creator is about to write the header.
const TRIES: u32 = 40;
/// How long to wait in between; four seconds in all, as Radiance does.
const PAUSE: Duration = Duration::from_millis(100);
/// The wavelengths in nm that separate the channels of RGB records.
const SPLITS: &str = "WAVELENGTH_SPLITS= 780 588 480 380";

/// An ambient file open for appending. Nothing is written when this is dropped: call [`AmbientFile::sync`] before.
#[derive(Debug)]
pub struct AmbientFile {
    pub(super) file: File,
    name: String,
    layout: Layout,
    /// Where the first record begins.
    start: u64,
    /// The end of what has been read or written here.
    end: u64,
    /// False on file systems without locks, where this process created the file and writes alone.
    pub(super) locks: bool,
    pub(super) waiting: Vec<Record>,
}

/// What opening came to.
#[derive(Debug)]
pub struct Opened {
    /// The records found.
    pub records: Vec<Record>,
    /// The file to append to; none if it cannot be written, of which a warning has told.
    pub file: Option<AmbientFile>,
}

impl AmbientFile {
    /// Opens an ambient file and reads its records, or creates it.
    ///
    /// `header_lines` go to the header of a new file after `#?RADIANCE`: the command line with its options, `SOFTWARE=`,
    /// `CAPDATE=` and `GMT=`; wavelengths, `NCOMP` and `FORMAT` follow by themselves. Warnings tell of read-only files,
    /// damaged records (which are skipped), incomplete ones at the end (which are cut off) and missing locks.
    pub fn open(path: &Path, header_lines: &[String], notify: &dyn Notify) -> Result<Opened, FileError> {
        let name = path.to_string_lossy().into_owned();
        let failed = |source| FileError::Io { action: "open", file: name.clone(), source };
        let mut empty = 0;
        loop {
            match File::options().read(true).write(true).open(path) {
                Ok(file) => {
                    if let Some(opened) = Self::existing(&file, &name, notify)? {
                        return Ok(opened.with(file));
                    }
                    // Nothing there yet: somebody creates it.
                    empty += 1;
                    if empty >= TRIES {
                        return Err(FileError::Incompatible { file: name, problem: "the file is empty".to_owned() });
                    }
                    drop(file);
                    std::thread::sleep(PAUSE);
                }
                Err(e) if e.kind() == ErrorKind::NotFound => {
                    match File::options().read(true).write(true).create_new(true).open(path) {
                        Ok(file) => return Self::create(file, name, header_lines, notify),
                        // Somebody was faster.
                        Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
                        Err(e) => return Err(failed(e)),
                    }
                }
                Err(e) if matches!(e.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) => {
                    let file = File::open(path).map_err(failed)?;
                    return Self::read_only(&file, &name, notify);
                }
                Err(e) => return Err(failed(e)),
            }
        }
    }

    /// Writes the header of a new file.
    fn create(file: File, name: String, header_lines: &[String], notify: &dyn Notify) -> Result<Opened, FileError> {
        let mut header = Header::new();
        header.extend(header_lines);
        header.push(SPLITS);
        header.push("NCOMP=3");
        header.push(format!("FORMAT={FORMAT}"));
        let mut bytes = Vec::new();
        let layout = Layout::CURRENT;
        let failed = |source| FileError::Io { action: "write", file: name.clone(), source };
        header.write(&mut bytes).map_err(failed)?;
        bytes.extend(layout.magic().to_be_bytes());
        let lock = lock(&file, LockMode::Exclusive, &name, notify)?;
        let locks = lock.is_some();
        let written = (&file).write_all(&bytes);
        drop(lock);
        written.map_err(failed)?;
        let start = bytes.len() as u64;
        let file = Self { file, name, layout, start, end: start, locks, waiting: Vec::new() };
        Ok(Opened { records: Vec::new(), file: Some(file) })
    }

    /// Reads a file that can be written; `None` if it is still empty.
    fn existing(file: &File, name: &str, notify: &dyn Notify) -> Result<Option<Existing>, FileError> {
        let mut mode = LockMode::Shared;
        loop {
            let lock = lock(file, mode, name, notify)?;
            let bytes = read_from(file, 0).map_err(io_error("read", name))?;
            if bytes.is_empty() {
                return Ok(None);
            }
            let contents = understood(&bytes, name)?;
            if contents.torn > 0 && lock.is_some() {
                if mode == LockMode::Shared {
                    // What looks incomplete may have been so for lack of a lock: look again where nobody else can write.
                    mode = LockMode::Exclusive;
                    continue;
                }
                let whole = bytes.len() - contents.torn;
                file.set_len(whole as u64).map_err(io_error("repair", name))?;
            }
            tell_damage(&contents, name, notify);
            return Ok(Some(Existing {
                layout: contents.layout,
                start: contents.start as u64,
                end: (bytes.len() - contents.torn) as u64,
                name: name.to_owned(),
                locked: lock.is_some(),
                records: contents.records,
            }));
        }
    }

    /// Reads a file that cannot be written.
    pub(super) fn read_only(file: &File, name: &str, notify: &dyn Notify) -> Result<Opened, FileError> {
        let lock = lock(file, LockMode::Shared, name, notify)?;
        let bytes = read_from(file, 0).map_err(io_error("read", name))?;
        drop(lock);
        let contents = understood(&bytes, name)?;
        tell_damage(&contents, name, notify);
        notify.warn(&format!("loaded {} values from read-only ambient file", contents.records.len()));
        Ok(Opened { records: contents.records, file: None })
    }

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

/// A file that was there, before its handle takes the descriptor.
struct Existing {
    layout: Layout,
    start: u64,
    end: u64,
    name: String,
    locked: bool,
    records: Vec<Record>,
}

impl Existing {
    /// Without locks others may be writing: the values are used, nothing is added.
    fn with(self, file: File) -> Opened {
        let Self { layout, start, end, name, locked, records } = self;
        let file = locked.then(|| AmbientFile { file, name, layout, start, end, locks: true, waiting: Vec::new() });
        Opened { records, file }
    }
}

/// A lock, or a warning where the file system has none.
fn lock<'f>(
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

fn lock_failed(error: LockError, name: &str) -> FileError {
    let source = match error {
        LockError::Unsupported(e) | LockError::Unavailable(e) | LockError::Deadlock(e) | LockError::Other(e) => e,
    };
    FileError::Io { action: "lock", file: name.to_owned(), source }
}

fn io_error(action: &'static str, name: &str) -> impl FnOnce(io::Error) -> FileError {
    move |source| FileError::Io { action, file: name.to_owned(), source }
}

/// The bytes from `offset` to the end, through the one descriptor: closing another would drop the lock.
fn read_from(mut file: &File, offset: u64) -> io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(offset))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn understood(bytes: &[u8], name: &str) -> Result<Contents, FileError> {
    scan(bytes, name).map_err(|problem| FileError::Incompatible { file: name.to_owned(), problem })
}

fn tell_damage(contents: &Contents, name: &str, notify: &dyn Notify) {
    if contents.damaged > 0 {
        notify.warn(&skipped(contents.damaged, name));
    }
    if contents.torn > 0 {
        notify.warn(&cut(contents.torn, name));
    }
}

fn skipped(damaged: usize, name: &str) -> String {
    format!("ignoring {damaged} values in ambient file \"{name}\" (corrupted)")
}

fn cut(torn: usize, name: &str) -> String {
    format!("ignoring the last {torn} bytes of ambient file \"{name}\" (an incomplete value)")
}
