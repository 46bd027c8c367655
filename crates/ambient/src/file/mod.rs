//! The ambient file: records shared between runs and between programs that run at the same time.
//!
//! A text header, a magic number of two bytes, then records of 67 bytes (those of a calculation by wavelength are longer) up to the end
//! of the file. The header tells, in
//! lines that Radiance passes over, what scene and parameters the records are of ([`Fingerprint`]); records of another
//! scene are left alone ([`Reuse`]).
//!
//! Everybody who writes holds an exclusive fcntl lock on the whole file, which Radiance's programs see and respect;
//! whoever reads holds a shared one. Whole records are appended in one call under the lock, after reading what others
//! appended; an incomplete record at the end is what a killed program left, and is cut off under the lock before
//! anything is written. Where the lock cannot be had, a process writes a file of its own beside it, a [`Segment`],
//! which whoever opens the ambient file later reads and merges.

mod error;
mod fingerprint;
mod habits;
mod open;
mod reuse;
mod scan;
mod segment;
mod share;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_reuse;
#[cfg(test)]
mod tests_segment;

pub use error::FileError;
pub use fingerprint::{Comparison, Fingerprint, Gravity, Mark, MarkLine, fingerprint_lines};
pub use habits::Habits;
pub use open::Opened;
pub use reuse::{Opening, PATIENCE, Reuse};
pub use scan::{Contents, FORMAT, scan, scan_header};
pub use segment::{Segment, missing, remove_done, segments};
pub use share::AmbientFile;
