//! Words of command lines: what numbers look like, and the words that `@file` and `$VAR` stand for.

use crate::error::Error;
use crate::native::path_of;
use std::fs::File;
use std::io::{self, Read};

/// The most words that one file or variable stands for; the rest is dropped without a word.
pub const WORD_LIMIT: usize = 4095;

/// Longest argument file read, in bytes: more than the words that count can fill in practice.
const FILE_LIMIT: u64 = 1 << 26;

/// A real number as options write it: `[+-]digits[.digits][e[+-]digits]` with at least one digit before the exponent.
/// `nan`, `inf`, `0x2`, and numbers too large for a double are none.
pub fn real(word: &str) -> Option<f64> {
    boundless_real(word).filter(|v| v.is_finite())
}

/// As [`real`], but numbers too large for a double are infinite: among the rays of a list they keep their place.
pub fn boundless_real(word: &str) -> Option<f64> {
    let plain = word.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E'));
    if plain { word.parse().ok() } else { None }
}

/// A number of the common kind at the beginning of a text, without exponent and of few digits, and how many bytes it has.
/// What comes after it is not looked at. An integer below 2⁵³ divided by a power of ten up to 10²² is correctly rounded,
/// both being exact (Clinger 1990), so this is what the standard library reads.
#[inline]
pub fn short_decimal(text: &[u8]) -> Option<(f64, usize)> {
    /// As many digits as always fit 2⁵³.
    const MAX_DIGITS: usize = 15;
    const POWERS: [f64; MAX_DIGITS + 1] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let minus = usize::from(text.first() == Some(&b'-'));
    let (whole, digits) = digits(0, &text[minus..]);
    let mut length = minus + digits;
    let (mut value, mut decimals) = (whole, 0);
    if text.get(length) == Some(&b'.') {
        (value, decimals) = self::digits(whole, &text[length + 1..]);
        length += 1 + decimals;
    }
    let count = digits + decimals;
    if !(1..=MAX_DIGITS).contains(&count) {
        return None;
    }
    let value = value as f64 / POWERS[decimals];
    Some((if minus > 0 { -value } else { value }, length))
}

/// Digits, if there are any, appended to a number; wrapping if they are too many. And how many there are.
#[inline]
fn digits(mut number: u64, text: &[u8]) -> (u64, usize) {
    for (count, &byte) in text.iter().enumerate() {
        if !byte.is_ascii_digit() {
            return (number, count);
        }
        number = number.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
    }
    (number, text.len())
}

/// An integer as options write it: `[+-]digits`, within 32 bits as the programs hold it.
pub fn integer(word: &str) -> Option<i32> {
    word.parse().ok()
}

/// The words of a variable's value or of a file's text: white space separates, nothing quotes, nothing comments.
pub fn split_words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|b| b.is_ascii_whitespace() || *b == 0x0b).filter(|w| !w.is_empty()).take(WORD_LIMIT)
}

/// The words of a file named by an argument `@file`; they are not expanded further here.
pub fn read_words(file: &str) -> Result<Vec<Vec<u8>>, Error> {
    let failed = |e: io::Error| Error::Expand { word: format!("@{file}"), source: e };
    let mut text = Vec::new();
    File::open(path_of(file)).map_err(failed)?.take(FILE_LIMIT).read_to_end(&mut text).map_err(failed)?;
    Ok(split_words(&text).map(<[u8]>::to_vec).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_are_what_the_standard_library_reads() {
        for text in
            ["0", "-0", "5.", ".5", "-.5", "1.25", "007", "123456789012345", "-0.00000000000001", "3.1415926535897"]
        {
            for rest in ["", " 7", "\n", ",", "x"] {
                let (number, length) = short_decimal(format!("{text}{rest}").as_bytes()).expect(text);
                assert_eq!((number.to_bits(), length), (text.parse::<f64>().unwrap().to_bits(), text.len()), "{text}");
            }
        }
        for none in ["", "-", ".", "-.", "+1", "x", "1234567890123456", "0.0000000000000001", "99999999999999999999999"]
        {
            assert_eq!(short_decimal(none.as_bytes()), None, "{none}");
        }
    }

    #[test]
    fn numbers_are_those_of_option_values() {
        for word in ["1", "+1", "-.5", "1.", "1e-2", "1.5E+3", "007"] {
            assert!(real(word).is_some(), "{word}");
        }
        for word in ["", ".", "1e", "0x2", "inf", "nan", "1d0", "1 ", "--1", "1e999", "e5"] {
            assert!(real(word).is_none(), "{word}");
        }
        assert_eq!(integer("+7"), Some(7));
        for word in ["1.5", "1e1", "", "99999999999", "-", "0x1"] {
            assert!(integer(word).is_none(), "{word}");
        }
    }

    #[test]
    fn words_are_split_at_white_space_only() {
        let words: Vec<&[u8]> = split_words(b" -ab 2\n#x \"a b\"\t\r\n").collect();
        assert_eq!(words, [&b"-ab"[..], b"2", b"#x", b"\"a", b"b\""]);
        assert_eq!(split_words(&b"x ".repeat(5000)).count(), WORD_LIMIT);
    }

    #[test]
    fn files_are_read_and_named_when_missing() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("opts");
        std::fs::write(&path, "-x 4\n-y 4").unwrap();
        assert_eq!(read_words(path.to_str().unwrap()).unwrap().len(), 4);
        let e = read_words("/no/such/file").unwrap_err().to_string();
        assert_eq!(e, "cannot expand '@/no/such/file': No such file or directory");
    }
}
