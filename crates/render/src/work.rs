//! Scratch memory and counters of one thread: nothing on the ray path allocates once these have grown.

use crate::sources::{Candidate, Chosen, Count, Part, SourceId, Tally};
use ambit_ambient::APART;
use ambit_base::Rgb;

/// What one thread reuses from ray to ray.
#[derive(Debug)]
pub(crate) struct Work {
    /// Rays traced.
    pub(crate) rays: u64,
    /// What of a hemisphere sample's light the last bounces brought, as the cache answered.
    pub(crate) late: [Rgb; APART],
    pub(crate) candidates: Vec<Candidate>,
    pub(crate) parts: Vec<Part>,
    /// Lamps that stand for all.
    pub(crate) chosen: Vec<Chosen>,
    /// Candidates as they are ranked.
    pub(crate) ranks: Vec<u64>,
    /// Rays that wait for each other.
    pub(crate) nested: u32,
    pub(crate) cal: ambit_cal::Scratch,
    /// Shadow tests since the last batch.
    pub(crate) tally: Tally,
    /// Shadow tests of the hit being lit.
    here: Vec<Count>,
}

impl Work {
    pub(crate) fn new(sources: usize) -> Self {
        Self {
            rays: 0,
            late: [Rgb::ZERO; APART],
            candidates: Vec::new(),
            parts: Vec::new(),
            chosen: Vec::new(),
            ranks: Vec::new(),
            nested: 0,
            cal: ambit_cal::Scratch::default(),
            tally: Tally::zero(sources),
            here: Tally::zero(sources).counts,
        }
    }

    /// Counts a shadow test of the hit being lit.
    pub(crate) fn note_test(&mut self, source: SourceId, clear: bool) {
        self.here[source as usize].note(clear);
    }

    /// Shadow tests of a source at the hit being lit.
    pub(crate) fn tests_here(&self, source: SourceId) -> Count {
        self.here[source as usize]
    }

    /// Moves the counts of the hit being lit to the thread's.
    pub(crate) fn settle(&mut self, tested: impl Iterator<Item = SourceId>) {
        for s in tested {
            let here = std::mem::replace(&mut self.here[s as usize], Count { hits: 0, tests: 0 });
            let total = &mut self.tally.counts[s as usize];
            total.hits += here.hits;
            total.tests += here.tests;
        }
    }
}
