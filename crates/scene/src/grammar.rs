//! The grammar of scene text below primitives (scene.md 1 and 2): blanks, words, numbers, comments and commands, as nom
//! parsers over bytes. None of them copies what it need not, and an error is only "not here": the reader says what was
//! expected and where.

use nom::branch::alt;
use nom::bytes::complete::{tag, take_till, take_till1, take_while};
use nom::character::complete::{char, digit0, digit1, one_of};
use nom::combinator::{all_consuming, opt, peek, recognize};
use nom::sequence::{delimited, preceded};
use nom::{IResult, Offset, Parser};

/// Longest word, in bytes; the next byte is lost and a new word begins after it.
const MAX_WORD: usize = 511;

/// Longest comment after its `#`; what follows is scene text.
const MAX_COMMENT: usize = 2047;

/// Longest command, its `!` and continuation lines included; what follows is scene text.
const MAX_COMMAND: usize = 2047;

/// Bytes still to be read.
pub(crate) type Text<'a> = &'a [u8];

/// What was read and the bytes after it, or that it is not here.
pub(crate) type Parsed<'a, T> = IResult<Text<'a>, T, ()>;

/// White space between words.
#[inline]
pub(crate) fn is_white(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

fn is_quote(byte: u8) -> bool {
    matches!(byte, b'"' | b'\'')
}

/// White space, or none.
#[inline]
pub(crate) fn white(text: Text<'_>) -> Parsed<'_, Text<'_>> {
    take_while(is_white).parse(text)
}

/// A word without quotes that is short enough to be taken as it stands: what nearly all are.
#[inline]
pub(crate) fn plain_word(text: Text<'_>) -> Parsed<'_, Text<'_>> {
    let (rest, word) = take_till1(|b| is_white(b) || is_quote(b)).parse(text)?;
    if word.len() > MAX_WORD || rest.first().is_some_and(|b| is_quote(*b)) { absent() } else { Ok((rest, word)) }
}

/// Any word: text and quoted text, one after the other, quotes removed. A quote that is not closed reaches to the end.
#[cold]
pub(crate) fn composed_word(text: Text<'_>) -> Parsed<'_, Vec<u8>> {
    let quoted = |quote| delimited(char(quote), take_till(move |b| b == quote as u8), opt(char(quote)));
    let mut piece = alt((quoted('"'), quoted('\''), take_till1(|b| is_white(b) || is_quote(b))));
    let (mut rest, first) = piece.parse(text)?;
    let mut next = Some(first);
    let mut word = Vec::new();
    while let Some(part) = next {
        let room = MAX_WORD - word.len();
        if part.len() > room {
            word.extend_from_slice(&part[..room]);
            return Ok((&text[text.offset(part) + room + 1..], word));
        }
        word.extend_from_slice(part);
        (rest, next) = opt(|t| piece.parse(t)).parse(rest)?;
    }
    Ok((rest, word))
}

/// From `#` through the end of the line.
pub(crate) fn comment(text: Text<'_>) -> Parsed<'_, ()> {
    let (rest, _) = char('#').parse(text)?;
    let near = &rest[..rest.len().min(MAX_COMMENT)];
    let (left, _) = (take_till(|b| b == b'\n'), opt(char('\n'))).parse(near)?;
    Ok((&rest[near.len() - left.len()..], ()))
}

/// From `!` to the end of the line, continuation lines included. Line ends inside become `\n`; the backslashes before
/// them stay, for the shell to remove.
pub(crate) fn command(text: Text<'_>) -> Parsed<'_, Vec<u8>> {
    peek(char('!')).parse(text)?;
    let line_end = || alt((tag("\r\n"), tag("\n"), tag("\r")));
    let mut command = Vec::new();
    let mut rest = text;
    while command.len() < MAX_COMMAND {
        let near = &rest[..rest.len().min(MAX_COMMAND - command.len())];
        let (_, line) = take_till(|b| matches!(b, b'\n' | b'\r')).parse(near)?;
        command.extend_from_slice(line);
        rest = &rest[line.len()..];
        if command.len() == MAX_COMMAND {
            break;
        }
        let ended;
        (rest, ended) = opt(line_end()).parse(rest)?;
        if ended.is_none() || command.last() != Some(&b'\\') {
            break;
        }
        command.push(b'\n');
    }
    Ok((rest, command))
}

/// A number of the common kind, white space after it: equal to what [`real`] gives, in a third of the time.
#[inline]
pub(crate) fn short_decimal(text: Text<'_>) -> Parsed<'_, f64> {
    let Some((value, length)) = ambit_file::short_decimal(text) else { return absent() };
    let rest = &text[length..];
    if rest.first().is_some_and(|b| is_white(*b)) { Ok((rest, value)) } else { absent() }
}

/// `-`, `+` or nothing; true for `-`.
#[expect(clippy::unnecessary_wraps, reason = "a parser among parsers")]
#[inline]
fn sign(text: Text<'_>) -> Parsed<'_, bool> {
    match text {
        [b'-', rest @ ..] => Ok((rest, true)),
        [b'+', rest @ ..] => Ok((rest, false)),
        _ => Ok((text, false)),
    }
}

/// `[+-]? (digit+ [. digit*] | . digit+) ([eE] [+-]? digit+)?`, after optional white space (that only quotes let in),
/// filling the word. Too large numbers become infinite.
pub fn real(word: Text<'_>) -> Option<f64> {
    let mantissa = alt((recognize((digit1, opt((char('.'), digit0)))), recognize((char('.'), digit1))));
    let exponent = opt((one_of("eE"), sign, digit1));
    let number = preceded(white, recognize((sign, mantissa, exponent)));
    let (_, number) = all_consuming(number).parse(word).ok()?;
    // Ours is a part of Rust's grammar, so this does not fail.
    std::str::from_utf8(number).ok()?.parse().ok()
}

/// `[+-]? digit+`, after optional white space, filling the word; held to 64 bits, then wrapped to 32.
pub(crate) fn integer(word: Text<'_>) -> Option<i32> {
    let (_, (negative, digits)) = all_consuming(preceded(white, (sign, digit1))).parse(word).ok()?;
    let value = digits.iter().fold(0i64, |n, &d| {
        let (n, digit) = (n.saturating_mul(10), i64::from(d - b'0'));
        if negative { n.saturating_sub(digit) } else { n.saturating_add(digit) }
    });
    Some(value as i32)
}

/// That something is not here.
fn absent<'a, T>() -> Parsed<'a, T> {
    Err(nom::Err::Error(()))
}
