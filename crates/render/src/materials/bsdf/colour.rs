//! Colours of scattering data: CIE tristimulus values to Radiance's primaries (shading.md 14).

use ambit_base::{Colour, Rgb};
use glam::{Mat3, Vec3};

/// From X, Y, Z to red, green, blue: the inverse of the rows .51414462 .32388448 .16197090 | .26510582 .67010582
/// .06478836 | .02410053 .12285274 .85304674.
const FROM_XYZ: Mat3 = Mat3::from_cols(
    Vec3::new(2.565_312_9, -1.022_108_2, 0.074_724_38),
    Vec3::new(-1.166_849_6, 1.978_286_6, -0.251_939_6),
    Vec3::new(-0.398_463_23, 0.043_821_556, 1.177_215_2),
);

/// CIE 1931 tristimulus values without the luminous efficacy; equal for white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cie {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) z: f32,
}

impl Cie {
    /// From luminance and CIE 1976 chromaticity u′, v′.
    pub(super) fn from_chromaticity(y: f32, u: f32, v: f32) -> Self {
        // Beyond any real colour; keeps the quotients finite.
        let v = v.max(1e-3);
        Self { x: y * 9.0 * u / (4.0 * v), y, z: y * (12.0 - 3.0 * u - 20.0 * v).max(0.0) / (4.0 * v) }
    }

    /// Red, green and blue; colours out of gamut are cut to it.
    pub(super) fn rgb(self) -> Rgb {
        (FROM_XYZ * Vec3::new(self.x, self.y, self.z)).max(Rgb::ZERO)
    }
}

/// A value with its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Coloured {
    Grey(f32),
    Rgb(Rgb),
}

impl Coloured {
    pub(super) fn rgb(self) -> Rgb {
        match self {
            Self::Grey(v) => Rgb::splat(v),
            Self::Rgb(c) => c,
        }
    }

    /// The colour at brightness 1; white if it is black.
    pub(super) fn hue(self) -> Rgb {
        match self {
            Self::Grey(_) => Rgb::ONE,
            Self::Rgb(c) => {
                let y = c.brightness();
                if y > 0.0 { c / y } else { Rgb::ONE }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_is_the_inverse() {
        let to = ambit_base::TO_XYZ.as_mat3();
        let product = FROM_XYZ * to;
        assert!(product.abs_diff_eq(Mat3::IDENTITY, 2e-6), "{product} {}", to.inverse());
    }

    #[test]
    fn chromaticity_and_tristimulus_agree() {
        // Y, X, Z = .5, .6, .25.
        let (x, y, z) = (0.6f32, 0.5f32, 0.25f32);
        let s = x + 15.0 * y + 3.0 * z;
        let c = Cie::from_chromaticity(y, 4.0 * x / s, 9.0 * y / s);
        assert!((c.x - x).abs() < 1e-6 && (c.z - z).abs() < 1e-6);
        let rgb = c.rgb();
        for (got, want) in rgb.to_array().into_iter().zip([0.856, 0.387, 0.213]) {
            assert!((got - want).abs() < 2e-3, "{rgb}");
        }
        assert!((rgb.brightness() - y).abs() < 1e-4);
    }
}
