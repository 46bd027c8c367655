//! Pictures as data: colours over a rectangle (scene.md 15.2).
//!
//! The shorter side of the picture is 1 long. The centres of the pixels at the border lie on the border of the
//! rectangle; between centres colours are blended bilinearly, outside they taper off as data tables do. Values are used
//! as they are stored: the header's exposure is not undone.

use ambit_base::{EPSILON, Rgb};
use ambit_file::{PictureReader, PixelSpace, decode_pixel, path_of};
use ambit_scene::Axis;
use std::fs::File;
use std::io::BufReader;

/// A picture with its pixels as coded, four bytes each.
#[derive(Debug)]
pub(crate) struct Image {
    /// Coordinates of the columns, from the left, and of the rows, from the bottom.
    u: Axis,
    v: Axis,
    /// Rows from the bottom up.
    codes: Vec<[u8; 4]>,
}

/// Why a file is no picture that can be used.
#[derive(Debug)]
pub(crate) enum BadImage {
    /// It cannot be read.
    Unreadable(ambit_file::Error),
    /// Its pixels are XYZ, which patterns do not accept.
    Space,
    /// It has no pixels.
    Empty,
}

impl BadImage {
    /// What to add to the message.
    pub(crate) fn detail(&self) -> String {
        match self {
            Self::Unreadable(e) => format!(" ({})", e.problem()),
            Self::Space => " (XYZ pixels)".to_owned(),
            Self::Empty => " (no pixels)".to_owned(),
        }
    }
}

impl From<ambit_file::Error> for BadImage {
    fn from(e: ambit_file::Error) -> Self {
        Self::Unreadable(e)
    }
}

/// The axes of a picture of that size, aspect being height over width of a pixel.
pub(crate) fn picture_axes(width: usize, height: usize, aspect: f64) -> (Axis, Axis) {
    let (w, h) = (width as f64, height as f64 * aspect);
    let (across, up) = if w <= h { (1.0, h / w) } else { (w / h, 1.0) };
    (Axis::even(0.0, across as f32, width), Axis::even(0.0, up as f32, height))
}

impl Image {
    /// Reads the picture file of that path.
    pub(crate) fn open(path: &str) -> Result<Self, BadImage> {
        let file = File::open(path_of(path)).map_err(|e| ambit_file::Error::io("cannot open picture file", path, e))?;
        let mut reader = PictureReader::new(BufReader::new(file), path)?;
        if reader.space != PixelSpace::Rgb {
            return Err(BadImage::Space);
        }
        let resolution = reader.resolution;
        let (width, height) = (resolution.width as usize, resolution.height as usize);
        if width == 0 || height == 0 {
            return Err(BadImage::Empty);
        }
        // Scanlines are kept as they come until the file has shown that it holds what its header promises.
        let mut stored = Vec::new();
        while let Some(scanline) = reader.next_codes()? {
            stored.extend_from_slice(scanline);
        }
        let mut codes = vec![[0; 4]; stored.len()];
        for (i, scanline) in (0..).zip(stored.chunks_exact(resolution.scanline_length() as usize)) {
            for (j, &code) in (0..).zip(scanline) {
                let (x, y) = resolution.pixel(i, j);
                codes[y as usize * width + x as usize] = code;
            }
        }
        let aspect = reader.header.pixel_aspect();
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let (u, v) = picture_axes(width, height, aspect);
        Ok(Self { u, v, codes })
    }

    /// Memory it takes.
    pub(crate) fn bytes(&self) -> usize {
        self.codes.len() * 4
    }

    /// The colour at (u, v).
    pub(crate) fn sample(&self, u: f64, v: f64) -> [f64; 3] {
        let (i, a0, a1) = self.u.cell(u);
        let (j, b0, b1) = self.v.cell(v);
        let mut sum = [0.0; 3];
        for (row, b) in [(j, b0), (j + 1, b1)] {
            for (column, a) in [(i, a0), (i + 1, a1)] {
                if a.abs() <= EPSILON || b.abs() <= EPSILON {
                    continue;
                }
                let colour: Rgb = self.codes.get(row * self.u.count + column).map_or(Rgb::ZERO, |&c| decode_pixel(c));
                for (s, c) in sum.iter_mut().zip(colour.to_array()) {
                    *s += a * b * f64::from(c);
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_file::{Header, Picture};

    fn written(space: PixelSpace, header_lines: &[&str]) -> tempfile::NamedTempFile {
        let mut header = Header::new();
        header.extend(header_lines);
        let grey = [0.502, 0.6, 0.701, 0.799, 0.0999, 0.0, 0.0, 0.0];
        let pixels = grey.map(Rgb::splat).to_vec();
        let file = tempfile::NamedTempFile::new().unwrap();
        Picture { header, width: 4, height: 2, space, pixels }.write(file.as_file()).unwrap();
        file
    }

    /// As rtrace answered, whatever the exposure.
    #[test]
    fn colours_are_blended_and_taper_off() {
        let file = written(PixelSpace::Rgb, &["EXPOSURE=2"]);
        let image = Image::open(file.path().to_str().unwrap()).unwrap();
        for (u, v, expected) in
            [(0.25, 0.0, 0.538_574_2), (2.0, 0.0, 0.798_828_1), (0.0, 0.5, 0.300_903_3), (2.2, 0.0, 0.828_125)]
        {
            let [r, g, b] = image.sample(u, v);
            assert!((r - expected).abs() < 1e-6 && r == g && g == b, "({u}, {v}): {r}");
        }
        assert_eq!(image.bytes(), 32);
    }

    #[test]
    fn tall_pixels_make_tall_pictures() {
        let file = written(PixelSpace::Rgb, &["PIXASPECT=4"]);
        let image = Image::open(file.path().to_str().unwrap()).unwrap();
        assert_eq!((image.u.end, image.v.end), (1.0, 2.0));
    }

    #[test]
    fn other_files_are_refused() {
        let file = written(PixelSpace::Xyz, &[]);
        assert!(matches!(Image::open(file.path().to_str().unwrap()), Err(BadImage::Space)));
        assert!(matches!(Image::open("no such picture"), Err(BadImage::Unreadable(_))));
    }
}
