//! The error of a result against a reference that has noise of its own, with bounds.
//!
//! Let x be a value (one channel of a pixel or sensor), a and b the same value in two independent halves of the
//! reference, r = (a + b)/2 and μ the truth. Then the mean of (x − a)(x − b) is (x − μ)² when a and b are unbiased: the
//! noise of the reference adds nothing to it on the mean, while (x − r)² contains the noise's variance. All means below
//! are over all channels of all pixels of all views, m is the mean of r.
//!
//! Bounds are percentiles of the bootstrap (Efron & Tibshirani 1993, ch. 13) over blocks of neighbouring values and over
//! repeats, both drawn with replacement.

use crate::error::Error;
use crate::parts::Part;
use crate::reference::Reference;
use ambit_base::hash_bits;
use serde::{Deserialize, Serialize};

/// Draws of the bootstrap for sums; the 95 % bounds of so many are good to about a tenth of their distance.
const DRAWS: usize = 1000;

/// Draws for the percentile, which has to be selected anew each time.
const PERCENTILE_DRAWS: usize = 100;

/// Where the bounds lie in the sorted draws: 95 % between them.
const TAIL: f64 = 0.025;

/// Which percentile tells of the worst pixels.
const PERCENTILE: f64 = 0.99;

/// A number with its 95 % bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounded {
    /// The estimate.
    pub value: f64,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

/// Errors relative to the mean of the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// √(mean of (x − a)(x − b)) / m: the error without the reference's noise. 0 if that mean is not positive, which says
    /// that the error is too small to be seen against this reference. With one half only it is `raw`.
    pub rms: Bounded,
    /// √(mean of (x − r)²) / m: the reference's noise is part of it.
    pub raw: f64,
    /// (mean of x − m) / m.
    pub bias: Bounded,
    /// 99th percentile over pixels of √(mean over channels of (x − r)²) / m; the reference's noise is part of it.
    pub p99: Bounded,
}

/// Sums over one block of neighbouring values.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Channels of values.
    count: f64,
    /// Σ (x − a)(x − b).
    product: f64,
    /// Σ (x − r)².
    square: f64,
    /// Σ x.
    sum: f64,
    /// Σ r.
    reference: f64,
    /// √(mean over channels of (x − r)²) of each value.
    distances: Vec<f32>,
}

/// Compares values with the reference; `what` names them in errors.
pub fn blocks(parts: &[Part], values: &[[f32; 3]], reference: &Reference, what: &str) -> Result<Vec<Block>, Error> {
    if values.len() != reference.a.len() {
        return Err(Error::Size { what: what.to_owned(), found: values.len(), expected: reference.a.len() });
    }
    finite(values, what)?;
    let b = reference.b.as_deref().unwrap_or(&reference.a);
    let mut blocks = Vec::new();
    let mut start = 0;
    for part in parts {
        let first = blocks.len();
        blocks.resize_with(first + part.blocks(), Block::default);
        for i in (0..part.len()).filter(|i| reference.counts(start + i)) {
            let (x, a, b) = (values[start + i], reference.a[start + i], b[start + i]);
            let block: &mut Block = &mut blocks[first + part.block(i)];
            let mut square = 0.0;
            for c in 0..3 {
                let [x, a, b] = [x[c] as f64, a[c] as f64, b[c] as f64];
                let r = f64::midpoint(a, b);
                block.product += (x - a) * (x - b);
                square += (x - r) * (x - r);
                block.sum += x;
                block.reference += r;
            }
            block.square += square;
            block.count += 3.0;
            block.distances.push((square / 3.0).sqrt() as f32);
        }
        start += part.len();
    }
    Ok(blocks)
}

/// Stops at the first value that is no finite number.
pub(crate) fn finite(values: &[[f32; 3]], what: &str) -> Result<(), Error> {
    let bad = values.iter().enumerate().find_map(|(i, v)| v.iter().find(|c| !c.is_finite()).map(|c| (i, *c)));
    bad.map_or(Ok(()), |(index, value)| Err(Error::NotFinite { what: what.to_owned(), index, value }))
}

