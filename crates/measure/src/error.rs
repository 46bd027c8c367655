//! What may go wrong in a measurement.

use std::io;

/// A measurement that could not be made; the text says what was expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A line of the ladder that is no rung.
    #[error("{file}, line {line}: {problem}")]
    Ladder {
        /// The file as the user named it.
        file: String,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// A value that is no finite number.
    #[error("{what}: value {index} is not finite ({value})")]
    NotFinite {
        /// What was computed, with its options.
        what: String,
        /// Number of the pixel or sensor, from 0, in the order of the output.
        index: usize,
        /// The value.
        value: f32,
    },
    /// Two results that should be of equal size are not.
    #[error("{what}: {found} values (expected {expected}, as the reference has)")]
    Size {
        /// What was computed.
        what: String,
        /// Values there are.
        found: usize,
        /// Values there should be.
        expected: usize,
    },
    /// A reference that can not be used.
    #[error("reference {file}: {problem}")]
    Reference {
        /// The file as the user named it.
        file: String,
        /// What is wrong, and what was expected.
        problem: String,
    },
    /// The reference is black, so that nothing can be said relative to its mean.
    #[error("the mean of the reference is {mean:e} (expected a positive number: errors are relative to it)")]
    Black {
        /// The mean over all values and channels.
        mean: f64,
    },
    /// Two passes that should be independent are the same numbers.
    #[error("{program}: two passes of the reference are equal, bit by bit: they say nothing about its noise")]
    EqualPasses {
        /// The program that made them.
        program: String,
    },
    /// A program could not be run or failed.
    #[error("{0}")]
    Program(String),
    /// A file of the system could not be read or written.
    #[error("{file}: {}", ambit_file::os_text(source))]
    File {
        /// The file.
        file: String,
        /// Why.
        source: io::Error,
    },
    /// A result could not be written as text.
    #[error("cannot write {what}: {problem}")]
    Write {
        /// The form.
        what: &'static str,
        /// Why.
        problem: String,
    },
}
