//! The line between a picture's header and its pixels: size and order of the scanlines.
//!
//! `-Y H +X W` is the standard: H scanlines from top to bottom, W pixels each from left to right. Image coordinates
//! have x to the right and y **up**, (0, 0) is the lower left pixel.

use crate::error::Error;
use std::fmt;
use std::io::{BufRead, Read};

/// The longest resolution string read.
const LIMIT: usize = 31;

/// One of the image's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// To the right.
    X,
    /// Up.
    Y,
}

/// The order of scanlines and pixels in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orientation {
    /// The axis from scanline to scanline; pixels of a scanline follow the other one.
    pub slow: Axis,
    /// True if x grows.
    pub right: bool,
    /// True if y grows.
    pub up: bool,
}

impl Orientation {
    /// As text is written: scanlines from the top down, pixels from left to right.
    pub const TEXT: Self = Self { slow: Axis::Y, right: true, up: false };

    /// All eight.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..8).map(|i| Self { slow: if i & 4 == 0 { Axis::Y } else { Axis::X }, right: i & 1 == 0, up: i & 2 != 0 })
    }
}

/// Size of a picture and the order of its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Pixels in x.
    pub width: u32,
    /// Pixels in y.
    pub height: u32,
    /// The order of the pixels.
    pub orientation: Orientation,
}

impl Resolution {
    /// The standard order of pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, orientation: Orientation::TEXT }
    }

    /// Reads the line, newline included; `file` names the stream in errors.
    pub fn read(input: &mut (impl BufRead + ?Sized), file: &str) -> Result<Self, Error> {
        let mut line = Vec::new();
        Read::take(&mut *input, LIMIT as u64)
            .read_until(b'\n', &mut line)
            .map_err(|e| Error::io("cannot read resolution string of", file, e))?;
        Self::parse(&line).ok_or_else(|| Error::Resolution {
            file: file.to_owned(),
            found: String::from_utf8_lossy(&line).trim_end().chars().take(LIMIT).collect(),
        })
    }

    /// Parses the text of the line: the letters `X` and `Y`, the sign right before each (`-` decreases, anything else
    /// increases) and the positive number after each count.
    pub fn parse(line: &[u8]) -> Option<Self> {
        let axis = |name: u8| {
            let at = line.iter().position(|&b| b == name)?;
            let up = at == 0 || line[at - 1] != b'-';
            let rest = line[at + 1..].trim_ascii_start();
            let rest = rest.strip_prefix(b"+").unwrap_or(rest);
            let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
            let size: i32 = std::str::from_utf8(&rest[..digits]).ok()?.parse().ok()?;
            (size > 0).then_some((at, up, size as u32))
        };
        let ((at_x, right, width), (at_y, up, height)) = (axis(b'X')?, axis(b'Y')?);
        let slow = if at_x < at_y { Axis::X } else { Axis::Y };
        Some(Self { width, height, orientation: Orientation { slow, right, up } })
    }

    /// Number of scanlines.
    pub fn scanlines(&self) -> u32 {
        if self.orientation.slow == Axis::Y { self.height } else { self.width }
    }

    /// Pixels in a scanline.
    pub fn scanline_length(&self) -> u32 {
        if self.orientation.slow == Axis::Y { self.width } else { self.height }
    }

    /// Image coordinates (x to the right, y up) of pixel `j` of scanline `i`, both from 0 and within the picture.
    #[inline]
    pub fn pixel(&self, i: u32, j: u32) -> (u32, u32) {
        let (x, y) = if self.orientation.slow == Axis::Y { (j, i) } else { (i, j) };
        let along = |v: u32, size: u32, grows: bool| if grows { v } else { size - 1 - v };
        (along(x, self.width, self.orientation.right), along(y, self.height, self.orientation.up))
    }
}

/// The line as programs write it, without its newline.
impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = |grows| if grows { '+' } else { '-' };
        let (x, y) = (sign(self.orientation.right), sign(self.orientation.up));
        match self.orientation.slow {
            Axis::Y => write!(f, "{y}Y {:8} {x}X {:8}", self.height, self.width),
            Axis::X => write!(f, "{x}X {:8} {y}Y {:8}", self.width, self.height),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_orientations_place_their_pixels() {
        let (w, h) = (5, 3);
        // Scanline 1, pixel 2 of each.
        for (line, expected) in [
            ("-Y 3 +X 5", (2, 1)),
            ("-Y 3 -X 5", (w - 3, 1)),
            ("+Y 3 +X 5", (2, 1)),
            ("+Y 3 -X 5", (w - 3, 1)),
            ("+X 5 +Y 3", (1, 2)),
            ("+X 5 -Y 3", (1, h - 3)),
            ("-X 5 +Y 3", (w - 2, 2)),
            ("-X 5 -Y 3", (w - 2, h - 3)),
        ] {
            let r = Resolution::parse(line.as_bytes()).unwrap();
            assert_eq!((r.width, r.height), (w, h), "{line}");
            assert_eq!(r.pixel(1, 2), expected, "{line}");
            assert_eq!(Resolution::parse(r.to_string().as_bytes()), Some(r));
        }
        assert_eq!(Resolution::parse(b"-Y 3 +X 5").unwrap().pixel(0, 0), (0, 2));
    }

    #[test]
    fn it_is_written_as_renderers_write_it() {
        assert_eq!(Resolution::new(39, 30).to_string(), "-Y       30 +X       39");
        for o in Orientation::all() {
            let r = Resolution { width: 7, height: 9, orientation: o };
            assert_eq!(Resolution::parse(r.to_string().as_bytes()), Some(r));
        }
    }

    #[test]
    fn junk_is_refused_with_its_text() {
        for bad in ["", "-Y 3", "-Y 0 +X 5", "-Y 3 +X -5", "-Y 3 +X 99999999999", "Y X"] {
            let e = Resolution::read(&mut bad.as_bytes(), "p.hdr").unwrap_err().to_string();
            assert!(e.starts_with(&format!("p.hdr: bad resolution string '{bad}'")), "{e}");
        }
    }
}
