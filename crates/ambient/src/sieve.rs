//! A coarse test of many records at once: distance and facing in whole numbers of 16 bits, eight records to a block, so
//! that one instruction compares them all. What passes is tested exactly.

use ambit_base::{DVec3, Vec3};
use wide::i16x8;

/// Records tested together.
pub(crate) const LANES: usize = 8;
/// Steps to an edge of a cell. A record lies at most one reach outside the cell, which is less than an edge: two edges
/// fill the positive numbers. Coordinates beyond them saturate, which brings places nearer to each other, never apart.
const STEPS: f64 = 16384.0;
/// Steps by which a reach is widened: both places are cut off by less than a step an axis, towards 0.
const WIDENING: f64 = 3.5;
/// A unit vector's component of 1.
const UNIT: f32 = 32767.0;
/// What products of two components of 1 become: half of a product's bits are dropped.
const PRODUCT: f32 = UNIT * UNIT / 65536.0;
/// Allowance for rounding in a cosine, in units of 1/`PRODUCT`: three products rounded down, of factors that are less
/// than a step off, which makes up to √3 together.
const COSINE_SLACK: f32 = 6.0;

/// What the coarse test knows of eight records, and which they are.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Block {
    /// Position relative to the low corner of the cell in which they are listed, and normal.
    columns: [i16x8; 6],
    /// Squared reach, the upper half of its bits; negative in vacant places, which nothing passes.
    reach2: i16x8,
    /// The records.
    id: [u32; LANES],
    /// The least level among them.
    level: u8,
}

/// One place of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    columns: [i16; 6],
    reach2: i16,
    id: u32,
}

/// A place within a cell with the given edge, in steps.
fn steps(relative: DVec3, edge: f64) -> [i16; 3] {
    (relative * (STEPS / edge)).to_array().map(|c| c as i16)
}

fn components(normal: Vec3) -> [i16; 3] {
    (normal * UNIT).to_array().map(|c| c as i16)
}

impl Mark {
    /// Of a record: its position relative to a cell with the given edge, its normal, its reach and its number.
    pub(crate) fn new(relative: DVec3, edge: f64, normal: Vec3, reach: f64, id: u32) -> Self {
        let [x, y, z] = steps(relative, edge);
        let [nx, ny, nz] = components(normal);
        let reach = reach * (STEPS / edge) + WIDENING;
        // The sum of squares' upper halves is no more than the upper half of their sum.
        Self { columns: [x, y, z, nx, ny, nz], reach2: (reach * reach / 65536.0) as i16, id }
    }
}

impl Block {
    /// A block of vacant places.
    pub(crate) const VACANT: Self =
        Self { columns: [i16x8::splat(0); 6], reach2: i16x8::splat(-1), id: [0; LANES], level: u8::MAX };

    /// The record at a place.
    pub(crate) fn id(&self, lane: usize) -> u32 {
        self.id[lane]
    }

    /// The level of the first record, which is the least.
    pub(crate) fn level(&self) -> u8 {
        self.level
    }

    /// Notes the level of the first record.
    pub(crate) fn set_level(&mut self, level: u8) {
        self.level = level;
    }

    /// What is at a place.
    pub(crate) fn mark(&self, lane: usize) -> Mark {
        Mark {
            columns: self.columns.each_ref().map(|c| c.as_array()[lane]),
            reach2: self.reach2.as_array()[lane],
            id: self.id[lane],
        }
    }

    /// Fills a place.
    pub(crate) fn set(&mut self, lane: usize, mark: Mark) {
        for (c, v) in self.columns.iter_mut().zip(mark.columns) {
            c.as_mut_array()[lane] = v;
        }
        self.reach2.as_mut_array()[lane] = mark.reach2;
        self.id[lane] = mark.id;
    }

