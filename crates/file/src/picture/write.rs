//! Writing a picture scanline by scanline, with the bytes that Radiance's renderers write.

use super::encode_scanline;
use crate::header::Header;
use crate::resolution::Resolution;
use crate::rgbe::encode_pixel;
use ambit_base::Rgb;
use std::io::{self, Write};

/// A picture being written. Nothing is held back: each call hands one whole scanline to the stream.
#[derive(Debug)]
pub struct PictureWriter<W> {
    out: W,
    codes: Vec<[u8; 4]>,
    bytes: Vec<u8>,
}

impl<W: Write> PictureWriter<W> {
    /// Writes the header, whose last line should be the [`super::PixelSpace::format`] as `FORMAT=`, and the resolution.
    pub fn new(out: W, header: &Header, resolution: &Resolution) -> io::Result<Self> {
        let mut bytes = Vec::new();
        header.write(&mut bytes)?;
        writeln!(bytes, "{resolution}")?;
        let mut writer = Self::scanlines_only(out);
        writer.out.write_all(&bytes)?;
        Ok(writer)
    }

    /// Continues a stream whose header and resolution have been written already.
    pub fn scanlines_only(out: W) -> Self {
        Self { out, codes: Vec::new(), bytes: Vec::new() }
    }

    /// Writes a scanline of pixels.
    pub fn write_pixels(&mut self, pixels: &[Rgb]) -> io::Result<()> {
        let mut codes = std::mem::take(&mut self.codes);
        codes.clear();
        codes.extend(pixels.iter().map(|&p| encode_pixel(p)));
        let written = self.write_codes(&codes);
        self.codes = codes;
        written
    }

    /// Writes a scanline of pixel codes.
    pub fn write_codes(&mut self, codes: &[[u8; 4]]) -> io::Result<()> {
        self.bytes.clear();
        encode_scanline(codes, &mut self.bytes);
        self.out.write_all(&self.bytes)
    }

    /// Flushes the stream.
    pub fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// The stream.
    pub fn into_inner(self) -> W {
        self.out
    }
}
