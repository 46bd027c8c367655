//! The three encodings of a scanline of n four-byte pixels.
//!
//! * flat: the pixels.
//! * old run-length: flat, but a pixel `01 01 01 c` repeats the one before c times; successive ones count 256 times more
//!   each.
//! * new run-length: `02 02`, n in two bytes, then all first bytes of the pixels, all second, third and fourth ones in
//!   packets: a code above 128 and a byte to be repeated code − 128 times, or a code up to 128 and as many bytes.
//!
//! The encoder makes the same choice of packets as Radiance's programs, so that pictures agree byte for byte.

use std::io::{self, BufRead};

/// Fewer pixels are written flat.
const SHORTEST: usize = 17;

/// More pixels are written flat: n must fit fifteen bits.
const LONGEST: usize = 0x7fff;

/// The shortest run that interrupts literal bytes.
const WORTHWHILE: usize = 4;

/// The longest run written.
const LONGEST_RUN: usize = 127;

/// The most literal bytes in a packet, and the code up to which packets are literal.
const LITERAL: usize = 128;

/// Appends the encoded scanline to `out`.
pub fn encode_scanline(pixels: &[[u8; 4]], out: &mut Vec<u8>) {
    let n = pixels.len();
    if !(SHORTEST..=LONGEST).contains(&n) {
        return encode_flat(pixels, out);
    }
    out.extend([2, 2, (n >> 8) as u8, n as u8]);
    let mut plane = Vec::with_capacity(n);
    for component in 0..4 {
        plane.clear();
        plane.extend(pixels.iter().map(|p| p[component]));
        encode_plane(&plane, out);
    }
}

/// Appends the scanline's pixels as they are.
pub fn encode_flat(pixels: &[[u8; 4]], out: &mut Vec<u8>) {
    out.extend_from_slice(pixels.as_flattened());
}

fn encode_plane(plane: &[u8], out: &mut Vec<u8>) {
    let mut rest = plane;
    while !rest.is_empty() {
        // The bytes before the next worthwhile run, and its length.
        let (mut before, mut run) = (0, 0);
        while before < rest.len() {
            run = run_length(&rest[before..]);
            if run >= WORTHWHILE {
                break;
            }
            before += run;
            run = 0;
        }
        let (plain, after) = rest.split_at(before);
        if (2..WORTHWHILE).contains(&before) && run_length(plain) == before {
            out.extend([(LITERAL + before) as u8, plain[0]]);
        } else {
            for part in plain.chunks(LITERAL) {
                out.push(part.len() as u8);
                out.extend_from_slice(part);
            }
        }
        if run > 0 {
            out.extend([(LITERAL + run) as u8, after[0]]);
        }
        rest = &after[run..];
    }
}

/// How many bytes equal the first one, up to the longest run.
fn run_length(bytes: &[u8]) -> usize {
    bytes.iter().take(LONGEST_RUN).take_while(|&&b| b == bytes[0]).count()
}

/// Replaces `pixels` by the next scanline of `n` pixels. The error has kind `InvalidData` or `UnexpectedEof` if the
/// bytes are at fault, with a text for the user.
pub fn decode_scanline(input: &mut (impl BufRead + ?Sized), n: usize, pixels: &mut Vec<[u8; 4]>) -> io::Result<()> {
    pixels.clear();
    if n == 0 {
        return Ok(());
    }
    let first = read(input)?;
    match first {
        [2, 2, high @ 0..=127, low] => {
            if usize::from(high) << 8 | usize::from(low) != n {
                return Err(invalid("a run-length encoded scanline of another length"));
            }
            pixels.resize(n, [0; 4]);
            (0..4).try_for_each(|component| decode_plane(input, pixels, component))
        }
        _ => decode_old(input, first, n, pixels),
    }
}

fn decode_plane(input: &mut (impl BufRead + ?Sized), pixels: &mut [[u8; 4]], component: usize) -> io::Result<()> {
    let mut at = 0;
    let mut literal = [0; LITERAL];
    while at < pixels.len() {
        let [code] = read(input)?;
        let code = usize::from(code);
        let length = if code > LITERAL { code - LITERAL } else { code };
        let part = pixels.get_mut(at..at + length).ok_or_else(|| invalid("a run beyond the end of the scanline"))?;
        if code > LITERAL {
            let [value] = read(input)?;
            for pixel in part {
                pixel[component] = value;
            }
        } else {
            input.read_exact(&mut literal[..length]).map_err(ended)?;
            part.iter_mut().zip(literal).for_each(|(p, value)| p[component] = value);
        }
        at += length;
    }
    Ok(())
}

