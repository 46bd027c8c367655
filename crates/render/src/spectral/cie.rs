//! From CIE 1931 tristimulus values to RGB of Radiance's primaries.

use ambit_base::{TO_XYZ, desaturated};
use glam::DVec3;

/// Linear RGB of Radiance's primaries, channels possibly negative.
pub(crate) fn rgb_of_xyz(xyz: DVec3) -> DVec3 {
    TO_XYZ.inverse() * xyz
}

/// Brings a colour with negative channels into range: towards the grey of the same brightness.
pub(crate) fn desaturate(rgb: DVec3) -> DVec3 {
    desaturated(rgb, TO_XYZ.row(1).dot(rgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_channels_turn_grey() {
        let c = DVec3::new(-0.2, 1.0, 0.5);
        let d = desaturate(c);
        let weights = TO_XYZ.row(1);
        assert!(d.min_element() >= 0.0 && d.x < 1e-6);
        assert!((d.dot(weights) - c.dot(weights)).abs() < 1e-6);
    }
}
