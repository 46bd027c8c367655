//! Spectra folded to the three channels: what a list of values at given wavelengths is worth in them (shading.md 14).
//!
//! The sum over values is linear up to its last step, so a spectrum's wavelengths give each value a weight once, and
//! folding costs three products a value. In a calculation by wavelength a channel takes the mean over its bin, and what
//! the list does not cover is black. In red, green and blue, a list of at most 24 values from long to short wavelengths
//! is taken as bands around them; others are first averaged over about as many bands of the range of the calculation.
//! Three bands are red, green and blue themselves.
//!
//! A function of wavelength is sampled at steps of a quarter of a bin down from its longest wavelength, as many as fit;
//! with more than 24 of them, 24 are spread evenly. The samples then count as equal bands of all its range, and are
//! averaged like the lists above. So did measured answers of Radiance turn out, to the last digit; a range shorter than
//! one sample is black there, too.

use crate::spectral::{Spectrum, desaturate, rgb_of_xyz, tristimulus};
use ambit_base::Rgb;
use glam::DVec3;
use std::ops::Range;

/// Most bands that Radiance computes with.
pub(crate) const MAX_BANDS: usize = Spectrum::MOST;

/// Samples of a function of wavelength in each bin.
const SAMPLES: f64 = 4.0;
/// Radiance places each sample at random in the middle part of its step, this much of it; the last step may end before
/// the rest of it.
const JITTER: f64 = 0.9;
/// Wavelengths that stand for a sample's random place, whose mean they give: 10 nm apart in red, green and blue.
const PLACES: usize = 3;
/// What a quotient may lack of a whole number by rounding.
const ROUNDING: f64 = 1e-9;
/// Radiance averages over the next larger number of bands, unless a quotient is this near above a whole number.
const ALMOST_WHOLE: f64 = 0.01;

/// Limits of a value's band, nm.
type Band = (f64, f64);

/// Where the values of a list lie.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    bands: Vec<Band>,
    /// Typical width of a band, nm.
    width: f64,
    /// Red, green and blue are made of the bands as they are.
    direct: bool,
    /// So many values in a row belong to each band.
    repeat: usize,
}

impl Layout {
    /// For values at evenly spaced wavelengths (nm), the first at `first`, the last at `last`, which differs.
    pub(crate) fn even(first: f64, last: f64, count: usize) -> Self {
        let step = (last - first) / (count.max(2) - 1) as f64;
        let half = 0.5 * step.abs();
        if step < 0.0 && count <= MAX_BANDS {
            // Radiance keeps the outer limits in single precision. Borders are cut to whole nanometres later on: those that
            // should be whole fall to either side of that.
            let limit = |nm: f64| f64::from(nm as f32);
            return Self { width: -step, ..Self::bands(limit(first + half), limit(last - half), count) };
        }
        let bands = (0..count)
            .map(|i| {
                let centre = first + step * i as f64;
                (centre - half, centre + half)
            })
            .collect();
        Self { bands, width: step.abs(), direct: false, repeat: 1 }
    }

    /// For values at wavelengths (nm) in order, either way: each stands for what is nearest to it.
    pub(crate) fn uneven(wavelengths: &[f64]) -> Self {
        let at = |i: usize| wavelengths[i];
        let last = wavelengths.len() - 1;
        let border = |i: usize| 0.5 * (at(i) + at(i + 1));
        let bands = (0..=last)
            .map(|i| {
                let before = if i == 0 { 2.0 * at(0) - border(0) } else { border(i - 1) };
                let after = if i == last { 2.0 * at(i) - border(i - 1) } else { border(i) };
                (before.min(after), before.max(after))
            })
            .collect();
        Self { bands, width: (at(last) - at(0)).abs() / last as f64, direct: false, repeat: 1 }
    }

