//! How many times faster one program is than another at equal error.

use crate::curve::{Curve, Point};
use serde::{Deserialize, Serialize};

/// Times at one error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Relative RMS error.
    pub error: f64,
    /// Seconds of the first program.
    pub first: f64,
    /// Seconds of the second.
    pub second: f64,
    /// second / first: how many times faster the first is.
    pub ratio: f64,
    /// Least and greatest ratio among the pairs of runs whose own curves both reach this error.
    pub range: Option<[f64; 2]>,
    /// How many pairs do.
    pub pairs: usize,
}

/// Two programs at equal error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Comparison {
    /// Both reach the errors from `low` to `high`.
    Overlap {
        /// Least error that both reach.
        low: f64,
        /// Greatest error that both have.
        high: f64,
        /// Geometric mean of the ratio over the logarithm of error, from `low` to `high`.
        mean: f64,
        /// The same of single pairs of runs: least and greatest.
        range: Option<[f64; 2]>,
        /// At both ends and at every point of either curve between them; errors falling.
        levels: Vec<Level>,
    },
    /// There is no error that both reach; what can be said nevertheless.
    None {
        /// One sentence.
        statement: String,
    },
}

/// Compares two curves, whose names go into what is said. `pairs` are the curves of single repeats, in which both
/// programs ran in turns.
pub fn compare(names: [&str; 2], first: &Curve, second: &Curve, pairs: &[(Curve, Curve)]) -> Comparison {
    let Some((low, high)) = overlap(first, second) else {
        return Comparison::None { statement: apart(names, first, second) };
    };
    let levels = knots(first, second, low, high).into_iter().filter_map(|error| {
        let (one, two) = (first.time_at(error)?, second.time_at(error)?);
        let ratios: Vec<f64> = pairs.iter().filter_map(|(a, b)| Some(b.time_at(error)? / a.time_at(error)?)).collect();
        Some(Level { error, first: one, second: two, ratio: two / one, range: range(&ratios), pairs: ratios.len() })
    });
    let means: Vec<f64> = pairs.iter().filter_map(|(a, b)| mean(a, b)).collect();
    Comparison::Overlap {
        low,
        high,
        mean: mean(first, second).unwrap_or(1.0),
        range: range(&means),
        levels: levels.collect(),
    }
}

/// The errors that both curves reach.
fn overlap(first: &Curve, second: &Curve) -> Option<(f64, f64)> {
    let low = first.finest()?.error.max(second.finest()?.error);
    let high = first.coarsest()?.error.min(second.coarsest()?.error);
    (low <= high).then_some((low, high))
}

/// The ends and all points between, falling.
fn knots(first: &Curve, second: &Curve, low: f64, high: f64) -> Vec<f64> {
    let own = first.points().iter().chain(second.points()).map(|p| p.error);
    let mut all: Vec<f64> = own.filter(|e| (low..=high).contains(e)).chain([low, high]).collect();
    all.sort_by(|a, b| b.total_cmp(a));
    all.dedup();
    all
}

/// Geometric mean of second / first over the logarithm of error. Its logarithm is linear between knots, so that
/// trapezoids are exact.
fn mean(first: &Curve, second: &Curve) -> Option<f64> {
    let (low, high) = overlap(first, second)?;
    let logs: Vec<(f64, f64)> = knots(first, second, low, high)
        .into_iter()
        .filter_map(|e| Some((e.ln(), (second.time_at(e)? / first.time_at(e)?).ln())))
        .collect();
    let width = logs.first()?.0 - logs.last()?.0;
    if width <= 0.0 {
        return Some(logs[0].1.exp());
    }
    let area: f64 = logs.windows(2).map(|w| (w[0].0 - w[1].0) * (w[0].1 + w[1].1) / 2.0).sum();
    Some((area / width).exp())
}

fn range(values: &[f64]) -> Option<[f64; 2]> {
    let least = values.iter().copied().reduce(f64::min)?;
    let most = values.iter().copied().reduce(f64::max)?;
    Some([least, most])
}

