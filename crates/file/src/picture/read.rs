//! Reading a picture scanline by scanline.

use super::{PixelSpace, decode_scanline};
use crate::error::Error;
use crate::header::Header;
use crate::resolution::Resolution;
use crate::rgbe::decode_pixel;
use ambit_base::Rgb;
use std::io::{BufRead, ErrorKind};

/// The longest scanline accepted, in pixels: a few bytes of old run-length codes stand for any number of pixels, and
/// must not fill the memory.
const LONGEST: u32 = 1 << 24;

/// A picture whose header and resolution have been read, and whose scanlines come next.
#[derive(Debug)]
pub struct PictureReader<R> {
    /// The header.
    pub header: Header,
    /// Size and order of the pixels.
    pub resolution: Resolution,
    /// What the channels are; RGB if the header has no FORMAT.
    pub space: PixelSpace,
    input: R,
    file: String,
    scanline: u32,
    codes: Vec<[u8; 4]>,
}

impl<R: BufRead> PictureReader<R> {
    /// Reads header and resolution; `file` names the stream in errors.
    pub fn new(mut input: R, file: &str) -> Result<Self, Error> {
        let header = Header::read(&mut input, file)?;
        let space = match header.format() {
            None => PixelSpace::Rgb,
            Some(format) => PixelSpace::from_format(format).ok_or_else(|| Error::Format {
                file: file.to_owned(),
                found: format.to_owned(),
                expected: "32-bit_rle_rgbe or 32-bit_rle_xyze",
            })?,
        };
        let resolution = Resolution::read(&mut input, file)?;
        if resolution.scanline_length() > LONGEST {
            return Err(Error::Resolution { file: file.to_owned(), found: resolution.to_string() });
        }
        Ok(Self { header, resolution, space, input, file: file.to_owned(), scanline: 0, codes: Vec::new() })
    }

    /// The next scanline's pixel codes, or `None` after the last one.
    pub fn next_codes(&mut self) -> Result<Option<&[[u8; 4]]>, Error> {
        if self.scanline == self.resolution.scanlines() {
            return Ok(None);
        }
        let n = self.resolution.scanline_length() as usize;
        decode_scanline(&mut self.input, n, &mut self.codes).map_err(|e| match e.kind() {
            ErrorKind::InvalidData | ErrorKind::UnexpectedEof => {
                Error::Scanline { file: self.file.clone(), scanline: self.scanline, problem: e.to_string() }
            }
            _ => Error::io("cannot read picture", &self.file, e),
        })?;
        self.scanline += 1;
        Ok(Some(&self.codes))
    }

    /// Appends the next scanline's pixels to `pixels`; false after the last one.
    pub fn next_pixels(&mut self, pixels: &mut Vec<Rgb>) -> Result<bool, Error> {
        let Some(codes) = self.next_codes()? else { return Ok(false) };
        pixels.extend(codes.iter().map(|&c| decode_pixel(c)));
        Ok(true)
    }

    /// How many scanlines have been read.
    pub fn position(&self) -> u32 {
        self.scanline
    }

    /// The stream, for what follows the picture.
    pub fn into_inner(self) -> R {
        self.input
    }
}
