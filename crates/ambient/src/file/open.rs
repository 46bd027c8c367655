//! Opening an ambient file: reading what is there, deciding whether it may be used, creating it if it is absent.

use super::error::FileError;
use super::habits::Habits;
use super::reuse::{Opening, Reuse, Verdict};
use super::scan::{Contents, FORMAT, scan_as};
use super::segment::{has_segments, missing, remove_done, segments};
use super::share::{AmbientFile, Locks, Spare, cut, io_error, lock, read_from, skipped};
use crate::codec::Layout;
use crate::components::Components;
use crate::conversion::{Conversion, DIGITS, SPLITS, Sampling};
use crate::record::Record;
use ambit_base::Notify;
use ambit_file::{FileLock, Header, LockMode, bytes_of, general, name_of, os_text};
use std::cell::Cell;
use std::fs::File;
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// How often an empty file is looked at again: its creator is about to write the header.
const TRIES: u32 = 40;
/// How long to wait in between; four seconds in all, as Radiance does.
const PAUSE: Duration = Duration::from_millis(100);

/// What opening came to.
#[derive(Debug)]
pub struct Opened {
    /// The records found.
    pub records: Vec<Record>,
    /// The file to append to; none if it cannot be written, of which a warning has told.
    pub file: Option<AmbientFile>,
    /// How the records are to be used; none of a new file.
    pub habits: Option<Habits>,
}

impl Opened {
    const NOTHING: Self = Self { records: Vec::new(), file: None, habits: None };
}

/// An ambient file on its way to being opened.
struct Entry<'a> {
    path: &'a Path,
    name: String,
    opening: &'a Opening<'a>,
    notify: &'a dyn Notify,
    /// The file beside one of another scene: should it not fit either, there is no further one.
    beside: bool,
    /// A lock was not granted: an abandoned request may still stand, and no further one is made.
    lockless: Cell<bool>,
}

