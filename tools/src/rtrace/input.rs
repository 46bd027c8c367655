//! Rays from standard input: six numbers each, as text or as native reals.

use ambit_base::DVec3;
use ambit_cli::InputFormat;
use ambit_file::{boundless_real, short_decimal};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use std::io::{self, BufRead, BufReader, Read};
use std::os::fd::AsFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Longest word of text input; what follows counts as a word of its own.
const LONGEST_WORD: usize = 31;

/// Characters of a word that messages show, escaped.
const LONGEST_SHOWN: usize = 40;

/// How often it is looked whether a signal has ended the wait for input.
const GLANCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 20_000_000 };

/// Input that ends where a signal asks the work to stop, however long its writer may wait.
pub(crate) struct Patient<R> {
    input: R,
    stop: Arc<AtomicBool>,
}

impl<R> Patient<R> {
    /// Ends once `stop` is true.
    pub(crate) fn new(input: R, stop: Arc<AtomicBool>) -> Self {
        Self { input, stop }
    }
}

/// Input that knows whether its next bytes have to be waited for.
pub(crate) trait Awaited: Read {
    /// True if there are none yet. At its end there is nothing to wait for.
    fn waits(&self) -> bool;
}

impl<R: Read + AsFd> Awaited for Patient<R> {
    fn waits(&self) -> bool {
        let ready = poll(&mut [PollFd::new(&self.input, PollFlags::IN)], Some(&Timespec::default()));
        !matches!(ready, Ok(1..))
    }
}

impl Awaited for &[u8] {
    fn waits(&self) -> bool {
        false
    }
}

impl<R: Read + AsFd> Read for Patient<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        loop {
            if self.stop.load(Ordering::Acquire) {
                return Ok(0);
            }
            match poll(&mut [PollFd::new(&self.input, PollFlags::IN)], Some(&GLANCE)) {
                Ok(0) | Err(Errno::INTR) => {}
                // What it cannot look at it reads.
                Ok(_) | Err(_) => return self.input.read(bytes),
            }
        }
    }
}

/// Bytes of input that are taken at once.
const BUFFER: usize = 1 << 16;

/// Reads rays.
pub(crate) struct RayReader<R> {
    input: BufReader<R>,
    format: InputFormat,
    odd: Option<String>,
}

impl<R: Awaited> RayReader<R> {
    /// Rays of a format from a stream.
    pub(crate) fn new(input: R, format: InputFormat) -> Self {
        Self { input: BufReader::with_capacity(BUFFER, input), format, odd: None }
    }

    /// True if no whole ray is left of what was read, and the rest of the next one, or the end, has to be waited for.
    pub(crate) fn waits(&self) -> bool {
        let left = self.input.buffer();
        let whole = match self.format {
            // Words that end, a space behind each.
            InputFormat::Ascii => left.windows(2).filter(|w| !is_space(w[0]) && is_space(w[1])).nth(5).is_some(),
            InputFormat::Float => left.len() >= 6 * size_of::<f32>(),
            InputFormat::Double => left.len() >= 6 * size_of::<f64>(),
        };
        !whole && self.input.get_ref().waits()
    }

    /// Origin and direction of the next ray. `None` at the end of the input, or where it stops being numbers; an
    /// incomplete last ray is dropped.
    pub(crate) fn next(&mut self) -> Option<(DVec3, DVec3)> {
        let mut v = [0.0; 6];
        for (i, x) in v.iter_mut().enumerate() {
            *x = match self.format {
                InputFormat::Ascii => self.number(i)?,
                InputFormat::Float => {
                    let mut bytes = [0; 4];
                    self.input.read_exact(&mut bytes).ok()?;
                    f64::from(f32::from_ne_bytes(bytes))
                }
                InputFormat::Double => {
                    let mut bytes = [0; 8];
                    self.input.read_exact(&mut bytes).ok()?;
                    f64::from_ne_bytes(bytes)
                }
            };
        }
        let [ox, oy, oz, dx, dy, dz] = v;
        Some((DVec3::new(ox, oy, oz), DVec3::new(dx, dy, dz)))
    }