    /// The records that may qualify, in order.
    #[inline]
    pub(crate) fn candidates(&self, probe: &Probe) -> impl Iterator<Item = u32> {
        let mut left = self.passing(probe);
        std::iter::from_fn(move || {
            let lane = (left != 0).then(|| left.trailing_zeros() as usize & (LANES - 1))?;
            left &= left - 1;
            Some(self.id[lane])
        })
    }

    /// One bit for each place whose record may qualify.
    #[inline]
    fn passing(&self, probe: &Probe) -> u32 {
        let [x, y, z, nx, ny, nz] = self.columns;
        let at = &probe.at;
        let square = |d: i16x8| d.mul_keep_high(d);
        let along = |c: i16x8, at: i16x8| square(c.saturating_sub(at));
        let distance2 = along(x, at[0]).saturating_add(along(y, at[1])).saturating_add(along(z, at[2]));
        let cosine = nx.mul_keep_high(at[3]) + ny.mul_keep_high(at[4]) + nz.mul_keep_high(at[5]);
        let far = distance2.simd_gt(self.reach2);
        (far | cosine.simd_lt(probe.cosine)).to_bitmask() ^ ((1 << LANES) - 1)
    }
}

/// A query as the coarse test of one cell sees it.
pub(crate) struct Probe {
    at: [i16x8; 6],
    /// Least cosine between normals.
    cosine: i16x8,
}

impl Probe {
    /// A probe of position (relative to the low corner of a cell with the given edge) and normal for records within
    /// `angle` radians.
    #[inline]
    pub(crate) fn new(relative: DVec3, edge: f64, normal: Vec3, angle: f32) -> Self {
        let [x, y, z] = steps(relative, edge);
        let [nx, ny, nz] = components(normal);
        // 2 − 2 cos θ < angle², the form of the exact test; and records that face away never qualify.
        let cosine = (1.0 - 0.5 * angle * angle).max(0.0) * PRODUCT - COSINE_SLACK;
        Self { at: [x, y, z, nx, ny, nz].map(i16x8::splat), cosine: i16x8::splat(cosine as i16) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::Stream;

    /// Three numbers in [−1, 1).
    fn three(key: u64) -> DVec3 {
        DVec3::from_array(Stream::new(0, key).three()) * 2.0 - 1.0
    }

    /// What qualifies always passes, at every scale, inside the cell and far outside; and not everything passes.
    #[test]
    fn nothing_that_qualifies_is_sieved_out() {
        let (mut qualified, mut passed, mut all) = (0, 0, 0);
        for key in 0..40_000u64 {
            let edge = [1e-4, 1.0, 3.7e5][key as usize % 3];
            let beyond = if key % 8 == 0 { 5.0 } else { 1.0 };
            let [share, angle, turn] = Stream::new(1, key).three();
            let reach = edge * (0.5 + 0.5 * share);
            let record = (three(key + 1_000_000) * 0.75 + 0.5) * edge * beyond;
            let query = record + three(key + 2_000_000) * reach * 1.2;
            let normal = three(key + 3_000_000).normalize();
            let other = (normal + three(key + 4_000_000) * turn).normalize();
            let (normal, other, angle) = (normal.as_vec3(), other.as_vec3(), angle as f32);
            let mut block = Block::VACANT;
            block.set(key as usize % LANES, Mark::new(record, edge, normal, reach, 77));
            let probe = Probe::new(query, edge, other, angle);
            let found: Vec<u32> = block.candidates(&probe).collect();
            assert!(found.is_empty() || found == [77]);
            let near = (query - record).length() <= reach;
            let facing = (normal - other).length_squared() < (angle * angle).min(2.0);
            assert!(!(near && facing) || found == [77], "{key}: {record} {query} {reach} in {edge}");
            all += 1;
            qualified += usize::from(near && facing);
            passed += found.len();
        }
        // The allowances let few others pass.
        assert!(qualified > 2000 && passed < qualified + all / 20, "{qualified} qualify, {passed} of {all} pass");
    }
}
