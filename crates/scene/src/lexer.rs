//! Words, numbers, comments and commands of scene text (scene.md 1 and 2), read from bytes in memory.

use std::borrow::Cow;

/// Longest word, in bytes; the next byte is lost and a new word begins after it.
const MAX_WORD: usize = 511;

/// Longest comment after its `#`; what follows is scene text.
const MAX_COMMENT: usize = 2047;

/// Longest command, its `!` and continuation lines included; what follows is scene text.
const MAX_COMMAND: usize = 2047;

/// White space between words.
#[inline]
pub(crate) fn is_white(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

fn newlines(bytes: &[u8]) -> u32 {
    bytes.iter().map(|&b| u32::from(b == b'\n')).sum()
}

/// A place in the bytes, walked forwards.
#[derive(Debug)]
pub(crate) struct Lexer<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Where the latest word began.
    word_start: usize,
    /// Lines are counted only up to where someone asked.
    counted: usize,
    line: u32,
}

/// A word without its quotes.
#[derive(Debug)]
pub(crate) struct Word<'a> {
    pub(crate) bytes: Cow<'a, [u8]>,
    /// True if some of it stood in quotes; only then can it contain white space.
    pub(crate) quoted: bool,
}

impl<'a> Lexer<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0, word_start: 0, counted: 0, line: 1 }
    }

    /// Skips white space; gives the byte after it without consuming it.
    #[inline]
    pub(crate) fn skip_white(&mut self) -> Option<u8> {
        while let Some(&byte) = self.bytes.get(self.position) {
            if !is_white(byte) {
                return Some(byte);
            }
            self.position += 1;
        }
        None
    }

    /// Line of the present position, from 1.
    pub(crate) fn line(&mut self) -> u32 {
        self.line += newlines(&self.bytes[self.counted..self.position]);
        self.counted = self.position;
        self.line
    }

    /// Line and column (in bytes) at which the latest word began, both from 1.
    pub(crate) fn place(&self) -> (u32, u32) {
        let before = &self.bytes[..self.word_start];
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        (newlines(before) + 1, (self.word_start - start) as u32 + 1)
    }

    /// The next word; `None` at the end.
    #[inline]
    pub(crate) fn word(&mut self) -> Option<Word<'a>> {
        self.skip_white();
        self.word_start = self.position;
        let rest = &self.bytes[self.position..];
        let end = rest.iter().position(|&b| is_white(b) || b == b'"' || b == b'\'').unwrap_or(rest.len());
        if end == 0 && rest.is_empty() {
            return None;
        }
        let quoted = rest.get(end).is_some_and(|&b| !is_white(b));
        if !quoted && end <= MAX_WORD {
            self.position += end;
            return Some(Word { bytes: Cow::Borrowed(&rest[..end]), quoted: false });
        }
        Some(self.long_word())
    }

    /// A word with quotes in it, or one that may be too long.
    #[cold]
    fn long_word(&mut self) -> Word<'a> {
        let mut bytes = Vec::new();
        let mut quoted = false;
        let mut quote = None;
        while let Some(&byte) = self.bytes.get(self.position) {
            if quote.is_none() && is_white(byte) {
                break;
            }
            self.position += 1;
            if quote == Some(byte) {
                quote = None;
            } else if quote.is_none() && matches!(byte, b'"' | b'\'') {
                quote = Some(byte);
                quoted = true;
            } else if bytes.len() == MAX_WORD {
                break;
            } else {
                bytes.push(byte);
            }
        }
        Word { bytes: Cow::Owned(bytes), quoted }
    }

    /// A real number filling the next word.
    #[inline]
    pub(crate) fn real(&mut self) -> Option<f64> {
        self.skip_white();
        let rest = &self.bytes[self.position..];
        if let Some((value, length)) = short_decimal(rest) {
            self.word_start = self.position;
            self.position += length;
            return Some(value);
        }
        parse_real(&self.word()?.bytes)
    }

    /// A count filling the next word: not negative, wrapped to 32 bits.
    pub(crate) fn count(&mut self) -> Option<usize> {
        usize::try_from(parse_integer(&self.word()?.bytes)?).ok()
    }

    /// From `#` through the end of the line.
    pub(crate) fn skip_comment(&mut self) {
        let rest = &self.bytes[self.position + 1..];
        let rest = &rest[..rest.len().min(MAX_COMMENT)];
        let length = rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |i| i + 1);
        self.position += 1 + length;
    }

    /// From `!` to the end of the line, continuation lines included. Line ends inside become `\n`; the backslashes before
    /// them stay, for the shell to remove.
    pub(crate) fn command(&mut self) -> Vec<u8> {
        self.word_start = self.position;
        let mut text = Vec::new();
        while text.len() < MAX_COMMAND {
            let Some(&byte) = self.bytes.get(self.position) else { break };
            self.position += 1;
            if byte != b'\n' && byte != b'\r' {
                text.push(byte);
                continue;
            }
            if byte == b'\r' && self.bytes.get(self.position) == Some(&b'\n') {
                self.position += 1;
            }
            if text.last() != Some(&b'\\') {
                break;
            }
            text.push(b'\n');
        }
        text
    }
}

/// The number at the start of `bytes` and its length, if it is one of the common kind: no exponent, few digits, white
/// space after it. An integer below 2⁵³ divided by a power of ten up to 10²² is correctly rounded, both being exact
/// (Clinger 1990), so this equals what [`parse_real`] gives, in a third of the time.
#[inline]
fn short_decimal(bytes: &[u8]) -> Option<(f64, usize)> {
    /// As many digits as always fit 2⁵³.
    const MAX_DIGITS: usize = 15;
    const POWERS: [f64; MAX_DIGITS + 1] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let negative = *bytes.first()? == b'-';
    let start = usize::from(negative);
    let mut mantissa = 0u64;
    let mut point = None;
    let mut at = start;
    loop {
        // The end of the text is left to the slow path.
        let byte = *bytes.get(at)?;
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        } else if byte == b'.' && point.is_none() {
            point = Some(at);
        } else if is_white(byte) {
            break;
        } else {
            return None;
        }
        at += 1;
    }
    let digits = at - start - usize::from(point.is_some());
    if digits == 0 || digits > MAX_DIGITS {
        return None;
    }
    let decimals = point.map_or(0, |p| at - p - 1);
    let value = mantissa as f64 / POWERS[decimals];
    Some((if negative { -value } else { value }, at))
}

/// `[+-]? (digit+ [. digit*] | . digit+) ([eE] [+-]? digit+)?`, after optional white space (that only quotes let in).
/// Too large numbers become infinite.
pub(crate) fn parse_real(word: &[u8]) -> Option<f64> {
    let word = word.trim_ascii_start();
    // Of what Rust takes, this keeps out only "inf" and "nan"; all else that passes here has our syntax.
    let plain = word.iter().all(|&b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E'));
    if !plain {
        return None;
    }
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// `[+-]? digit+`, after optional white space; held to 64 bits, then wrapped to 32.
pub(crate) fn parse_integer(word: &[u8]) -> Option<i32> {
    let word = word.trim_ascii_start();
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let value = digits.iter().fold(0i64, |n, &d| {
        let digit = i64::from(d - b'0');
        let n = n.saturating_mul(10);
        if negative { n.saturating_sub(digit) } else { n.saturating_add(digit) }
    });
    Some(value as i32)
}
