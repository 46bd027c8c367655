//! The pixel code: one mantissa byte per channel and a common exponent byte (Ward 1991, *Real Pixels*). RGB and XYZ
//! pixels have three mantissas, spectral pixels and ambient values as many as the file's `NCOMP` says.
//!
//! With M = f·2^E the largest channel, ½ ≤ f < 1, a channel c is stored as c·2^(8−E), truncated; decoding adds half a
//! unit, so a zero mantissa of a pixel that is not black decodes to a small positive number.

use ambit_base::Rgb;

/// A largest channel up to this is black.
const BLACK: f32 = 1e-32;

/// Encodes a pixel. Negative channels become zero; channels of 2¹²⁷ and more, and infinities, the largest code.
#[inline]
pub fn encode_pixel(c: Rgb) -> [u8; 4] {
    let mut code = [0; 4];
    encode_spectrum(&[c.x, c.y, c.z], &mut code);
    code
}

/// Decodes a pixel.
#[inline]
pub fn decode_pixel(code: [u8; 4]) -> Rgb {
    let [r, g, b, e] = code;
    if e == 0 {
        return Rgb::ZERO;
    }
    let unit = unit(e);
    Rgb::new(f32::from(r) + 0.5, f32::from(g) + 0.5, f32::from(b) + 0.5) * unit
}

/// Encodes any number of channels; `code` is one byte longer than `channels` (what either has more is left alone).
pub fn encode_spectrum(channels: &[f32], code: &mut [u8]) {
    let n = channels.len().min(code.len().saturating_sub(1));
    let (Some(channels), Some(code)) = (channels.get(..n), code.get_mut(..=n)) else { return };
    code.fill(0);
    // `max` passes over NaN.
    let largest = channels.iter().fold(0f32, |m, &c| m.max(c));
    if largest <= BLACK {
        return;
    }
    // The exponent field of a normal number is E + 126; BLACK is far above the subnormal ones. The byte holds E + 128.
    let exponent = (largest.to_bits() >> 23).min(0xfd) as i32 - 126;
    let scale = f64::from_bits(((8 - exponent + 1023) as u64) << 52);
    for (&c, byte) in channels.iter().zip(code.iter_mut()) {
        // The conversion saturates: 0 for negative numbers and NaN, 255 for what the exponent could not follow.
        *byte = (f64::from(c) * scale) as u8;
    }
    code[n] = (exponent + 128) as u8;
}

/// Decodes any number of channels from one byte more (what either has more is left alone).
pub fn decode_spectrum(code: &[u8], channels: &mut [f32]) {
    let n = channels.len().min(code.len().saturating_sub(1));
    let (Some(channels), Some(mantissas), Some(&e)) = (channels.get_mut(..n), code.get(..n), code.get(n)) else {
        return;
    };
    if e == 0 {
        channels.fill(0.0);
        return;
    }
    let unit = unit(e);
    for (c, &m) in channels.iter_mut().zip(mantissas) {
        *c = (f32::from(m) + 0.5) * unit;
    }
}

/// 2^(e − 136) for an exponent byte e > 0; subnormal numbers below e = 10.
#[inline]
fn unit(e: u8) -> f32 {
    f64::from_bits((u64::from(e) + 1023 - 136) << 52) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn pixels_have_the_published_codes() {
        assert_eq!(encode_pixel(Rgb::new(1.0, 0.5, 0.25)), [0x80, 0x40, 0x20, 0x81]);
        assert_eq!(encode_pixel(Rgb::ZERO), [0; 4]);
        assert_eq!(encode_pixel(Rgb::new(1e-32, 0.0, 0.0)), [0; 4]);
        assert_eq!(encode_pixel(Rgb::new(-1.0, -2.0, -3.0)), [0; 4]);
        assert_eq!(decode_pixel([0x80, 0x40, 0x20, 0x81]), Rgb::new(257.0, 129.0, 65.0) / 256.0);
        assert_eq!(decode_pixel([9, 9, 9, 0]), Rgb::ZERO);
        // From a real ambient record.
        let v = decode_pixel([0xa8, 0x78, 0x48, 0x7d]);
        assert!((v - Rgb::new(8.227539e-2, 5.883789e-2, 3.540039e-2)).abs().max_element() < 1e-8, "{v}");
    }

    #[test]
    fn mantissas_are_truncated_not_rounded() {
        assert_eq!(encode_pixel(Rgb::new(0.999_999_9, 1.0 / 256.0, 0.0039)), [255, 1, 0, 128]);
    }

    #[test]
    fn odd_numbers_give_finite_pixels() {
        for v in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE] {
            let code = encode_pixel(Rgb::new(v, 1.0, 0.0));
            assert!(decode_pixel(code).is_finite(), "{v}");
        }
        assert_eq!(encode_pixel(Rgb::splat(f32::INFINITY)), [255; 4]);
    }

    #[test]
    fn spectra_share_one_exponent() {
        let mut code = [0; 7];
        encode_spectrum(&[4.0, 2.0, 1.0, 0.5, 0.25, 0.0], &mut code);
        assert_eq!(code, [128, 64, 32, 16, 8, 0, 131]);
        let mut back = [0.0; 6];
        decode_spectrum(&code, &mut back);
        assert_eq!(back[..2], [128.5 / 32.0, 64.5 / 32.0]);
        assert_eq!(back[5], 0.5 / 32.0);
    }

    proptest! {
        #[test]
        fn every_normalised_code_survives(r in any::<u8>(), g in any::<u8>(), b in 128u8.., e in 23u8..) {
            let code = [r, g, b, e];
            prop_assert_eq!(encode_pixel(decode_pixel(code)), code);
        }

        #[test]
        fn three_channels_are_a_pixel(r in 0f32..1e5, g in 0f32..10.0, b in 0f32..1e-3) {
            let pixel = encode_pixel(Rgb::new(r, g, b));
            let mut code = [0; 4];
            encode_spectrum(&[r, g, b], &mut code);
            prop_assert_eq!(pixel, code);
            let mut back = [0.0; 3];
            decode_spectrum(&code, &mut back);
            prop_assert_eq!(decode_pixel(code), Rgb::from(back));
        }
    }
}
