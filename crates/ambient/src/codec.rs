//! The bytes of a record in ambient files: big-endian, without padding; reals are 31-bit mantissas with a binary
//! exponent, directions 32-bit codes, the value a mantissa for each component with a common exponent. What reals of single
//! precision leave of their mantissas tells what the last bounces brought (`shares`).

use crate::components::Components;
use crate::record::Record;
use crate::shares::{CARRIERS, late, shares};
use ambit_base::{DVec3, Rgb};
use ambit_file::{FLOAT_BYTES, decode_direction, decode_float, decode_single, decode_spectrum};
use ambit_file::{encode_direction, encode_float, encode_single, encode_spectrum};
use std::ops::Range;

/// The length of a record of three components.
pub const RECORD_BYTES: usize = 67;
/// The length of a record without the mantissas of its value.
const FRAME_BYTES: usize = 64;

/// The order of fields, told by the magic number after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Magic 561, of Radiance 6: the value last.
    V561,
    /// Magic 559, of Radiance 5: the value before the radii, the corral last.
    V559,
}

impl Layout {
    /// Where the codes of normal and tangent stand.
    pub const DIRECTIONS: Range<usize> = 21..29;
    /// What is written.
    pub const CURRENT: Self = Self::V561;

    /// The layout with the given magic number.
    pub fn of_magic(magic: u16) -> Option<Self> {
        match magic {
            561 => Some(Self::V561),
            559 => Some(Self::V559),
            _ => None,
        }
    }

    /// The magic number.
    pub fn magic(self) -> u16 {
        match self {
            Self::V561 => 561,
            Self::V559 => 559,
        }
    }

    /// Offsets of the value, the radii (with the gradients following) and the corral.
    fn offsets(self) -> (usize, usize, usize) {
        match self {
            Self::V561 => (63, 29, 59),
            Self::V559 => (29, 33, 63),
        }
    }

    /// The length of a record.
    pub fn record_bytes(self, components: &Components) -> usize {
        FRAME_BYTES + components.count()
    }

    /// The bytes of a record. The older layout has three components.
    pub fn encode(self, record: &Record, components: &Components) -> Vec<u8> {
        let mut bytes = vec![0; self.record_bytes(components)];
        let (value, radii, corral) = self.offsets();
        let mut put = |at: usize, part: &[u8]| bytes[at..at + part.len()].copy_from_slice(part);
        put(0, &[record.level]);
        put(1, &encode_float(f64::from(record.weight)));
        for (k, x) in record.position.to_array().into_iter().enumerate() {
            put(6 + k * FLOAT_BYTES, &encode_float(x));
        }
        put(21, &encode_direction(record.normal).to_be_bytes());
        put(25, &encode_direction(record.u).to_be_bytes());
        let reals = record.radii.iter().chain(&record.gradient).chain(&record.rotation);
        for (k, (&x, share)) in reals.zip(shares(record)).enumerate() {
            put(radii + k * FLOAT_BYTES, &encode_single(x, share));
        }
        put(corral, &record.corral.to_be_bytes());
        let mut channels = [0.0; Components::MOST];
        channels.iter_mut().zip(components.of(record)).for_each(|(channel, c)| *channel = c);
        encode_spectrum(&channels[..components.count()], &mut bytes[value..]);
        bytes
    }

