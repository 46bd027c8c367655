//! Three-channel colours: radiance in W/(sr·m²), irradiance in W/m², or dimensionless factors.

use glam::{DMat3, DVec3, Vec3};

/// Red, green and blue, in that order, as `x`, `y`, `z` of a vector.
pub type Rgb = Vec3;

/// Lumen per watt that turns the brightness of a radiance into luminance in cd/m².
pub const LUMINOUS_EFFICACY: f32 = 179.0;

/// Brightness weights of red, green and blue for Radiance's standard primaries and equal-energy white.
const WEIGHTS: Vec3 = Vec3::new(0.265_105_8, 0.670_105_8, 0.064_788_4);

/// Linear RGB of Radiance's standard primaries to CIE 1931 XYZ, columns; white has Y = 1.
pub const TO_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(0.514_144_62, 0.265_105_82, 0.024_100_53),
    DVec3::new(0.323_884_48, 0.670_105_82, 0.122_852_74),
    DVec3::new(0.161_970_90, 0.064_788_36, 0.853_046_74),
);

/// Moves a colour towards the grey of its brightness, which is given, until no channel is negative.
pub fn desaturated(c: DVec3, grey: f64) -> DVec3 {
    let least = c.min_element();
    if least >= 0.0 {
        return c;
    }
    if grey <= 0.0 {
        return DVec3::ZERO;
    }
    let keep = grey / (grey - least);
    (DVec3::splat(grey) + (c - grey) * keep).max(DVec3::ZERO)
}

/// Photometric and bookkeeping scalars of a colour.
pub trait Colour {
    /// Photometric brightness: the Y of XYZ, without the luminous efficacy.
    fn brightness(self) -> f32;
    /// The mean of the channels.
    fn mean(self) -> f32;
}

impl Colour for Rgb {
    #[inline]
    fn brightness(self) -> f32 {
        self.dot(WEIGHTS)
    }

    #[inline]
    fn mean(self) -> f32 {
        (self.x + self.y + self.z) * (1.0 / 3.0)
    }
}