/// Sums over blocks.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    product: f64,
    square: f64,
    sum: f64,
    reference: f64,
}

impl Sums {
    fn of<'a>(blocks: impl Iterator<Item = &'a Block>) -> Self {
        blocks.fold(Self::default(), |s, b| Self {
            count: s.count + b.count,
            product: s.product + b.product,
            square: s.square + b.square,
            sum: s.sum + b.sum,
            reference: s.reference + b.reference,
        })
    }

    fn mean(&self) -> f64 {
        self.reference / self.count
    }

    // Relative to the mean of the whole reference, in every draw of the bootstrap, too: what the scene is like is not
    // left to chance, or a bright lamp in one block would make all bounds wide.

    fn rms(&self, mean: f64) -> f64 {
        (self.product / self.count).max(0.0).sqrt() / mean
    }

    fn raw(&self, mean: f64) -> f64 {
        (self.square / self.count).sqrt() / mean
    }

    fn bias(&self, mean: f64) -> f64 {
        (self.sum - self.reference) / self.count / mean
    }
}

/// The score of the repeats of one setting: blocks of each repeat, all compared with one reference. `key` chooses the
/// random numbers of the bootstrap.
pub fn score(repeats: &[Vec<Block>], key: u64) -> Result<Score, Error> {
    let all = Sums::of(repeats.iter().flatten());
    let mean = all.mean();
    // Written so that a mean of no number fails, too.
    if !(mean.is_finite() && mean > 0.0) {
        return Err(Error::Black { mean });
    }
    let draws: Vec<Sums> = (0..DRAWS).map(|d| Sums::of(draw(repeats, key, d))).collect();
    let bounded = |value: f64, of: fn(&Sums, f64) -> f64| bounds(value, draws.iter().map(|d| of(d, mean)).collect());
    let p99 = percentile(repeats.iter().flatten()) / mean;
    let p99_draws = (0..PERCENTILE_DRAWS).map(|d| percentile(draw(repeats, key, d)) / mean).collect();
    Ok(Score {
        rms: bounded(all.rms(mean), Sums::rms),
        raw: all.raw(mean),
        bias: bounded(all.bias(mean), Sums::bias),
        p99: bounds(p99, p99_draws),
    })
}

/// RMS and mean error of one repeat, without bounds; not finite against a black reference.
pub(crate) fn single(blocks: &[Block]) -> (f64, f64) {
    let sums = Sums::of(blocks.iter());
    (sums.rms(sums.mean()), sums.bias(sums.mean()))
}

/// The blocks of one draw of the bootstrap: repeats with replacement, and in each the same blocks with replacement.
fn draw(repeats: &[Vec<Block>], key: u64, draw: usize) -> impl Iterator<Item = &Block> {
    let pick = move |tag: u64, i: usize, n: usize| (hash_bits(&[key, draw as u64, tag, i as u64]) % n as u64) as usize;
    (0..repeats.len()).flat_map(move |i| {
        let repeat = &repeats[pick(1, i, repeats.len())];
        (0..repeat.len()).map(move |j| &repeat[pick(2, j, repeat.len())])
    })
}

/// The 99th percentile of the distances, not yet relative.
fn percentile<'a>(blocks: impl Iterator<Item = &'a Block>) -> f64 {
    let mut all: Vec<f32> = blocks.flat_map(|b| b.distances.iter().copied()).collect();
    if all.is_empty() {
        return 0.0;
    }
    let at = ((all.len() - 1) as f64 * PERCENTILE).round() as usize;
    *all.select_nth_unstable_by(at, f32::total_cmp).1 as f64
}

/// The estimate with the percentiles of the draws.
fn bounds(value: f64, mut draws: Vec<f64>) -> Bounded {
    draws.sort_by(f64::total_cmp);
    let at = |p: f64| draws.get(((draws.len().max(1) - 1) as f64 * p).round() as usize).copied().unwrap_or(value);
    Bounded { value, low: at(TAIL).min(value), high: at(1.0 - TAIL).max(value) }
}

#[cfg(test)]
#[path = "tests/score.rs"]
mod tests;
