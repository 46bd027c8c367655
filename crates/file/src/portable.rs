//! Portable numbers and strings as octrees, meshes and ambient files store them.
//!
//! * `I(n)`: two's-complement integer of n bytes, most significant first; the top bit of the first byte is the sign.
//! * `S`: the bytes of a string and one NUL.
//! * `F`: a real number in five bytes, an `I(4)` mantissa and an `I(1)` binary exponent.

use std::io::{self, Read, Write};

/// Length of a portable real number in bytes.
pub const FLOAT_BYTES: usize = 5;

/// What a mantissa of one stands for: the largest `I(4)`.
const MANTISSA: f64 = 2_147_483_647.0;

/// Encodes a real number: with x = f·2^e and ½ ≤ |f| < 1, the mantissa is f·(2³¹ − 1) truncated towards zero.
///
/// Numbers of 2¹²⁷ and more in size become the largest one, numbers below 2⁻¹²⁹ and NaN become zero.
pub fn encode_float(x: f64) -> [u8; FLOAT_BYTES] {
    let (fraction, exponent) = split(x);
    let (m, e) = match exponent {
        128.. => (if fraction < 0.0 { -i32::MAX } else { i32::MAX }, 127),
        ..=-129 => (0, 0),
        e => ((fraction * MANTISSA) as i32, e as i8),
    };
    let [a, b, c, d] = m.to_be_bytes();
    [a, b, c, d, e as u8]
}

/// Decodes a real number; half a unit is added to the size of the mantissa, which centres what truncation lost.
pub fn decode_float(bytes: [u8; FLOAT_BYTES]) -> f64 {
    let [a, b, c, d, e] = bytes;
    let m = i32::from_be_bytes([a, b, c, d]);
    if m == 0 {
        return 0.0;
    }
    let centred = f64::from(m) + if m > 0 { 0.5 } else { -0.5 };
    centred * (1.0 / MANTISSA) * power_of_two(i32::from(e as i8))
}

/// The greatest number that fits beside a real number of single precision.
pub const SPARE: u8 = 62;

/// Encodes a real number of single precision with another one of 0 to [`SPARE`] in what is left of the mantissa: seven
/// bits, of which half a step is where rounding begins. Who reads the number in single precision, as other programs do,
/// meets `x` whatever stands beside it; beside 0 the bytes are those of [`encode_float`].
pub fn encode_single(x: f32, beside: u8) -> [u8; FLOAT_BYTES] {
    let [a, b, c, d, e] = encode_float(f64::from(x));
    let m = i32::from_be_bytes([a, b, c, d]);
    let beside = i32::from(beside.min(SPARE));
    // Beside a zero it stands with the least exponent, far below single precision.
    let (m, e) = match m {
        0 if beside > 0 => (beside, i8::MIN as u8),
        0.. => (m.saturating_add(beside), e),
        _ => (m.saturating_sub(beside), e),
    };
    let [a, b, c, d] = m.to_be_bytes();
    [a, b, c, d, e]
}

/// The real number in single precision, and what stands beside it; None if that is not what [`encode_single`] writes.
pub fn decode_single(bytes: [u8; FLOAT_BYTES]) -> (f32, Option<u8>) {
    let [a, b, c, d, e] = bytes;
    let x = decode_float(bytes) as f32;
    let plain = encode_float(f64::from(x));
    let size = |[a, b, c, d]: [u8; 4]| i32::from_be_bytes([a, b, c, d]).unsigned_abs();
    let beside = size([a, b, c, d]).checked_sub(size([plain[0], plain[1], plain[2], plain[3]]));
    let beside = beside.and_then(|n| u8::try_from(n).ok()).filter(|&n| n <= SPARE && encode_single(x, n)[4] == e);
    (x, beside)
}

/// x = f·2^e with ½ ≤ |f| < 1; zero, subnormal numbers and NaN give (0, 0), infinity an exponent above every other.
fn split(x: f64) -> (f64, i32) {
    const EXPONENT: u64 = 0x7ff << 52;
    let bits = x.to_bits();
    match (bits & EXPONENT) >> 52 {
        0 => (0.0, 0),
        0x7ff if x.is_nan() => (0.0, 0),
        0x7ff => (1f64.copysign(x), 1025),
        biased => (f64::from_bits(bits & !EXPONENT | 1022 << 52), biased as i32 - 1022),
    }
}

