//! Numbers as text, quickly: what `printf("%e")` prints.

use std::io::Write;

/// Appends a number with six decimals and an exponent of at least two digits.
pub(crate) fn push_exponent(out: &mut Vec<u8>, x: f64) {
    let start = out.len();
    // Writing to memory does not fail.
    let _ = write!(out, "{x:.6e}");
    let Some(e) = out[start..].iter().rposition(|&b| b == b'e').map(|i| start + i + 1) else { return };
    let (sign, digits) = if out.get(e) == Some(&b'-') { (b'-', e + 1) } else { (b'+', e) };
    let mut exponent = [b'0'; 4];
    let count = out.len() - digits;
    let padding = 2usize.saturating_sub(count);
    exponent[padding..padding + count].copy_from_slice(&out[digits..]);
    out.truncate(e);
    out.push(sign);
    out.extend_from_slice(&exponent[..padding + count]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_printed_as_printf_does() {
        for x in [0.0, -0.0, 1.0, -2.5e-3, 1e10, 123456.789, 9.9999996e9, 1e-300, 1.5e300, 0.3674845] {
            let mut text = Vec::new();
            push_exponent(&mut text, x);
            assert_eq!(String::from_utf8(text).unwrap(), ambit_file::exponent(x, 6));
        }
    }
}
