//! What stands for indirect light where the calculation stops: `-av`, or with `-aw` the running logarithmic average of
//! the records, which counts each computed value times 1 − the assumed reflectance lest it feed on itself.

use crate::observe::LEVELS;
use crate::params::{ASSUMED_REFLECTANCE, Params};
use ambit_base::{Colour, EPSILON, Rgb};

/// Running sums over the records.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Average {
    logarithms: f64,
    count: u64,
    /// Sum of brightness and number by level of those that are not black.
    levels: [(f64, u64); LEVELS],
}

impl Average {
    /// Counts a record by its level and its values in all passes, unless it is black.
    pub(crate) fn add(&mut self, level: u8, values: impl Iterator<Item = Rgb>) {
        let (mut sum, mut passes) = (0.0, 0);
        for value in values {
            sum += f64::from(value.brightness());
            passes += 1;
        }
        let b = sum / f64::from(passes.max(1));
        if b > EPSILON {
            self.logarithms += b.ln();
            self.count += 1;
            let own = &mut self.levels[usize::from(level).min(LEVELS - 1)];
            *own = (own.0 + b, own.1 + 1);
        }
    }

    /// The mean brightness of the records of a level (one of [`LEVELS`]) that are not black; 0 without any.
    pub(crate) fn mean(&self, level: usize) -> f64 {
        let (sum, count) = self.levels[level];
        if count == 0 { 0.0 } else { sum / count as f64 }
    }

    /// The radiance to use where the calculation stops.
    pub(crate) fn fallback(&self, params: &Params) -> Rgb {
        if params.weight <= 0 || self.count == 0 {
            return params.value;
        }
        let (n, aw) = (self.count as f64, f64::from(params.weight));
        let kept = (1.0 - ASSUMED_REFLECTANCE).ln();
        let given = f64::from(params.value.brightness());
        if given > EPSILON {
            let mean = ((aw * given.ln() + self.logarithms + n * kept) / (aw + n)).exp();
            params.value * (mean / given) as f32
        } else {
            Rgb::splat((self.logarithms / n + kept).exp() as f32)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn average(sum: f64, n: u64) -> Average {
        Average { logarithms: sum, count: n, ..Average::default() }
    }

    #[test]
    fn the_average_agrees_with_measured_values() {
        let params = |value| Params { weight: 1, value: Rgb::splat(value), ..Params::default() };
        for (sum, value, expected) in [(2.250_359, 0.0, 0.331_211), (2.383_583, 0.5, 0.325_806)] {
            let got = 0.5 * average(sum, 8).fallback(&params(value)).x;
            assert!((got - expected).abs() < 2e-6, "{got} instead of {expected}");
        }
    }

    #[test]
    fn without_weight_or_records_the_constant_stands() {
        let params = Params { weight: 4, value: Rgb::new(1.0, 2.0, 3.0), ..Params::default() };
        assert_eq!(Average::default().fallback(&params), params.value);
        assert_eq!(average(3.0, 2).fallback(&Params { weight: 0, ..params }), params.value);
        let mut black = Average::default();
        black.add(0, std::iter::once(Rgb::ZERO));
        assert_eq!(black.fallback(&params), params.value);
    }
}
