//! Whether the records of an ambient file may be used by a run that has a fingerprint of its own.

use super::error::FileError;
use super::fingerprint::{Comparison, Fingerprint, Gravity};
use crate::components::Components;
use crate::conversion::Observer;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What is done with an ambient file that is there already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reuse {
    /// Records of the same light are used, with a warning where they are finer or coarser. A file of another scene is
    /// left alone, with a warning; the run uses a file of its own beside it. Files without a fingerprint are used.
    #[default]
    Auto,
    /// Anything but the same scene and the same parameters is an error, and so is a file without a fingerprint.
    Strict,
    /// All records are used and new ones added, whatever they are of.
    Append,
    /// As `Auto`, but nothing is written, and the file must be there.
    ReadOnly,
}

/// What a run brings to an ambient file.
#[derive(Clone, Copy, Debug)]
pub struct Opening<'a> {
    /// Lines of a new file's header after `#?RADIANCE`: the command with its options, `SOFTWARE=`, `CAPDATE=`, `GMT=`.
    /// The fingerprint, wavelengths, `NCOMP` and `FORMAT` follow by themselves.
    pub header: &'a [String],
    /// Where the components of a file's values stand in records.
    pub components: &'a Components,
    /// The wavelengths of components in nm: longest limit, red/green split, green/blue split, shortest limit.
    pub splits: [f64; 4],
    /// Who sees the spectra of a file as red, green and blue.
    pub observer: Observer,
    /// What the run's records depend on; `None` writes none and accepts all.
    pub fingerprint: Option<&'a Fingerprint>,
    /// What is done with records that are there.
    pub reuse: Reuse,
    /// How long to wait for the lock of the file before it is taken to be broken.
    pub patience: Duration,
    /// Names this process among all that share a file system, for the file it writes where there are no locks.
    pub owner: &'a str,
}

/// How long a lock is waited for unless a program knows better: writers hold it for milliseconds.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// What is to be done with a file.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Its records are used, perhaps with a warning.
    Use(Option<String>),
    /// It is left alone, because of what this lists.
    Leave(String),
}

impl Opening<'_> {
    /// Judges a file by its fingerprint.
    pub(super) fn judge(&self, compared: &Comparison, file: &str) -> Result<Verdict, FileError> {
        let refuse = |problem: String| Err(FileError::Unfit { file: file.to_owned(), problem });
        match self.reuse {
            Reuse::Append => Ok(Verdict::Use(None)),
            Reuse::Strict if !compared.marked => refuse("it has no fingerprint of what it was computed for".to_owned()),
            Reuse::Strict => match compared.list(Gravity::Slight) {
                Some(list) => refuse(format!("other {list}")),
                None => Ok(Verdict::Use(None)),
            },
            Reuse::Auto | Reuse::ReadOnly => match compared.list(Gravity::Decisive) {
                Some(list) => Ok(Verdict::Leave(list)),
                None => Ok(Verdict::Use(compared.list(Gravity::Accuracy).map(|list| {
                    format!("ambient file \"{file}\" was computed with other parameters: {list}; its values are used")
                }))),
            },
        }
    }

    /// Compares the run's fingerprint with a header's; without one of its own, everything fits.
    pub(super) fn compare(&self, header: &ambit_file::Header) -> Comparison {
        match self.fingerprint {
            Some(print) => print.compare(header),
            None => Comparison { marked: true, differences: Vec::new() },
        }
    }

    /// The file of this run beside one of another scene: `NAME.XXXXXXXX`, named by the fingerprint.
    pub(super) fn beside(&self, path: &Path) -> Option<PathBuf> {
        let mut name = path.as_os_str().to_owned();
        name.push(".");
        name.push(self.fingerprint?.short_name());
        Some(name.into())
    }
}