/// What can be said of curves that no error has in common. The nearest points bound the ratio if the more exact one is
/// the faster one, too.
fn apart(names: [&str; 2], first: &Curve, second: &Curve) -> String {
    let ends = |c: &Curve| c.coarsest().zip(c.finest());
    let (one, two) = match (ends(first), ends(second)) {
        (Some(one), Some(two)) => (one, two),
        (None, _) => return format!("no overlap: no run of {} has an error that the reference can show", names[0]),
        (_, None) => return format!("no overlap: no run of {} has an error that the reference can show", names[1]),
    };
    // The more exact program's coarsest run against the other's finest.
    let (exact, coarse, near, far) =
        if one.0.error < two.1.error { (names[0], names[1], one.0, two.1) } else { (names[1], names[0], two.0, one.1) };
    let show = |p: Point| format!("{:.2} % in {:.3} s", 100.0 * p.error, p.time);
    let nearest =
        format!("no overlap: the coarsest run of {exact} has {}, the finest of {coarse} {}", show(near), show(far));
    if near.time <= far.time {
        format!(
            "{nearest}; so {exact} reaches the error of the latter at least {:.2} times faster",
            far.time / near.time
        )
    } else {
        format!("{nearest}: {:.2} times the error, {:.2} times the time", near.error / far.error, near.time / far.time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// error = scale/√time.
    fn sampling(scale: f64, times: &[f64]) -> Curve {
        Curve::new(times.iter().map(|t| Point { time: *t, error: scale / t.sqrt() }))
    }

    #[test]
    fn equal_slopes_have_one_ratio() {
        // Twice the error at equal times takes four times as long at equal error.
        let (ours, theirs) = (sampling(0.1, &[1.0, 5.0, 40.0]), sampling(0.2, &[2.0, 10.0, 64.0]));
        let pairs = [
            (sampling(0.1, &[0.9, 5.0, 40.0]), sampling(0.2 * 1.1, &[2.0, 10.0, 64.0])),
            (ours.clone(), theirs.clone()),
        ];
        let Comparison::Overlap { low, high, mean, range, levels } = compare(["a", "b"], &ours, &theirs, &pairs) else {
            panic!("they overlap");
        };
        assert!((low - 0.025).abs() < 1e-12 && (high - 0.1).abs() < 1e-12);
        assert!((mean - 4.0).abs() < 1e-9);
        let range = range.unwrap();
        assert!((range[0] - 4.0).abs() < 1e-9 && (range[1] - 4.84).abs() < 1e-9, "{range:?}");
        assert_eq!(levels.len(), 4);
        for level in levels {
            assert!((level.ratio - 4.0).abs() < 1e-9, "{level:?}");
            assert!(level.pairs >= 1 && level.range.unwrap()[0] <= 4.0 + 1e-9);
        }
    }

    #[test]
    fn the_mean_is_over_the_logarithm_of_error() {
        // Ratio 1 at error 0.1, 4 at 0.01, a power law between: geometric mean 2.
        let point = |time, error| Point { time, error };
        let (a, b) =
            (Curve::new([point(1.0, 0.1), point(10.0, 0.01)]), Curve::new([point(1.0, 0.1), point(40.0, 0.01)]));
        let Comparison::Overlap { mean, .. } = compare(["a", "b"], &a, &b, &[]) else { panic!("they overlap") };
        assert!((mean - 2.0).abs() < 1e-9);
        // One common error only.
        let c = Curve::new([point(3.0, 0.1), point(0.5, 0.2)]);
        let Comparison::Overlap { mean, levels, .. } = compare(["a", "c"], &a, &c, &[]) else { panic!("they overlap") };
        assert!((mean - 3.0).abs() < 1e-9 && levels.len() == 1);
    }

    #[test]
    fn curves_apart_are_bounded_not_extrapolated() {
        let (fine, coarse) = (sampling(0.01, &[1.0, 4.0]), sampling(0.1, &[1.0, 8.0]));
        let Comparison::None { statement } = compare(["ours", "theirs"], &fine, &coarse, &[]) else { panic!() };
        assert!(statement.contains("no overlap") && statement.contains("ours reaches"), "{statement}");
        assert!(statement.contains("at least 8.00 times"), "{statement}");
        let Comparison::None { statement } = compare(["ours", "theirs"], &coarse, &fine, &[]) else { panic!() };
        assert!(statement.contains("theirs reaches"), "{statement}");
        let slow = sampling(0.1, &[200.0, 400.0]);
        let Comparison::None { statement } = compare(["ours", "theirs"], &slow, &coarse, &[]) else { panic!() };
        assert!(!statement.contains("at least") && statement.contains("25.00 times the time"), "{statement}");
        let Comparison::None { statement } = compare(["ours", "theirs"], &Curve::new([]), &fine, &[]) else { panic!() };
        assert!(statement.contains("no run of ours"), "{statement}");
    }
}
