//! Hyperspectral pictures as data (scene.md 15.3): four to twenty-four bands a pixel, from long to short wavelengths.

use super::folding::{Layout, MAX_BANDS};
use super::image::picture_axes;
use ambit_base::EPSILON;
use ambit_file::{Header, Orientation, Resolution, decode_spectrum};
use ambit_scene::Axis;

/// A picture with its pixels as coded: a byte a band and the exponent.
#[derive(Debug)]
pub(crate) struct SpectralImage {
    u: Axis,
    v: Axis,
    /// Bands a pixel.
    bands: usize,
    /// Longest and shortest wavelength, nm.
    range: (f64, f64),
    /// Rows from the top down, as in the file.
    codes: Box<[u8]>,
}

impl SpectralImage {
    /// Reads a picture. The error says what is wrong with it.
    pub(crate) fn parse(mut bytes: &[u8], file: &str) -> Result<Self, String> {
        let header = Header::read(&mut bytes, file).map_err(|e| e.problem())?;
        let resolution = Resolution::read(&mut bytes, file).map_err(|e| e.problem())?;
        if header.format() != Some("Radiance_spectra") {
            return Err("no FORMAT=Radiance_spectra".into());
        }
        let bands = header.components() as usize;
        if !(4..=MAX_BANDS).contains(&bands) {
            return Err(format!("NCOMP={bands}, expected 4 to {MAX_BANDS}"));
        }
        let splits = header.wavelength_splits().filter(|[longest, .., shortest]| longest > shortest && *shortest > 0.0);
        let Some([longest, .., shortest]) = splits else {
            return Err("no WAVELENGTH_SPLITS that fall".into());
        };
        if resolution.orientation != Orientation::TEXT {
            return Err(format!("resolution string '{resolution}', expected -Y HEIGHT +X WIDTH"));
        }
        let (width, height) = (resolution.width as usize, resolution.height as usize);
        let size = width.checked_mul(height).and_then(|n| n.checked_mul(bands + 1)).filter(|&n| n > 0);
        let Some(codes) = size.and_then(|n| bytes.get(..n)) else {
            return Err(format!("fewer than {width} x {height} pixels"));
        };
        let codes = codes.into();
        let aspect = header.pixel_aspect();
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let (u, v) = picture_axes(width, height, aspect);
        Ok(Self { u, v, bands, range: (longest, shortest), codes })
    }

    /// Number of bands.
    pub(crate) fn bands(&self) -> usize {
        self.bands
    }

    /// Wavelength in the middle of a band, nm.
    pub(crate) fn wavelength(&self, band: usize) -> f64 {
        self.range.0 + (self.range.1 - self.range.0) * ((band as f64 + 0.5) / self.bands as f64)
    }

    /// Where its bands lie.
    pub(crate) fn layout(&self) -> Layout {
        Layout::bands(self.range.0, self.range.1, self.bands)
    }

    /// The spectrum at (u, v); of `values` the first are filled.
    pub(crate) fn sample(&self, u: f64, v: f64, values: &mut [f64; MAX_BANDS]) {
        let (i, a0, a1) = self.u.cell(u);
        let (j, b0, b1) = self.v.cell(v);
        let size = self.bands + 1;
        values.fill(0.0);
        for (row, b) in [(j, b0), (j + 1, b1)] {
            for (column, a) in [(i, a0), (i + 1, a1)] {
                if a.abs() <= EPSILON || b.abs() <= EPSILON {
                    continue;
                }
                let Some(from_top) = (self.v.count - 1).checked_sub(row) else { continue };
                let start = (from_top * self.u.count + column) * size;
                let mut pixel = [0.0; MAX_BANDS];
                if let Some(code) = self.codes.get(start..start + size) {
                    decode_spectrum(code, &mut pixel[..self.bands]);
                }
                for (value, c) in values.iter_mut().zip(&pixel) {
                    *value += a * b * f64::from(*c);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(format: &str, splits: &str) -> Vec<u8> {
        let mut bytes =
            format!("#?RADIANCE\nNCOMP=4\nWAVELENGTH_SPLITS= {splits}\nFORMAT={format}\n\n-Y 2 +X 2\n").into_bytes();
        // Top left, top right, bottom left, bottom right; exponent 129 makes a mantissa m stand for (m + ½)/128.
        for m in [10u8, 20, 30, 40] {
            bytes.extend([m, m + 1, m + 2, m + 3, 129]);
        }
        bytes
    }

    #[test]
    fn spectra_are_blended_between_pixels() {
        let image = SpectralImage::parse(&picture("Radiance_spectra", "780 588 480 380"), "p.hsr").unwrap();
        let mut values = [0.0; MAX_BANDS];
        let mut at = |u, v| {
            image.sample(u, v, &mut values);
            (values[0], values[3])
        };
        assert_eq!(at(0.0, 0.0), (30.5 / 128.0, 33.5 / 128.0));
        assert_eq!(at(1.0, 1.0), (20.5 / 128.0, 23.5 / 128.0));
        assert_eq!(at(0.5, 0.0), (35.5 / 128.0, 38.5 / 128.0));
        assert_eq!((image.bands(), image.wavelength(0), image.wavelength(3)), (4, 730.0, 430.0));
    }

    #[test]
    fn others_are_refused() {
        let good = picture("Radiance_spectra", "780 588 480 380");
        assert!(SpectralImage::parse(&good[..good.len() - 1], "p").is_err());
        assert!(SpectralImage::parse(&picture("32-bit_rle_rgbe", "780 588 480 380"), "p").is_err());
        assert!(SpectralImage::parse(&picture("Radiance_spectra", "380 480 588 780"), "p").is_err());
        assert!(SpectralImage::parse(b"", "p").is_err());
    }
}
