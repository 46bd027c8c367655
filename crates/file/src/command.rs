//! How a program records its command in a header: base name and arguments, separated by single blanks.

/// What follows the last `/`.
pub fn base_name(path: &[u8]) -> &[u8] {
    path.rsplit(|&b| b == b'/').next().unwrap_or(path)
}

/// The header line of a command (without newline): the program's base name and its arguments.
///
/// A word is quoted if it is empty, has white space, or has a quote anywhere but at its ends; with `"`, or with `'` if
/// such an inner quote is a `"`.
pub fn command_line<A: AsRef<[u8]>>(program: &[u8], arguments: impl IntoIterator<Item = A>) -> Vec<u8> {
    let mut line = Vec::new();
    push_word(&mut line, base_name(program));
    for word in arguments {
        line.push(b' ');
        push_word(&mut line, word.as_ref());
    }
    line
}

fn push_word(line: &mut Vec<u8>, word: &[u8]) {
    let inner = word.get(1..word.len().saturating_sub(1)).unwrap_or_default();
    let quote = if inner.contains(&b'"') {
        Some(b'\'')
    } else if inner.contains(&b'\'') || word.is_empty() || word.iter().any(|&b| b.is_ascii_whitespace() || b == 0x0b) {
        Some(b'"')
    } else {
        None
    };
    line.extend(quote);
    line.extend(word);
    line.extend(quote);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_as_oconv_quotes_them() {
        for (word, written) in [
            ("a.rad", "a.rad"),
            ("!cat a.rad", "\"!cat a.rad\""),
            ("", "\"\""),
            ("\"a b\"", "\"\"a b\"\""),
            ("a'b", "\"a'b\""),
            ("a\"b", "'a\"b'"),
            ("\"ab", "\"ab"),
            ("ab\"", "ab\""),
            ("\"ab\"", "\"ab\""),
            ("a b'c", "\"a b'c\""),
            ("a b\"c", "'a b\"c'"),
            ("a'b\"c", "'a'b\"c'"),
            ("'", "'"),
            ("''", "''"),
            ("'''", "\"'''\""),
        ] {
            let line = command_line(b"/usr/bin/oconv", [word]);
            assert_eq!(String::from_utf8(line).unwrap(), format!("oconv {written}"));
        }
    }
}
