//! What look-ups come to, counted for those who ask for it (`Cache::observe`).
//!
//! A cache that is not observed runs the same instructions as ever: the question whether to count takes the place of the
//! one whether to cache. Counts are integers, one set a thread, so that their sums do not depend on threads. Of one
//! look-up in 64, chosen by its place, the records that answer together are compared: with weights ωᵢ and answers vᵢ
//! around their mean v, `s² = Σ ωᵢ (vᵢ − v)² / Σ ωᵢ` says how far they differ, and `s √Σωᵢ² / Σωᵢ` how uncertain their mean
//! is if they err independently: the estimated error of interpolation, from noise and extrapolation alike. Answers are
//! extrapolations, of the first order: what the second makes good of their bend is counted still. Both are told by the level
//! of the question, relative to the mean of the level's records so far, as errors of pictures are: relative to v, dark
//! corners would be all.

use crate::cache::Cache;
use crate::sampler::{Answer, Query, Sampler};
use crate::steps::Steps;
use ambit_base::{Colour, hash_point};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

/// Levels that are counted one by one; deeper ones count as the last.
pub const LEVELS: usize = 8;
/// One look-up in so many is looked at closely.
const CLOSELY: u64 = 64;
/// Fixed-point one of squared relative differences.
const ONE: f64 = 4294967296.0;
/// The largest that counts, so that sums cannot overflow.
const MOST: f64 = 1e4;

/// The counts of one thread, in a cache line or more of its own.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Counts {
    asked: [AtomicU64; LEVELS],
    answered: [AtomicU64; LEVELS],
    compared: [AtomicU64; LEVELS],
    difference: [AtomicU64; LEVELS],
    error: [AtomicU64; LEVELS],
}

/// Time since some moment; whoever has a clock lends it.
pub type Clock = fn() -> Duration;

/// Counts look-ups.
#[derive(Debug)]
pub(crate) struct Observer(Vec<Counts>);

/// Measures the time spent in filling the cache.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stopwatch {
    clock: Option<Clock>,
    running: bool,
    total: Duration,
}

impl Stopwatch {
    /// The time, unless it is being measured already (a hemisphere within a hemisphere) or does not count.
    pub(crate) fn start(&mut self) -> Option<Duration> {
        let clock = self.clock.filter(|_| !self.running)?;
        self.running = true;
        Some(clock())
    }

    /// Adds the time since `start`.
    pub(crate) fn stop(&mut self, start: Option<Duration>) {
        if let (Some(start), Some(clock)) = (start, self.clock) {
            self.running = false;
            self.total += clock().saturating_sub(start);
        }
    }
}

/// What look-ups came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observed {
    /// Look-ups by level (the last entry: all deeper ones, too).
    pub asked: [u64; LEVELS],
    /// Those that records answered.
    pub answered: [u64; LEVELS],
    /// Look-ups by level whose records were compared: those with two or more.
    pub compared: [u64; LEVELS],
    /// Difference of the records that answer together, RMS, relative to the mean of the level's records.
    pub difference: [f64; LEVELS],
    /// Estimated error of interpolated values, RMS, relative to the mean of the level's records.
    pub error: [f64; LEVELS],
}

impl Observer {
    pub(crate) fn new() -> Self {
        Self((0..=rayon::current_num_threads()).map(|_| Counts::default()).collect())
    }

    fn counts(&self) -> &Counts {
        let slot = rayon::current_thread_index().map_or(0, |i| i + 1);
        &self.0[slot % self.0.len()]
    }

    fn total(&self) -> Observed {
        let mut all = Observed::default();
        for k in 0..LEVELS {
            let sum =
                |of: fn(&Counts) -> &[AtomicU64; LEVELS]| self.0.iter().map(|c| of(c)[k].load(Relaxed)).sum::<u64>();
            (all.asked[k], all.answered[k]) = (sum(|c| &c.asked), sum(|c| &c.answered));
            let count = sum(|c| &c.compared);
            let rms = |sum: u64| if count > 0 { (sum as f64 / ONE / count as f64).sqrt() } else { 0.0 };
            (all.compared[k], all.difference[k], all.error[k]) =
                (count, rms(sum(|c| &c.difference)), rms(sum(|c| &c.error)));
        }
        all
    }
}

impl Cache {
    /// Counts look-ups and measures time from now on.
    pub fn observe(&mut self, clock: Clock) {
        self.stopwatch.clock = Some(clock);
        self.observer = Some(Observer::new().into());
        self.plain = false;
    }

    /// Times parallel steps and the work of this thread between them from now on: `wall` and `own` are the time, and the
    /// processor time of the thread that asks.
    pub fn time_steps(&mut self, wall: Clock, own: Clock) {
        self.steps = Steps::timed(wall, own).into();
    }

    /// Does parallel steps: those of whoever asks the cache go with the cache's own where these are timed.
    pub fn steps(&self) -> &Steps {
        &self.steps
    }

    /// What look-ups came to since [`Cache::observe`].
    pub fn observed(&self) -> Option<Observed> {
        self.observer.as_ref().map(|o| o.total())
    }

    /// Time spent in [`Cache::resolve`] since [`Cache::observe`].
    pub fn filling(&self) -> Duration {
        self.stopwatch.total
    }

    /// Answers where look-ups are counted, or nothing is cached.
    #[cold]
    pub(crate) fn ask_observed<S: Sampler>(&self, sampler: &S, query: &Query<S::Origin>) -> Answer {
        if !self.params.caches() {
            return Answer::Uncached;
        }
        let answer = self.lookup(sampler, query);
        if let Some(observer) = &self.observer {
            let counts = observer.counts();
            let level = usize::from(query.level).min(LEVELS - 1);
            counts.asked[level].fetch_add(1, Relaxed);
            counts.answered[level].fetch_add(u64::from(answer.is_some()), Relaxed);
            if hash_point(query.position).is_multiple_of(CLOSELY) {
                self.compare(sampler, query, level, counts);
            }
        }
        answer.map_or(Answer::Miss, Answer::Value)
    }

    fn compare<S: Sampler>(&self, sampler: &S, query: &Query<S::Origin>, level: usize, counts: &Counts) {
        let parts = self.store.contributions(&self.limits, sampler, query);
        let weights: f64 = parts.iter().map(|p| f64::from(p.0)).sum();
        let mean = parts.iter().map(|p| f64::from(p.0 * p.1.mean())).sum::<f64>() / weights;
        let whole = self.average.mean(level);
        if parts.len() < 2 || mean.is_nan() || whole <= 0.0 {
            return;
        }
        let apart = |p: &(f32, ambit_base::Rgb)| f64::from(p.0) * ((f64::from(p.1.mean()) - mean) / whole).powi(2);
        let difference = (parts.iter().map(apart).sum::<f64>() / weights).min(MOST);
        let error = difference * parts.iter().map(|p| f64::from(p.0).powi(2)).sum::<f64>() / weights.powi(2);
        counts.compared[level].fetch_add(1, Relaxed);
        counts.difference[level].fetch_add((difference * ONE) as u64, Relaxed);
        counts.error[level].fetch_add((error * ONE) as u64, Relaxed);
    }
}
