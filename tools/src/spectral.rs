//! What is written for a spectrum: a colour, one photometric number, or its bins.

use crate::colour::{Conversion, from_xyz};
use ambit_base::{LUMINOUS_EFFICACY, desaturated};
use ambit_cli::{Output, SCOTOPIC_EFFICACY};
use ambit_render::{Efficiency, Spectrum};
use glam::{DMat3, DVec3};

/// Room for whatever a spectrum becomes.
pub(crate) type Channels = [f32; Spectrum::MOST];

/// Converts the bins that were calculated to what is written.
#[derive(Clone, Debug)]
pub(crate) enum SpectralConversion {
    /// The bins, times a factor.
    Bins {
        /// How many.
        count: usize,
        /// What they are multiplied by.
        factor: f32,
    },
    /// Weights of the bins, one number.
    Number(Vec<f64>),
    /// Tristimulus values of the bins, and a matrix from their sum to the channels.
    Colour {
        /// Of each bin.
        xyz: Vec<DVec3>,
        /// To the channels.
        channels: DMat3,
        /// If channels are kept from being negative: what brightness 1 is in each channel of its grey.
        grey: Option<f64>,
    },
}

impl SpectralConversion {
    /// The conversion of spectra for an output.
    pub(crate) fn new(output: Output, spectrum: &Spectrum) -> Self {
        let colour = |channels: DMat3, grey| Self::Colour { xyz: spectrum.tristimulus(), channels, grey };
        let weighed = |function, efficacy: f32| {
            let weights = spectrum.efficiency(function);
            Self::Number(weights.into_iter().map(|w| w * f64::from(efficacy)).collect())
        };
        match output {
            Output::Calculated { bins: true, factor } => Self::Bins { count: spectrum.bins(), factor },
            Output::Calculated { bins: false, factor } => {
                let factor = f64::from(factor);
                colour(from_xyz(None) * factor, Some(factor))
            }
            Output::Rgb => colour(from_xyz(None), Some(1.0)),
            Output::Primaries(p) => colour(from_xyz(Some(p)), Some(1.0)),
            Output::Xyz => colour(DMat3::IDENTITY * f64::from(LUMINOUS_EFFICACY), None),
            Output::Photopic => {
                Self::Number(spectrum.tristimulus().iter().map(|c| c.y * f64::from(LUMINOUS_EFFICACY)).collect())
            }
            Output::Scotopic => weighed(Efficiency::Scotopic, SCOTOPIC_EFFICACY),
            Output::Melanopic => weighed(Efficiency::Melanopic, LUMINOUS_EFFICACY),
            Output::Average => Self::Number(vec![1.0 / spectrum.bins() as f64; spectrum.bins()]),
        }
    }

    /// The same, all results divided by a number.
    pub(crate) fn over(self, divisor: f32) -> Self {
        let by = f64::from(divisor);
        match self {
            Self::Bins { count, factor } => Self::Bins { count, factor: factor / divisor },
            Self::Number(weights) => Self::Number(weights.into_iter().map(|w| w / by).collect()),
            Self::Colour { xyz, channels, grey } => {
                Self::Colour { xyz, channels: channels / by, grey: grey.map(|g| g / by) }
            }
        }
    }

    /// How many numbers a spectrum becomes.
    pub(crate) fn channels(&self) -> usize {
        match self {
            Self::Bins { count, .. } => *count,
            Self::Number(_) => 1,
            Self::Colour { .. } => 3,
        }
    }

    /// The numbers for a spectrum, which stand in `out`.
    pub(crate) fn apply<'o>(&self, bins: &[f32], out: &'o mut Channels) -> &'o [f32] {
        match self {
            Self::Bins { factor, .. } => out.iter_mut().zip(bins).for_each(|(c, b)| *c = b * factor),
            Self::Number(weights) => {
                out[0] = weights.iter().zip(bins).map(|(w, &b)| w * f64::from(b)).sum::<f64>() as f32;
            }
            Self::Colour { xyz, channels, grey } => {
                let sum: DVec3 = xyz.iter().zip(bins).map(|(&c, &b)| c * f64::from(b)).sum();
                let colour = *channels * sum;
                let colour = grey.map_or(colour, |grey| desaturated(colour, sum.y * grey));
                out[..3].copy_from_slice(&colour.as_vec3().to_array());
            }
        }
        &out[..self.channels()]
    }
}

/// What converts the answers of a run.
#[derive(Clone, Debug)]
pub(crate) enum Converter {
    /// Of a calculation in red, green and blue.
    Rgb(Conversion),
    /// Of one by wavelength.
    Spectral(SpectralConversion),
}

impl Converter {
    /// The conversion of what is calculated for an output.
    pub(crate) fn new(output: Output, spectrum: &Spectrum) -> Self {
        if spectrum.is_rgb() {
            Self::Rgb(Conversion::new(output, false))
        } else {
            Self::Spectral(SpectralConversion::new(output, spectrum))
        }
    }

    /// The conversion of shares of light, which have no lumens.
    pub(crate) fn of_shares(&self, output: Output) -> Self {
        let efficacy = output.efficacy();
        if efficacy == 1.0 {
            return self.clone();
        }
        match self.clone() {
            Self::Rgb(c) => Self::Rgb(c.over(efficacy)),
            Self::Spectral(c) => Self::Spectral(c.over(efficacy)),
        }
    }

    /// How many numbers a colour becomes.
    pub(crate) fn channels(&self) -> usize {
        match self {
            Self::Rgb(c) => c.channels(),
            Self::Spectral(c) => c.channels(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red, green and blue 1, 2, 3 by wavelength, and what rtrace writes for it.
    #[test]
    fn spectra_become_what_rtrace_writes() {
        let first = Output::Primaries([0.7, 0.3, 0.2, 0.7, 0.1, 0.1, 0.33, 0.33]);
        let nine = [1., 1., 1., 1., 2., 2., 2., 3., 3.];
        let (bins, factor) = (true, 179.0);
        for (output, wanted) in [
            (Output::Rgb, &[1.333_501, 1.969_435, 2.915_434][..]),
            (Output::Xyz, &[321.4297, 333.3221, 494.235]),
            (Output::Photopic, &[333.3221]),
            (Output::Scotopic, &[901.1129]),
            (Output::Melanopic, &[406.8122]),
            (Output::Average, &[1.777_778]),
            (first, &[1.631_215, 1.785_644, 2.845_118]),
            (Output::Calculated { bins, factor }, &[179., 179., 179., 179., 358., 358., 358., 537., 537.]),
            (Output::Calculated { bins: false, factor }, &[238.6966, 352.5288, 521.8626]),
        ] {
            let conversion = SpectralConversion::new(output, &Spectrum::new(9, 380.0, 780.0).unwrap());
            let mut made = Channels::default();
            let made = conversion.apply(&nine, &mut made);
            assert_eq!((made.len(), conversion.channels()), (wanted.len(), wanted.len()));
            for (a, b) in made.iter().zip(wanted) {
                assert!((a - b).abs() <= 1e-3 * b, "{output:?} {made:?} {wanted:?}");
            }
        }
    }

    #[test]
    fn no_channel_of_a_colour_is_negative() {
        let spectrum = Spectrum::new(9, 380.0, 780.0).unwrap();
        let mut green = [0.0; 9];
        green[5] = 1.0;
        let mut made = Channels::default();
        let made = SpectralConversion::new(Output::Rgb, &spectrum).apply(&green, &mut made).to_vec();
        assert!(made.iter().all(|&c| c >= 0.0) && made[1] > 0.3, "{made:?}");
    }
}