    /// What is odd about where text stops being rays, if anything is. Radiance says nothing: lists with commas, or with a
    /// line of titles, come to nothing there.
    pub(crate) fn odd(&self) -> Option<&str> {
        self.odd.as_deref()
    }

    /// Number `i` of a ray.
    fn number(&mut self, i: usize) -> Option<f64> {
        if let Some(number) = self.buffered() {
            return Some(number);
        }
        let Some(word) = self.word() else {
            self.odd = (i > 0).then(|| format!("last ray has {i} numbers of 6, and is left out"));
            return None;
        };
        let number = boundless_real(&word);
        // Text in two bytes a character ends with an empty word.
        if number.is_none() && !word.is_empty() {
            self.odd = Some(format!("rays end at \"{}\" (expected a number{})", shown(&word), binary(&word)));
        }
        number
    }

    /// The next number, if its word is as plain as nearly all are and stands in the buffer, with what ends it.
    fn buffered(&mut self) -> Option<f64> {
        let buffer = self.input.buffer();
        let start = buffer.iter().position(|&b| !is_space(b))?;
        let (number, length) = short_decimal(&buffer[start..])?;
        let end = start + length;
        // It is shorter than words may be.
        let whole = buffer.get(end).is_some_and(|&b| is_space(b));
        whole.then(|| self.input.consume(end)).map(|()| number)
    }

    /// The next word: up to white space, or what stands between quotes.
    fn word(&mut self) -> Option<String> {
        let mut first = self.byte().ok()??;
        while is_space(first) {
            first = self.byte().ok()??;
        }
        let quote = matches!(first, b'"' | b'\'').then_some(first);
        let mut word = String::new();
        // Bytes of zero are passed over: every second one of UTF-16.
        if quote.is_none() && first != 0 {
            word.push(char::from(first));
        }
        while word.len() < LONGEST_WORD {
            let Some(next) = self.peek().ok()? else { break };
            if quote.is_none() && is_space(next) {
                break;
            }
            self.input.consume(1);
            if Some(next) == quote {
                break;
            }
            if next != 0 {
                word.push(char::from(next));
            }
        }
        Some(word)
    }

    fn byte(&mut self) -> io::Result<Option<u8>> {
        let byte = self.peek()?;
        if byte.is_some() {
            self.input.consume(1);
        }
        Ok(byte)
    }

    fn peek(&mut self) -> io::Result<Option<u8>> {
        loop {
            match self.input.fill_buf() {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                other => return other.map(|buffer| buffer.first().copied()),
            }
        }
    }
}

/// A word for a message: on one line, not too long, and harmless to terminals.
fn shown(word: &str) -> String {
    let mut text: String = word.escape_default().take(LONGEST_SHOWN).collect();
    if word.escape_default().nth(LONGEST_SHOWN).is_some() {
        text.push('…');
    }
    text
}

