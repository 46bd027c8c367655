//! The information header at the start of every data file: lines of text, ended by an empty line.
//!
//! Lines are kept verbatim and in order, known or not, so that filters pass them on. Names of variables are
//! case-sensitive, start in the first column and have no blank before the `=`.

use crate::error::Error;
use std::io::{self, BufRead, Read, Write};

/// Longest stretch of a line that is interpreted at once; what follows counts as a line of its own.
const PIECE: usize = 2046;

/// Longest value of a `FORMAT` line.
const FORMAT_LIMIT: usize = 63;

/// Longest header accepted, in bytes: far above real ones, it keeps an endless stream from filling the memory.
const LIMIT: usize = 1 << 26;

/// The lines of a header, without their newlines and without the empty line at the end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    lines: Vec<Vec<u8>>,
}

impl Header {
    /// A new header, which has the identifier line `#?RADIANCE`.
    pub fn new() -> Self {
        Self { lines: vec![b"#?RADIANCE".to_vec()] }
    }

    /// A header without any line; to be written it needs at least one.
    pub fn empty() -> Self {
        Self::default()
    }

    /// Reads a header and its empty line from a stream; `file` names it in errors.
    ///
    /// The first byte must be printable. A missing `#?RADIANCE` is tolerated, the end of the file before the empty
    /// line is not.
    pub fn read(input: &mut (impl BufRead + ?Sized), file: &str) -> Result<Self, Error> {
        let (header, ended) = Self::scan(input, file)?;
        if ended { Ok(header) } else { Err(bad(file, "an empty line at its end")) }
    }

    /// Reads the header at the start of `bytes` and tells where the data begins.
    pub fn parse(bytes: &[u8], file: &str) -> Result<(Self, usize), Error> {
        let mut rest = bytes;
        let header = Self::read(&mut rest, file)?;
        Ok((header, bytes.len() - rest.len()))
    }

    /// Reads lines up to an empty one or the end of the file, as view files have them.
    pub fn read_text(input: &mut (impl BufRead + ?Sized), file: &str) -> Result<Self, Error> {
        Ok(Self::scan(input, file)?.0)
    }

    /// The lines, and whether an empty line ended them.
    fn scan(input: &mut (impl BufRead + ?Sized), file: &str) -> Result<(Self, bool), Error> {
        let mut header = Self::empty();
        let mut size = 0;
        loop {
            let mut line = Vec::new();
            let n = Read::take(&mut *input, (LIMIT - size) as u64)
                .read_until(b'\n', &mut line)
                .map_err(|e| Error::io("cannot read header of", file, e))?;
            size += n;
            if size == 0 {
                return Err(bad(file, "some text (there is nothing in it)"));
            }
            if header.lines.is_empty() && !line.first().is_some_and(|b| (b' '..=b'~').contains(b)) {
                return Err(bad(file, "a printable first character"));
            }
            let complete = line.last() == Some(&b'\n');
            if size >= LIMIT {
                return Err(bad(file, "an empty line within the first 64 MiB"));
            }
            if complete {
                line.pop();
                if line.is_empty() || line == b"\r" {
                    return Ok((header, true));
                }
            }
            if !line.is_empty() {
                header.lines.push(line);
            }
            if !complete {
                return Ok((header, false));
            }
        }
    }

    /// The lines in order.
    pub fn lines(&self) -> impl Iterator<Item = &[u8]> {
        self.lines.iter().map(Vec::as_slice)
    }

    /// The lines as programs interpret them: in pieces of at most 2046 bytes.
    pub fn pieces(&self) -> impl Iterator<Item = &[u8]> {
        self.lines.iter().flat_map(|line| line.chunks(PIECE))
    }

    /// The lines but those that tell the format, which a program that writes another format replaces.
    pub fn lines_without_format(&self) -> impl Iterator<Item = &[u8]> {
        self.lines().filter(|line| !line.starts_with(b"FORMAT="))
    }

    /// Appends a line; a newline inside would break the header, so what follows one is left out.
    pub fn push(&mut self, line: impl AsRef<[u8]>) {
        let line = line.as_ref();
        let end = line.iter().position(|&b| b == b'\n').unwrap_or(line.len());
        if end > 0 {
            self.lines.push(line[..end].to_vec());
        }
    }

