//! The settings that reach an asked error at the least time, found with a few cheap runs of a small part of the work.
//!
//! Interreflection errs in two ways: by what is interpolated between irradiance values, which is in proportion to the
//! accuracy `-aa` (Ward, Rubinstein & Clear 1988 define it so), and by the noise of the hemispheres, whose variance is as
//! one over their divisions `-ad`. So the square of the relative RMS error is taken to be
//!
//! > e²(a, d) = s (a/a₀)² + n (d₀/d)
//!
//! with a₀, d₀ the coarsest settings. Of two runs with other random numbers, neither of which is right, the mean square
//! difference is then e² of the one plus e² of the other: s and n follow from the differences of all pairs of runs, and no
//! converged answer is needed. The runs lie across, from few exact values to many noisy ones, or s and n could not be told
//! apart. Squares of differences scatter by factors, therefore the fit is one of least squares of their logarithms, with
//! the prior belief that s/n is within some e-foldings of one.
//!
//! What runs have in common, such as light that no sample of any of them found, shows in no difference. [`TYPICAL`] and
//! [`SAFETY`] make up for that on the average over scenes; `docs/error-target.md` has the numbers.

use crate::error::Error;
use crate::score::finite;

/// The settings that variances are told for: accuracy and divisions.
const UNIT: Setting = Setting { accuracy: 0.6, divisions: 16 };

/// The first runs: about equally dear, as different as can be.
const FIRST: [Setting; 3] = [
    Setting { accuracy: 0.6, divisions: 256 },
    Setting { accuracy: 0.3, divisions: 64 },
    Setting { accuracy: 0.2, divisions: 16 },
];

/// How many times dearer the chosen settings may be than the dearest run. The more, the cheaper the runs beside the work
/// itself, and the farther the model has to reach.
const REACH: f64 = 8.0;

/// Standard deviation of the logarithm of a mean square difference about the model.
const SCATTER: f64 = 0.6;

/// Standard deviation of ln(s/n) over scenes.
const BELIEF: f64 = 1.2;

/// Values of ln(s/n) that are tried: so far to either side of 0, in such steps.
const WIDEST: f64 = 6.0;
const STEP: f64 = 0.25;

/// Mean square differences below this are none: pixels have no more digits.
const LEAST: f64 = 1e-12;

/// The median of true over modelled error, over scenes.
pub const TYPICAL: f64 = 1.2;

/// What true over modelled error stays below in 9 of 10 cases.
pub const SAFETY: f64 = 2.1;

/// Settings of interreflection, as far as the model goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// `-aa`; 0 interpolates nothing.
    pub accuracy: f64,
    /// `-ad`, at least 1.
    pub divisions: i32,
}

impl Setting {
    /// What the variances s and n are multiplied by.
    fn terms(self) -> [f64; 2] {
        [(self.accuracy / UNIT.accuracy).powi(2), f64::from(UNIT.divisions) / f64::from(self.divisions)]
    }

    /// Time, up to a factor: values times divisions. Without interpolation there is one accuracy only.
    fn cost(self) -> f64 {
        let values = if self.accuracy > 0.0 { self.accuracy.powi(-2) } else { 1.0 };
        values * f64::from(self.divisions)
    }

    /// How far apart two settings are.
    fn distance(self, other: Self) -> f64 {
        let fold = |a: f64, b: f64| (a.max(1e-3) / b.max(1e-3)).ln().abs();
        2.0 * fold(self.accuracy, other.accuracy) + fold(f64::from(self.divisions), f64::from(other.divisions))
    }
}

/// The variances s and n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    spacing: f64,
    sampling: f64,
}

impl Model {
    /// The most probable variances for pairs of settings with their relative mean square differences, of `runs` runs.
    /// Pairs that share a run are not independent: they count as half as many as there are runs.
    fn fit(pairs: &[(Setting, Setting, f64)], runs: usize) -> Self {
        let count = f64::max(pairs.len() as f64, 1.0);
        let weight = 2.0 / (runs.max(1) as f64 * SCATTER * SCATTER);
        let mut best = (f64::INFINITY, Self { spacing: 0.0, sampling: 0.0 });
        let steps = (2.0 * WIDEST / STEP) as i32;
        for ratio in (0..=steps).map(|k| -WIDEST + f64::from(k) * STEP) {
            let logarithm = |(a, b, square): &(Setting, Setting, f64)| {
                let ([p, q], [r, s]) = (a.terms(), b.terms());
                square.max(LEAST).ln() - (ratio.exp() * (p + r) + q + s).ln()
            };
            let mean = pairs.iter().map(logarithm).sum::<f64>() / count;
            let squares: f64 = pairs.iter().map(|p| (logarithm(p) - mean).powi(2)).sum();
            let unlikely = squares * weight + (ratio / BELIEF).powi(2);
            if unlikely < best.0 {
                best = (unlikely, Self { spacing: (mean + ratio).exp(), sampling: mean.exp() });
            }
        }
        best.1
    }

