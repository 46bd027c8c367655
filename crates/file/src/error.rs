//! What may go wrong with a file, with its name and what was expected.

use std::io;

/// A file that could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused; `action` reads like `cannot open view file`.
    #[error("{action} \"{file}\": {}", os_text(source))]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file as the user named it.
        file: String,
        /// Why it failed.
        source: io::Error,
    },
    /// The file of an argument `@file` (or a variable `$VAR`) is not there.
    #[error("cannot expand '{word}': {}", os_text(source))]
    Expand {
        /// The argument, with its first character.
        word: String,
        /// Why it failed.
        source: io::Error,
    },
    /// The information header is missing or has no end.
    #[error("{file}: bad header: expected {expected}")]
    Header {
        /// The file as the user named it.
        file: String,
        /// What was expected.
        expected: &'static str,
    },
    /// The header's `FORMAT=` is not one that can be read here.
    #[error("{file}: FORMAT={found} (expected {expected})")]
    Format {
        /// The file as the user named it.
        file: String,
        /// The value that stands there.
        found: String,
        /// The values that would do.
        expected: &'static str,
    },
    /// The resolution string is missing or malformed.
    #[error("{file}: bad resolution string '{found}' (expected something like '-Y 512 +X 512')")]
    Resolution {
        /// The file as the user named it.
        file: String,
        /// What stands in its place.
        found: String,
    },
    /// A view file without any view option.
    #[error("bad view file \"{file}\"")]
    NoView {
        /// The file as the user named it.
        file: String,
    },
    /// A scanline that can not be decoded.
    #[error("{file}: scanline {scanline}: found {problem}")]
    Scanline {
        /// The file as the user named it.
        file: String,
        /// Number of the scanline in the file, from 0.
        scanline: u32,
        /// What was found instead of pixels.
        problem: String,
    },
}

impl Error {
    /// Wraps an error of the operating system.
    pub fn io(action: &'static str, file: &str, source: io::Error) -> Self {
        Self::Io { action, file: file.to_owned(), source }
    }

    /// What is wrong, without the file's name, for messages that have it already.
    pub fn problem(&self) -> String {
        match self {
            Self::Io { action, source, .. } => format!("{action}: {}", os_text(source)),
            Self::Header { expected, .. } => format!("bad header: expected {expected}"),
            Self::Format { found, expected, .. } => format!("FORMAT={found}, expected {expected}"),
            Self::Resolution { found, .. } => format!("bad resolution string '{found}'"),
            Self::Scanline { scanline, problem, .. } => format!("scanline {scanline}: {problem}"),
            Self::Expand { .. } | Self::NoView { .. } => self.to_string(),
        }
    }
}

/// What the system says about an error, without the number that the standard library appends.
pub fn os_text(error: &io::Error) -> String {
    let text = error.to_string();
    match (error.raw_os_error(), text.rfind(" (os error ")) {
        (Some(_), Some(at)) => text[..at].to_owned(),
        _ => text,
    }
}
