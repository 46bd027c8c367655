//! A place in scene text, walked forwards word by word, that knows its line and column.

use crate::grammar::{self, Parsed, Text};
use std::borrow::Cow;

fn newlines(bytes: &[u8]) -> u32 {
    bytes.iter().map(|&b| u32::from(b == b'\n')).sum()
}

/// A place in the bytes, walked forwards.
#[derive(Debug)]
pub(crate) struct Lexer<'a> {
    bytes: Text<'a>,
    rest: Text<'a>,
    /// Where the latest word began.
    word_start: usize,
    /// Lines are counted only up to where someone asked.
    counted: usize,
    line: u32,
}

impl<'a> Lexer<'a> {
    pub(crate) fn new(bytes: Text<'a>) -> Self {
        Self { bytes, rest: bytes, word_start: 0, counted: 0, line: 1 }
    }

    fn position(&self) -> usize {
        self.bytes.len() - self.rest.len()
    }

    /// What a parser reads here, if it is here.
    #[inline]
    fn read<T>(&mut self, parser: impl FnOnce(Text<'a>) -> Parsed<'a, T>) -> Option<T> {
        let (rest, value) = parser(self.rest).ok()?;
        self.rest = rest;
        Some(value)
    }

    /// Skips white space; gives the byte after it without consuming it.
    #[inline]
    pub(crate) fn skip_white(&mut self) -> Option<u8> {
        self.read(grammar::white)?;
        self.rest.first().copied()
    }

    /// Line of the present position, from 1.
    pub(crate) fn line(&mut self) -> u32 {
        let position = self.position();
        self.line += newlines(&self.bytes[self.counted..position]);
        self.counted = position;
        self.line
    }

    /// Line and column (in bytes) at which the latest word began, both from 1.
    pub(crate) fn place(&self) -> (u32, u32) {
        let before = &self.bytes[..self.word_start];
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        (newlines(before) + 1, (self.word_start - start) as u32 + 1)
    }

    /// The next word without its quotes; `None` at the end.
    #[inline]
    pub(crate) fn word(&mut self) -> Option<Cow<'a, [u8]>> {
        self.skip_white();
        self.word_start = self.position();
        match self.read(grammar::plain_word) {
            Some(word) => Some(Cow::Borrowed(word)),
            None => self.read(grammar::composed_word).map(Cow::Owned),
        }
    }

    /// A real number filling the next word.
    #[inline]
    pub(crate) fn real(&mut self) -> Option<f64> {
        self.skip_white();
        let start = self.position();
        if let Some(value) = self.read(grammar::short_decimal) {
            self.word_start = start;
            return Some(value);
        }
        grammar::real(&self.word()?)
    }

    /// A count filling the next word: not negative, wrapped to 32 bits.
    pub(crate) fn count(&mut self) -> Option<usize> {
        usize::try_from(grammar::integer(&self.word()?)?).ok()
    }

    /// A comment, whose `#` is the next byte.
    pub(crate) fn skip_comment(&mut self) {
        self.read(grammar::comment);
    }

    /// A command, whose `!` is the next byte.
    pub(crate) fn command(&mut self) -> Vec<u8> {
        self.word_start = self.position();
        self.read(grammar::command).unwrap_or_default()
    }
}
