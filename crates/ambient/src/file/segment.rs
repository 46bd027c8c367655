//! Where the lock of an ambient file cannot be had (network file systems without a lock service, or one that hangs), a
//! process keeps its records in a file of its own beside it, a *segment*: `NAME.seg-OWNER`, an ambient file by itself.
//! Nobody else writes to it, so it needs no locks.
//!
//! Whoever opens the ambient file later reads the segments, too, and appends their records under an exclusive lock if
//! there is one. Records that are there already, byte for byte, are not appended again, so that this may be repeated,
//! and interrupted anywhere. A segment is removed once its records are safe and its owner has said, by renaming it to
//! `NAME.seg-OWNER.done`, that no more will come.

use super::fingerprint::fingerprint_lines;
use super::scan::{Contents, scan_as};
use crate::codec::Layout;
use crate::components::Components;
use crate::conversion::Sampling;
use crate::record::Record;
use ambit_base::Notify;
use ambit_file::{Header, name_of};
use std::collections::HashSet;
use std::ffi::OsString;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// What follows the ambient file's name.
const INFIX: &str = ".seg-";
/// What follows the name of a segment that is complete.
const DONE: &str = ".done";
/// Segments that one process may have of one file.
const MOST: u32 = 1000;

/// A segment that was found.
#[derive(Debug)]
pub struct Segment {
    /// Its name.
    pub path: PathBuf,
    /// What it holds.
    pub contents: Contents,
}

impl Segment {
    /// True if no more records will come.
    pub fn is_done(&self) -> bool {
        self.path.as_os_str().as_encoded_bytes().ends_with(DONE.as_bytes())
    }
}

/// The segments of the ambient file at `path`, in order of their names. Those that cannot be read, or that are of other
/// scenes or parameters than the file, are passed over with a warning.
pub fn segments(path: &Path, main: &Contents, notify: &dyn Notify) -> Vec<Segment> {
    let mut found = Vec::new();
    for path in names(path) {
        let shown = name_of(&path).into_owned();
        let contents = std::fs::read(&path)
            .map_err(|e| ambit_file::os_text(&e))
            .and_then(|bytes| scan_as(&bytes, &shown, |header| components(header, main)));
        match contents {
            Ok(contents) if fingerprint_lines(&contents.header).eq(fingerprint_lines(&main.header)) => {
                found.push(Segment { path, contents });
            }
            Ok(_) => notify.warn(&format!("segment \"{shown}\" of the ambient file is of another scene, and not used")),
            // Its owner may be about to write the header, or a name may have gone.
            Err(problem) => notify.warn(&format!("segment \"{shown}\" of the ambient file is not used: {problem}")),
        }
    }
    found
}

/// Those of the file: a segment is of its wavelength sampling, whatever that of the run that wrote it.
fn components(segment: &Header, main: &Contents) -> Result<Components, String> {
    match (Sampling::of(segment), Sampling::of(&main.header)) {
        (Some(a), Some(b)) if a.is_as(&b) => Ok(main.components.clone()),
        _ => Err("it has another wavelength sampling than the file".to_owned()),
    }
}

/// True if there are segments of the ambient file at `path`.
pub(super) fn has_segments(path: &Path) -> bool {
    !names(path).is_empty()
}

pub(super) fn names(path: &Path) -> Vec<PathBuf> {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return Vec::new() };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut prefix = name.to_owned();
    prefix.push(INFIX);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let ours = |name: &OsString| name.as_encoded_bytes().starts_with(prefix.as_encoded_bytes());
    let mut names: Vec<PathBuf> =
        entries.filter_map(|e| Some(e.ok()?.file_name())).filter(ours).map(|n| path.with_file_name(n)).collect();
    names.sort();
    names
}

/// The records of segments that `main` does not have yet, as bytes of its layout.
pub fn missing(main: &Contents, segments: &[Segment]) -> (Vec<Record>, Vec<u8>) {
    let mut known: HashSet<Vec<u8>> = main.records.iter().map(|r| main.layout.encode(r, &main.components)).collect();
    let mut records = Vec::new();
    let mut bytes = Vec::new();
    for record in segments.iter().flat_map(|s| &s.contents.records) {
        let encoded = main.layout.encode(record, &main.components);
        if known.insert(encoded.clone()) {
            records.push(record.clone());
            bytes.extend(encoded);
        }
    }
    (records, bytes)
}

/// Removes the segments that are done with, whose records are in the file now. What cannot be removed does no harm.
pub fn remove_done(segments: &[Segment]) {
    for segment in segments.iter().filter(|s| s.is_done()) {
        let _ = std::fs::remove_file(&segment.path);
    }
}

/// A new segment of the ambient file at `path`, with its name.
pub(super) fn create(path: &Path, owner: &str) -> io::Result<(File, PathBuf)> {
    let mut outcome = Err(io::ErrorKind::AlreadyExists.into());
    for number in 1..=MOST {
        let mut name = path.as_os_str().to_owned();
        name.push(INFIX);
        name.push(owner);
        if number > 1 {
            name.push(format!("-{number}"));
        }
        let name = PathBuf::from(name);
        if done(&name).exists() {
            continue;
        }
        outcome = File::options().read(true).write(true).create_new(true).open(&name).map(|file| (file, name));
        match &outcome {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            _ => break,
        }
    }
    outcome
}

/// The name of a segment that is complete.
pub(super) fn done(segment: &Path) -> PathBuf {
    let mut name = segment.as_os_str().to_owned();
    name.push(DONE);
    name.into()
}

/// The layout of segments.
pub(super) const LAYOUT: Layout = Layout::CURRENT;
