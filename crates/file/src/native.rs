//! Names of files as text. Unix allows any bytes in them; text keeps those that are not UTF-8 as characters of a private
//! area, which stand for nothing else here: [`text_of`] loses nothing, and [`bytes_of`] brings everything back.
//!
//! Whatever comes from outside (arguments, variables, words of files) and may name a file becomes text by the first;
//! whatever goes out (paths, headers, messages) becomes bytes again by the second.

use std::borrow::Cow;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};

/// The byte b stands as this character plus b. Bytes that are not UTF-8 are 128 and more.
const AREA: u32 = 0x10_ff00;
/// The first character that stands for a byte; the last is the last that there is.
const FIRST: char = '\u{10ff80}';

/// Text for bytes.
pub fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) if !text.contains(stands_for_byte) => Cow::Borrowed(text),
        _ => Cow::Owned(escaped(bytes)),
    }
}

fn escaped(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    let escape = |text: &mut String, bytes: &[u8]| text.extend(bytes.iter().filter_map(|&b| byte_character(b)));
    for chunk in bytes.utf8_chunks() {
        for c in chunk.valid().chars() {
            if stands_for_byte(c) {
                // Its own bytes, one by one: it stood for nothing.
                escape(&mut text, c.encode_utf8(&mut [0; 4]).as_bytes());
            } else {
                text.push(c);
            }
        }
        escape(&mut text, chunk.invalid());
    }
    text
}

fn byte_character(byte: u8) -> Option<char> {
    char::from_u32(AREA + u32::from(byte))
}

fn stands_for_byte(c: char) -> bool {
    c >= FIRST
}

/// The bytes that text stands for.
pub fn bytes_of(text: &str) -> Cow<'_, [u8]> {
    if !text.contains(stands_for_byte) {
        return Cow::Borrowed(text.as_bytes());
    }
    let mut bytes = Vec::with_capacity(text.len());
    for c in text.chars() {
        if stands_for_byte(c) {
            bytes.push((u32::from(c) - AREA) as u8);
        } else {
            bytes.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes());
        }
    }
    Cow::Owned(bytes)
}

/// The path that text stands for.
pub fn path_of(text: &str) -> PathBuf {
    PathBuf::from(OsString::from_vec(bytes_of(text).into_owned()))
}

/// Text for a path.
pub fn name_of(path: &Path) -> Cow<'_, str> {
    text_of(path.as_os_str().as_bytes())
}

/// Text for an argument or a variable.
pub fn word_of(word: &OsStr) -> String {
    text_of(word.as_bytes()).into_owned()
}

/// The value of an environment variable, as text.
pub fn variable(name: &str) -> Option<String> {
    std::env::var_os(name).map(|value| word_of(&value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn plain_text_is_itself() {
        for text in ["", "scene.oct", "Küche/Fenster ⅓.rad", "\u{10ff7f}"] {
            assert!(matches!(text_of(text.as_bytes()), Cow::Borrowed(t) if t == text));
            assert!(matches!(bytes_of(text), Cow::Borrowed(b) if b == text.as_bytes()));
        }
        assert_eq!(text_of(b"sc\xff.oct").chars().count(), 7);
    }

    proptest! {
        #[test]
        fn bytes_come_back(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            let text = text_of(&bytes);
            prop_assert_eq!(&*bytes_of(&text), &bytes[..]);
        }

        #[test]
        fn so_do_the_characters_of_the_area(text in "[a\u{10ff00}-\u{10ffff}é]{0,9}") {
            let kept = text_of(text.as_bytes());
            prop_assert_eq!(&*bytes_of(&kept), text.as_bytes());
            let bytes = bytes_of(&text);
            let again = text_of(&bytes);
            prop_assert_eq!(&*bytes_of(&again), &*bytes);
        }
    }
}
