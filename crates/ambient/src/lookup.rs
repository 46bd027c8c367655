//! Whether a record may answer a query, with what weight, and what it answers: the tests in order of Radiance 6.0a, a
//! product of two hat functions (Schwarzhaupt, Jensen, Jarosz 2012 for the ellipse) and first-order extrapolation
//! (Ward & Heckbert 1992, *Irradiance Gradients*).
//!
//! Means of extrapolations are too bright where irradiance is hollow from below, as on every ceiling: tangents lie above.
//! Let records of values `Eᵢ` and gradients `gᵢ`, at offsets `dᵢ` from them to the query, have weights `wᵢ` that add up to
//! 1, and let the field be quadratic, with Hessian `H`. The mean of `Eᵢ + gᵢ·dᵢ` errs by `−½ Σwᵢ dᵢᵀHdᵢ`. The mean of `Eᵢ` alone, moved
//! by the mean gradient over the mean offset `D`, errs by `+½ Σwᵢ dᵢᵀHdᵢ − DᵀHD`. The mean of both therefore errs by
//! `−½ DᵀHD`: nothing where records lie evenly around, and what extrapolation does where there is but one. Linear functions
//! are met exactly, and of the gradients' noise half is averaged. That is interpolation of second order here; it needs no
//! record's Hessian. Gradients being relative and the same for all colours, the move is one factor, of grey.

use crate::entry::Entry;
use crate::light::Light;
use crate::params::{Interpolation, Limits};
use crate::sampler::{Query, Sampler};
use ambit_base::{Colour, DVec3, EPSILON, Vec3};

/// Least extrapolation factor; a record that falls to it is not used.
pub(crate) const MIN_FACTOR: f32 = 0.05;
/// Largest extrapolation factor.
pub(crate) const MAX_FACTOR: f32 = 20.0;
/// Relative rounding of positions in ambient files (31-bit mantissas), allowed for in the tests across the plane.
const ROUNDING: f64 = 1e-9;
/// Limits of the factor by which the mean gradient moves what records extrapolate half the way: what one record comes to.
const MIN_MOVE: f32 = 2.0 * MIN_FACTOR / (MIN_FACTOR + MAX_FACTOR);
const MAX_MOVE: f32 = 2.0;
/// What a record of a file counts for towards the weight that is asked for. The view that left it there has that weight at
/// its own pixels and less between them, so that a view from elsewhere would thicken what is thick enough. Half of the
/// records that it would add do little for the error.
const FOUND: f32 = 3.0;
/// Queries this near to a corralled record, as a fraction of its reach, need no probe: the azimuth of so short a vector
/// means nothing, and probing would reject a record at its own place.
const COINCIDENT: f32 = 1e-3;
/// cos² of the angle to the normal at which the corral's probe passes over the query's surface (20° above its plane).
const PROBE_COS2: f64 = 0.116_977_778_440_510_98;

/// A query, prepared for many comparisons.
pub(crate) struct Asked {
    pub(crate) position: DVec3,
    pub(crate) normal: Vec3,
    shading: Vec3,
    pub(crate) level: u8,
    /// Records of the query's own level must weigh at least this.
    pub(crate) least_weight: f32,
    /// Largest angle between normals, of full weight and opened for dim rays.
    angle: f32,
    pub(crate) opened: f32,
    accuracy: f32,
    /// The same, widened for smoothing.
    used: f32,
    /// How far below a record's plane a query may lie.
    behind: f32,
    rounding: f32,
    step: f32,
    /// Within this distance a record that would be rejected for its steep extrapolation still serves as last resort.
    spare_reach: f32,
    interpolation: Interpolation,
}

impl Asked {
    pub(crate) fn new<O>(query: &Query<O>, limits: &Limits) -> Self {
        let rounding = ROUNDING * query.position.abs().max_element();
        Self {
            position: query.position,
            normal: query.normal.as_vec3(),
            shading: query.shading.as_vec3(),
            level: query.level,
            least_weight: 0.9 * query.weight,
            angle: limits.max_angle as f32,
            opened: limits.opened_angle(query.weight) as f32,
            accuracy: limits.accuracy as f32,
            used: limits.used(query.level) as f32,
            behind: (limits.min_radius * limits.accuracy + rounding) as f32,
            rounding: rounding as f32,
            step: limits.step,
            spare_reach: (0.5 * limits.min_radius * limits.accuracy) as f32,
            interpolation: limits.interpolation,
        }
    }

