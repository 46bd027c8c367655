//! The 32-bit code of a direction in ambient files, meshes and normal maps: signs in bits 0–2, which two of the three
//! components are stored in bits 3 and 4, their sizes in bits 5–17 and 18–30. The largest component follows from
//! unit length. The error is at most about 0.006°.

use ambit_base::DVec3;

/// Steps per unit: (2¹³ − ½)·√2, so that a component of 1/√2, the largest ever stored, fits thirteen bits.
const SCALE: f64 = 11584.5;

/// The largest stored size.
const LARGEST: u32 = 0x1fff;

/// Encodes a unit vector. The zero vector gives 0, the code that stands for "no direction".
pub fn encode_direction(d: DVec3) -> u32 {
    let size = |c: f64| (c.abs() * SCALE + 0.5) as u32;
    let (x, y, z) = (size(d.x), size(d.y), size(d.z));
    if x | y | z == 0 {
        return 0;
    }
    let signs = u32::from(d.x < 0.0) | u32::from(d.y < 0.0) << 1 | u32::from(d.z < 0.0) << 2;
    let (which, first, other) = if x <= y { (1 << 3, x, y) } else { (0, y, x) };
    let (which, second) = if z <= other { (which | 1 << 4, z) } else { (which, other) };
    // Only vectors longer than a unit reach the limits.
    let code = signs | which | first.min(LARGEST) << 5 | second.min(LARGEST) << 18;
    if code == 0 { 8 } else { code }
}

/// Decodes a direction of unit length; 0 gives the zero vector.
pub fn decode_direction(code: u32) -> DVec3 {
    if code == 0 {
        return DVec3::ZERO;
    }
    let a = f64::from(code >> 5 & LARGEST) / SCALE;
    let b = f64::from(code >> 18 & LARGEST) / SCALE;
    // Below zero only for codes that no unit vector has.
    let c = (1.0 - a * a - b * b).max(0.0).sqrt();
    let d = match (code & 1 << 4 != 0, code & 1 << 3 != 0) {
        (false, false) => DVec3::new(b, a, c),
        (false, true) => DVec3::new(a, b, c),
        (true, false) => DVec3::new(c, a, b),
        (true, true) => DVec3::new(a, c, b),
    };
    let sign = |bit: u32| if code & bit == 0 { 1.0 } else { -1.0 };
    d * DVec3::new(sign(1), sign(2), sign(4))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn directions_have_the_published_codes() {
        for (d, code) in [
            ([0.0, 0.0, 1.0], 0x00000008),
            ([0.0, 0.0, -1.0], 0x0000000c),
            ([1.0, 0.0, 0.0], 0x00000010),
            ([-1.0, 0.0, 0.0], 0x00000011),
            ([0.0, 1.0, 0.0], 0x00000018),
            ([0.0, -1.0, 0.0], 0x0000001a),
            ([0.6, 0.8, 0.0], 0x000364f8),
            ([-0.6, 0.0, 0.8], 0x6c9c0001),
            ([0.48, -0.6, 0.64], 0x6c9eb72a),
            ([1.0, 1.0, 1.0], 0x68834418),
            ([-1.0, 2.0, -3.0], 0x60c1830d),
        ] {
            let d = DVec3::from(d).normalize();
            assert_eq!(encode_direction(d), code, "{d}");
            // Half a step in two components tilts by at most 0.006 degrees.
            assert!(decode_direction(code).distance(d) < 1.1e-4, "{d}");
        }
        assert_eq!(encode_direction(DVec3::ZERO), 0);
        assert_eq!(decode_direction(0), DVec3::ZERO);
        assert_eq!(decode_direction(8), DVec3::Z);
    }

    proptest! {
        #[test]
        fn a_clear_direction_keeps_its_code_when_decoded(x in -1f64..1.0, y in -1f64..1.0, z in -1f64..1.0) {
            let v = DVec3::new(x, y, z);
            prop_assume!(v.length() > 1e-3);
            let d = v.normalize();
            let code = encode_direction(d);
            let back = decode_direction(code);
            prop_assert!(back.distance(d) < 1.1e-4);
            prop_assert!((back.length() - 1.0).abs() < 1e-12);
            // If two components nearly tie for the largest, rounding may have the other one left out next time; a
            // component that is stored as zero loses its sign.
            let mut sizes = d.abs().to_array();
            sizes.sort_by(f64::total_cmp);
            let again = encode_direction(back);
            let clear = sizes[2] - sizes[1] > 2.0 / SCALE && sizes[0] > 1.0 / SCALE;
            prop_assert!(again == code || !clear, "{:x} {:x}", code, again);
            prop_assert!(decode_direction(again).distance(back) < 1.1e-4);
        }

        #[test]
        fn every_code_decodes_to_finite_numbers(code in any::<u32>()) {
            prop_assert!(decode_direction(code).is_finite());
        }
    }
}