    /// The record in the bytes, as many as [`Layout::record_bytes`], not checked for plausibility: a null code gives a
    /// null direction.
    pub fn decode(self, bytes: &[u8], components: &Components) -> Record {
        let (value, radii, corral) = self.offsets();
        let five = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3], bytes[at + 4]];
        let real = |at: usize| decode_float(five(at));
        let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        let singles: [_; CARRIERS] = std::array::from_fn(|k| decode_single(five(radii + k * FLOAT_BYTES)));
        let pair = |k: usize| [singles[k].0, singles[k + 1].0];
        let direction = |at: usize| decode_direction(u32::from_be_bytes(word(at)));
        let mut channels = [0.0; Components::MOST];
        let channels = &mut channels[..components.count()];
        decode_spectrum(&bytes[value..], channels);
        let mut record = Record {
            position: DVec3::new(real(6), real(11), real(16)),
            normal: direction(21),
            u: direction(25),
            level: bytes[0],
            weight: real(1) as f32,
            radii: pair(0),
            gradient: pair(2),
            rotation: pair(4),
            corral: u32::from_be_bytes(word(corral)),
            value: Rgb::ZERO,
            further: Box::default(),
            late: Box::default(),
        };
        components.give(channels, &mut record);
        // Where another program left something else than nothing, it tells of no bounces.
        let told = singles.iter().all(|(_, beside)| beside.is_some());
        let shares = singles.map(|(_, beside)| beside.filter(|_| told).unwrap_or(0));
        record.late = late(shares, &record);
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[rustfmt::skip]
    const EXAMPLE: [u8; RECORD_BYTES] = [
        0x01,
        0x3f, 0xff, 0xff, 0xff, 0x00,
        0x44, 0x22, 0x44, 0xff, 0x01, 0x51, 0x35, 0x1e, 0xff, 0xff, 0x5f, 0xff, 0xff, 0xff, 0x02,
        0x00, 0x00, 0x00, 0x0c,
        0x00, 0x00, 0x61, 0xfa,
        0x66, 0x66, 0x87, 0xff, 0x00, 0x66, 0x66, 0x87, 0xff, 0x00,
        0xa4, 0x33, 0x33, 0x81, 0xff, 0xbc, 0x3c, 0x0d, 0x81, 0xfe,
        0x8e, 0x0e, 0xff, 0x01, 0xfa, 0x93, 0x8e, 0x22, 0x81, 0xfe,
        0x00, 0x00, 0x00, 0x00,
        0xa8, 0x78, 0x48, 0x7d,
    ];

    fn rgb() -> Components {
        Components::default()
    }

    #[test]
    fn a_record_of_a_real_file_is_understood() {
        let r = Layout::V561.decode(&EXAMPLE, &rgb());
        assert_eq!((r.level, r.weight, r.corral), (1, 0.5, 0));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
        for (a, b) in r.position.to_array().into_iter().zip([1.064592, 0.317217, 3.0]) {
            near(a, b);
        }
        assert_eq!(r.normal, DVec3::NEG_Z);
        for (a, b) in r.u.to_array().into_iter().zip([0.067590, -0.997713, 0.0]) {
            near(a, b);
        }
        near(f64::from(r.radii[0]), 0.800004);
        near(f64::from(r.gradient[0]), -0.358594);
        near(f64::from(r.gradient[1]), -0.132354);
        near(f64::from(r.rotation[0]), -0.013909);
        near(f64::from(r.rotation[1]), -0.211806);
        near(f64::from(r.value.x), 8.227539e-2);
        near(f64::from(r.value.z), 3.540039e-2);
        assert!(r.is_plausible());
        assert_eq!(Layout::V561.encode(&r, &rgb()), EXAMPLE);
    }

    /// Of `-cs 9`, and the colour that another program made of it.
    #[rustfmt::skip]
    const SPECTRAL: [u8; 73] = [
        0x01, 0x3f, 0xff, 0xff, 0xff, 0x00,
        0x78, 0x45, 0x23, 0x7f, 0x00, 0x5c, 0xc6, 0x10, 0x7f, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0xd6, 0x79,
        0x66, 0x66, 0x87, 0xff, 0x00, 0x66, 0x66, 0x87, 0xff, 0x00,
        0x46, 0x7d, 0xd1, 0xff, 0xfe, 0x4a, 0x1f, 0xcd, 0x7f, 0x00,
        0xb8, 0x4d, 0x5b, 0x81, 0x01, 0x7f, 0x11, 0x83, 0xff, 0xfe,
        0x00, 0x00, 0x00, 0x00,
        0x00, 0x96, 0xae, 0x8d, 0x44, 0x30, 0x22, 0x17, 0x0f, 0x7d,
    ];

    #[test]
    fn a_spectral_record_of_a_real_file_is_understood() {
        let nine = Components::in_order(9);
        let r = Layout::V561.decode(&SPECTRAL, &nine);
        assert!(r.is_plausible() && r.further.len() == 2);
        assert!((r.position - DVec3::new(0.939_610, 1.449_589, 0.0)).length() < 1e-6);
        assert!((r.rotation[0] + 1.120_278).abs() < 1e-6 && (r.gradient[1] - 0.579_096).abs() < 1e-6);
        let mantissas: Vec<f32> = nine.of(&r).map(|c| c * 2048.0 - 0.5).collect();
        assert_eq!(mantissas, [0.0, 150.0, 174.0, 141.0, 68.0, 48.0, 34.0, 23.0, 15.0]);
        assert_eq!(Layout::V561.encode(&r, &nine), SPECTRAL);
        // The same in another order, with a channel that repeats another's component.
        let places = vec![(1, 0), (0, 0), (2, 0), (3, 0), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2)];
        let passes = vec![[1, 4, 7], [0, 5, 8], [2, 6, 8], [3, 6, 8]];
        let turns = Components::new(places, passes).unwrap();
        let r = Layout::V561.decode(&SPECTRAL, &turns);
        assert_eq!(r.of_pass(3), Rgb::new(141.5, 34.5, 15.5) / 2048.0);
        assert_eq!(Layout::V561.encode(&r, &turns), SPECTRAL);
        assert_eq!(r.quantised(&turns), r);
        // A single pass keeps a component of each channel, and gives it to all.
        let one = Components::new([0, 0, 0, 0, 1, 1, 1, 2, 2].map(|c| (0, c)).into(), vec![[2, 4, 7]]).unwrap();
        let r = Layout::V561.decode(&SPECTRAL, &one);
        assert_eq!(r.value, Rgb::new(174.5, 68.5, 23.5) / 2048.0);
        assert_eq!(Layout::V561.encode(&r, &one)[63..], [174, 174, 174, 174, 68, 68, 68, 23, 23, 0x7d]);
    }

    fn direction() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0f64, 0.0..std::f64::consts::TAU)
            .prop_map(|(z, a)| DVec3::new((1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z))
    }

    prop_compose! {
        fn record()(
            position in prop::array::uniform3(-1e6..1e6f64), normal in direction(), other in direction(),
            level in 0..=255u8, weight in 1e-6..1.0f32, r0 in 1e-5..1e3f32, ratio in 1.0..2.0f32,
            gradient in prop::array::uniform2(-1e4..1e4f32), rotation in prop::array::uniform2(-10.0..10.0f32),
            corral: u32, value in prop::array::uniform3(0.0..1e5f32),
        ) -> Record {
            let u = normal.cross(other).normalize_or(normal.any_orthonormal_vector());
            Record {
                position: position.into(), normal, u, level, weight, radii: [r0, r0 * ratio], gradient, rotation,
                corral, value: value.into(), further: Box::default(),
            late: Box::default(),
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(r in record(), old: bool) {
            let layout = if old { Layout::V559 } else { Layout::V561 };
            let bytes = layout.encode(&r, &rgb());
            let back = layout.decode(&bytes, &rgb());
            prop_assert!(back.is_plausible());
            prop_assert!((back.position - r.position).length() <= 2e-9 * r.position.length());
            prop_assert!(back.normal.dot(r.normal) > 1.0 - 1e-8 && back.u.dot(r.u) > 1.0 - 1e-8);
            prop_assert_eq!((back.level, back.corral), (r.level, r.corral));
            for (a, b) in [(back.weight, r.weight), (back.radii[0], r.radii[0]), (back.radii[1], r.radii[1]),
                (back.gradient[0], r.gradient[0]), (back.gradient[1], r.gradient[1]),
                (back.rotation[0], r.rotation[0]), (back.rotation[1], r.rotation[1])] {
                prop_assert!((a - b).abs() <= 1e-6 * b.abs(), "{} instead of {}", a, b);
            }
            prop_assert!((back.value - r.value).abs().max_element() <= r.value.max_element() / 128.0);
            // Once quantised, nothing changes any more.
            prop_assert_eq!(layout.decode(&layout.encode(&back, &rgb()), &rgb()).value, back.value);
            prop_assert_eq!(layout.decode(&layout.encode(&back, &rgb()), &rgb()).position, back.position);
        }

        #[test]
        fn any_bytes_decode(bytes in prop::array::uniform32(0..=255u8), rest in prop::array::uniform32(0..=255u8)) {
            let mut all = [0; RECORD_BYTES];
            all[..32].copy_from_slice(&bytes);
            all[32..64].copy_from_slice(&rest);
            for layout in [Layout::V559, Layout::V561] {
                let _ = layout.decode(&all, &rgb()).is_plausible();
            }
        }
    }
}
