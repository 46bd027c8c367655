//! How many samples the hemispheres of deeper records are worth.
//!
//! Let n hemispheres of N samples each answer what is seen directly, and M records of a further bounce with N' samples
//! each what those samples ask. The noise of a value is that of its own samples and, of each record, its part of them,
//! about 1/M: `a N⁻ᵖ + b N'⁻ᵠ / M`. The samples taken are `n N + M N'`. So the least noise for as many samples has N' in
//! proportion to `(√n / M)^(2/(q+1))`: the more records share a value and the fewer hemispheres share a record, the less
//! each of them is worth. The model alone gives powers of .67 (evenly spread samples, q = 2) to 1 (random ones, q = 1);
//! [`POWER`] and [`SCALE`] are what served best, sensors and pictures, for radii and gradients need samples, too.
//!
//! n and M are those of the whole scene so far, for it is not known which records a value shares. In a building of many
//! rooms alike both grow with the rooms, and their ratio is too small: [`LEAST`] bounds what that can do.
//!
//! Records are counted between rounds, and in a round by the order of its hemispheres, so that the answer depends neither on
//! threads nor on time.

/// The power of √n / M.
const POWER: f32 = 0.6;
/// The share of samples, per weight of the record, that the power is multiplied by.
const SCALE: f32 = 4.0;
/// The least share, over the greatest.
const LEAST: f32 = 0.25;

/// What is known of the numbers of hemispheres.
#[derive(Clone, Debug, Default)]
pub(crate) struct Worth {
    /// Records by level.
    records: Vec<u32>,
    /// Queries of level 0 that are resolved together now: they become records, or are answered by those of others. With
    /// the records there are already they are n, so that it is never too small; the root lessens what is counted twice.
    open: usize,
}

impl Worth {
    /// So many queries of level 0 are about to be resolved.
    pub(crate) fn expect(&mut self, queries: usize) {
        self.open = queries;
    }

    /// Records of a level.
    pub(crate) fn records(&self, level: u8) -> usize {
        self.records.get(usize::from(level)).copied().unwrap_or(0) as usize
    }

    /// There is one record more.
    pub(crate) fn made(&mut self, level: u8) {
        let level = usize::from(level);
        if self.records.len() <= level {
            self.records.resize(level + 1, 0);
        }
        self.records[level] += 1;
    }

    /// The share of `-ad` and `-as` that the hemisphere of a record of this level and weight gets, where so many of its round
    /// come before it: at most the square of its weight. Radiance samples in proportion to the weight; but a deeper record is
    /// one of hundreds that a hemisphere above it sees, and their noise is averaged there.
    pub(crate) fn share(&self, level: u8, weight: f32, before: usize) -> f32 {
        let square = weight * weight;
        if level == 0 {
            return square;
        }
        let seen = (self.records(0) + self.open).max(1) as f32;
        let records = (self.records(level) + before).max(1) as f32;
        (SCALE * weight * (seen.sqrt() / records).powf(POWER)).clamp(LEAST * square, square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_more_records_share_a_value_the_fewer_samples_each_gets() {
        let mut worth = Worth::default();
        worth.expect(100);
        let mut last = worth.share(1, 0.5, 0);
        assert_eq!(last, 0.25, "the first get the square of their weight");
        for made in 1..=10_000 {
            let share = worth.share(1, 0.5, 1);
            worth.made(1);
            assert_eq!(share, worth.share(1, 0.5, 0), "one that is about to come counts as one that has");
            assert!(share <= last);
            last = share;
            assert!(made == 320 || (share == 0.25) == (made < 320), "up to 32 √n: {share} at {made}");
            if made == 1000 {
                // 2 (10 / 1000)^.6
                assert!((share - 0.126_191_47).abs() < 1e-6, "{share}");
            }
        }
        assert_eq!(last, 0.0625, "a quarter of that at least");
        worth.expect(1_000_000);
        assert!(worth.share(1, 0.5, 0) > last, "they are worth more to more hemispheres");
        assert_eq!(worth.share(0, 1.0, 0), 1.0, "what is seen directly gets all");
        assert_eq!(worth.share(2, 0.25, 0), 0.0625, "other levels count by themselves");
    }
}
