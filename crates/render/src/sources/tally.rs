//! How often each source's shadow tests came out clear: the memory that estimates untested sources.
//!
//! The counts that shading reads stay frozen while a batch is computed and are brought up to date between batches, so
//! that they depend on neither threads nor timing.

/// Shadow tests of one source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Count {
    pub(crate) hits: u64,
    pub(crate) tests: u64,
}

impl Count {
    /// Counts a test.
    pub(crate) fn note(&mut self, clear: bool) {
        self.tests += 1;
        self.hits += u64::from(clear);
    }
}

/// Shadow tests of all sources.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) counts: Vec<Count>,
    /// Share of each source's tests that came out clear, so far as it is asked for.
    pub(crate) clear: Vec<f64>,
}

impl Tally {
    /// The counts that every source starts with: half of the tests clear.
    pub(crate) fn new(sources: usize) -> Self {
        Self { counts: vec![Count { hits: 1, tests: 2 }; sources], clear: vec![0.5; sources] }
    }

    /// No tests at all: what a thread counts from.
    pub(crate) fn zero(sources: usize) -> Self {
        Self { counts: vec![Count { hits: 0, tests: 0 }; sources], clear: Vec::new() }
    }

    /// Moves the counts of `other` into this one.
    pub(crate) fn take(&mut self, other: &mut Self) {
        for (mine, theirs) in self.counts.iter_mut().zip(&mut other.counts) {
            mine.hits += std::mem::take(&mut theirs.hits);
            mine.tests += std::mem::take(&mut theirs.tests);
        }
        for (clear, count) in self.clear.iter_mut().zip(&self.counts) {
            *clear = count.hits as f64 / count.tests as f64;
        }
    }
}
