//! What a calculation took: records, look-ups, hemispheres, time. Counted for those who ask before it begins.

use crate::Renderer;
use ambit_ambient::{Clock, Observed, Parallelism, Record};
use std::time::Duration;

/// Numbers of a level each; entry 0 is seen from the eye.
fn by_level(records: &[Record]) -> Vec<u64> {
    let mut counts = Vec::new();
    for level in records.iter().map(|r| usize::from(r.level)) {
        if counts.len() <= level {
            counts.resize(level + 1, 0);
        }
        counts[level] += 1;
    }
    counts
}

/// What a calculation took.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Rays traced.
    pub rays: u64,
    /// Records computed, by level.
    pub made: Vec<u64>,
    /// Records from the ambient file, by level.
    pub loaded: Vec<u64>,
    /// Hemisphere samples, by level.
    pub samples: Vec<u64>,
    /// Rounds of filling.
    pub rounds: u64,
    /// Time spent in hemispheres, with all that their rays asked for.
    pub filling: Duration,
    /// Look-ups and what they came to.
    pub observed: Observed,
    /// What the same would take on other numbers of cores, if steps were timed.
    pub parallelism: Option<Parallelism>,
}

impl Renderer {
    /// Counts look-ups and measures the time of hemispheres from now on, by the clock `wall`.
    pub fn measure(&mut self, wall: Clock) {
        self.cache_mut().observe(wall);
    }

    /// Times every task from now on, by the processor time of the thread that asks, `own`: a tenth of the time itself.
    pub fn time_steps(&mut self, wall: Clock, own: Clock) {
        self.cache_mut().time_steps(wall, own);
    }

    /// What it took since [`Renderer::measure`]; none if that was not called.
    pub fn report(&self) -> Option<Report> {
        let observed = self.cache().observed()?;
        let statistics = self.cache().statistics();
        let loaded = &statistics.loaded;
        let mut made = by_level(self.cache().records());
        for (all, loaded) in made.iter_mut().zip(loaded) {
            *all -= loaded;
        }
        Some(Report {
            rays: self.rays(),
            made,
            loaded: loaded.clone(),
            samples: statistics.samples.clone(),
            rounds: statistics.rounds,
            filling: self.cache().filling(),
            observed,
            parallelism: self.cache().steps().parallelism(),
        })
    }
}