    /// The angle limit within a list whose first record has the given level.
    #[inline]
    pub(crate) fn angle_for(&self, first_level: u8) -> f32 {
        if first_level <= self.level { self.opened } else { self.angle }
    }
}

/// Weighted sum over the records that qualify.
pub(crate) struct Sum {
    /// Of the records whose reach the query is within, those of a file multiplied by [`FOUND`].
    pub(crate) weight: f32,
    /// Of all records that `light` is of.
    pub(crate) smooth: f32,
    light: Light,
    moved: Moved,
    spare: Option<(f32, Light)>,
}

/// Sums for interpolation of second order, in grey; all 0 for the first.
struct Moved {
    /// Of what `light` is of.
    value: f32,
    /// Of gradients.
    gradient: Vec3,
    /// Of offsets from records to the query.
    offset: Vec3,
}

impl Moved {
    const NONE: Self = Self { value: 0.0, gradient: Vec3::ZERO, offset: Vec3::ZERO };

    /// How much more the sum comes to once the mean gradient has moved it by half the mean offset.
    fn factor(&self, weight: f32) -> f32 {
        let by = 0.5 * self.gradient.dot(self.offset) / weight;
        if self.value > 0.0 { (1.0 + by / self.value).clamp(MIN_MOVE, MAX_MOVE) } else { 1.0 }
    }
}

impl Sum {
    pub(crate) const EMPTY: Self =
        Self { weight: 0.0, smooth: 0.0, light: Light::NONE, moved: Moved::NONE, spare: None };

    /// True if the weight makes an answer; a last resort does whatever it weighs.
    pub(crate) fn is_enough(&self, weight: f32) -> bool {
        self.weight >= weight || self.spare.is_some()
    }

    /// The interpolated value, if the query is within the reach of a record.
    pub(crate) fn answer(&self) -> Option<Light> {
        if f64::from(self.weight) > EPSILON { self.smoothed() } else { self.spare.map(|(_, light)| light) }
    }

    /// The mean of all that has been added.
    pub(crate) fn smoothed(&self) -> Option<Light> {
        (f64::from(self.smooth) > EPSILON).then(|| self.light * (self.moved.factor(self.smooth) / self.smooth))
    }
}

/// Adds one record to the sum, returning its weight; 0 if it does not qualify, or only smooths. Level and weight are tested
/// by the caller. `light` gives what it answers at its own place.
#[inline]
pub(crate) fn accumulate<S: Sampler>(
    asked: &Asked,
    angle: f32,
    entry: &Entry,
    light: impl FnOnce() -> Light,
    sampler: &S,
    query: &Query<S::Origin>,
    sum: &mut Sum,
) -> f32 {
    let a2 = asked.used * asked.used;
    let delta = asked.position - DVec3::from_array(entry.position);
    let d = delta.as_vec3();
    let d2 = d.length_squared();
    // The ellipse lies within the sphere of the longer radius.
    if d2 * entry.inverse_radii[1] * entry.inverse_radii[1] >= a2 {
        return 0.0;
    }
    let normal = Vec3::from_array(entry.normal);
    // 2 − 2 cos of the angle between the normals, without cancellation.
    let tilt2 = (asked.normal - normal).length_squared();
    if tilt2 >= 2.0 || tilt2 >= angle * angle {
        return 0.0;
    }
    let dn = d.dot(normal);
    if dn < -asked.behind {
        return 0.0;
    }
    let (tilt, off) = (tilt2.sqrt(), (dn.abs() - asked.rounding).max(0.0));
    let slope = asked.step + tilt;
    if off * off > slope * slope * (d2 - dn * dn).max(0.0) {
        return 0.0;
    }
    let u = Vec3::from_array(entry.u);
    let v = normal.cross(u);
    let (du, dv) = (d.dot(u), d.dot(v));
    let [i0, i1] = entry.inverse_radii;
    let (en, eu, ev) = (off * i0, du * i0, dv * i1);
    let reach2 = en * en + eu * eu + ev * ev;
    if reach2 >= a2 {
        return 0.0;
    }
    if entry.corralled && d2 * i0 * i0 > a2 * COINCIDENT * COINCIDENT {
        let k = sector(du, dv);
        if entry.corral >> k & 1 != 0 && fenced(delta, entry, sampler, query) {
            return 0.0;
        }
    }
    let turn = normal.cross(asked.shading);
    let [gu, gv] = entry.gradient;
    let [hu, hv] = entry.rotation;
    let turned = 1.0 + turn.dot(u) * hu + turn.dot(v) * hv;
    let factor = turned + du * gu + dv * gv;
    if factor <= MIN_FACTOR {
        if d2 < asked.spare_reach * asked.spare_reach && sum.spare.is_none_or(|(nearest, _)| d2 < nearest) {
            sum.spare = Some((d2, light() * MIN_FACTOR));
        }
        return 0.0;
    }
    let (facing, reach) = (1.0 - tilt / angle, reach2.sqrt());
    let weight = facing * (1.0 - reach / asked.accuracy).max(0.0);
    let smooth = facing * (1.0 - reach / asked.used);
    sum.weight += if entry.found { weight * FOUND } else { weight };
    sum.smooth += smooth;
    let light = light();
    sum.light += match asked.interpolation {
        Interpolation::First => light * (factor.min(MAX_FACTOR) * smooth),
        Interpolation::Second => {
            // What the gradient may add once either end is within its limits.
            let (start, end) = (turned.clamp(MIN_FACTOR, MAX_FACTOR), factor.min(MAX_FACTOR));
            let tamed = match (start == turned && end == factor, start == end) {
                (true, _) => 1.0,
                (_, true) => 0.0,
                _ => (end - start) / (factor - turned),
            };
            let half = 0.5 * (start + end) * smooth;
            let value = light.value.mean();
            sum.moved.value += value * half;
            sum.moved.gradient += (u * gu + v * gv) * (tamed * value * smooth);
            sum.moved.offset += d * smooth;
            light * half
        }
    };
    weight
}

