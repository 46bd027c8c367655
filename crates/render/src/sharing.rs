//! The ambient file of a run: records come in when it is opened and between batches, and new ones go out in the order
//! in which they were published.

use crate::spectral::tristimulus;
use crate::{Error, Renderer};
use ambit_ambient::{AmbientFile, Clamping, Components, FileError, Fingerprint, Opening, PATIENCE, Reuse, StepTest};
use ambit_base::Notify;
use std::path::Path;

/// The ambient file that a run wants.
#[derive(Clone, Copy, Debug)]
pub struct Store<'a> {
    /// Its name.
    pub path: &'a Path,
    /// Lines of a new file's header: the command with its effective options, software and dates.
    pub header: &'a [String],
    /// What the run's records depend on.
    pub fingerprint: &'a Fingerprint,
    /// What is done with records that are there.
    pub reuse: Reuse,
    /// Names this process among all that share a file system.
    pub owner: &'a str,
}

/// An open ambient file, and how far the cache's records have been handed to it.
#[derive(Debug)]
pub(crate) struct Sharing {
    file: AmbientFile,
    handed: usize,
    /// True if the file could not be written, and that has been told.
    trouble: bool,
}

impl Renderer {
    /// Loads the records of an ambient file and shares new ones through it; creates it if absent.
    pub fn share(&mut self, store: &Store<'_>, notify: &dyn Notify) -> Result<(), Error> {
        let components = &self.options.spectrum.components(self.passes());
        let opened = AmbientFile::open(store.path, &self.opening(store, components), notify).map_err(|e| failed(&e))?;
        let cache = self.cache_mut();
        cache.quantise(components.clone());
        if let Some(habits) = opened.habits {
            cache.adopt(habits);
        }
        cache.load(opened.records);
        let handed = cache.records().len();
        self.sharing = opened.file.map(|file| Sharing { file, handed, trouble: false });
        Ok(())
    }

    /// Uses records as those of the ambient file will be used, from now on, and leaves it closed: what is estimated
    /// before it is shared is as what comes.
    pub fn foresee(&mut self, store: &Store<'_>) {
        let components = &self.options.spectrum.components(self.passes());
        if let Some(habits) = AmbientFile::habits(store.path, &self.opening(store, components)) {
            let own = &mut self.options.ambient;
            own.smoothing = own.smoothing.min(habits.smoothing);
            if !habits.ours {
                own.systems.step_test = StepTest::Off;
                if own.systems.clamping == Clamping::Deeper {
                    own.systems.clamping = Clamping::Nobody;
                }
            }
            self.cache_mut().adopt(habits);
        }
    }

    fn opening<'a>(&self, store: &Store<'a>, components: &'a Components) -> Opening<'a> {
        let Store { header, fingerprint, reuse, owner, .. } = *store;
        let splits = self.options.spectrum.limits();
        let (observer, fingerprint, patience) = (tristimulus, Some(fingerprint), PATIENCE);
        Opening { header, components, splits, observer, fingerprint, reuse, patience, owner }
    }

    /// Hands records computed since the last call to the ambient file, and takes in those of others.
    ///
    /// A file that cannot be written is no reason to lose a picture: the records wait, a warning tells, and what is
    /// still waiting in the end is an error then.
    pub(crate) fn exchange(&mut self, notify: &dyn Notify, last: bool) -> Result<(), Error> {
        let Some(mut sharing) = self.sharing.take() else { return Ok(()) };
        let records = self.cache().records();
        let mut outcome = sharing.file.append(&records[sharing.handed..], notify);
        sharing.handed = records.len();
        if last && let Ok(mut first) = outcome {
            outcome = sharing.file.sync(notify).map(|more| {
                first.extend(more);
                first
            });
        }
        match outcome {
            Ok(foreign) => {
                if !foreign.is_empty() {
                    self.cache_mut().load(foreign);
                    sharing.handed = self.cache().records().len();
                }
                sharing.trouble = false;
            }
            Err(e) if last => return Err(failed(&e)),
            Err(e) => {
                if !std::mem::replace(&mut sharing.trouble, true) {
                    notify.warn(&format!("{e}; they are kept in memory"));
                }
            }
        }
        if last {
            sharing.file.close();
        } else {
            self.sharing = Some(sharing);
        }
        Ok(())
    }

    /// Writes what the ambient file still waits for. Call it before the program ends, whatever the reason.
    pub fn finish(&mut self, notify: &dyn Notify) -> Result<(), Error> {
        self.exchange(notify, true)
    }
}

fn failed(e: &FileError) -> Error {
    match e {
        FileError::Incompatible { .. } | FileError::Unfit { .. } => Error::user(e.to_string()),
        _ => Error::system(e.to_string()),
    }
}
