//! The ambient file of a run: records come in when it is opened and between batches, and new ones go out in the order
//! in which they were published.

use crate::{Error, Renderer};
use ambit_ambient::{AmbientFile, FileError};
use ambit_base::Notify;
use std::path::Path;

/// An open ambient file, and how far the cache's records have been handed to it.
#[derive(Debug)]
pub(crate) struct Sharing {
    file: AmbientFile,
    handed: usize,
}

impl Renderer {
    /// Loads the records of the ambient file at `path` and shares new ones through it; creates it if absent.
    ///
    /// `header` are the lines of a new file's header: the command with its effective options, software and dates.
    pub fn share(&mut self, path: &Path, header: &[String], notify: &dyn Notify) -> Result<(), Error> {
        let opened = AmbientFile::open(path, header, notify).map_err(|e| failed(&e))?;
        let cache = self.cache_mut();
        cache.quantise(true);
        cache.load(opened.records);
        let handed = cache.records().len();
        self.sharing = opened.file.map(|file| Sharing { file, handed });
        Ok(())
    }

    /// Hands records computed since the last call to the ambient file, and takes in those of others.
    pub(crate) fn exchange(&mut self, notify: &dyn Notify, last: bool) -> Result<(), Error> {
        let Some(mut sharing) = self.sharing.take() else { return Ok(()) };
        let records = self.cache().records();
        let mut foreign = sharing.file.append(&records[sharing.handed..], notify);
        sharing.handed = records.len();
        if last && let Ok(mut first) = foreign {
            foreign = sharing.file.sync(notify).map(|more| {
                first.extend(more);
                first
            });
        }
        let foreign = foreign.map_err(|e| failed(&e))?;
        if !foreign.is_empty() {
            self.cache_mut().load(foreign);
            sharing.handed = self.cache().records().len();
        }
        self.sharing = Some(sharing);
        Ok(())
    }

    /// Writes what the ambient file still waits for. Call it before the program ends, whatever the reason.
    pub fn finish(&mut self, notify: &dyn Notify) -> Result<(), Error> {
        self.exchange(notify, true)
    }
}

fn failed(e: &FileError) -> Error {
    match e {
        FileError::Incompatible { .. } => Error::user(e.to_string()),
        _ => Error::system(e.to_string()),
    }
}