/// Tangents of 11.25°, 22.5° and 33.75°.
const TANGENTS: [f32; 3] = [0.198_912_37, 0.414_213_57, 0.668_178_6];

/// The corral sector of a tangential vector: 32 of 11.25° each, from `u` towards `v`.
#[inline]
pub(crate) fn sector(u: f32, v: f32) -> u32 {
    let (a, b) = (u.abs(), v.abs());
    let (low, high) = (a.min(b), a.max(b));
    let within = TANGENTS.into_iter().map(|t| u32::from(low > t * high)).sum::<u32>();
    let in_quadrant = if b >= a && high > 0.0 { 7 - within } else { within };
    match (u < 0.0, v < 0.0) {
        (false, false) => in_quadrant,
        (true, false) => 15 - in_quadrant,
        (true, true) => 16 + in_quadrant,
        (false, true) => 31 - in_quadrant,
    }
}

/// The corral sector of an azimuth in radians, of any sign.
pub(crate) fn sector_of_angle(azimuth: f64) -> u32 {
    (azimuth * (16.0 / std::f64::consts::PI)).floor().rem_euclid(32.0) as u32 & 31
}

/// True if something stands between the query and the point above the record that appears 20° above the query's plane.
#[cold]
fn fenced<S: Sampler>(delta: DVec3, entry: &Entry, sampler: &S, query: &Query<S::Origin>) -> bool {
    let normal = Vec3::from_array(entry.normal).as_dvec3();
    let to_record = -delta;
    // D(t) = to_record + t·normal with (D·N)² = κ|D|².
    let (nn, dn, dm) = (normal.dot(query.normal), to_record.dot(query.normal), to_record.dot(normal));
    let a = nn * nn - PROBE_COS2;
    let half_b = nn * dn - PROBE_COS2 * dm;
    let c = dn * dn - PROBE_COS2 * to_record.length_squared();
    let discriminant = half_b * half_b - a * c;
    if a.abs() < EPSILON || discriminant.is_nan() || discriminant <= 0.0 {
        return true;
    }
    let root = discriminant.sqrt();
    let t = ((-half_b + root) / a).max((-half_b - root) / a);
    if t <= EPSILON {
        return false;
    }
    sampler.occluded(query, query.position, to_record + normal * t)
}

#[cfg(test)]
mod tests {
    use super::{sector, sector_of_angle};

    #[test]
    fn sectors_of_vectors_are_those_of_their_azimuths() {
        for k in 0..10_000 {
            let azimuth = (f64::from(k) + 0.3) * (std::f64::consts::TAU / 10_000.0);
            for length in [1e-20f32, 3.7, 1e15] {
                let (u, v) = (azimuth.cos() as f32 * length, azimuth.sin() as f32 * length);
                assert_eq!(sector(u, v), sector_of_angle(azimuth), "at {azimuth} times {length}");
            }
        }
        assert_eq!(sector(0.0, 0.0), 0);
    }
}
