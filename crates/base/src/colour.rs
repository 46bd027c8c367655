//! Three-channel colours: radiance in W/(sr·m²), irradiance in W/m², or dimensionless factors.

use glam::Vec3;

/// Red, green and blue, in that order, as `x`, `y`, `z` of a vector.
pub type Rgb = Vec3;

/// Lumen per watt that turns the brightness of a radiance into luminance in cd/m².
pub const LUMINOUS_EFFICACY: f32 = 179.0;

/// Brightness weights of red, green and blue for Radiance's standard primaries and equal-energy white.
const WEIGHTS: Vec3 = Vec3::new(0.265_105_8, 0.670_105_8, 0.064_788_4);

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
