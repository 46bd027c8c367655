//! Spectra folded to RGB: what a list of values at given wavelengths is worth in three channels (shading.md 14).
//!
//! The sum over values is linear up to its last step, so a spectrum's wavelengths give each value a weight once, and
//! folding costs three products a value. A list of at most 24 values from long to short wavelengths is taken as bands
//! around them; others are first averaged over about as many bands of the visible range. Three bands are red, green
//! and blue themselves.
//!
//! A function of wavelength is sampled at steps of a twelfth of the visible range down from its longest wavelength, as
//! many as fit; the samples then count as equal bands of all its range, and are averaged like the lists above. So did
//! measured answers of Radiance turn out, to the last digit; a range shorter than one sample is black there, too.

use super::cie::{LONGEST, Observer, SHORTEST, desaturate, rgb_of_xyz};
use ambit_base::Rgb;
use glam::DVec3;

/// Most bands that Radiance computes with.
pub(crate) const MAX_BANDS: usize = 24;

/// nm between Radiance's samples of a function of wavelength.
const SAMPLE: f64 = (LONGEST - SHORTEST) / 12.0;
/// Radiance places each sample at random in the middle part of its step, this much of it; the last step may end before
/// the rest of it.
const JITTER: f64 = 0.9;
/// Wavelengths that stand for a sample's random place, whose mean they give: 10 nm apart.
const PLACES: usize = 3;
/// What a quotient may lack of a whole number by rounding.
const ROUNDING: f64 = 1e-9;
/// Radiance averages over the next larger number of bands, unless a quotient is this near above a whole number.
const ALMOST_WHOLE: f64 = 0.01;

/// Weights of the values of one list.
#[derive(Clone, Debug)]
pub(crate) struct Folding {
    weights: Box<[DVec3]>,
}

/// Limits of a value's band, nm.
type Band = (f64, f64);

impl Folding {
    /// For values at evenly spaced wavelengths (nm), the first at `first`, the last at `last`, which differs.
    pub(crate) fn even(first: f64, last: f64, count: usize) -> Self {
        let step = (last - first) / (count.max(2) - 1) as f64;
        let half = 0.5 * step.abs();
        let bands: Vec<Band> = (0..count)
            .map(|i| {
                let centre = first + step * i as f64;
                (centre - half, centre + half)
            })
            .collect();
        if step < 0.0 && count <= MAX_BANDS { Self::of_bands(&bands) } else { Self::averaged(&bands, step.abs()) }
    }

    /// For values at wavelengths (nm) in order, either way: each stands for what is nearest to it.
    pub(crate) fn uneven(wavelengths: &[f64]) -> Self {
        let at = |i: usize| wavelengths[i];
        let last = wavelengths.len() - 1;
        let border = |i: usize| 0.5 * (at(i) + at(i + 1));
        let bands: Vec<Band> = (0..=last)
            .map(|i| {
                let before = if i == 0 { 2.0 * at(0) - border(0) } else { border(i - 1) };
                let after = if i == last { 2.0 * at(i) - border(i - 1) } else { border(i) };
                (before.min(after), before.max(after))
            })
            .collect();
        Self::averaged(&bands, (at(last) - at(0)).abs() / last as f64)
    }

    /// For values of a function at the wavelengths (nm) that are returned beside, which lie from `longest` down to
    /// `shortest`; none if the range is too short for a sample.
    pub(crate) fn sampled(longest: f64, shortest: f64) -> (Self, Box<[f64]>) {
        let range = longest - shortest;
        // At most 12: the cast of what is no number, or negative, is 0.
        let count = (range / SAMPLE + (1.0 - JITTER) + ROUNDING) as usize;
        let place = |i: usize, k: usize| {
            let within = 0.5 + JITTER * ((k as f64 + 0.5) / PLACES as f64 - 0.5);
            longest - SAMPLE * (i as f64 + within)
        };
        let wavelengths = (0..count).flat_map(|i| (0..PLACES).map(move |k| place(i, k))).collect();
        let step = range / count.max(1) as f64;
        let border = |i: usize| longest - step * i as f64;
        let bands: Vec<Band> = (0..count).map(|i| (border(i + 1), border(i))).collect();
        let whole = Self::averaged(&bands, step).weights;
        let weights = whole.iter().flat_map(|&w| [w / PLACES as f64; PLACES]).collect();
        (Self { weights }, wavelengths)
    }

