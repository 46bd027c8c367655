//! Pictures for other programs: PNG, tone-mapped by an exposure and a transfer curve, and EXR, linear.

use crate::picture::{Picture, PixelSpace};
use ambit_base::{Colour, Rgb};
use glam::{Mat3, Vec3};
use image::{ImageBuffer, ImageError, ImageFormat, RgbImage};
use std::io::{Seek, Write};

/// From CIE XYZ to red, green and blue of Radiance's standard primaries, equal-energy white (columns X, Y, Z).
const XYZ_TO_RGB: Mat3 = Mat3::from_cols(
    Vec3::new(2.5653128, -1.0221082, 0.0747244),
    Vec3::new(-1.1668496, 1.9782866, -0.2519396),
    Vec3::new(-0.3984632, 0.0438216, 1.1772152),
);

/// What the logarithmic mean of the brightness becomes with automatic exposure: the key of an ordinary scene
/// (Reinhard, Stark, Shirley & Ferwerda 2002, *Photographic Tone Reproduction for Digital Images*, equation 2).
const KEY: f64 = 0.18;

/// What values are multiplied by before they are mapped to the range of a display, where 1 is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// A factor.
    Factor(f64),
    /// A power of two.
    Stops(f64),
    /// The logarithmic mean of the brightness becomes a medium grey; black pixels do not count.
    Automatic,
}

/// How linear values become display values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// v^(1/γ); 2.2 is usual.
    Gamma(f64),
    /// The curve of IEC 61966-2-1.
    Srgb,
}