impl AmbientFile {
    /// Opens an ambient file and reads its records, or creates it.
    ///
    /// Warnings tell of files of other scenes (see [`Reuse`]), of read-only ones, damaged records (which are skipped),
    /// incomplete ones at the end (which are cut off) and missing locks.
    pub fn open(path: &Path, opening: &Opening<'_>, notify: &dyn Notify) -> Result<Opened, FileError> {
        let name = name_of(path).into_owned();
        Entry { path, name, opening, notify, beside: false, lockless: Cell::new(false) }.open()
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
            return self.read_only(&Arc::new(file));
        }
        let failed = |source| io_error("open", &self.name)(source);
        let mut empty = 0;
        loop {
            match File::options().read(true).write(true).open(path) {
                Ok(file) => {
                    let file = Arc::new(file);
                    if let Some(found) = self.existing(&file)? {
                        return Ok(self.taken(found, file));
                    }
                    // Nothing there yet: somebody creates it, or was killed doing so.
                    empty += 1;
                    if empty >= TRIES {
                        return self.begin(file);
                    }
                    drop(file);
                    std::thread::sleep(PAUSE);
                }
                Err(e) if e.kind() == ErrorKind::NotFound => {
                    if let Some(opened) = self.create()? {
                        return Ok(opened);
                    }
                    // Somebody was faster.
                }
                Err(e) if matches!(e.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) => {
                    let file = File::open(path).map_err(failed)?;
                    return self.read_only(&Arc::new(file));
                }
                Err(e) => return Err(failed(e)),
            }
        }
    }

    /// Creates the file; `None` if it is there after all.
    ///
    /// It is written under another name and linked to its own, so that nobody ever sees it without its header.
    fn create(&self) -> Result<Option<Opened>, FileError> {
        let mut aside = self.path.as_os_str().to_owned();
        aside.push(format!(".new-{}", self.opening.owner));
        let aside = PathBuf::from(aside);
        let open = |path: &Path| File::options().read(true).write(true).create_new(true).open(path);
        // A process of this name is gone: what it left is in the way.
        let _ = std::fs::remove_file(&aside);
        let file = match open(&aside) {
            Ok(file) => file,
            // Another of this name (in a container, say) is at it this very moment.
            Err(e) if e.kind() == ErrorKind::AlreadyExists => return Ok(None),
            Err(e) => return Err(io_error("open", &self.name)(e)),
        };
        let linked = (&file).write_all(&self.head(None)).and_then(|()| std::fs::hard_link(&aside, self.path));
        let _ = std::fs::remove_file(&aside);
        let full = [ErrorKind::StorageFull, ErrorKind::QuotaExceeded, ErrorKind::FileTooLarge];
        match linked {
            // Of two processes of one name (in containers, say) one may have linked the other's file.
            Ok(()) if !is_at(&file, self.path) => Ok(None),
            Ok(()) => self.new_file(Arc::new(file)).map(Some),
            Err(e) if e.kind() == ErrorKind::AlreadyExists => Ok(None),
            Err(e) if full.contains(&e.kind()) => Err(io_error("write", &self.name)(e)),
            // No links here.
            Err(_) => match open(self.path) {
                Ok(file) => self.begin(Arc::new(file)).map(Some),
                Err(e) if e.kind() == ErrorKind::AlreadyExists => Ok(None),
                Err(e) => Err(io_error("open", &self.name)(e)),
            },
        }
    }

    /// Writes the header of a file that is empty.
    fn begin(&self, file: Arc<File>) -> Result<Opened, FileError> {
        let lock = self.lock(&file, LockMode::Exclusive)?;
        if file.metadata().map_err(io_error("read", &self.name))?.len() > 0 {
            drop(lock);
            return self.open();
        }
        let written = (&*file).write_all(&self.head(None));
        if written.is_err() {
            let _ = file.set_len(0);
        }
        drop(lock);
        written.map_err(io_error("write", &self.name))?;
        self.new_file(file)
    }

    /// A file that has but a header, just written.
    fn new_file(&self, file: Arc<File>) -> Result<Opened, FileError> {
        // Without locks this process, having created the file, writes to it, and the others beside it.
        let lock = self.lock(&file, LockMode::Shared)?;
        let locks = if lock.is_some() { Locks::Within(self.opening.patience) } else { Locks::Alone };
        drop(lock);
        let head = self.head(None);
        let start = head.len() as u64;
        let (name, spare) = (self.name.clone(), self.spare(head));
        let (layout, components) = (Layout::CURRENT, self.opening.components.clone());
        let file = AmbientFile { file, name, layout, components, start, end: start, locks, waiting: Vec::new(), spare };
        Ok(Opened { records: Vec::new(), file: Some(file), habits: None })
    }

    /// Locks a file of this entry; `None` if there are no locks to be had.
    fn lock<'f>(&self, file: &'f Arc<File>, mode: LockMode) -> Result<Option<FileLock<'f>>, FileError> {
        if self.lockless.get() {
            return Ok(None);
        }
        let lock = lock(file, mode, self.opening.patience, &self.name, self.notify)?;
        self.lockless.set(lock.is_none());
        Ok(lock)
    }

    fn spare(&self, head: Vec<u8>) -> Spare {
        Spare { path: self.path.to_owned(), owner: self.opening.owner.to_owned(), head, segment: None }
    }

    /// What a new file begins with, or a segment of the file that has this header.
    fn head(&self, main: Option<&Header>) -> Vec<u8> {
        let mut header = Header::new();
        header.extend(self.opening.header.iter().map(|line| bytes_of(line)));
        match main {
            Some(main) => header.extend(super::fingerprint_lines(main)),
            None => header.extend(self.opening.fingerprint.map(super::Fingerprint::lines).unwrap_or_default()),
        }
        let splits = main.map_or(self.opening.splits, |main| main.wavelength_splits().unwrap_or(SPLITS));
        let count = main.map_or(self.opening.components.count(), |main| main.components() as usize);
        header.push(format!("WAVELENGTH_SPLITS= {}", words(&splits)));
        header.push(format!("NCOMP={count}"));
        header.push(format!("FORMAT={FORMAT}"));
        let mut bytes = Vec::new();
        // Writing to memory does not fail.
        let _ = header.write(&mut bytes);
        bytes.extend(Layout::CURRENT.magic().to_be_bytes());
        bytes
    }

    /// Reads a file that can be written; `None` if it is still empty.
    fn existing(&self, file: &Arc<File>) -> Result<Option<Existing>, FileError> {
        let name = &self.name;
        let mut mode = LockMode::Shared;
        loop {
            let lock = self.lock(file, mode)?;
            let bytes = read_from(file, 0).map_err(io_error("read", name))?;
            if bytes.is_empty() {
                return Ok(None);
            }
            let mut contents = self.understood(&bytes)?;
            let verdict = self.opening.judge(&self.opening.compare(&contents.header), name)?;
            let mut end = (bytes.len() - contents.torn) as u64;
            if matches!(verdict, Verdict::Use(_)) {
                let changes = contents.torn > 0 || has_segments(self.path);
                if changes && lock.is_some() && mode == LockMode::Shared {
                    // What looks incomplete may have been so for lack of a lock: look again where nobody else can write.
                    mode = LockMode::Exclusive;
                    continue;
                }
                if contents.torn > 0 && lock.is_some() {
                    file.set_len(end).map_err(io_error("repair", name))?;
                }
                // Segments that came up meanwhile wait for one who may write.
                let alone = lock.is_some() && mode == LockMode::Exclusive;
                end = self.merge(&mut contents, alone.then_some(&**file), end);
            }
            return Ok(Some(Existing { contents, verdict, end, locked: lock.is_some() }));
        }
    }

    /// Takes in the records of segments, and appends them to the file at `end` if it is given; returns where it ends.
    fn merge(&self, contents: &mut Contents, file: Option<&File>, end: u64) -> u64 {
        let segments = segments(self.path, contents, self.notify);
        let (records, bytes) = missing(contents, &segments);
        contents.records.extend_from_slice(&records);
        // What is converted twice is not what it was: the next run of the file's own sampling merges.
        let Some(mut file) = file.filter(|_| !contents.components.is_converted()) else { return end };
        if !bytes.is_empty() {
            let written = file.seek(SeekFrom::Start(end)).and_then(|_| file.write_all(&bytes));
            if let Err(e) = written.and_then(|()| file.sync_data()) {
                let _ = file.set_len(end);
                let why = os_text(&e);
                self.notify.warn(&format!("cannot merge segments into ambient file \"{}\": {why}", self.name));
                return end;
            }
            let (values, files) = (records.len(), segments.len());
            let plural = if files == 1 { "" } else { "s" };
            self.notify.warn(&format!(
                "merged {values} values of {files} segment{plural} into ambient file \"{}\"",
                self.name
            ));
        }
        remove_done(&segments);
        end + bytes.len() as u64
    }

    /// Goes on with a file that was read as its fingerprint allows.
    fn taken(&self, found: Existing, file: Arc<File>) -> Opened {
        let Existing { contents, verdict, end, locked } = found;
        let habits = Some(Habits::of(&contents.header));
        match verdict {
            Verdict::Leave(list) => self.left(&contents, &list),
            Verdict::Use(warning) => {
                if let Some(text) = warning {
                    self.notify.warn(&text);
                }
                self.tell_sampling(&contents);
                self.tell_damage(&contents);
                let spare = self.spare(self.head(Some(&contents.header)));
                let Contents { layout, components, start, records, .. } = contents;
                let (name, start) = (self.name.clone(), start as u64);
                // Without locks others may be writing: new records will go elsewhere.
                let locks = if locked { Locks::Within(self.opening.patience) } else { Locks::Broken };
                let file =
                    AmbientFile { file, name, layout, components, start, end, locks, waiting: Vec::new(), spare };
                Opened { records, file: Some(file), habits }
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
        let name = name_of(&path).into_owned();
        if self.opening.reuse == Reuse::ReadOnly && !path.exists() {
            self.notify.warn(&unused);
            return Opened::NOTHING;
        }
        self.notify.warn(&format!("{unused}, \"{name}\" is used instead"));
        let entry = Entry {
            path: &path,
            name,
            opening: self.opening,
            notify: self.notify,
            beside: true,
            lockless: Cell::new(false),
        };
        entry.open().unwrap_or_else(|e| {
            self.notify.warn(&format!("{e}; values are not kept"));
            Opened::NOTHING
        })
    }

    /// Reads a file that cannot be written, or is not to be.
    fn read_only(&self, file: &Arc<File>) -> Result<Opened, FileError> {
        let lock = self.lock(file, LockMode::Shared)?;
        let bytes = read_from(file, 0).map_err(io_error("read", &self.name))?;
        drop(lock);
        let mut contents = self.understood(&bytes)?;
        match self.opening.judge(&self.opening.compare(&contents.header), &self.name)? {
            Verdict::Leave(list) => Ok(self.left(&contents, &list)),
            Verdict::Use(warning) => {
                if let Some(text) = warning {
                    self.notify.warn(&text);
                }
                self.tell_sampling(&contents);
                self.tell_damage(&contents);
                self.merge(&mut contents, None, 0);
                if self.opening.reuse != Reuse::ReadOnly {
                    let found = contents.records.len();
                    self.notify.warn(&format!("loaded {found} values from read-only ambient file"));
                }
                let habits = Some(Habits::of(&contents.header));
                Ok(Opened { records: contents.records, file: None, habits })
            }
        }
    }

    fn understood(&self, bytes: &[u8]) -> Result<Contents, FileError> {
        let contents = scan_as(bytes, &self.name, |header| self.components(header));
        let contents = contents.map_err(|problem| self.incompatible(problem))?;
        if contents.components.is_converted() && self.opening.reuse == Reuse::Strict {
            let problem = format!("it is of another wavelength sampling ({})", shown(&contents.header));
            return Err(FileError::Unfit { file: self.name.clone(), problem });
        }
        Ok(contents)
    }

    /// The run's components in a file of this header, which may be of another sampling.
    fn components(&self, header: &Header) -> Result<Components, String> {
        let Opening { components, splits, observer, .. } = *self.opening;
        let found = Sampling::of(header).ok_or("bad WAVELENGTH_SPLITS")?;
        let run = Sampling::new(components.count(), splits).ok_or("a run without wavelengths")?;
        Ok(if found.is_as(&run) {
            components.clone()
        } else {
            components.converted(Conversion::new(&found, &run, observer))
        })
    }

    /// Says that values are converted.
    fn tell_sampling(&self, contents: &Contents) {
        if contents.components.is_converted() {
            let (name, found) = (&self.name, shown(&contents.header));
            self.notify.warn(&format!(
                "different ambient file wavelength sampling: \"{name}\" is of {found}, and its values are converted"
            ));
        }
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

/// The sampling of a header that has one.
fn shown(header: &Header) -> String {
    Sampling::of(header).map(|s| s.to_string()).unwrap_or_default()
}

/// Wavelengths as headers have them.
fn words(splits: &[f64; 4]) -> String {
    splits.map(|nm| general(nm, DIGITS)).join(" ")
}

/// True if the path names this very file.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    let place = |m: &std::fs::Metadata| (m.dev(), m.ino());
    matches!((file.metadata(), std::fs::metadata(path)), (Ok(a), Ok(b)) if place(&a) == place(&b))
}

#[cfg(test)]
impl AmbientFile {
    /// Reads a file as if it could not be written: permissions do not stop the superuser.
    pub(super) fn open_read_only(
        file: &Arc<File>,
        opening: &Opening<'_>,
        notify: &dyn Notify,
    ) -> Result<Opened, FileError> {
        let name = "a.amb".to_owned();
        Entry { path: Path::new("a.amb"), name, opening, notify, beside: false, lockless: Cell::new(false) }
            .read_only(file)
    }
}
