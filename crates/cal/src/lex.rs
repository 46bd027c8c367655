//! Tokens of the language: blanks and comments, numbers, names, channels. Answers function-files.md section 1.

use nom::bytes::complete::{take_while, take_while1};
use nom::{IResult, Parser};

use crate::error::Problem;

/// Bytes still to be read.
pub(crate) type Text<'a> = &'a [u8];

/// A token or tree, or where and why there is none.
pub(crate) type Parsed<'a, T> = IResult<Text<'a>, T, Trouble>;

/// Characters of a name or number that count; the rest is read over.
const SIGNIFICANT: usize = 127;

/// Why parsing stopped, and how many bytes were left then.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Trouble {
    pub(crate) left: usize,
    pub(crate) problem: Problem,
}

impl nom::error::ParseError<Text<'_>> for Trouble {
    fn from_error_kind(input: Text<'_>, _: nom::error::ErrorKind) -> Self {
        Self { left: input.len(), problem: Problem::UnexpectedCharacter }
    }

    fn append(_: Text<'_>, _: nom::error::ErrorKind, other: Self) -> Self {
        other
    }
}

/// A failure at the head of `text`; alternatives are chosen by looking ahead, so none is ever retried.
pub(crate) fn fail<T>(text: Text<'_>, problem: Problem) -> Parsed<'_, T> {
    Err(nom::Err::Failure(Trouble { left: text.len(), problem }))
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | b'`')
}

/// Whether a name starts here.
pub(crate) fn starts_name(text: Text<'_>) -> bool {
    text.first().is_some_and(|byte| byte.is_ascii_alphabetic() || *byte == b'`')
}

/// Skips blanks and nested comments.
pub(crate) fn blanks(text: Text<'_>) -> Parsed<'_, ()> {
    let mut depth = 0_usize;
    for (at, byte) in text.iter().enumerate() {
        match byte {
            b'{' => depth += 1,
            b'}' if depth > 0 => depth -= 1,
            _ if depth > 0 || is_blank(*byte) => {}
            _ => return Ok((&text[at..], ())),
        }
    }
    let end = &text[text.len()..];
    if depth > 0 { fail(end, Problem::Expected("'}'")) } else { Ok((end, ())) }
}

/// Exactly this character, then blanks; otherwise the failure that names it.
pub(crate) fn expect<'a>(text: Text<'a>, byte: u8, quoted: &'static str) -> Parsed<'a, ()> {
    match text.split_first() {
        Some((first, rest)) if *first == byte => blanks(rest),
        _ => fail(text, Problem::Expected(quoted)),
    }
}

/// A name (section 1: letters, digits, `_`, `.` and back-quotes), cut to the significant length, then blanks. The
/// caller has seen that one starts here.
pub(crate) fn name(text: Text<'_>) -> Parsed<'_, String> {
    let (rest, word) = take_while1(is_name).parse(text)?;
    let word = word.iter().take(SIGNIFICANT).map(|byte| char::from(*byte)).collect();
    let (rest, ()) = blanks(rest)?;
    Ok((rest, word))
}

fn digits(text: Text<'_>) -> Parsed<'_, Text<'_>> {
    take_while(|byte: u8| byte.is_ascii_digit()).parse(text)
}

/// An unsigned decimal number, then blanks.
pub(crate) fn number(text: Text<'_>) -> Parsed<'_, f64> {
    let (mut rest, whole) = digits(text)?;
    let mut any = !whole.is_empty();
    if let Some(after) = rest.strip_prefix(b".") {
        let (after, fraction) = digits(after)?;
        any |= !fraction.is_empty();
        rest = after;
    }
    if !any {
        return fail(rest, Problem::BadNumber);
    }
    if let [b'e' | b'E', after @ ..] = rest {
        let after = after.strip_prefix(b"+").or_else(|| after.strip_prefix(b"-")).unwrap_or(after);
        let (after, exponent) = digits(after)?;
        if exponent.is_empty() {
            return fail(after, Problem::MissingExponent);
        }
        rest = after;
    }
    let value = value_of(&text[..text.len() - rest.len()]);
    let (rest, ()) = blanks(rest)?;
    Ok((rest, value))
}

/// The value of a number's significant characters; a cut may leave an exponent without digits, which then counts not.
fn value_of(word: Text<'_>) -> f64 {
    let word: String = word.iter().take(SIGNIFICANT).map(|byte| char::from(*byte)).collect();
    word.trim_end_matches(['+', '-']).trim_end_matches(['e', 'E']).parse().unwrap_or(0.0)
}

/// What follows `$`: a channel number, 0 if there is none, then blanks. Numbers beyond any channel saturate.
pub(crate) fn channel(text: Text<'_>) -> Parsed<'_, u32> {
    let (rest, ()) = blanks(text)?;
    let (rest, word) = digits(rest)?;
    let value = word.iter().fold(0_u32, |n, digit| n.saturating_mul(10).saturating_add(u32::from(digit - b'0')));
    let (rest, ()) = blanks(rest)?;
    Ok((rest, value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem<T: std::fmt::Debug>(parsed: Parsed<'_, T>) -> (usize, String) {
        match parsed {
            Err(nom::Err::Failure(trouble)) => (trouble.left, trouble.problem.to_string()),
            other => panic!("no failure: {other:?}"),
        }
    }

    #[test]
    fn numbers_follow_the_rules_of_the_language() {
        for (text, value, left) in
            [("1.", 1.0, 0), (".5", 0.5, 0), ("1e400", f64::INFINITY, 0), ("2.5.5", 2.5, 2), ("1e+2 x", 100.0, 1)]
        {
            let (rest, number) = number(text.as_bytes()).unwrap();
            assert_eq!((number, rest.len()), (value, left), "{text}");
        }
        assert_eq!(problem(number(b".")), (0, "badly formed number".into()));
        assert_eq!(problem(number(b"1e")), (0, "missing exponent".into()));
        assert_eq!(problem(number(b"2ex")), (1, "missing exponent".into()));
    }

    #[test]
    fn only_the_first_127_characters_of_a_number_count() {
        let long = format!("0.{}e5", "1".repeat(124));
        assert!((number(long.as_bytes()).unwrap().1 - 1.0 / 9.0).abs() < 1e-12, "the exponent's digits are cut off");
        assert!((number(&long.as_bytes()[1..]).unwrap().1 - 1e5 / 9.0).abs() < 1e-7, "here they just fit");
    }

    #[test]
    fn comments_nest_and_must_end() {
        assert_eq!(blanks(b" {a{b}c} \r\n+").unwrap().0, b"+");
        assert_eq!(blanks(b"}").unwrap().0, b"}");
        assert_eq!(problem(blanks(b"{ {a}")), (0, "'}' expected".into()));
    }

    #[test]
    fn channels_saturate() {
        assert_eq!(channel(b" 12 +").unwrap(), (&b"+"[..], 12));
        assert_eq!(channel(b"+").unwrap(), (&b"+"[..], 0));
        assert_eq!(channel(b"99999999999").unwrap().1, u32::MAX);
    }
}
