//! What is written for a colour: RGB of the standard or other primaries, XYZ, or one photometric number.

use ambit_base::{Colour, LUMINOUS_EFFICACY, Rgb, TO_XYZ, desaturated};
use ambit_cli::Output;
use glam::{DMat3, DVec3};

/// From XYZ to the sharpened cone responses in which whites are adapted (von Kries), columns.
const SHARPENED: DMat3 = DMat3::from_cols(
    DVec3::new(1.2694, -0.8364, 0.0297),
    DVec3::new(-0.0988, 1.8006, -0.0315),
    DVec3::new(-0.1706, 0.0357, 1.0018),
);

/// Its inverse, with four digits: that is what Radiance's results have been made with.
const FROM_SHARPENED: DMat3 = DMat3::from_cols(
    DVec3::new(0.8156, 0.3791, -0.0123),
    DVec3::new(0.0472, 0.5769, 0.0167),
    DVec3::new(0.1372, 0.0440, 0.9955),
);

/// Scotopic luminance of the channels: 412 lm/W times their scotopic efficiency.
const SCOTOPIC: Rgb = Rgb::new(4.652171, 292.07463, 115.2732);

/// Melanopic luminance of the channels: 179 lm/W times their melanopic efficiency.
const MELANOPIC: Rgb = Rgb::new(0.3277638, 107.4519, 71.22034);

/// Converts what was calculated to what is written.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Conversion {
    /// Nothing to do.
    Same,
    /// A matrix.
    Matrix(DMat3),
    /// A matrix whose results are kept from being negative.
    Gamut(DMat3),
    /// One number.
    Weights(Rgb),
}

impl Conversion {
    /// The conversion for an output. Pictures of other primaries are only labelled (`labelled`).
    pub(crate) fn new(output: Output, labelled: bool) -> Self {
        match output {
            Output::Rgb | Output::Calculated { factor: 1.0, .. } => Self::Same,
            Output::Calculated { factor, .. } => Self::Matrix(DMat3::IDENTITY * f64::from(factor)),
            Output::Primaries(_) if labelled => Self::Same,
            Output::Primaries(p) => Self::Gamut(from_xyz(Some(p)) * TO_XYZ),
            Output::Xyz => Self::Matrix(TO_XYZ * f64::from(LUMINOUS_EFFICACY)),
            Output::Photopic => Self::Weights(Rgb::new(
                Rgb::X.brightness() * LUMINOUS_EFFICACY,
                Rgb::Y.brightness() * LUMINOUS_EFFICACY,
                Rgb::Z.brightness() * LUMINOUS_EFFICACY,
            )),
            Output::Scotopic => Self::Weights(SCOTOPIC),
            Output::Melanopic => Self::Weights(MELANOPIC),
            Output::Average => Self::Weights(Rgb::splat(1.0 / 3.0)),
        }
    }

    /// The same, all results divided by a number.
    pub(crate) fn over(self, divisor: f32) -> Self {
        match self {
            Self::Same => Self::Matrix(DMat3::IDENTITY / f64::from(divisor)),
            Self::Matrix(m) => Self::Matrix(m / f64::from(divisor)),
            Self::Gamut(m) => Self::Gamut(m / f64::from(divisor)),
            Self::Weights(w) => Self::Weights(w / divisor),
        }
    }

    /// How many numbers a colour becomes.
    pub(crate) fn channels(&self) -> usize {
        if matches!(self, Self::Weights(_)) { 1 } else { 3 }
    }

    /// The colour as written; one number stands in the first place.
    pub(crate) fn apply(&self, colour: Rgb) -> Rgb {
        match self {
            Self::Same => colour,
            Self::Matrix(m) => (*m * colour.as_dvec3()).as_vec3(),
            Self::Gamut(m) => desaturated(*m * colour.as_dvec3(), colour.brightness().into()).as_vec3(),
            Self::Weights(w) => Rgb::new(colour.as_dvec3().dot(w.as_dvec3()) as f32, 0.0, 0.0),
        }
    }
}

/// From XYZ to RGB of these primaries, or of the standard ones.
pub(crate) fn from_xyz(output: Option<[f64; 8]>) -> DMat3 {
    output.map_or_else(|| TO_XYZ.inverse(), |p| primaries(p).inverse() * adaptation([p[6], p[7]]))
}

/// XYZ of RGB with these primaries, white (1, 1, 1) having Y = 1.
fn primaries(p: [f64; 8]) -> DMat3 {
    let xyz = |x: f64, y: f64| DVec3::new(x, y, 1.0 - x - y);
    let columns = DMat3::from_cols(xyz(p[0], p[1]), xyz(p[2], p[3]), xyz(p[4], p[5]));
    let white = xyz(p[6], p[7]) / p[7];
    columns * DMat3::from_diagonal(columns.inverse() * white)
}

/// XYZ under the standard white, which has equal chromaticities, to XYZ under another one.
fn adaptation([x, y]: [f64; 2]) -> DMat3 {
    let to = SHARPENED * (DVec3::new(x, y, 1.0 - x - y) / y);
    let from = SHARPENED * DVec3::ONE;
    FROM_SHARPENED * DMat3::from_diagonal(to / from) * SHARPENED
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_rtrace() {
        let vivid = Rgb::new(0.9, 0.1, 0.02);
        let blue = Rgb::new(0.01, 0.1, 2.0);
        let first = Output::Primaries([0.6, 0.3, 0.2, 0.6, 0.1, 0.05, 0.3, 0.3]);
        let second = Output::Primaries([0.5, 0.4, 0.32, 0.4, 0.31, 0.2, 0.31, 0.33]);
        for (output, colour, wanted) in [
            (first, blue, [2.433448e-1, 1.068338e-2, 2.21845]),
            (first, vivid, [6.359917e-1, 1.342699e-1, 0.0]),
            (second, vivid, [0.0, 2.914055e-1, 3.020655e-1]),
            (second, blue, [1.893477e1, 3.107471e-1, 3.653189]),
            (Output::Rgb, blue, [0.01, 0.1, 2.0]),
            (Output::Xyz, vivid, [8.920608e1, 5.493538e1, 9.135567]),
            (Output::Scotopic, vivid, [3.569988e1, 0.0, 0.0]),
            (Output::Melanopic, vivid, [1.246458e1, 0.0, 0.0]),
            (Output::Photopic, blue, [3.566367e1, 0.0, 0.0]),
            (Output::Average, blue, [7.033333e-1, 0.0, 0.0]),
        ] {
            let made = Conversion::new(output, false).apply(colour);
            for (a, b) in made.to_array().into_iter().zip(wanted) {
                // Radiance goes through single precision, and the primaries of `second` lie close together.
                assert!((a - b).abs() <= 5e-6 * b.max(1.0), "{output:?} {made} {wanted:?}");
            }
        }
        assert_eq!(Conversion::new(first, true).apply(vivid), vivid);
    }
}
