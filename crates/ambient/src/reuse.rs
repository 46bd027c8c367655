//! Where records are hardly reused (leaves, blades, hair): measured, not listed.
//!
//! A record pays when other questions use it. On hairy surfaces most questions need one of their own, whose many samples
//! then serve a single point. From level 1 on such a point is one of hundreds that a hemisphere averages, and a few
//! samples that are not kept do as well: path tracing. (At level 0 they would not: there each point is looked at alone,
//! and fewer samples are more noise.)
//!
//! Per cell of a grid and level, this counts the misses and how they were settled: by a record of their own, or by that
//! of another. Once more than half took one of their own, misses are answered by hemispheres of 1/[`RENT`] of the samples.
//! Nobody knows how many questions are still to come, and with enough of them even hair is worth covering. So it is
//! decided as one decides between renting and buying: each record made allows as many samples that are not kept, and when
//! these are used up, the next miss gets a record. Whatever comes, it takes at most twice the samples of what would have
//! been better; and a region that is but newly seen, where almost every miss makes a record, too, gets its records in the
//! end.
//!
//! All is counted between rounds, in the order of the list, so that it depends neither on threads nor on time; look-ups
//! know nothing of it.

use crate::params::Limits;
use crate::sampler::Query;
use std::collections::HashMap;

/// Samples of a record over those of a hemisphere that is not kept.
pub(crate) const RENT: u64 = 16;
/// Misses that must have been settled before a cell is judged.
const LEAST: u64 = 16;
/// Edge of the scene's cube over that of a cell.
const CELLS: f64 = 16.0;

/// What happened in one cell at one level.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    /// Misses settled, by whatever record.
    settled: u64,
    /// Records made.
    made: u64,
    /// Hemispheres used once.
    rented: u64,
}

/// Counts of all cells.
#[derive(Clone, Debug)]
pub(crate) struct Reuse {
    edge: f64,
    /// Passes of a record, of which a hemisphere that is not kept has but one.
    passes: u64,
    cells: HashMap<Cell, Count>,
}

/// A cell of the grid, and a level.
type Cell = ([i64; 3], u8);

impl Reuse {
    /// Nothing counted yet.
    pub(crate) fn new(limits: &Limits, passes: u8) -> Self {
        Self { edge: limits.edge / CELLS, passes: u64::from(passes.max(1)), cells: HashMap::new() }
    }

    fn cell<O>(&self, query: &Query<O>) -> Cell {
        ((query.position / self.edge).floor().to_array().map(|x| x as i64), query.level)
    }

    fn count<O>(&mut self, query: &Query<O>) -> &mut Count {
        self.cells.entry(self.cell(query)).or_default()
    }

    /// A miss was answered by the record of another.
    pub(crate) fn served<O>(&mut self, query: &Query<O>) {
        self.count(query).settled += 1;
    }

    /// A miss got a record of its own.
    pub(crate) fn made<O>(&mut self, query: &Query<O>) {
        let count = self.count(query);
        count.settled += 1;
        count.made += 1;
    }

    /// True if a miss is to be answered by a hemisphere that is not kept; counts it if so.
    pub(crate) fn rents<O>(&mut self, query: &Query<O>) -> bool {
        if query.level == 0 {
            return false;
        }
        let cell = self.cell(query);
        let most = RENT * self.passes;
        let Some(count) = self.cells.get_mut(&cell) else { return false };
        let hardly = count.settled >= LEAST && count.made > count.settled / 2;
        let rents = hardly && count.rented < most * count.made;
        count.rented += u64::from(rents);
        rents
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Params;
    use ambit_base::DVec3;

    fn query(x: f64, level: u8) -> Query<()> {
        let position = DVec3::new(x, 0.1, 0.1);
        Query { position, normal: DVec3::Z, shading: DVec3::Z, weight: 1.0, level, pass: 0, origin: () }
    }

    fn empty() -> Reuse {
        Reuse::new(&Limits::new(&Params::default(), 1.0), 1)
    }

    #[test]
    fn cells_whose_records_serve_others_never_rent() {
        let mut reuse = empty();
        for _ in 0..1000 {
            reuse.made(&query(0.1, 1));
            reuse.served(&query(0.1, 1));
            assert!(!reuse.rents(&query(0.1, 1)));
        }
    }

    #[test]
    fn a_cell_rents_as_much_as_it_has_bought_and_then_buys_again() {
        let mut reuse = empty();
        for _ in 0..LEAST {
            assert!(!reuse.rents(&query(0.1, 1)), "too few to judge");
            reuse.made(&query(0.1, 1));
        }
        for made in LEAST..3 * LEAST {
            let rented = (0..10_000).take_while(|_| reuse.rents(&query(0.1, 1))).count() as u64;
            assert_eq!(rented, if made == LEAST { RENT * LEAST } else { RENT });
            reuse.made(&query(0.1, 1));
        }
        // Elsewhere, at another level, and at the eye nothing is known.
        for other in [query(0.5, 1), query(0.1, 2), query(0.1, 0)] {
            assert!(!reuse.rents(&other));
        }
    }

    #[test]
    fn points_seen_by_the_eye_have_records() {
        let mut reuse = empty();
        for _ in 0..100 {
            reuse.made(&query(0.1, 0));
        }
        assert!(!reuse.rents(&query(0.1, 0)));
    }
}