/// What may help where a word is none, the mark of UTF-8 apart.
fn binary(word: &str) -> &'static str {
    let text = word.strip_prefix("\u{ef}\u{bb}\u{bf}").unwrap_or(word);
    if text.chars().all(|c| c.is_ascii_graphic() || c.is_ascii_whitespace()) {
        ""
    } else {
        "; binary rays need -ff or -fd"
    }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rays(text: &str) -> Vec<[f64; 6]> {
        let mut reader = RayReader::new(text.as_bytes(), InputFormat::Ascii);
        std::iter::from_fn(|| reader.next()).map(|(o, d)| [o.x, o.y, o.z, d.x, d.y, d.z]).collect()
    }

    /// Input that comes byte by byte.
    struct Drops<'a>(&'a [u8]);

    impl Read for Drops<'_> {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            let count = self.0.len().min(bytes.len()).min(1);
            bytes[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    impl Awaited for Drops<'_> {
        fn waits(&self) -> bool {
            false
        }
    }

    #[test]
    fn words_may_come_in_pieces() {
        let text = "12.5 -3 1e2\n4 55 .75 100 200 300 400 500 600";
        let mut reader = RayReader::new(Drops(text.as_bytes()), InputFormat::Ascii);
        let read: Vec<_> = std::iter::from_fn(|| reader.next()).map(|(o, d)| [o.x, o.y, o.z, d.x, d.y, d.z]).collect();
        assert_eq!(read, [[12.5, -3.0, 100.0, 4.0, 55.0, 0.75], [100.0, 200.0, 300.0, 400.0, 500.0, 600.0]]);
        assert_eq!(read, rays(text));
    }

    #[test]
    fn any_layout_of_words_will_do() {
        assert_eq!(
            rays("1 2\t3\r\n4 5 \"6\" 7 8 9 1e1 +11 .5\n7 7"),
            [[1., 2., 3., 4., 5., 6.], [7., 8., 9., 10., 11., 0.5]]
        );
        assert_eq!(rays(""), [[0.0; 6]; 0]);
        let wide: String = "1 2 .3 4 5 6\n".chars().flat_map(|c| [c, '\0']).collect();
        assert_eq!(rays(&wide), [[1., 2., 0.3, 4., 5., 6.]]);
    }

    #[test]
    fn the_first_bad_word_is_the_end() {
        for bad in ["nan", "inf", "0x2", "foo", "#", "1,", "1d0"] {
            assert_eq!(rays(&format!("1 2 3 4 5 6 7 8 9 {bad} 1 1 1 2 3 4 5 6")).len(), 1, "{bad}");
        }
    }

    #[test]
    fn what_rays_end_with_is_kept() {
        let odd = |text: &str| {
            let mut reader = RayReader::new(text.as_bytes(), InputFormat::Ascii);
            while reader.next().is_some() {}
            reader.odd().map(str::to_owned)
        };
        let word = |w: &str| Some(format!("rays end at \"{w}\" (expected a number)"));
        assert_eq!(odd("1 2 3 4 5 6\n"), None);
        assert_eq!(odd(""), None);
        assert_eq!(odd("x,y,z,dx,dy,dz\n1 2 3 4 5 6\n"), word("x,y,z,dx,dy,dz"));
        assert_eq!(odd("1 2 3 4 5 6 7 8 9 nan 1 1"), word("nan"));
        assert_eq!(odd("\u{feff}0 0 0 0 1 0"), word("\\u{ef}\\u{bb}\\u{bf}0"));
        let escaped = format!("{}\\u{{1…", "\\u{1b}".repeat(6));
        let binary = format!("rays end at \"{escaped}\" (expected a number; binary rays need -ff or -fd)");
        assert_eq!(odd(&"\u{1b}".repeat(9)), Some(binary));
        assert_eq!(odd("1 2 3 4 5 6\n1 2 3\n"), Some("last ray has 3 numbers of 6, and is left out".to_owned()));
    }

    #[test]
    fn numbers_that_are_too_large_count() {
        assert_eq!(rays("1 2 1e400 4 5 6 -1e999 1 2 3 4 5")[1][0], f64::NEG_INFINITY);
    }

    #[test]
    fn long_words_are_split() {
        let long = format!("0.5{}25 3 4 5 6", "0".repeat(28));
        // 31 characters, then two more.
        assert_eq!(rays(&long), [[0.5, 25.0, 3.0, 4.0, 5.0, 6.0]]);
    }

    #[test]
    fn binary_rays_are_native() {
        let bytes: Vec<u8> = (0..13).flat_map(|i| (i as f32).to_ne_bytes()).collect();
        let mut reader = RayReader::new(&bytes[..], InputFormat::Float);
        assert_eq!(reader.next(), Some((DVec3::new(0., 1., 2.), DVec3::new(3., 4., 5.))));
        assert!(reader.next().is_some());
        assert_eq!(reader.next(), None);
        let bytes: Vec<u8> = (0..6).flat_map(|i| f64::from(i).to_ne_bytes()).collect();
        assert!(RayReader::new(&bytes[..], InputFormat::Double).next().is_some());
    }
}
