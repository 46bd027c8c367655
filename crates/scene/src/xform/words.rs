//! Command lines that need no shell: words, quoted perhaps, with one pipe at most that matters.

/// A command line.
pub(super) struct Pipe<'a> {
    /// What the last program reads, if that is what others print.
    pub(super) before: Option<&'a [u8]>,
    /// The last program's call, as it stands.
    pub(super) last: &'a [u8],
    /// Its words.
    pub(super) words: Vec<Vec<u8>>,
}

/// Words with which a shell begins something else than a program.
const KEYWORDS: [&[u8]; 13] =
    [b"case", b"do", b"done", b"elif", b"else", b"esac", b"fi", b"for", b"if", b"then", b"time", b"until", b"while"];

/// Bytes that mean nothing to a shell, wherever they stand.
fn is_plain(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"_-+./,:=@%^".contains(&byte)
}

/// Takes a command line apart, if the last of its programs is called in plain words. What stands before it may use what a
/// word may hold in a shell, but for what would make the last `|` anything but a pipe.
pub(super) fn split(command: &[u8]) -> Option<Pipe<'_>> {
    let mut before = None;
    let mut words = Vec::new();
    let mut word: Option<Vec<u8>> = None;
    // True if the words so far are plain.
    let mut plain = true;
    let mut at = 0;
    while let Some(&byte) = command.get(at) {
        at += 1;
        match byte {
            b' ' | b'\t' => words.extend(word.take()),
            b'\\' if matches!(command.get(at), Some(b'\n' | b'\r')) => {
                at += 1 + usize::from(command[at..].starts_with(b"\r\n"));
            }
            b'"' | b'\'' => {
                let length = command[at..].iter().position(|&b| b == byte)?;
                let quoted = &command[at..at + length];
                if byte == b'"' && quoted.iter().any(|b| b"$`\\".contains(b)) {
                    return None;
                }
                word.get_or_insert_default().extend_from_slice(quoted);
                at += length + 1;
            }
            // Two of them, or one with an ampersand, are something else.
            b'|' if !matches!(command.get(at), Some(b'|' | b'&')) => {
                words.extend(word.take());
                if words.first().is_none_or(|first: &Vec<u8>| KEYWORDS.contains(&&first[..])) {
                    return None;
                }
                before = Some(&command[..at - 1]);
                words.clear();
                plain = true;
            }
            b if is_plain(b) => word.get_or_insert_default().push(b),
            b'*' | b'?' | b'[' | b']' | b'~' => {
                plain = false;
                word.get_or_insert_default().push(byte);
            }
            _ => return None,
        }
    }
    words.extend(word);
    (plain && words.first().is_some_and(|w| w == b"xform")).then(|| Pipe {
        before,
        last: &command[before.map_or(0, |b| b.len() + 1)..],
        words,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(command: &str) -> Option<(Option<&str>, String)> {
        let pipe = split(command.as_bytes())?;
        let words: Vec<&str> = pipe.words.iter().map(|w| std::str::from_utf8(w).unwrap()).collect();
        Some((pipe.before.map(|b| std::str::from_utf8(b).unwrap()), words.join("|")))
    }

    #[test]
    fn plain_words_need_no_shell() {
        for (command, before, words) in [
            (" xform -t 1 2 3 a.rad ", None, "xform|-t|1|2|3|a.rad"),
            ("xform -n 'a b' \"c\"'d'e", None, "xform|-n|a b|cde"),
            ("xform \\\n\t-rz 90 x", None, "xform|-rz|90|x"),
            ("genbox m b 1 1 1 | xform -s 2", Some("genbox m b 1 1 1 "), "xform|-s|2"),
            ("genrev m b t*1.71 '(1|2)' 32|xform -s 2", Some("genrev m b t*1.71 '(1|2)' 32"), "xform|-s|2"),
            ("cat x | grep a | xform", Some("cat x | grep a "), "xform"),
        ] {
            assert_eq!(parts(command), Some((before, words.to_owned())), "{command}");
        }
    }

    #[test]
    fn all_else_does() {
        for command in [
            "",
            "genbox m b 1 1 1",
            "xform $X a",
            "xform \"$X\" a",
            "xform a; xform b",
            "xform a & xform b",
            "xform a && xform b",
            "a || xform b",
            "a |& xform b",
            "xform a > b",
            "xform *.rad",
            "xform a?",
            "xform ~/a",
            "xform `a`",
            "(xform a)",
            "xform a # b",
            "xform a\\ b",
            "xform 'a",
            "X=1 xform a",
            "/bin/xform a",
            "xform a | grep b",
            "| xform a",
            "a | | xform b",
            "if true | xform b",
            "xform a\nxform b",
        ] {
            assert_eq!(parts(command), None, "{command}");
        }
    }
}
