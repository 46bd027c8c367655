//! White-space separated words with `#` comments, as data files and fonts have them.

use crate::grammar::is_white;
use ambit_base::Location;

/// Longest word of such files; what follows without white space makes it malformed.
const MAX_WORD: usize = 63;

/// The words of a file, one after the other.
#[derive(Debug)]
pub(crate) struct Tokens<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Where the latest word began.
    start: usize,
}

impl<'a> Tokens<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0, start: 0 }
    }

    /// The next word; `None` at the end. Words that are too long come in pieces that no number syntax accepts in full, so
    /// they are given as empty words.
    pub(crate) fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let &byte = self.bytes.get(self.position)?;
            if byte == b'#' {
                let rest = &self.bytes[self.position..];
                self.position += rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
            } else if is_white(byte) {
                self.position += 1;
            } else {
                break;
            }
        }
        self.start = self.position;
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|&b| is_white(b) || b == b'#').unwrap_or(rest.len());
        self.position += length;
        Some(if length > MAX_WORD { &[] } else { &rest[..length] })
    }

    /// True if nothing at all follows the latest word.
    pub(crate) fn at_end(&self) -> bool {
        self.position == self.bytes.len()
    }

    /// Where the latest word began.
    pub(crate) fn location(&self, file: &str) -> Location {
        let before = &self.bytes[..self.start];
        let line = before.split(|&b| b == b'\n').count() as u32;
        let column = before.iter().rev().take_while(|&&b| b != b'\n').count() as u32 + 1;
        Location { file: file.to_owned(), line, column }
    }
}