    /// The relative RMS error of a setting.
    pub fn error(&self, setting: Setting) -> f64 {
        let [p, q] = setting.terms();
        (self.spacing * p + self.sampling * q).sqrt()
    }
}

/// The relative RMS difference of two results, of which `mean` is the mean.
///
/// # Errors
/// For results of different sizes.
pub fn difference(a: &[[f32; 3]], b: &[[f32; 3]], mean: f64) -> Result<f64, Error> {
    if a.len() != b.len() {
        return Err(Error::Size { what: "a run".to_owned(), found: b.len(), expected: a.len() });
    }
    let square = |(x, y): (&[f32; 3], &[f32; 3])| (0..3).map(|c| f64::from(x[c] - y[c]).powi(2)).sum::<f64>();
    let sum: f64 = a.iter().zip(b).map(square).sum();
    Ok((sum / (3 * a.len().max(1)) as f64).sqrt() / mean)
}

/// The mean over all channels of all values.
pub fn mean(values: &[[f32; 3]]) -> f64 {
    let sum: f64 = values.iter().flatten().map(|&c| f64::from(c)).sum();
    sum / (3 * values.len().max(1)) as f64
}

/// What a search has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Which of the settings.
    pub index: usize,
    /// Its error by the model, without [`TYPICAL`] or [`SAFETY`].
    pub error: f64,
}

/// A search among settings: ask what to run, and tell what came out, until there is nothing more to run.
#[derive(Clone, Debug)]
pub struct Search {
    settings: Vec<Setting>,
    goal: f64,
    runs: Vec<(usize, Vec<[f32; 3]>)>,
}

impl Search {
    /// A search among `settings`, at least one, for a model's error of at most `goal`.
    pub fn new(settings: Vec<Setting>, goal: f64) -> Self {
        Self { settings, goal, runs: Vec::new() }
    }

    /// The setting to be run next, with random numbers of its own; none when [`Search::found`] is the answer.
    pub fn next(&self) -> Option<usize> {
        let all = 0..self.settings.len();
        if let Some(first) = FIRST.get(self.runs.len()) {
            let far = |i: &usize| self.settings[*i].distance(*first);
            return all.min_by(|a, b| far(a).total_cmp(&far(b)));
        }
        let model = self.model();
        let best = self.cheapest(&model)?;
        let cost = |i: usize| self.settings[i].cost();
        let dearest = self.runs.iter().map(|r| cost(r.0)).fold(0.0, f64::max);
        if cost(best) <= REACH * dearest {
            return None;
        }
        let error = |i: &usize| model.error(self.settings[*i]);
        let within = all.filter(|&i| cost(i) > dearest && cost(i) <= REACH * dearest);
        within.min_by(|a, b| error(a).total_cmp(&error(b)))
    }

    /// Takes in what the setting gave.
    ///
    /// # Errors
    /// For values that are no finite numbers.
    pub fn add(&mut self, index: usize, values: Vec<[f32; 3]>) -> Result<(), Error> {
        finite(&values, "a run")?;
        self.runs.push((index, values));
        Ok(())
    }

    /// How many runs there have been.
    pub fn runs(&self) -> usize {
        self.runs.len()
    }

    /// The cheapest setting that reaches the goal; the most exact one if none does.
    pub fn found(&self) -> Option<Found> {
        let model = self.model();
        self.cheapest(&model).map(|index| Found { index, error: model.error(self.settings[index]) })
    }

    fn cheapest(&self, model: &Model) -> Option<usize> {
        let all = 0..self.settings.len();
        let error = |i: &usize| model.error(self.settings[*i]);
        let cost = |i: &usize| self.settings[*i].cost();
        let reaches = all.clone().filter(|i| error(i) <= self.goal);
        reaches.min_by(|a, b| cost(a).total_cmp(&cost(b))).or_else(|| all.min_by(|a, b| error(a).total_cmp(&error(b))))
    }

    fn model(&self) -> Model {
        let means = self.runs.iter().map(|r| mean(&r.1)).sum::<f64>() / self.runs.len().max(1) as f64;
        let mut pairs = Vec::new();
        for (k, (i, x)) in self.runs.iter().enumerate() {
            for (j, y) in &self.runs[..k] {
                // Runs are of one size, and a black result has no differences.
                let square = difference(x, y, means).map_or(0.0, |d| d * d);
                let square = if square.is_finite() { square } else { 0.0 };
                pairs.push((self.settings[*i], self.settings[*j], square));
            }
        }
        Model::fit(&pairs, self.runs.len())
    }
}

#[cfg(test)]
#[path = "tests/search.rs"]
mod tests;
