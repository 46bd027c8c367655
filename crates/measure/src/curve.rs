//! Curves of error against time, between whose points times are interpolated.
//!
//! A rung that takes longer than another and errs no less is no sensible setting; what remains, each point slower and
//! more exact than the one before, is the curve. Between two neighbours, the logarithm of time is linear in the logarithm
//! of error. Outside of the points the curve says nothing.

/// One setting's cost and error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Seconds.
    pub time: f64,
    /// Relative error.
    pub error: f64,
}

/// Sensible settings, from coarse and fast to exact and slow.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    points: Vec<Point>,
}

impl Curve {
    /// The curve through the sensible ones of these points. Points without a positive, finite time and error (an error
    /// below what the reference can show is 0) have no logarithm and are left out.
    pub fn new(points: impl IntoIterator<Item = Point>) -> Self {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        let mut all: Vec<Point> = points.into_iter().filter(|p| positive(p.time) && positive(p.error)).collect();
        all.sort_by(|p, q| p.time.total_cmp(&q.time).then(p.error.total_cmp(&q.error)));
        let mut points: Vec<Point> = Vec::new();
        for point in all {
            if points.last().is_none_or(|last| point.error < last.error) {
                points.push(point);
            }
        }
        Self { points }
    }

    /// The points on it, errors falling.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The fastest, which errs most.
    pub fn coarsest(&self) -> Option<Point> {
        self.points.first().copied()
    }

    /// The most exact, which takes longest.
    pub fn finest(&self) -> Option<Point> {
        self.points.last().copied()
    }

    /// Seconds to reach an error; `None` outside of the points.
    pub fn time_at(&self, error: f64) -> Option<f64> {
        if let Some(point) = self.points.iter().find(|p| p.error == error) {
            return Some(point.time);
        }
        let pair = self.points.windows(2).find(|p| p[1].error < error && error < p[0].error)?;
        let (p, q) = (pair[0], pair[1]);
        let part = (error / p.error).ln() / (q.error / p.error).ln();
        Some(p.time * (q.time / p.time).powf(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// error = 0.1/√time: what sampling gives.
    fn sampling(times: &[f64]) -> Curve {
        Curve::new(times.iter().map(|t| Point { time: *t, error: 0.1 / t.sqrt() }))
    }

    #[test]
    fn power_laws_are_interpolated_exactly() {
        let curve = sampling(&[1.0, 3.0, 20.0, 100.0]);
        for time in [1.0_f64, 1.5, 3.0, 7.0, 50.0, 100.0] {
            let found = curve.time_at(0.1 / time.sqrt()).unwrap();
            assert!((found / time - 1.0).abs() < 1e-9, "{time}: {found}");
        }
    }

    #[test]
    fn nothing_is_said_outside() {
        let curve = sampling(&[1.0, 100.0]);
        assert_eq!((curve.time_at(0.1001), curve.time_at(0.0099)), (None, None));
        assert_eq!(Curve::new([]).time_at(0.1), None);
        let one = sampling(&[4.0]);
        assert_eq!((one.time_at(0.05), one.time_at(0.051)), (Some(4.0), None));
    }

    #[test]
    fn settings_that_others_beat_are_left_out() {
        let point = |time, error| Point { time, error };
        let curve = Curve::new([point(4.0, 0.1), point(1.0, 0.2), point(2.0, 0.3), point(5.0, 0.1), point(9.0, 0.0)]);
        assert_eq!(curve.points(), [point(1.0, 0.2), point(4.0, 0.1)]);
        assert_eq!((curve.coarsest(), curve.finest()), (Some(point(1.0, 0.2)), Some(point(4.0, 0.1))));
        assert!(Curve::new([point(f64::NAN, 1.0), point(1.0, f64::INFINITY)]).points().is_empty());
    }
}
