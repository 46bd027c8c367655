//! A coarse test of many records at once: distance and facing in single precision, eight records to a block, so that
//! one instruction compares several. What passes is tested exactly.

use ambit_base::{DVec3, Vec3};
use wide::f32x8;

/// Records tested together.
pub(crate) const LANES: usize = 8;
/// Allowance for single-precision rounding: reaches are widened, and angles opened, by this fraction.
const SLACK: f32 = 1e-5;

/// What the coarse test knows of eight records, and which they are.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// Position relative to the low corner of the record's cell, and normal.
    columns: [f32x8; 6],
    /// Squared reach; negative in vacant places, which nothing passes.
    reach2: f32x8,
    /// The records.
    id: [u32; LANES],
}

/// One place of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    columns: [f32; 6],
    reach2: f32,
    id: u32,
}

impl Mark {
    /// Of a record: its position relative to its cell, its normal, its reach and its number.
    pub(crate) fn new(relative: DVec3, normal: [f32; 3], reach: f64, id: u32) -> Self {
        let p = relative.as_vec3();
        let reach = reach as f32 * (1.0 + SLACK);
        Self { columns: [p.x, p.y, p.z, normal[0], normal[1], normal[2]], reach2: reach * reach, id }
    }
}

impl Block {
    /// A block of vacant places.
    pub(crate) const VACANT: Self =
        Self { columns: [f32x8::splat(0.0); 6], reach2: f32x8::splat(-1.0), id: [0; LANES] };

    /// The record at a place.
    pub(crate) fn id(&self, lane: usize) -> u32 {
        self.id[lane]
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

    /// One bit for each place whose record may qualify.
    #[inline]
    pub(crate) fn passing(&self, probe: &Probe) -> u32 {
        let [x, y, z, nx, ny, nz] = self.columns;
        let at = &probe.at;
        let (dx, dy, dz) = (x - at[0], y - at[1], z - at[2]);
        let near = (dx * dx + dy * dy + dz * dz).simd_lt(self.reach2);
        let facing = (nx * at[3] + ny * at[4] + nz * at[5]).simd_ge(probe.cosine);
        (near & facing).to_bitmask()
    }
}

/// A query as the coarse test of one cell sees it.
pub(crate) struct Probe {
    at: [f32x8; 6],
    /// Least cosine between normals.
    cosine: f32x8,
}

impl Probe {
    /// A probe of position (relative to the cell's corner) and normal for records within `angle` radians.
    #[inline]
    pub(crate) fn new(relative: DVec3, normal: Vec3, angle: f32) -> Self {
        let p = relative.as_vec3();
        // 2 − 2 cos θ < angle², the form of the exact test; and records that face away never qualify.
        let cosine = (1.0 - 0.5 * angle * angle).max(0.0) - SLACK;
        Self { at: [p.x, p.y, p.z, normal.x, normal.y, normal.z].map(f32x8::splat), cosine: f32x8::splat(cosine) }
    }
}
