//! Where in a text something stands, and the channel that warnings go through.

use std::fmt;

/// A place in a scene or data file, counted from 1; line 0 means the whole file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// The file as the user named it, `standard input`, or the text of a `!command`.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// Column in bytes, from 1; 0 if unknown.
    pub column: u32,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
            if self.column > 0 {
                write!(f, ":{}", self.column)?;
            }
        }
        Ok(())
    }
}

/// Receives warnings; libraries never write to standard error themselves.
pub trait Notify: Sync {
    /// One warning, without program name or class word.
    fn warn(&self, text: &str);
}

/// Drops every warning.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Notify for Silent {
    fn warn(&self, _: &str) {}
}