    /// Appends lines.
    pub fn extend<L: AsRef<[u8]>>(&mut self, lines: impl IntoIterator<Item = L>) {
        lines.into_iter().for_each(|line| self.push(line));
    }

    /// The values of all lines `name=value` in order, without white space around them.
    pub fn values<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        self.pieces().filter_map(move |line| {
            let value = line.strip_prefix(name.as_bytes())?.strip_prefix(b"=")?;
            std::str::from_utf8(value.trim_ascii()).ok()
        })
    }

    /// The last `FORMAT`, at most 63 characters; most readers accept a file without one.
    pub fn format(&self) -> Option<&str> {
        let value = self.values("FORMAT").last()?;
        value.get(..FORMAT_LIMIT).or(Some(value))
    }

    /// The product of all `EXPOSURE` lines: what the pixels have been multiplied by.
    pub fn exposure(&self) -> f64 {
        self.values("EXPOSURE").filter_map(number).product()
    }

    /// The component-wise product of all `COLORCORR` lines.
    pub fn colour_correction(&self) -> [f64; 3] {
        self.values("COLORCORR").filter_map(numbers::<3>).fold([1.0; 3], |p, c| [p[0] * c[0], p[1] * c[1], p[2] * c[2]])
    }

    /// The product of all `PIXASPECT` lines: height over width of a pixel.
    pub fn pixel_aspect(&self) -> f64 {
        self.values("PIXASPECT").filter_map(number).product()
    }

    /// The last `NCOMP`: values per record or pixel, 3 if there is none.
    pub fn components(&self) -> u32 {
        self.values("NCOMP").filter_map(|v| v.parse().ok()).last().unwrap_or(3)
    }

    /// The last `PRIMARIES`: x and y of red, green, blue and white.
    pub fn primaries(&self) -> Option<[f64; 8]> {
        self.values("PRIMARIES").filter_map(numbers).last()
    }

    /// The last `WAVELENGTH_SPLITS` in nm: longest limit, red/green split, green/blue split, shortest limit.
    pub fn wavelength_splits(&self) -> Option<[f64; 4]> {
        self.values("WAVELENGTH_SPLITS").filter_map(numbers).last()
    }

    /// Writes the lines and the empty line.
    pub fn write(&self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        self.write_lines(out)?;
        out.write_all(b"\n")
    }

    /// Writes the lines alone: the beginning of a header that goes on.
    pub fn write_lines(&self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        for line in &self.lines {
            out.write_all(line)?;
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    /// Length of what [`Header::write`] writes, less the empty line: where a line pushed next would start.
    pub fn size(&self) -> u64 {
        self.lines.iter().map(|line| line.len() as u64 + 1).sum()
    }
}

/// The bytes that data of a format is aligned to in files: 4 for `float`, 8 for `double`, and so on; 1 for text,
/// run-length encoded pictures and records.
pub fn alignment(format: &str) -> u64 {
    const SIZES: [(&str, u64); 5] = [("float", 4), ("double", 8), ("16-bit", 2), ("32-bit", 4), ("64-bit", 8)];
    if format.starts_with("32-bit_rle_") && format.len() == "32-bit_rle_rgbe".len() && format.ends_with('e') {
        return 1;
    }
    SIZES.iter().find(|(prefix, _)| format.starts_with(prefix)).map_or(1, |&(_, size)| size)
}

/// How many blanks follow the format's name at the end of the last header line so that the data after the empty line
/// is aligned, if that name ends at offset `end` of a seekable file.
pub fn format_padding(format: &str, end: u64) -> usize {
    let size = alignment(format);
    ((size - (end + 2) % size) % size) as usize
}

/// The line `FORMAT=…`, the last of a header. `start` is the offset in the file at which the line will stand if the
/// output is seekable; the line is then padded with blanks that align the data. Nothing is padded on pipes (`None`).
pub fn format_line(format: &str, start: Option<u64>) -> String {
    let mut line = format!("FORMAT={format}");
    if let Some(start) = start {
        let padding = format_padding(format, start + line.len() as u64);
        line.extend(std::iter::repeat_n(' ', padding));
    }
    line
}

fn bad(file: &str, expected: &'static str) -> Error {
    Error::Header { file: file.to_owned(), expected }
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|v: &f64| v.is_finite())
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut all = [0.0; N];
    let mut words = text.split_ascii_whitespace();
    for v in &mut all {
        *v = number(words.next()?)?;
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PICTURE: &[u8] =
        b"#?RADIANCE\noconv a.rad\nrpict -vp 1 2 3\nEXPOSURE=2.0000e+00\n\tEXPOSURE=9\nEXPOSURE= 0.25\n\
        COLORCORR= 1 2 3\nCOLORCORR= 2 2 2\nNCOMP=6\nFORMAT=float\t \nFORMAT=32-bit_rle_rgbe  \r\n\n-Y 1 +X 1\n";

    #[test]
    fn known_lines_combine_by_their_rules() {
        let (h, at) = Header::parse(PICTURE, "p.hdr").unwrap();
        assert_eq!(&PICTURE[at..], b"-Y 1 +X 1\n");
        assert_eq!(h.format(), Some("32-bit_rle_rgbe"));
        assert_eq!(h.exposure(), 0.5);
        assert_eq!(h.colour_correction(), [2.0, 4.0, 6.0]);
        assert_eq!(h.components(), 6);
        assert_eq!(h.pixel_aspect(), 1.0);
        assert_eq!(h.lines().count(), 11);
        assert_eq!(h.lines_without_format().count(), 9);
        let mut out = Vec::new();
        h.write(&mut out).unwrap();
        assert_eq!(out, &PICTURE[..at]);
        assert_eq!(h.size() + 1, at as u64);
    }

    #[test]
    fn broken_headers_are_named() {
        for (bytes, expected) in [
            (&b"\n\n"[..], "printable"),
            (b"", "there is nothing in it"),
            (b"\tx\n\n", "printable"),
            (b"#?RADIANCE\nx", "empty line"),
            (b"#?RADIANCE\n", "empty line"),
        ] {
            let e = Header::parse(bytes, "f.oct").unwrap_err().to_string();
            assert!(e.starts_with("f.oct: bad header") && e.contains(expected), "{e}");
        }
        assert_eq!(Header::read_text(&mut &b"VIEW= -vth\nx"[..], "v").unwrap().lines().count(), 2);
        assert_eq!(Header::parse(b"x\r\n\r\nrest", "f").unwrap().1, 5);
    }

    #[test]
    fn long_lines_are_kept_but_interpreted_in_pieces() {
        let mut bytes = vec![b'x'; 2046];
        bytes.extend(b"FORMAT=ascii\n\n");
        let (h, at) = Header::parse(&bytes, "f").unwrap();
        assert_eq!((h.lines().count(), h.format(), at), (1, Some("ascii"), bytes.len()));
    }

    #[test]
    fn data_is_aligned_on_seekable_output() {
        for start in 0..16 {
            for (format, size) in [("float", 4), ("double", 8), ("16-bit_encoded_depth", 2), ("32-bit_rle_rgbe", 1)] {
                let line = format_line(format, Some(start));
                assert_eq!((start + line.len() as u64 + 2) % size, 0);
                assert!(line.len() < format.len() + 7 + size as usize);
            }
        }
        assert_eq!(format_line("double", None), "FORMAT=double");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            if let Ok((h, at)) = Header::parse(&bytes, "f") {
                prop_assert!(at <= bytes.len());
                let _ = (h.format(), h.exposure(), h.primaries(), h.wavelength_splits());
            }
        }

        #[test]
        fn lines_round_trip(lines in proptest::collection::vec("[ -~][ -~\t]{0,30}", 1..8)) {
            let mut h = Header::empty();
            h.extend(&lines);
            let mut out = Vec::new();
            h.write(&mut out).unwrap();
            let (back, at) = Header::parse(&out, "f").unwrap();
            prop_assert_eq!(at, out.len());
            prop_assert_eq!(back, h);
        }
    }
}
