//! Opening an ambient file: reading what is there, deciding whether it may be used, creating it if it is absent.

use super::error::FileError;
use super::reuse::{Opening, Reuse, Verdict};
use super::scan::{Contents, FORMAT, scan};
use super::share::{AmbientFile, cut, io_error, lock, read_from, skipped};
use crate::codec::Layout;
use crate::record::Record;
use ambit_base::Notify;
use ambit_file::{Header, LockMode};
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::time::Duration;

/// How often an empty file is looked at again: its creator is about to write the header.
const TRIES: u32 = 40;
/// How long to wait in between; four seconds in all, as Radiance does.
const PAUSE: Duration = Duration::from_millis(100);
/// The wavelengths in nm that separate the channels of RGB records.
const SPLITS: &str = "WAVELENGTH_SPLITS= 780 588 480 380";

/// What opening came to.
#[derive(Debug)]
pub struct Opened {
    /// The records found.
    pub records: Vec<Record>,
    /// The file to append to; none if it cannot be written, of which a warning has told.
    pub file: Option<AmbientFile>,
}

impl Opened {
    const NOTHING: Self = Self { records: Vec::new(), file: None };
}

/// An ambient file on its way to being opened.
struct Entry<'a> {
    path: &'a Path,
    name: String,
    opening: &'a Opening<'a>,
    notify: &'a dyn Notify,
    /// The file beside one of another scene: should it not fit either, there is no further one.
    beside: bool,
}

impl AmbientFile {
    /// Opens an ambient file and reads its records, or creates it.
    ///
    /// Warnings tell of files of other scenes (see [`Reuse`]), of read-only ones, damaged records (which are skipped),
    /// incomplete ones at the end (which are cut off) and missing locks.
    pub fn open(path: &Path, opening: &Opening<'_>, notify: &dyn Notify) -> Result<Opened, FileError> {
        let name = path.to_string_lossy().into_owned();
        Entry { path, name, opening, notify, beside: false }.open()
    }
}

