//! Numbers as text, quickly: what `printf("%e")` prints.

use std::io::Write;

/// Powers of ten that are exact.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// A number of seven digits before the point is off by less, after one multiplication or division by an exact power of
/// ten, than what it may miss a half by here: 10⁷ has steps of 2·10⁻⁹.
const CLOSE: f64 = 1e-6;

/// Appends a number with six decimals and an exponent of at least two digits.
pub(crate) fn push_exponent(out: &mut Vec<u8>, x: f64) {
    match seven_digits(x.abs()) {
        Some((digits, exponent)) => push_digits(out, x.is_sign_negative(), digits, exponent),
        None => push_slowly(out, x),
    }
}

/// The first seven digits of a number, rounded, and the exponent of the first; `None` where that takes more care.
fn seven_digits(x: f64) -> Option<(u32, i32)> {
    if x == 0.0 {
        return Some((0, 0));
    }
    let scaled = |exponent: i32| {
        let power = |n: i32| POWERS.get(usize::try_from(n).ok()?);
        let shift = 6 - exponent;
        if shift < 0 { Some(x / power(-shift)?) } else { Some(x * power(shift)?) }
    };
    // Of the power of two below, the power of ten below: right, or one too small.
    let two = (x.to_bits() >> 52) as i32 - 1023;
    let mut exponent = (f64::from(two) * std::f64::consts::LOG10_2).floor() as i32;
    let mut digits = scaled(exponent)?;
    if digits >= 1e7 {
        exponent += 1;
        digits = scaled(exponent)?;
    }
    let rounded = digits.round();
    if (0.5 - (digits - rounded).abs()).abs() < CLOSE {
        return None;
    }
    // 9.9999997 is 10.
    if rounded >= 1e7 { Some((1_000_000, exponent + 1)) } else { Some((rounded as u32, exponent)) }
}

/// Appends seven digits and an exponent of two.
fn push_digits(out: &mut Vec<u8>, negative: bool, digits: u32, exponent: i32) {
    let digit = |n: u32| b'0' + (n % 10) as u8;
    let size = exponent.unsigned_abs();
    let mut text = *b"-0.000000e+00";
    text[1] = digit(digits / 1_000_000);
    let mut rest = digits;
    for place in text[3..9].iter_mut().rev() {
        *place = digit(rest);
        rest /= 10;
    }
    text[10] = if exponent < 0 { b'-' } else { b'+' };
    (text[11], text[12]) = (digit(size / 10), digit(size));
    out.extend_from_slice(&text[usize::from(!negative)..]);
}

fn push_slowly(out: &mut Vec<u8>, x: f64) {
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

    fn printed(x: f64) -> String {
        let mut text = Vec::new();
        push_exponent(&mut text, x);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn any_number_is_printed_as_printf_does() {
        let mut stream = 1u64;
        let mut bits = || {
            stream = stream.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            stream ^ stream >> 29
        };
        for _ in 0..200_000 {
            let wide = f64::from_bits(bits());
            let usual = f64::from((f64::from_bits(bits() >> 12 | 0x3ff << 52) - 1.5) as f32);
            // Halves between numbers of seven digits, and their neighbours.
            let half = ((bits() % 9_000_000) as f64 + 1_000_000.5) * [1e-6, 1e-3, 1.0, 8.0, 1e4][(bits() % 5) as usize];
            for x in [wide, usual, half, half.next_up(), half.next_down()] {
                if x.is_finite() {
                    assert_eq!(printed(x), ambit_file::exponent(x, 6), "{x:e}");
                }
            }
        }
    }

    #[test]
    fn numbers_are_printed_as_printf_does() {
        for x in [0.0, -0.0, 1.0, -2.5e-3, 1e10, 123456.789, 9.9999996e9, 1e-300, 1.5e300, 0.3674845, 1e6, 1e-6, 5e-324]
        {
            assert_eq!(printed(x), ambit_file::exponent(x, 6));
        }
    }
}
