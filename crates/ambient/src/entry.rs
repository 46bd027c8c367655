//! A record as look-ups read it.

use crate::light::Light;
use crate::record::Record;

/// Two lines of the processor's cache: where a record is valid, which every comparison reads, and what it answers, which
/// is read once it qualifies.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub(crate) struct Entry {
    pub(crate) position: [f64; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) u: [f32; 3],
    pub(crate) inverse_radii: [f32; 2],
    pub(crate) weight: f32,
    pub(crate) level: u8,
    pub(crate) corralled: bool,
    /// A file brought it: an earlier run computed it, or another process.
    pub(crate) found: bool,

    pub(crate) gradient: [f32; 2],
    pub(crate) rotation: [f32; 2],
    pub(crate) corral: u32,
    /// In the first pass.
    light: Light,
}

const _: () = assert!(size_of::<Entry>() == 128, "a record is two lines of the cache");

impl Entry {
    /// `apart` if bounces are told apart.
    pub(crate) fn of(record: &Record, apart: bool, found: bool) -> Self {
        Self {
            position: record.position.to_array(),
            normal: record.normal.as_vec3().to_array(),
            u: record.u.as_vec3().to_array(),
            inverse_radii: record.radii.map(f32::recip),
            weight: record.weight,
            level: record.level,
            corralled: record.corral != 0,
            found,
            gradient: record.gradient,
            rotation: record.rotation,
            corral: record.corral,
            light: light_of(record, 0, apart),
        }
    }

    /// What the record answers, at its own place and in the first pass, to questions of a level that is not below its own.
    #[inline]
    pub(crate) fn light(&self, level: u8) -> Light {
        self.light.deeper(level - self.level)
    }
}

/// A record's light in a pass.
pub(crate) fn light_of(record: &Record, pass: u8, apart: bool) -> Light {
    if apart { record.light(pass) } else { record.of_pass(pass).into() }
}