    /// For values of a function at the wavelengths (nm) that are returned beside, which lie from `longest` down to
    /// `shortest`; none if the range is too short for a sample.
    pub(crate) fn sampled(longest: f64, shortest: f64, spectrum: &Spectrum) -> (Self, Box<[f64]>) {
        let range = longest - shortest;
        let mut step = spectrum.width() / SAMPLES;
        // The cast of what is no number, or negative, is 0.
        let mut count = (range / step + (1.0 - JITTER) + ROUNDING) as usize;
        if count > MAX_BANDS {
            count = MAX_BANDS;
            step = range / count as f64;
        }
        let place = |i: usize, k: usize| {
            let within = 0.5 + JITTER * ((k as f64 + 0.5) / PLACES as f64 - 0.5);
            longest - step * (i as f64 + within)
        };
        let wavelengths = (0..count).flat_map(|i| (0..PLACES).map(move |k| place(i, k))).collect();
        let width = range / count.max(1) as f64;
        let border = |i: usize| longest - width * i as f64;
        let bands = (0..count).map(|i| (border(i + 1), border(i))).collect();
        (Self { bands, width, direct: false, repeat: PLACES }, wavelengths)
    }

    /// For values that hold throughout `count` equal bands from `longest` down to `shortest` (nm).
    pub(crate) fn bands(longest: f64, shortest: f64, count: usize) -> Self {
        let border = |i: usize| longest + (shortest - longest) * (i as f64 / count as f64);
        let bands = (0..count).map(|i| (border(i + 1), border(i))).collect();
        Self { bands, width: (longest - shortest) / count as f64, direct: true, repeat: 1 }
    }

    /// How the values fold in each pass of a calculation.
    pub(crate) fn foldings(&self, spectrum: &Spectrum) -> Box<[Folding]> {
        if !spectrum.is_rgb() {
            return spectrum.schedule().iter().map(|bins| self.onto(bins)).collect();
        }
        let weights = if self.direct { rgb_of_bands(&self.bands) } else { self.averaged(spectrum) };
        Box::new([Folding { weights: self.repeated(weights.into_iter()), observed: true }])
    }

    /// Means over the bins of three channels.
    fn onto(&self, bins: &[Range<f64>; 3]) -> Folding {
        let weight = |&band: &Band| DVec3::from_array([0, 1, 2].map(|c| overlap(band, &bins[c])));
        Folding { weights: self.repeated(self.bands.iter().map(weight)), observed: false }
    }

    /// Averages over bands of the range of the calculation, about as wide as the values' own, seen in colour.
    fn averaged(&self, spectrum: &Spectrum) -> Vec<DVec3> {
        let [longest, .., shortest] = spectrum.limits();
        let range = longest - shortest;
        // The cast of what is no number, or too large, stays in range.
        let count = ((range / self.width + (1.0 - ALMOST_WHOLE)) as usize).clamp(3, MAX_BANDS);
        let wide = Self::bands(longest, shortest, count);
        let colours = rgb_of_bands(&wide.bands);
        let weight = |&own: &Band| {
            let share = |&(a, b): &Band| overlap(own, &(a..b));
            wide.bands.iter().zip(&colours).map(|(band, &colour)| colour * share(band)).sum()
        };
        self.bands.iter().map(weight).collect()
    }

    fn repeated(&self, weights: impl Iterator<Item = DVec3>) -> Box<[DVec3]> {
        weights.flat_map(|w| std::iter::repeat_n(w / self.repeat as f64, self.repeat)).collect()
    }
}

/// How much of a bin a band fills.
fn overlap((a, b): Band, bin: &Range<f64>) -> f64 {
    (b.min(bin.end) - a.max(bin.start)).max(0.0) / (bin.end - bin.start)
}

/// Red, green and blue of unit power in bands, from long to short; three of them are these themselves.
fn rgb_of_bands(bands: &[Band]) -> Vec<DVec3> {
    if bands.len() == 3 {
        return vec![DVec3::X, DVec3::Y, DVec3::Z];
    }
    bands.iter().map(|&(a, b)| rgb_of_xyz(tristimulus(&(a..b)))).collect()
}

/// Weights of the values of one list in one pass.
#[derive(Clone, Debug)]
pub(crate) struct Folding {
    weights: Box<[DVec3]>,
    /// The channels are red, green and blue, which turn greyer where one would be negative.
    observed: bool,
}