/// 2^e for exponents of normal numbers.
fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

/// Sign-extends the big-endian bytes of an `I(n)`, at most eight.
pub(crate) fn integer(bytes: &[u8]) -> i64 {
    let sign = if bytes.first().is_some_and(|b| b & 0x80 != 0) { -1 } else { 0 };
    bytes.iter().fold(sign, |v, &b| v << 8 | i64::from(b))
}

/// Reading portable values from a stream.
pub trait PortableRead: Read {
    /// An `I(n)`, n from 1 to 8. Fails if the stream ends.
    fn read_int(&mut self, n: usize) -> io::Result<i64> {
        let mut bytes = [0; 8];
        let part = bytes.get_mut(..n).ok_or(io::ErrorKind::InvalidInput)?;
        self.read_exact(part)?;
        Ok(integer(part))
    }

    /// A string without its NUL. Fails if the stream ends or if the string is longer than `limit` bytes.
    fn read_string(&mut self, limit: usize) -> io::Result<Vec<u8>> {
        let mut text = Vec::new();
        loop {
            let mut byte = [0];
            self.read_exact(&mut byte)?;
            match byte[0] {
                0 => return Ok(text),
                _ if text.len() == limit => return Err(io::ErrorKind::InvalidData.into()),
                b => text.push(b),
            }
        }
    }

    /// An `F`. Fails if the stream ends.
    fn read_float(&mut self) -> io::Result<f64> {
        let mut bytes = [0; FLOAT_BYTES];
        self.read_exact(&mut bytes)?;
        Ok(decode_float(bytes))
    }
}

impl<R: Read + ?Sized> PortableRead for R {}

/// Writing portable values to a stream (or to a `Vec<u8>`).
pub trait PortableWrite: Write {
    /// The low n bytes of an integer, n from 1 to 8, without a range check.
    fn write_int(&mut self, n: usize, value: i64) -> io::Result<()> {
        let bytes = value.to_be_bytes();
        let start = 8usize.checked_sub(n).ok_or(io::ErrorKind::InvalidInput)?;
        self.write_all(&bytes[start..])
    }

    /// A string and its NUL; what follows an inner NUL is left out, since no reader would see it as part of the string.
    fn write_string(&mut self, text: &[u8]) -> io::Result<()> {
        let end = text.iter().position(|&b| b == 0).unwrap_or(text.len());
        self.write_all(&text[..end])?;
        self.write_all(&[0])
    }

    /// An `F`.
    fn write_float(&mut self, value: f64) -> io::Result<()> {
        self.write_all(&encode_float(value))
    }
}