fn decode_old(
    input: &mut (impl BufRead + ?Sized),
    first: [u8; 4],
    n: usize,
    pixels: &mut Vec<[u8; 4]>,
) -> io::Result<()> {
    let (mut pixel, mut weight) = (first, 1usize);
    loop {
        if let [1, 1, 1, count] = pixel {
            let last = *pixels.last().ok_or_else(|| invalid("a repeat code before the first pixel"))?;
            let count = usize::from(count).saturating_mul(weight).min(n - pixels.len());
            pixels.extend(std::iter::repeat_n(last, count));
            weight = weight.saturating_mul(256);
        } else {
            pixels.push(pixel);
            weight = 1;
        }
        if pixels.len() >= n {
            return Ok(());
        }
        pixel = read(input)?;
    }
}

fn read<const N: usize>(input: &mut (impl BufRead + ?Sized)) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes).map_err(ended)?;
    Ok(bytes)
}

fn invalid(problem: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, problem)
}

fn ended(error: io::Error) -> io::Error {
    if error.kind() == io::ErrorKind::UnexpectedEof {
        io::Error::new(io::ErrorKind::UnexpectedEof, "the end of the file")
    } else {
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn packets(plane: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        encode_plane(plane, &mut out);
        out
    }

    #[test]
    fn packets_are_chosen_as_published() {
        assert_eq!(packets(&[7; 300]), [255, 7, 255, 7, 128 + 46, 7]);
        // Three left over: a short run of its own.
        assert_eq!(packets(&[7; 130]), [255, 7, 131, 7]);
        assert_eq!(packets(&[7; 128]), [255, 7, 1, 7]);
        assert_eq!(packets(&[1, 1, 2, 2, 2, 2]), [130, 1, 132, 2]);
        assert_eq!(packets(&[1, 1, 1, 3, 2, 2, 2, 2]), [4, 1, 1, 1, 3, 132, 2]);
        assert_eq!(packets(&[1, 2, 2, 2, 2, 5, 5]), [1, 1, 132, 2, 130, 5]);
        let mixed: Vec<u8> = (0..200).collect();
        assert_eq!(packets(&mixed)[..2], [128, 0]);
        assert_eq!(packets(&mixed)[129..131], [72, 128]);
    }

    #[test]
    fn short_and_long_scanlines_are_flat() {
        for (n, length) in [(16, 64), (17, 4 + 4 * 2), (32767, 4 + 4 * 259 * 2), (32768, 4 * 32768)] {
            let mut out = Vec::new();
            encode_scanline(&vec![[9, 9, 9, 9]; n], &mut out);
            assert_eq!(out.len(), length, "{n}");
        }
    }

    #[test]
    fn old_runs_count_with_growing_weights() {
        let bytes = b"\xc8\x01\x02\x81\x01\x01\x01\x10\x01\x01\x01\x02\x64\xc8\x03\x82";
        let mut pixels = Vec::new();
        decode_scanline(&mut &bytes[..], 530, &mut pixels).unwrap();
        assert!(pixels[..529].iter().all(|p| *p == [0xc8, 1, 2, 0x81]));
        assert_eq!(pixels[529], [0x64, 0xc8, 3, 0x82]);
        // What exceeds the scanline is dropped.
        decode_scanline(&mut &bytes[..], 100, &mut pixels).unwrap();
        assert_eq!(pixels.len(), 100);
    }

    #[test]
    fn broken_scanlines_are_described() {
        let decode = |bytes: &[u8], n| decode_scanline(&mut &bytes[..], n, &mut Vec::new()).unwrap_err().to_string();
        assert_eq!(decode(b"\x02\x02\x00\x05", 6), "a run-length encoded scanline of another length");
        assert_eq!(decode(b"\x02\x02\x00\x05\x86\x01", 5), "a run beyond the end of the scanline");
        assert_eq!(decode(b"\x02\x02\x00\x05\x03\x01", 5), "the end of the file");
        assert_eq!(decode(b"\x01\x01\x01\x05", 5), "a repeat code before the first pixel");
        assert_eq!(decode(b"\x01\x02\x01\x05", 2), "the end of the file");
        assert_eq!(decode(b"", 2), "the end of the file");
    }

    proptest! {
        #[test]
        fn scanlines_round_trip(runs in proptest::collection::vec((any::<[u8; 4]>(), 1usize..200), 1..12)) {
            let pixels: Vec<[u8; 4]> = runs
                .into_iter()
                // A flat scanline can not hold the codes that start or repeat runs.
                .flat_map(|([r, g, b, e], n)| std::iter::repeat_n([r.max(3), g, b, e], n))
                .collect();
            let mut out = Vec::new();
            encode_scanline(&pixels, &mut out);
            let (mut rest, mut back) = (out.as_slice(), Vec::new());
            decode_scanline(&mut rest, pixels.len(), &mut back).unwrap();
            prop_assert!(rest.is_empty());
            prop_assert_eq!(back, pixels);
        }

        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(0u8..140, 0..200), n in 0usize..100, new: bool) {
            let mut input = if new { vec![2, 2, 0, n as u8] } else { Vec::new() };
            input.extend(bytes);
            let mut pixels = Vec::new();
            if decode_scanline(&mut input.as_slice(), n, &mut pixels).is_ok() {
                prop_assert_eq!(pixels.len(), n);
            }
        }
    }
}
