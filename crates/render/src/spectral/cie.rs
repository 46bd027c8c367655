//! From CIE 1931 tristimulus values to RGB of Radiance's primaries.

use glam::{DMat3, DVec3};

/// Linear RGB of Radiance's primaries, channels possibly negative.
pub(crate) fn rgb_of_xyz(xyz: DVec3) -> DVec3 {
    // Columns of the matrix from RGB to XYZ.
    let to_xyz = DMat3::from_cols(
        DVec3::new(0.514_144_62, 0.265_105_82, 0.024_100_53),
        DVec3::new(0.323_884_48, 0.670_105_82, 0.122_852_74),
        DVec3::new(0.161_970_90, 0.064_788_36, 0.853_046_74),
    );
    to_xyz.inverse() * xyz
}

/// Brings a colour with negative channels into range: towards the grey of the same brightness.
pub(crate) fn desaturate(rgb: DVec3) -> DVec3 {
    let grey = rgb.dot(DVec3::new(0.265_105_82, 0.670_105_82, 0.064_788_36));
    let least = rgb.min_element();
    if least >= 0.0 {
        rgb
    } else if grey <= 0.0 {
        DVec3::ZERO
    } else {
        let t = least / (least - grey);
        (rgb + (DVec3::splat(grey) - rgb) * t).max(DVec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_channels_turn_grey() {
        let c = DVec3::new(-0.2, 1.0, 0.5);
        let d = desaturate(c);
        let weights = DVec3::new(0.265_105_82, 0.670_105_82, 0.064_788_36);
        assert!(d.min_element() >= 0.0 && d.x < 1e-6);
        assert!((d.dot(weights) - c.dot(weights)).abs() < 1e-6);
    }
}
