//! Pictures: a header, a resolution string and scanlines of RGBE or XYZE pixels, run-length encoded or flat.
//!
//! RGBE holds radiance in W/(sr·m²) per channel. XYZE as rpict writes it holds luminous values (cd/m² for Y). Both have
//! been multiplied by the header's EXPOSURE and COLORCORR.

mod read;
mod scanline;
mod whole;
mod write;

pub use read::PictureReader;
pub use scanline::{decode_scanline, encode_flat, encode_scanline};
pub use whole::Picture;
pub use write::PictureWriter;

/// What the three channels of a pixel are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelSpace {
    /// Red, green and blue of the header's PRIMARIES.
    #[default]
    Rgb,
    /// CIE X, Y and Z.
    Xyz,
}

impl PixelSpace {
    /// The value of the header's `FORMAT`.
    pub fn format(self) -> &'static str {
        match self {
            Self::Rgb => "32-bit_rle_rgbe",
            Self::Xyz => "32-bit_rle_xyze",
        }
    }

    /// The space that a `FORMAT` stands for.
    pub fn from_format(format: &str) -> Option<Self> {
        [Self::Rgb, Self::Xyz].into_iter().find(|s| s.format() == format)
    }
}