impl Entry<'_> {
    fn open(&self) -> Result<Opened, FileError> {
        let path = self.path;
        if std::fs::metadata(path).is_ok_and(|m| !m.is_file()) {
            return Err(self.incompatible("not a regular file"));
        }
        if self.opening.reuse == Reuse::ReadOnly {
            let file = File::open(path).map_err(io_error("open", &self.name))?;
            return self.read_only(&file);
        }
        let failed = |source| io_error("open", &self.name)(source);
        let mut empty = 0;
        loop {
            match File::options().read(true).write(true).open(path) {
                Ok(file) => {
                    if let Some(found) = self.existing(&file)? {
                        return Ok(self.taken(found, file));
                    }
                    // Nothing there yet: somebody creates it.
                    empty += 1;
                    if empty >= TRIES {
                        return Err(self.incompatible("the file is empty"));
                    }
                    drop(file);
                    std::thread::sleep(PAUSE);
                }
                Err(e) if e.kind() == ErrorKind::NotFound => {
                    match File::options().read(true).write(true).create_new(true).open(path) {
                        Ok(file) => return self.create(file),
                        // Somebody was faster.
                        Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
                        Err(e) => return Err(failed(e)),
                    }
                }
                Err(e) if matches!(e.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) => {
                    let file = File::open(path).map_err(failed)?;
                    return self.read_only(&file);
                }
                Err(e) => return Err(failed(e)),
            }
        }
    }

    /// Writes the header of a new file.
    fn create(&self, file: File) -> Result<Opened, FileError> {
        let bytes = self.head();
        let lock = lock(&file, LockMode::Exclusive, &self.name, self.notify)?;
        let locks = lock.is_some();
        let written = (&file).write_all(&bytes);
        drop(lock);
        written.map_err(io_error("write", &self.name))?;
        let start = bytes.len() as u64;
        let name = self.name.clone();
        let file = AmbientFile { file, name, layout: Layout::CURRENT, start, end: start, locks, waiting: Vec::new() };
        Ok(Opened { records: Vec::new(), file: Some(file) })
    }

    /// What a new file begins with.
    fn head(&self) -> Vec<u8> {
        let mut header = Header::new();
        header.extend(self.opening.header);
        header.extend(self.opening.fingerprint.map(super::Fingerprint::lines).unwrap_or_default());
        header.push(SPLITS);
        header.push("NCOMP=3");
        header.push(format!("FORMAT={FORMAT}"));
        let mut bytes = Vec::new();
        // Writing to memory does not fail.
        let _ = header.write(&mut bytes);
        bytes.extend(Layout::CURRENT.magic().to_be_bytes());
        bytes
    }

    /// Reads a file that can be written; `None` if it is still empty.
    fn existing(&self, file: &File) -> Result<Option<Existing>, FileError> {
        let name = &self.name;
        let mut mode = LockMode::Shared;
        loop {
            let lock = lock(file, mode, name, self.notify)?;
            let bytes = read_from(file, 0).map_err(io_error("read", name))?;
            if bytes.is_empty() {
                return Ok(None);
            }
            let contents = self.understood(&bytes)?;
            let verdict = self.opening.judge(&self.opening.compare(&contents.header), name)?;
            if contents.torn > 0 && lock.is_some() && matches!(verdict, Verdict::Use(_)) {
                if mode == LockMode::Shared {
                    // What looks incomplete may have been so for lack of a lock: look again where nobody else can write.
                    mode = LockMode::Exclusive;
                    continue;
                }
                let whole = bytes.len() - contents.torn;
                file.set_len(whole as u64).map_err(io_error("repair", name))?;
            }
            let end = (bytes.len() - contents.torn) as u64;
            return Ok(Some(Existing { contents, verdict, end, locked: lock.is_some() }));
        }
    }

    /// Goes on with a file that was read as its fingerprint allows.
    fn taken(&self, found: Existing, file: File) -> Opened {
        let Existing { contents, verdict, end, locked } = found;
        match verdict {
            Verdict::Leave(list) => self.left(&contents, &list),
            Verdict::Use(warning) => {
                if let Some(text) = warning {
                    self.notify.warn(&text);
                }
                self.tell_damage(&contents);
                let Contents { layout, start, records, .. } = contents;
                let (name, start) = (self.name.clone(), start as u64);
                // Without locks others may be writing: the values are used, nothing is added.
                let file =
                    locked.then(|| AmbientFile { file, name, layout, start, end, locks: true, waiting: Vec::new() });
                Opened { records, file }
            }
        }
    }

    /// Leaves a file of another scene alone and turns to the one beside it.
    fn left(&self, contents: &Contents, list: &str) -> Opened {
        let beside = if self.beside { None } else { self.opening.beside(self.path) };
        let found = contents.records.len();
        let unused =
            format!("ambient file \"{}\" does not fit: other {list}; its {found} values are not used", self.name);
        let Some(path) = beside else {
            self.notify.warn(&unused);
            return Opened::NOTHING;
        };
        let name = path.to_string_lossy().into_owned();
        if self.opening.reuse == Reuse::ReadOnly && !path.exists() {
            self.notify.warn(&unused);
            return Opened::NOTHING;
        }
        self.notify.warn(&format!("{unused}, \"{name}\" is used instead"));
        let entry = Entry { path: &path, name, opening: self.opening, notify: self.notify, beside: true };
        entry.open().unwrap_or_else(|e| {
            self.notify.warn(&format!("{e}; values are not kept"));
            Opened::NOTHING
        })
    }

    /// Reads a file that cannot be written, or is not to be.
    fn read_only(&self, file: &File) -> Result<Opened, FileError> {
        let lock = lock(file, LockMode::Shared, &self.name, self.notify)?;
        let bytes = read_from(file, 0).map_err(io_error("read", &self.name))?;
        drop(lock);
        let contents = self.understood(&bytes)?;
        match self.opening.judge(&self.opening.compare(&contents.header), &self.name)? {
            Verdict::Leave(list) => Ok(self.left(&contents, &list)),
            Verdict::Use(warning) => {
                if let Some(text) = warning {
                    self.notify.warn(&text);
                }
                self.tell_damage(&contents);
                if self.opening.reuse != Reuse::ReadOnly {
                    let found = contents.records.len();
                    self.notify.warn(&format!("loaded {found} values from read-only ambient file"));
                }
                Ok(Opened { records: contents.records, file: None })
            }
        }
    }

    fn understood(&self, bytes: &[u8]) -> Result<Contents, FileError> {
        scan(bytes, &self.name).map_err(|problem| self.incompatible(problem))
    }

    fn incompatible(&self, problem: impl Into<String>) -> FileError {
        FileError::Incompatible { file: self.name.clone(), problem: problem.into() }
    }

    fn tell_damage(&self, contents: &Contents) {
        if contents.damaged > 0 {
            self.notify.warn(&skipped(contents.damaged, &self.name));
        }
        if contents.torn > 0 {
            self.notify.warn(&cut(contents.torn, &self.name));
        }
    }
}

/// A file that was there, before its handle takes the descriptor.
struct Existing {
    contents: Contents,
    verdict: Verdict,
    /// Where its last whole record ends.
    end: u64,
    locked: bool,
}

#[cfg(test)]
impl AmbientFile {
    /// Reads a file as if it could not be written: permissions do not stop the superuser.
    pub(super) fn open_read_only(file: &File, opening: &Opening<'_>, notify: &dyn Notify) -> Result<Opened, FileError> {
        let name = "a.amb".to_owned();
        Entry { path: Path::new("a.amb"), name, opening, notify, beside: false }.read_only(file)
    }
}