/// A picture that could not be written in another format.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A picture without pixels.
    #[error("empty picture")]
    Empty,
    /// An exposure or gamma that is not a positive number.
    #[error("{0} must be a positive number")]
    Parameter(&'static str),
    /// The encoder or the file failed.
    #[error(transparent)]
    Encoder(#[from] ImageError),
}

impl Exposure {
    /// The factor for a picture's stored values.
    pub fn factor(self, picture: &Picture) -> f64 {
        match self {
            Self::Factor(f) => f,
            Self::Stops(s) => s.exp2(),
            Self::Automatic => {
                let (mut sum, mut count) = (0.0, 0u64);
                for &p in &picture.pixels {
                    let brightness = f64::from(linear(p, picture.space).brightness());
                    if brightness > 0.0 {
                        sum += brightness.ln();
                        count += 1;
                    }
                }
                if count == 0 { 1.0 } else { KEY / (sum / count as f64).exp() }
            }
        }
    }
}

impl Transfer {
    /// The byte for a linear value; 1 and more are white.
    fn byte(self, v: f64) -> u8 {
        let v = v.clamp(0.0, 1.0);
        let display = match self {
            Self::Gamma(g) => v.powf(1.0 / g),
            Self::Srgb if v <= 0.003_130_8 => 12.92 * v,
            Self::Srgb => 1.055 * v.powf(1.0 / 2.4) - 0.055,
        };
        (display * 255.0 + 0.5) as u8
    }
}

/// Writes an 8-bit PNG. The picture's values are taken as stored, with the exposure its header tells of; its primaries
/// are taken for those of the display. Pixels are assumed square.
pub fn write_png(
    picture: &Picture,
    exposure: Exposure,
    transfer: Transfer,
    mut out: impl Write + Seek,
) -> Result<(), ExportError> {
    if matches!(transfer, Transfer::Gamma(g) if !(g.is_finite() && g > 0.0)) {
        return Err(ExportError::Parameter("gamma"));
    }
    let factor = exposure.factor(picture);
    if !(factor.is_finite() && factor > 0.0) {
        return Err(ExportError::Parameter("exposure"));
    }
    let bytes = picture
        .rows()
        .flatten()
        .flat_map(|&p| linear(p, picture.space).to_array().map(|v| transfer.byte(f64::from(v) * factor)))
        .collect();
    let image = RgbImage::from_raw(picture.width, picture.height, bytes).filter(|i| !i.is_empty());
    Ok(image.ok_or(ExportError::Empty)?.write_to(&mut out, ImageFormat::Png)?)
}

/// Writes an EXR of 32-bit floats that hold the physical values: the header's EXPOSURE and COLORCORR are undone, so
/// that RGB pictures give radiance in W/(sr·m²).
pub fn write_exr(picture: &Picture, mut out: impl Write + Seek) -> Result<(), ExportError> {
    let [r, g, b] = picture.header.colour_correction().map(|c| (1.0 / (c * picture.header.exposure())) as f32);
    let undo = Rgb::new(r, g, b);
    if !undo.is_finite() {
        return Err(ExportError::Parameter("the header's exposure"));
    }
    // An exposure applies to any three channels alike, so it is undone before the space changes.
    let values = picture.rows().flatten().flat_map(|&p| linear(p * undo, picture.space).to_array()).collect();
    let image = ImageBuffer::<image::Rgb<f32>, Vec<f32>>::from_raw(picture.width, picture.height, values);
    Ok(image.filter(|i| !i.is_empty()).ok_or(ExportError::Empty)?.write_to(&mut out, ImageFormat::OpenExr)?)
}

/// Red, green and blue of a pixel.
fn linear(p: Rgb, space: PixelSpace) -> Rgb {
    match space {
        PixelSpace::Rgb => p,
        PixelSpace::Xyz => XYZ_TO_RGB * p,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::Header;
    use std::io::Cursor;

    fn picture(space: PixelSpace, top: [Rgb; 2], bottom: [Rgb; 2]) -> Picture {
        let mut header = Header::new();
        header.push("EXPOSURE=2");
        header.push("COLORCORR= 1 2 4");
        Picture { header, width: 2, height: 2, space, pixels: [bottom, top].concat() }
    }

    fn grey(v: f32) -> Rgb {
        Rgb::splat(v)
    }

    fn decoded(bytes: &[u8]) -> image::DynamicImage {
        image::load_from_memory(bytes).unwrap()
    }

    #[test]
    fn png_has_the_top_row_first_and_the_curve_applied() {
        let p = picture(PixelSpace::Rgb, [grey(0.5), grey(9.0)], [grey(0.0), grey(0.001)]);
        for (transfer, half, small) in [(Transfer::Srgb, 188, 3), (Transfer::Gamma(2.2), 186, 11)] {
            let mut out = Cursor::new(Vec::new());
            write_png(&p, Exposure::Factor(1.0), transfer, &mut out).unwrap();
            let image = decoded(out.get_ref()).to_rgb8();
            let bytes: Vec<u8> = image.pixels().map(|p| p.0[1]).collect();
            assert_eq!(bytes, [half, 255, 0, small]);
        }
    }

    #[test]
    fn exposures_scale_and_the_automatic_one_finds_the_middle() {
        let p = picture(PixelSpace::Rgb, [grey(0.5), grey(2.0)], [grey(0.0), grey(1.0)]);
        assert_eq!(Exposure::Stops(-3.0).factor(&p), 0.125);
        // The logarithmic mean of ½, 1 and 2 is 1; brightness weights add up to one in six digits.
        assert!((Exposure::Automatic.factor(&p) - KEY).abs() < 1e-6);
        let black = picture(PixelSpace::Rgb, [grey(0.0); 2], [grey(0.0); 2]);
        assert_eq!(Exposure::Automatic.factor(&black), 1.0);
    }

    #[test]
    fn exr_holds_physical_values() {
        let p = picture(PixelSpace::Rgb, [grey(8.0), grey(1.0)], [grey(0.0), grey(1e6)]);
        let mut out = Cursor::new(Vec::new());
        write_exr(&p, &mut out).unwrap();
        let image = decoded(out.get_ref()).to_rgb32f();
        assert_eq!(image.get_pixel(0, 0).0, [4.0, 2.0, 1.0]);
        assert_eq!(image.get_pixel(1, 1).0, [5e5, 2.5e5, 1.25e5]);
    }

    #[test]
    fn xyz_becomes_rgb() {
        // X, Y and Z of equal-energy white.
        let white = linear(grey(1.0), PixelSpace::Xyz);
        assert!((white - grey(1.0)).abs().max_element() < 1e-5, "{white}");
    }

    #[test]
    fn impossible_parameters_are_refused() {
        let p = picture(PixelSpace::Rgb, [grey(1.0); 2], [grey(1.0); 2]);
        let png = |e, t| write_png(&p, e, t, Cursor::new(Vec::new()));
        assert!(png(Exposure::Factor(0.0), Transfer::Srgb).is_err());
        assert!(png(Exposure::Factor(f64::NAN), Transfer::Srgb).is_err());
        assert!(png(Exposure::Factor(1.0), Transfer::Gamma(0.0)).is_err());
        let empty = Picture { width: 0, height: 0, pixels: Vec::new(), ..p.clone() };
        assert!(write_png(&empty, Exposure::Automatic, Transfer::Srgb, Cursor::new(Vec::new())).is_err());
        assert!(write_exr(&empty, Cursor::new(Vec::new())).is_err());
    }
}