impl<W: Write + ?Sized> PortableWrite for W {}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SATURATED: f64 = 1.701411835000833e+38;

    #[test]
    fn real_numbers_have_the_published_bytes() {
        for (x, bytes, back) in [
            (0.0, [0, 0, 0, 0, 0], 0.0),
            (1.0, [0x3f, 0xff, 0xff, 0xff, 0x01], 1.0),
            (-1.0, [0xc0, 0x00, 0x00, 0x01, 0x01], -1.0),
            (0.5, [0x3f, 0xff, 0xff, 0xff, 0x00], 0.5),
            (3.0, [0x5f, 0xff, 0xff, 0xff, 0x02], 3.0000000004656613),
            (100.0, [0x63, 0xff, 0xff, 0xff, 0x07], 100.0000000167638),
            (0.7, [0x59, 0x99, 0x99, 0x98, 0x00], 0.6999999998137355),
            (-0.1, [0x99, 0x99, 0x99, 0x9b, 0xfd], -0.09999999999417923),
            (std::f64::consts::PI, [0x64, 0x87, 0xed, 0x50, 0x02], 3.141592653999847),
            (1e-5, [0x53, 0xe2, 0xd6, 0x22, 0xf0], 9.999999997172608e-06),
            (1e10, [0x4a, 0x81, 0x7c, 0x7f, 0x22], 10000000000.656612),
            (1e-39, [0, 0, 0, 0, 0], 0.0),
            (1.7e38, [0x7f, 0xe4, 0xcf, 0x1d, 0x7f], 1.7000000002361143e+38),
            (1e39, [0x7f, 0xff, 0xff, 0xff, 0x7f], SATURATED),
            (-1e39, [0x80, 0x00, 0x00, 0x01, 0x7f], -SATURATED),
            (f64::INFINITY, [0x7f, 0xff, 0xff, 0xff, 0x7f], SATURATED),
            (f64::NAN, [0, 0, 0, 0, 0], 0.0),
        ] {
            assert_eq!(encode_float(x), bytes, "{x}");
            let decoded = decode_float(bytes);
            // The expected values are printed with 13 to 17 digits.
            assert!((decoded - back).abs() <= 1e-13 * back.abs(), "{x}: {decoded} is not {back}");
        }
    }

    #[test]
    fn what_stands_beside_a_number_is_below_single_precision() {
        for x in [0.0, 1.0, -1.0, 0.5, -0.5, 1.0 - f32::EPSILON / 2.0, 1.0 + f32::EPSILON, 0.1, 1e30, 1e-30, 3.0f32] {
            for n in 0..=SPARE {
                let bytes = encode_single(x, n);
                // What another program makes of it.
                assert_eq!(decode_float(bytes) as f32, x, "beside {n}");
                assert_eq!(decode_single(bytes), (x, Some(n)));
            }
        }
        assert_eq!(decode_single(encode_float(0.1)).1, None, "of double precision");
    }

    #[test]
    fn powers_of_two_survive_exactly() {
        for e in -128..127 {
            for x in [2f64.powi(e), -2f64.powi(e)] {
                assert_eq!(decode_float(encode_float(x)), x);
            }
        }
    }

    #[test]
    fn integers_are_big_endian_with_sign() {
        let mut out = Vec::new();
        out.write_int(2, 287).unwrap();
        out.write_int(4, -1).unwrap();
        out.write_int(1, -2).unwrap();
        out.write_int(8, i64::MIN).unwrap();
        assert_eq!(out[..7], [0x01, 0x1f, 0xff, 0xff, 0xff, 0xff, 0xfe]);
        let mut r = out.as_slice();
        assert_eq!(r.read_int(2).unwrap(), 287);
        assert_eq!(r.read_int(4).unwrap(), -1);
        assert_eq!(r.read_int(1).unwrap(), -2);
        assert_eq!(r.read_int(8).unwrap(), i64::MIN);
        assert!(r.read_int(1).is_err());
        assert!(r.read_int(9).is_err());
    }

    #[test]
    fn overlong_and_unfinished_strings_are_refused() {
        assert_eq!((&b"abc\0"[..]).read_string(3).unwrap(), b"abc");
        assert!((&b"abc\0"[..]).read_string(2).is_err());
        assert!((&b"abc"[..]).read_string(9).is_err());
    }

    proptest! {
        #[test]
        fn single_precision_is_kept_beside_everything(x in prop::num::f32::NORMAL, n in 0..=SPARE) {
            let kept = encode_single(x, n);
            prop_assert_eq!(decode_float(kept) as f32, decode_float(encode_float(f64::from(x))) as f32);
            // Numbers next to the greatest, which stands for all above, leave no room.
            if x.abs() < 1e38 {
                prop_assert_eq!(decode_single(kept), (decode_float(encode_float(f64::from(x))) as f32, Some(n)));
            }
        }

        #[test]
        fn every_decoded_number_encodes_to_itself(m in any::<i32>(), e in any::<i8>()) {
            let [a, b, c, d] = m.to_be_bytes();
            let x = decode_float([a, b, c, d, e as u8]);
            prop_assert!(x.is_finite());
            let again = decode_float(encode_float(x));
            // The largest mantissas round up to the next power of two, which saturates at the top exponent; numbers
            // below the smallest normalised one become zero.
            prop_assert!((again - x).abs() <= x.abs() * 1e-9 + 2f64.powi(-129), "{x} {again}");
            if m.unsigned_abs() >= 1 << 30 && m.unsigned_abs() < i32::MAX as u32 {
                prop_assert_eq!(encode_float(x), [a, b, c, d, e as u8]);
            }
        }

        #[test]
        fn integers_and_strings_round_trip(v in any::<i32>(), s in "[^\0]{0,40}") {
            let mut out = Vec::new();
            out.write_int(4, v as i64).unwrap();
            out.write_string(s.as_bytes()).unwrap();
            let mut r = out.as_slice();
            prop_assert_eq!(r.read_int(4).unwrap(), v as i64);
            prop_assert_eq!(r.read_string(400).unwrap(), s.as_bytes());
        }
    }
}
