//! The spectra of a batch of answers, put together from passes.

use super::Spectrum;
use crate::request::Answer;
use crate::tree::TreeRay;
use ambit_base::Rgb;

/// Spectra of answers, from long to short wavelengths.
#[derive(Clone, Debug)]
pub struct Spectra {
    bins: usize,
    value: Vec<f32>,
    contribution: Vec<f32>,
    mirrored: Vec<f32>,
    coefficient: Vec<f32>,
}

/// The spectra of one answer.
#[derive(Clone, Copy, Debug)]
pub struct Bins<'a> {
    /// Radiance or irradiance.
    pub value: &'a [f32],
    /// What it brings to the primary ray's.
    pub contribution: &'a [f32],
    /// The part of the value that came by mirror reflection.
    pub mirrored: &'a [f32],
    /// What the medium on the way leaves of the light; of a ray in a tree its share of the primary ray's value.
    pub coefficient: &'a [f32],
}

impl Spectra {
    /// From the answers of all passes to the same requests; one pass serves all bins.
    pub(crate) fn gather(spectrum: &Spectrum, passes: &[Vec<Answer>]) -> Self {
        Self::of(spectrum, passes, |answer| answer, |answer| answer.value)
    }

    /// From the rays of a tree as all passes have followed them.
    pub(crate) fn of_tree(spectrum: &Spectrum, passes: &[Vec<TreeRay>]) -> Self {
        Self::of(spectrum, passes, |ray| &ray.answer, |ray| ray.contribution)
    }

    fn of<T>(spectrum: &Spectrum, passes: &[Vec<T>], answer: fn(&T) -> &Answer, contribution: fn(&T) -> Rgb) -> Self {
        let places = spectrum.places(passes.len());
        let count = passes.first().map_or(0, Vec::len);
        let all = |colour: &dyn Fn(&T) -> Rgb| {
            let of = |i: usize| places.iter().map(move |&(pass, channel)| colour(&passes[pass][i])[channel]);
            (0..count).flat_map(of).collect()
        };
        Self {
            bins: spectrum.bins(),
            value: all(&|a| answer(a).value),
            contribution: all(&contribution),
            mirrored: all(&|a| answer(a).mirrored),
            coefficient: all(&|a| answer(a).coefficient),
        }
    }

    /// Those of answer `i`.
    pub fn bins<'a>(&'a self, i: usize) -> Bins<'a> {
        let of = |all: &'a [f32]| &all[i * self.bins..(i + 1) * self.bins];
        Bins {
            value: of(&self.value),
            contribution: of(&self.contribution),
            mirrored: of(&self.mirrored),
            coefficient: of(&self.coefficient),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::DVec3;

    #[test]
    fn every_bin_comes_from_its_pass() {
        let spectrum = Spectrum::new(9, 380.0, 780.0).unwrap();
        let answers = |pass: f32| {
            let mut answer = Answer::nothing(DVec3::ZERO, DVec3::Z);
            answer.value = Rgb::new(1.0, 2.0, 3.0) + 10.0 * pass;
            vec![answer]
        };
        let one = Spectra::gather(&spectrum, &[answers(0.0)]);
        assert_eq!(one.bins(0).value, [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0]);
        assert_eq!(one.bins(0).coefficient, [1.0; 9]);
        let passes: Vec<_> = [0.0, 1.0, 2.0, 3.0].map(answers).into();
        // Those nearest to 607, 553 and 469 nm are computed first.
        let four = Spectra::gather(&spectrum, &passes);
        assert_eq!(four.bins(0).value, [31.0, 21.0, 11.0, 1.0, 12.0, 2.0, 22.0, 3.0, 13.0]);
    }
}
