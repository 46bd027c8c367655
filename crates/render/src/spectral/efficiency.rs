//! Functions that weigh light by wavelength, each normalised to unit area: what share of equal light is in a band.
//!
//! They are given by their shares in bands of 5 nm, in 65535ths, as Radiance's programs print them for light in such a
//! band: to the precision that these calculate with, their rounding included.

use glam::DVec3;
use std::ops::Range;

/// Where the tables begin, nm.
const START: f64 = 355.0;
/// Width of a band, nm.
const STEP: f64 = 5.0;
/// What the shares are parts of.
const WHOLE: f64 = 65535.0;

/// A function that weighs light by wavelength for one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Efficiency {
    /// Of rods.
    Scotopic,
    /// Of the cells that set the inner clock.
    Melanopic,
}

impl Efficiency {
    /// The share of light, equal at all wavelengths, that falls into a band (nm).
    pub(super) fn share(self, band: &Range<f64>) -> f64 {
        match self {
            Self::Scotopic => share(&SCOTOPIC, band),
            Self::Melanopic => share(&MELANOPIC, band),
        }
    }
}

/// CIE 1931 tristimulus values of unit power in a band (nm); those of all light together are 1, 1, 1.
pub(crate) fn tristimulus(band: &Range<f64>) -> DVec3 {
    DVec3::new(share(&X, band), share(&Y, band), share(&Z, band))
}

fn share(table: &[u16], band: &Range<f64>) -> f64 {
    below(table, band.end) - below(table, band.start)
}

/// The share below a wavelength, whose fraction of a nanometre is cut off as in Radiance.
fn below(table: &[u16], nm: f64) -> f64 {
    let x = ((nm.trunc() - START) / STEP).max(0.0);
    let i = (x as usize).min(table.len());
    let share = |k: Option<usize>| k.and_then(|k| table.get(k)).map_or(0.0, |&s| f64::from(s));
    let low: f64 = table[..i].iter().map(|&s| f64::from(s)).sum();
    let high = low + share(Some(i));
    // A cubic whose slopes at the borders are the means of the bands beside.
    let slope = |k: usize| 0.5 * (share(k.checked_sub(1)) + share(Some(k)));
    let t = (x - i as f64).min(1.0);
    let (s, p, q) = (t * t * (3.0 - 2.0 * t), t * (1.0 - t) * (1.0 - t), t * t * (t - 1.0));
    // Beyond the table there is nothing to rise to.
    let rise = if i == table.len() { 0.0 } else { (high - low) * s + slope(i) * p + slope(i + 1) * q };
    (low + rise) / WHOLE
}

/// x̄ of the CIE 1931 observer.
#[rustfmt::skip]
const X: [u16; 84] = [
    0, 1, 1, 2, 4,
    6, 12, 21, 39, 65, 120, 215, 374, 607, 831, 983, 1059, 1069, 1039, 989, 910,
    796, 635, 467, 321, 200, 113, 54, 20, 8, 23, 76, 171, 306, 473, 654, 851,
    1059, 1284, 1521, 1772, 2029, 2285, 2535, 2765, 2964, 3120, 3224, 3256, 3219, 3104, 2919, 2674,
    2369, 2037, 1722, 1430, 1159, 915, 709, 537, 397, 288, 208, 153, 109, 76, 52, 38,
    26, 19, 14, 10, 6, 5, 3, 3, 1, 1, 1, 1, 0, 0, 1,
];

/// ȳ of the CIE 1931 observer.
#[rustfmt::skip]
const Y: [u16; 81] = [
    0, 0, 0, 0, 0,
    0, 1, 0, 1, 2, 4, 6, 11, 20, 33, 48, 67, 87, 111, 141, 176,
    218, 268, 331, 410, 500, 613, 760, 949, 1195, 1483, 1800, 2116, 2383, 2603, 2775, 2903,
    2992, 3043, 3064, 3056, 3012, 2937, 2831, 2696, 2537, 2359, 2169, 1974, 1778, 1581, 1391, 1205,
    1021, 846, 694, 562, 445, 347, 265, 199, 147, 105, 76, 56, 39, 28, 18, 14,
    10, 7, 4, 4, 2, 2, 1, 1, 1, 0, 0, 1,
];

/// z̄ of the CIE 1931 observer.
#[rustfmt::skip]
const Z: [u16; 54] = [
    1, 3, 5, 10, 18,
    29, 55, 100, 187, 309, 568, 1028, 1795, 2936, 4046, 4844, 5293, 5451, 5443, 5366, 5170,
    4781, 4104, 3343, 2629, 2005, 1513, 1147, 880, 686, 518, 369, 259, 187, 138, 99, 68,
    45, 29, 19, 13, 9, 7, 6, 5, 4, 4, 3, 3, 2, 1, 1, 0,
    1,
];

/// CIE V′ of 1951.
#[rustfmt::skip]
const SCOTOPIC: [u16; 66] = [
    0, 0, 0, 0, 0,
    2, 5, 10, 21, 42, 83, 149, 250, 387, 558, 758, 974, 1196, 1412, 1615, 1806,
    1986, 2168, 2358, 2556, 2757, 2946, 3115, 3251, 3342, 3372, 3341, 3241, 3086, 2881, 2634, 2363,
    2079, 1792, 1515, 1255, 1020, 812, 635, 486, 364, 270, 194, 139, 97, 68, 47, 31,
    22, 14, 9, 7, 4, 3, 2, 1, 1, 1, 0, 1, 1,
];

/// The melanopic function of CIE S 026.
#[rustfmt::skip]
const MELANOPIC: [u16; 60] = [
    0, 0, 0, 0, 0,
    5, 9, 18, 33, 66, 134, 243, 423, 623, 846, 1097, 1379, 1664, 1949, 2240, 2529,
    2820, 3106, 3348, 3543, 3671, 3727, 3723, 3655, 3518, 3319, 3055, 2744, 2414, 2075, 1744, 1434,
    1149, 898, 683, 505, 364, 255, 176, 118, 79, 53, 34, 23, 15, 9, 7, 4,
    3, 2, 1, 1, 0, 1, 1,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_add_up() {
        for table in [&X[..], &Y, &Z, &SCOTOPIC, &MELANOPIC] {
            assert!((share(table, &(100.0..900.0)) - 1.0).abs() < 1e-3);
            let part = |i: i32| 340.0 + 11.3 * f64::from(i);
            let parts: f64 = (0..40).map(|i| share(table, &(part(i)..part(i + 1)))).sum();
            assert!((parts - share(table, &(100.0..900.0))).abs() < 1e-12);
            assert!((370..790).all(|nm| share(table, &(f64::from(nm)..f64::from(nm) + 1.0)) >= -1.0 / WHOLE));
        }
    }

    #[test]
    fn white_is_as_radiance_prints_it() {
        // rtrace -cs 5 of a white surface.
        let white = super::super::Spectrum::rgb(tristimulus(&(380.0..780.0)));
        assert!((white - DVec3::new(0.999_911_9, 1.0001, 0.999_326_3)).abs().max_element() < 1e-6, "{white}");
    }
}