impl Folding {
    /// The three channels of a list of values.
    pub(crate) fn fold(&self, values: impl IntoIterator<Item = f64>) -> Rgb {
        let sum = self.weights.iter().zip(values).map(|(&w, v)| w * v).sum();
        if self.observed { desaturate(sum).as_vec3() } else { sum.as_vec3() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rgb(layout: &Layout) -> Folding {
        layout.foldings(&Spectrum::default())[0].clone()
    }

    /// First and last wavelength, values, and what Radiance makes of them.
    const MEASURED: [(f64, f64, &[f64], [f32; 3]); 20] = [
        (780.0, 380.0, &[1.0, 2.0, 3.0, 4.0], [1.959_488, 2.913_241, 3.538_31]),
        (700.0, 400.0, &[1.0, 3.0, 5.0, 2.0, 4.0, 1.0, 3.0, 2.0, 5.0, 1.0], [3.774_155, 2.143_092, 3.560_428]),
        (380.0, 780.0, &[0.2, 0.4, 0.6, 0.8], [0.7, 0.5, 0.3]),
        (780.0, 380.0, &[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
        (700.0, 500.0, &[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
        (700.0, 400.0, &[1.0, 2.0, 3.0, 4.0], [1.686_773, 2.587_784, 3.669_642]),
        (400.0, 700.0, &[4.0, 3.0, 2.0, 1.0], [1.632_056, 2.607_254, 3.769_532]),
        (400.0, 700.0, &[4.0, 3.0, 2.0, 1.0, 5.0, 1.0], [2.981_92, 1.392_521, 3.386_104]),
        (700.0, 400.0, &[1.0, 5.0, 1.0, 2.0, 3.0, 4.0], [2.915_981, 1.382_765, 3.351_212]),
        (380.0, 780.0, &[1.0, 1.0, 1.0, 1.0, 1.0, 1.0], [0.999_911_9, 1.000_1, 0.999_326_3]),
        (400.0, 700.0, &[1.0, 1.0, 1.0, 1.0], [0.996_318_8, 1.000_617, 0.999_353_3]),
        (400.0, 700.0, &[1.0, 0.0, 0.0, 0.0], [0.020_633_52, 0.0, 0.234_583_4]),
        (400.0, 700.0, &[0.0, 1.0, 0.0, 0.0], [0.0, 0.678_013, 0.330_436]),
        (400.0, 700.0, &[0.0, 0.0, 1.0, 0.0], [0.699_337, 0.336_855_1, 0.0]),
        (400.0, 700.0, &[0.0, 0.0, 0.0, 1.0], [0.306_286_2, 0.015_898_12, 0.0]),
        (680.0, 550.0, &[0.0, 0.0, 1.0, 0.0], [0.654_952_1, 0.167_619, 0.0]),
        (450.0, 600.0, &[1.0, 3.0, 5.0, 2.0, 4.0, 1.0], [0.361_03, 3.648_031, 1.108_96]),
        (420.0, 660.0, &[1.0, 3.0, 5.0], [4.646_019, 3.183_493, 0.869_369]),
        (600.0, 780.0, &[1.0, 3.0, 5.0, 2.0, 4.0, 1.0, 3.0], [1.934_477, 0.0, 0.050_145]),
        (430.0, 655.0, &[1.0, 3.0, 5.0, 2.0, 4.0, 1.0], [2.237_072, 3.794_398, 1.825_215]),
    ];

    /// Shortest and longest wavelength, and what Radiance makes of the function 1 there.
    const SAMPLED: [(f64, f64, [f32; 3]); 14] = [
        (380.0, 780.0, [0.999_912, 1.0001, 0.999_326]),
        (400.0, 700.0, [0.992_195, 1.003_51, 0.979_81]),
        (450.0, 600.0, [0.189_093, 1.111_897, 0.435_991]),
        (600.0, 780.0, [0.686_608, 0.0, 0.001_664]),
        (380.0, 500.0, [0.0, 0.035_301, 0.755_254]),
        (550.0, 600.0, [0.405_437, 0.393_617, 0.0]),
        (700.0, 780.0, [0.001_846, 0.0, 0.000_217]),
        (453.0, 550.0, [0.0, 0.574_109, 0.451_219]),
        (441.0, 550.0, [0.0, 0.575_021, 0.560_728]),
        (486.0, 550.0, [0.0, 0.542_999, 0.176_719]),
        (487.0, 550.0, [0.0, 0.546_453, 0.198_116]),
        (510.0, 550.0, [0.0, 0.423_291, 0.061_771]),
        (520.0, 550.0, [0.0, 0.369_356, 0.049_563]),
        (521.0, 550.0, [0.0, 0.0, 0.0]),
    ];

    #[test]
    fn functions_are_sampled_as_measured() {
        for (shortest, longest, expected) in SAMPLED {
            let (layout, wavelengths) = Layout::sampled(longest, shortest, &Spectrum::default());
            let got = rgb(&layout).fold(wavelengths.iter().map(|_| 1.0));
            let error = (got - Rgb::from(expected)).abs().max_element();
            assert!(error <= 2e-4, "{shortest} {longest}: {got} for {expected:?}");
            assert!(wavelengths.iter().all(|&w| shortest < w && w < longest));
        }
    }

    #[test]
    fn lists_fold_as_measured() {
        for (first, last, values, expected) in MEASURED {
            let got = rgb(&Layout::even(first, last, values.len())).fold(values.iter().copied());
            let scale = values.iter().copied().fold(0.0, f64::max) as f32;
            let error = (got - Rgb::from(expected)).abs().max_element();
            assert!(error <= 2e-4 * scale, "{first} {last} {values:?}: {got} for {expected:?}");
        }
    }

    #[test]
    fn flat_spectra_are_white_however_given() {
        let flat = |layout: &Layout| rgb(layout).fold(std::iter::repeat(1.0));
        for layout in [
            Layout::even(380.0, 780.0, 41),
            Layout::even(780.0, 380.0, 81),
            Layout::uneven(&[370.0, 400.0, 410.0, 500.0, 640.0, 790.0]),
            Layout::uneven(&[790.0, 640.0, 500.0, 410.0, 400.0, 370.0]),
            Layout::bands(800.0, 350.0, 5),
        ] {
            assert!((flat(&layout) - Rgb::ONE).abs().max_element() < 1e-3);
        }
    }

    /// First and last wavelength, values, bins, limits, and Radiance's means over the bins.
    #[test]
    fn bins_take_means_as_measured() {
        for (first, last, values, bins, (from, to), expected) in [
            (380.0, 780.0, &[0.2, 0.4, 0.6, 0.8][..], 4, (380.0, 780.0), &[0.733_33, 0.6, 0.4, 0.266_67][..]),
            (380.0, 780.0, &[0.2, 0.4, 0.6, 0.8], 6, (700.0, 400.0), &[0.6, 0.6, 0.48, 0.4, 0.4, 0.213_33]),
            (700.0, 400.0, &[3.0, 2.0, 1.0], 4, (380.0, 780.0), &[2.85, 2.55, 2.0, 1.05]),
            (450.0, 600.0, &[1.0, 3.0, 5.0, 2.0, 4.0, 1.0], 4, (380.0, 780.0), &[0.0, 0.5, 3.55, 0.75]),
            (800.0, 1000.0, &[1.0, 1.0, 1.0], 4, (380.0, 780.0), &[0.3, 0.0, 0.0, 0.0]),
        ] {
            let spectrum = Spectrum::new(bins, from, to).unwrap();
            let foldings = Layout::even(first, last, values.len()).foldings(&spectrum);
            for channel in 0..3 {
                for (pass, bin) in spectrum.channel(channel).into_iter().enumerate() {
                    let got = f64::from(foldings[pass].fold(values.iter().copied())[channel]);
                    assert!((got - expected[bin]).abs() < 1e-5, "{values:?} {bins}: {got} in bin {bin}");
                }
            }
        }
    }

    /// Range of the function λ, bins, and Radiance's means over 400 rays.
    #[test]
    fn functions_are_sampled_by_bins_as_measured() {
        for (shortest, longest, bins, expected) in [
            (380.0, 780.0, 4, &[729.96, 629.9, 529.98, 429.84][..]),
            (400.0, 700.0, 4, &[137.44, 630.27, 529.78, 352.38]),
            (550.0, 600.0, 4, &[0.0, 117.54, 169.98, 0.0]),
            (450.0, 600.0, 10, &[0.0, 0.0, 0.0, 0.0, 295.03, 560.04, 519.95, 479.92, 113.81, 0.0]),
        ] {
            let spectrum = Spectrum::new(bins, 380.0, 780.0).unwrap();
            let (layout, wavelengths) = Layout::sampled(longest, shortest, &spectrum);
            let foldings = layout.foldings(&spectrum);
            for channel in 0..3 {
                for (pass, bin) in spectrum.channel(channel).into_iter().enumerate() {
                    let got = f64::from(foldings[pass].fold(wavelengths.iter().copied())[channel]);
                    // What is left of the noise.
                    assert!((got - expected[bin]).abs() < 1.0, "{shortest} {longest} {bins}: {got} in bin {bin}");
                }
            }
        }
    }
}
