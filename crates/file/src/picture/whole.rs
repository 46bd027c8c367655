//! A whole picture in memory, whatever the order of pixels in its file.

use super::{PictureReader, PictureWriter, PixelSpace};
use crate::error::Error;
use crate::header::Header;
use crate::native::path_of;
use crate::resolution::{Orientation, Resolution};
use ambit_base::Rgb;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};

/// A picture with one pixel a cell, rows from the **bottom** up, each from left to right.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The header of its file.
    pub header: Header,
    /// Pixels in x.
    pub width: u32,
    /// Pixels in y.
    pub height: u32,
    /// What the channels are.
    pub space: PixelSpace,
    /// The pixels as stored: multiplied by the header's EXPOSURE and COLORCORR.
    pub pixels: Vec<Rgb>,
}

impl Picture {
    /// Reads a picture of either space, any encoding and any orientation; `file` names the stream in errors.
    pub fn read(input: impl BufRead, file: &str) -> Result<Self, Error> {
        let mut reader = PictureReader::new(input, file)?;
        let resolution = reader.resolution;
        let mut stored = Vec::new();
        while reader.next_pixels(&mut stored)? {}
        let (width, height) = (resolution.width, resolution.height);
        let mut pixels = vec![Rgb::ZERO; stored.len()];
        for (i, scanline) in (0..).zip(stored.chunks_exact(resolution.scanline_length() as usize)) {
            for (j, &pixel) in (0..).zip(scanline) {
                let (x, y) = resolution.pixel(i, j);
                pixels[y as usize * width as usize + x as usize] = pixel;
            }
        }
        Ok(Self { header: reader.header, width, height, space: reader.space, pixels })
    }

    /// Reads the picture file of that name.
    pub fn open(file: &str) -> Result<Self, Error> {
        let open = File::open(path_of(file)).map_err(|e| Error::io("cannot open picture", file, e))?;
        Self::read(BufReader::new(open), file)
    }

    /// The pixel in column `x` from the left and row `y` from the bottom; `None` outside.
    pub fn at(&self, x: u32, y: u32) -> Option<Rgb> {
        if x < self.width { self.pixels.get(y as usize * self.width as usize + x as usize).copied() } else { None }
    }

    /// Rows from the top down, as files and screens have them.
    pub fn rows(&self) -> impl Iterator<Item = &[Rgb]> {
        self.pixels.chunks_exact((self.width as usize).max(1)).rev()
    }

    /// Writes the picture in the standard order of pixels. The header's lines are kept, its FORMAT is replaced.
    pub fn write(&self, out: impl Write) -> io::Result<()> {
        let mut header = Header::empty();
        header.extend(self.header.lines_without_format());
        header.push(format!("FORMAT={}", self.space.format()));
        let resolution = Resolution { width: self.width, height: self.height, orientation: Orientation::TEXT };
        let mut writer = PictureWriter::new(out, &header, &resolution)?;
        self.rows().try_for_each(|row| writer.write_pixels(row))?;
        writer.flush()
    }
}