    /// For values that hold throughout `count` equal bands from `longest` down to `shortest` (nm).
    pub(crate) fn bands(longest: f64, shortest: f64, count: usize) -> Self {
        let border = |i: usize| longest + (shortest - longest) * (i as f64 / count as f64);
        Self::of_bands(&(0..count).map(|i| (border(i + 1), border(i))).collect::<Vec<_>>())
    }

    /// Bands as they are, from long to short.
    fn of_bands(bands: &[Band]) -> Self {
        if bands.len() == 3 {
            return Self { weights: vec![DVec3::X, DVec3::Y, DVec3::Z].into() };
        }
        let observer = Observer::new();
        Self { weights: bands.iter().map(|&(a, b)| rgb_of_xyz(observer.band(a, b))).collect() }
    }

    /// Values averaged over bands of the visible range, about as wide as the values' own.
    fn averaged(bands: &[Band], width: f64) -> Self {
        let range = LONGEST - SHORTEST;
        // The cast of what is no number, or too large, stays in range.
        let count = ((range / width + (1.0 - ALMOST_WHOLE)) as usize).clamp(3, MAX_BANDS);
        let own = Self::bands(LONGEST, SHORTEST, count);
        let wide = range / count as f64;
        let weight = |&(a, b): &Band| {
            let share = |i: usize| {
                let top = LONGEST - wide * i as f64;
                (b.min(top) - a.max(top - wide)).max(0.0) / wide
            };
            own.weights.iter().enumerate().map(|(i, &w)| w * share(i)).sum()
        };
        Self { weights: bands.iter().map(weight).collect() }
    }

    /// RGB of a list of values.
    pub(crate) fn fold(&self, values: impl IntoIterator<Item = f64>) -> Rgb {
        desaturate(self.weights.iter().zip(values).map(|(&w, v)| w * v).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First and last wavelength, values, and what Radiance makes of them.
    const MEASURED: [(f64, f64, &[f64], [f32; 3]); 18] = [
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
            let (folding, wavelengths) = Folding::sampled(longest, shortest);
            let got = folding.fold(wavelengths.iter().map(|_| 1.0));
            let error = (got - Rgb::from(expected)).abs().max_element();
            assert!(error <= 2e-3, "{shortest} {longest}: {got} for {expected:?}");
            assert!(wavelengths.iter().all(|&w| shortest < w && w < longest));
        }
    }

    #[test]
    fn lists_fold_as_measured() {
        for (first, last, values, expected) in MEASURED {
            let got = Folding::even(first, last, values.len()).fold(values.iter().copied());
            let scale = values.iter().copied().fold(0.0, f64::max) as f32;
            let error = (got - Rgb::from(expected)).abs().max_element();
            assert!(error <= 2e-3 * scale, "{first} {last} {values:?}: {got} for {expected:?}");
        }
    }

    #[test]
    fn flat_spectra_are_white_however_given() {
        let flat = |f: Folding| f.fold(std::iter::repeat(1.0));
        for folding in [
            Folding::even(380.0, 780.0, 41),
            Folding::even(780.0, 380.0, 81),
            Folding::uneven(&[370.0, 400.0, 410.0, 500.0, 640.0, 790.0]),
            Folding::uneven(&[790.0, 640.0, 500.0, 410.0, 400.0, 370.0]),
            Folding::bands(800.0, 350.0, 5),
        ] {
            assert!((flat(folding) - Rgb::ONE).abs().max_element() < 2e-3);
        }
    }
}
