//! What may go wrong with an ambient file.

use ambit_file::os_text;
use std::io;

/// An ambient file that cannot be used, or not any longer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The operating system refused; `action` is "open", "read", "lock" or the like.
    #[error("cannot {action} ambient file \"{file}\": {}", os_text(source))]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file as the user named it.
        file: String,
        /// Why it failed.
        source: io::Error,
    },
    /// Not an ambient file, or of a version that is not known.
    #[error("bad/incompatible ambient file \"{file}\": {problem}")]
    Incompatible {
        /// The file as the user named it.
        file: String,
        /// What was found and what was expected.
        problem: String,
    },
    /// Records could not be written. None is lost: they are kept, and the file ends with a whole record.
    #[error("cannot write {records} records to ambient file \"{file}\": {}", os_text(source))]
    Write {
        /// The file as the user named it.
        file: String,
        /// How many records are waiting.
        records: usize,
        /// Why it failed.
        source: io::Error,
    },
    /// The file is of another scene or of other parameters, which the user does not tolerate.
    #[error("ambient file \"{file}\" does not fit: {problem}")]
    Unfit {
        /// The file as the user named it.
        file: String,
        /// What differs.
        problem: String,
    },
    /// Another program shortened the file to less than its header.
    #[error("ambient file \"{file}\" was truncated by another program")]
    Truncated {
        /// The file as the user named it.
        file: String,
    },
}
