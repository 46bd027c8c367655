//! Primitives as `xform` reads and writes them: their modifiers are only names.

use crate::grammar::is_white;
use crate::lexer::Lexer;
use crate::print::print_word;
use crate::reader::arguments;
use crate::{Class, Kind};
use std::borrow::Cow;
use std::io::Write;

/// A primitive of scene text.
#[derive(Clone)]
pub(super) struct Primitive {
    pub(super) modifier: Vec<u8>,
    pub(super) kind: Kind,
    pub(super) name: Vec<u8>,
    /// An alias's only one is what it stands for.
    pub(super) strings: Vec<Vec<u8>>,
    pub(super) reals: Vec<f64>,
    /// Decimals of the reals beside the first digit.
    pub(super) decimals: usize,
}

/// Decimals of `xform`'s numbers: 12 digits, and for what it calculates of light 6.
const DECIMALS: usize = 11;
pub(super) const FEW_DECIMALS: usize = 5;

impl Primitive {
    /// Reads one; `None` if it is malformed, or has words that mean trouble.
    pub(super) fn read(lexer: &mut Lexer<'_>) -> Option<Self> {
        let mut word = || lexer.word().map(Cow::into_owned).filter(|w| is_simple(w));
        let (modifier, kind, name) = (word()?, Kind::from_name(&word()?)?, word()?);
        let (strings, reals) = if kind == Kind::Alias {
            (vec![word()?], Vec::new())
        } else {
            let mut reals = Vec::new();
            let strings = arguments(lexer, &mut reals)?;
            (strings.into_iter().map(Cow::into_owned).collect(), reals)
        };
        Some(Self { modifier, kind, name, strings, reals, decimals: DECIMALS })
    }

    /// True for what has a place in space.
    pub(super) fn is_surface(&self) -> bool {
        matches!(self.kind.class(), Class::Surface | Class::Volume)
    }

    /// Writes it as scene text with rounded numbers; `None` if one has become infinite.
    pub(super) fn print(&self, text: &mut Vec<u8>) -> Option<()> {
        if !self.reals.iter().all(|x| x.is_finite()) {
            return None;
        }
        print_word(&self.modifier, text).ok()?;
        write!(text, " {} ", self.kind.name()).ok()?;
        print_word(&self.name, text).ok()?;
        if self.kind != Kind::Alias {
            write!(text, " {}", self.strings.len()).ok()?;
        }
        for word in &self.strings {
            text.push(b' ');
            print_word(word, text).ok()?;
        }
        if self.kind != Kind::Alias {
            write!(text, " 0 {}", self.reals.len()).ok()?;
        }
        for x in &self.reals {
            write!(text, " {x:.*e}", self.decimals).ok()?;
        }
        text.push(b'\n');
        Some(())
    }
}

/// True for words that come out of `xform` as they went in.
pub(super) fn is_simple(word: &[u8]) -> bool {
    !word.is_empty()
        && !matches!(word[0], b'#' | b'!')
        && !word.iter().any(|&b| is_white(b) && b != b' ' || matches!(b, b'"' | b'\''))
}
