//! A coarse test of many records at once: distance and facing in single precision, column by column, so that the
//! compiler compares several records with one instruction. What passes is tested exactly.

use ambit_base::{DVec3, Vec3};
use std::ops::Range;

/// Records tested together.
pub(crate) const LANES: usize = 4;
/// Allowance for single-precision rounding: reaches are widened, and angles opened, by this fraction.
const SLACK: f32 = 1e-5;

/// What the coarse test knows of each record, in columns parallel to the store's arrays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sieve {
    /// Position relative to the low corner of the record's cell, and normal.
    columns: [Vec<f32>; 6],
    /// Squared reach; negative for vacant places, which nothing passes.
    reach2: Vec<f32>,
}

/// A query as the coarse test of one cell sees it.
pub(crate) struct Probe {
    at: [f32; 6],
    /// Least cosine between normals.
    cosine: f32,
}

impl Probe {
    /// A probe of position (relative to the cell's corner) and normal for records within `angle` radians.
    pub(crate) fn new(relative: DVec3, normal: Vec3, angle: f32) -> Self {
        let p = relative.as_vec3();
        // 2 − 2 cos θ < angle², the form of the exact test; and records that face away never qualify.
        let cosine = (1.0 - 0.5 * angle * angle).max(0.0) - SLACK;
        Self { at: [p.x, p.y, p.z, normal.x, normal.y, normal.z], cosine }
    }
}

impl Sieve {
    /// Grows all columns to `len` places.
    pub(crate) fn resize(&mut self, len: usize) {
        for c in &mut self.columns {
            c.resize(len, 0.0);
        }
        self.reach2.resize(len, -1.0);
    }

    /// Makes a run of places vacant.
    pub(crate) fn clear(&mut self, range: Range<usize>) {
        self.reach2[range].fill(-1.0);
    }

    /// Moves a run of places.
    pub(crate) fn copy_within(&mut self, from: Range<usize>, to: usize) {
        for c in &mut self.columns {
            c.copy_within(from.clone(), to);
        }
        self.reach2.copy_within(from, to);
    }

    /// Notes a record: its position relative to its cell, its normal and its reach.
    pub(crate) fn set(&mut self, at: usize, relative: DVec3, normal: [f32; 3], reach: f64) {
        let p = relative.as_vec3();
        for (c, v) in self.columns.iter_mut().zip([p.x, p.y, p.z, normal[0], normal[1], normal[2]]) {
            c[at] = v;
        }
        let reach = reach as f32 * (1.0 + SLACK);
        self.reach2[at] = reach * reach;
    }

    /// Calls `f` with the offset in `range` of every record that may qualify, in order, until it answers false.
    /// The range is a whole number of [`LANES`].
    #[inline]
    pub(crate) fn pass(&self, range: Range<usize>, probe: &Probe, mut f: impl FnMut(usize) -> bool) {
        let [x, y, z, nx, ny, nz] = self.columns.each_ref().map(|c| c[range.clone()].as_chunks::<LANES>().0);
        let reach2 = self.reach2[range].as_chunks::<LANES>().0;
        for (i, reach2) in reach2.iter().enumerate() {
            let mut mask = probe.mask([&x[i], &y[i], &z[i], &nx[i], &ny[i], &nz[i]], reach2);
            while mask != 0 {
                if !f(i * LANES + mask.trailing_zeros() as usize) {
                    return;
                }
                mask &= mask - 1;
            }
        }
    }
}

impl Probe {
    #[inline]
    fn mask(&self, c: [&[f32; LANES]; 6], reach2: &[f32; LANES]) -> u32 {
        let mut far = [0.0f32; LANES];
        let mut cosine = [0.0f32; LANES];
        for i in 0..LANES {
            let (dx, dy, dz) = (c[0][i] - self.at[0], c[1][i] - self.at[1], c[2][i] - self.at[2]);
            far[i] = dx * dx + dy * dy + dz * dz;
            cosine[i] = c[3][i] * self.at[3] + c[4][i] * self.at[4] + c[5][i] * self.at[5];
        }
        let mut mask = 0;
        for i in 0..LANES {
            let near = u32::from(far[i] < reach2[i]);
            let facing = u32::from(cosine[i] >= self.cosine);
            mask |= (near & facing) << i;
        }
        mask
    }
}
