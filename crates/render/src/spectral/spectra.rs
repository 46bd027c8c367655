//! The spectra of a batch of answers, put together from passes.

use super::Spectrum;
use crate::request::Answer;
use ambit_base::Rgb;

/// Spectra of answers, from long to short wavelengths.
#[derive(Clone, Debug)]
pub struct Spectra {
    bins: usize,
    value: Vec<f32>,
    mirrored: Vec<f32>,
    coefficient: Vec<f32>,
}

impl Spectra {
    /// From the answers of all passes to the same requests; one pass serves all bins.
    pub(crate) fn gather(spectrum: &Spectrum, passes: &[Vec<Answer>]) -> Self {
        let places = spectrum.places(passes.len());
        let count = passes.first().map_or(0, Vec::len);
        let all = |colour: fn(&Answer) -> Rgb| {
            let of = |i: usize| places.iter().map(move |&(pass, channel)| colour(&passes[pass][i])[channel]);
            (0..count).flat_map(of).collect()
        };
        Self {
            bins: spectrum.bins(),
            value: all(|a| a.value),
            mirrored: all(|a| a.mirrored),
            coefficient: all(|a| a.coefficient),
        }
    }

    /// Radiance or irradiance of answer `i`.
    pub fn value(&self, i: usize) -> &[f32] {
        self.of(&self.value, i)
    }

    /// The part of it that came by mirror reflection.
    pub fn mirrored(&self, i: usize) -> &[f32] {
        self.of(&self.mirrored, i)
    }

    /// What the medium on the way leaves of the light.
    pub fn coefficient(&self, i: usize) -> &[f32] {
        self.of(&self.coefficient, i)
    }

    fn of<'a>(&self, all: &'a [f32], i: usize) -> &'a [f32] {
        &all[i * self.bins..(i + 1) * self.bins]
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
        assert_eq!(one.value(0), [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0]);
        assert_eq!(one.coefficient(0), [1.0; 9]);
        let passes: Vec<_> = [0.0, 1.0, 2.0, 3.0].map(answers).into();
        // Those nearest to 607, 553 and 469 nm are computed first.
        let four = Spectra::gather(&spectrum, &passes);
        assert_eq!(four.value(0), [31.0, 21.0, 11.0, 1.0, 12.0, 2.0, 22.0, 3.0, 13.0]);
    }
}
