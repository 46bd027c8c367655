//! One record of the cache: irradiance at a point, its derivatives, and where it may be reused.

use crate::codec::Layout;
use crate::components::Components;
use crate::light::{APART, Light};
use ambit_base::{DVec3, Rgb};

/// Irradiance at a point of a surface, with first derivatives and an ellipse of validity.
///
/// `u` and `v = normal × u` span the tangent plane; pairs of numbers are components along them.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The point, scene units.
    pub position: DVec3,
    /// The side of the surface that is lit, unit length.
    pub normal: DVec3,
    /// The direction of the shorter radius, unit length, tangential.
    pub u: DVec3,
    /// The number of diffuse bounces between the eye and the point.
    pub level: u8,
    /// Importance, in (0, 1]; decides sample numbers and radii.
    pub weight: f32,
    /// Radii along `u` and `v`, scene units, the first the smaller. A look-up multiplies them by the tolerance.
    pub radii: [f32; 2],
    /// Translational gradient over the mean of the channels, 1/scene unit.
    pub gradient: [f32; 2],
    /// Rotational gradient over the mean of the channels, 1/radian, as components of the turning axis.
    pub rotation: [f32; 2],
    /// Bit k: something stands near in the azimuths k·11.25° … (k+1)·11.25° from `u` towards `v`.
    pub corral: u32,
    /// Irradiance/π: the cosine-weighted mean radiance, W/(sr·m²).
    pub value: Rgb,
    /// The same in the further passes of a calculation by wavelength; none without.
    pub further: Box<[Rgb]>,
    /// What of the values the last bounce, and the last two, brought, in each pass; none where it is not known, as in files
    /// of other programs.
    pub late: Box<[[Rgb; APART]]>,
}

/// Bounds of plausible numbers in records (Radiance's "infinite").
const HUGE: f64 = 1e10;

impl Record {
    /// True if every number is finite and in the range that ambient files allow: unit directions, weight in (0, 1],
    /// positive ordered radii, non-negative value.
    pub fn is_plausible(&self) -> bool {
        let unit = |v: DVec3| (v.length_squared() - 1.0).abs() < 1e-3;
        let below = |x: f32| f64::from(x).abs() < HUGE;
        let radius = |r: f32| r > 0.0 && below(r);
        self.position.abs().max_element() <= HUGE
            && !self.position.is_nan()
            && unit(self.normal)
            && unit(self.u)
            && self.weight > 0.0
            && self.weight <= 1.0
            && self.radii.iter().all(|&r| radius(r))
            && self.radii[0] <= self.radii[1] * (1.0 + 1e-6) + 1e-6
            && self.gradient.iter().chain(&self.rotation).all(|&g| below(g))
            && self.late.iter().flatten().all(|l| l.is_finite())
            && self.values().all(|v| v.to_array().iter().all(|&c| c >= 0.0 && below(c)))
    }

    /// The record as an ambient file of such components would return it; what the last bounces brought, which files hold
    /// more coarsely, is kept.
    pub fn quantised(&self, components: &Components) -> Self {
        let kept = Layout::CURRENT.decode(&Layout::CURRENT.encode(self, components), components);
        // Rounding must not move what fewer bounces bring.
        let rounded = |(pass, late): (usize, &[Rgb; APART])| {
            let off = kept.of_pass(pass as u8) - self.of_pass(pass as u8);
            late.map(|l| l + off)
        };
        Self { late: self.late.iter().enumerate().map(rounded).collect(), ..kept }
    }

    /// Irradiance/π in each pass.
    pub fn values(&self) -> impl Iterator<Item = Rgb> {
        std::iter::once(self.value).chain(self.further.iter().copied())
    }

    /// Irradiance/π in a pass; black in one that the record knows nothing of.
    pub fn of_pass(&self, pass: u8) -> Rgb {
        if pass == 0 { self.value } else { self.further.get(usize::from(pass) - 1).copied().unwrap_or_default() }
    }

    /// The light in a pass.
    pub(crate) fn light(&self, pass: u8) -> Light {
        Light { value: self.of_pass(pass), late: self.late.get(usize::from(pass)).copied().unwrap_or_default() }
    }

    /// The second tangent, `normal × u`.
    pub fn v(&self) -> DVec3 {
        self.normal.cross(self.u)
    }
}
