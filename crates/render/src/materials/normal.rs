//! plastic, metal and trans: a diffuse part, a Gaussian or ideal specular lobe, and for trans the same two through the
//! surface. Also the Lambertian stand-in that measures irradiance.

use super::rough::Facets;
use super::{Facing, Finish, mirror_direction};
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Rgb};
use std::f64::consts::PI;

/// Which of the three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NormalKind {
    Plastic,
    Metal,
    Trans,
}

/// Arguments of plastic, metal or trans.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Normal {
    pub(crate) kind: NormalKind,
    pub(crate) colour: Rgb,
    pub(crate) specular: f64,
    /// RMS facet slope.
    pub(crate) roughness: f64,
    pub(crate) transmission: f64,
    pub(crate) transmitted_specular: f64,
}

/// Smooth surfaces at least this specular get the Fresnel estimate.
pub(super) const FRESNEL_FROM: f64 = 0.017999;
/// Cosines of view angles are no smaller than this in lobes.
pub(super) const LEAST_COSINE: f64 = 0.001;

/// Fresnel estimate for an angle of incidence with cosine `c`.
pub(crate) fn fresnel(c: f64) -> f64 {
    (-5.85 * c).exp() - 0.00202943064
}

/// The direction of `bent` if that crosses the surface as the view direction `d` does, else `d`.
pub(super) fn crossing(bent: DVec3, d: DVec3, facing: &Facing) -> DVec3 {
    let bent = bent.normalize_or(d);
    if bent.dot(facing.geometric) < 0.0 { bent } else { d }
}

/// How one hit splits its light.
struct Split {
    /// Specular reflection.
    reflected: f64,
    /// Specular reflection with its colour.
    mirror: Rgb,
    through: f64,
    through_specular: f64,
    through_diffuse: f64,
    diffuse: f64,
    smooth: bool,
    /// The diffuse part of smooth surfaces also loses the Fresnel share of the light's side.
    fresnel: bool,
}

impl Normal {
    /// True for trans that lets part of a beam through as a beam, which only smooth ones do.
    pub(crate) fn transmits_beams(&self) -> bool {
        self.is_smooth() && self.transmission * self.transmitted_specular > EPSILON
    }

    /// True if it has a diffuse part and nothing else.
    fn is_matte(&self) -> bool {
        self.kind != NormalKind::Trans && self.specular == 0.0
    }

    fn is_smooth(&self) -> bool {
        self.roughness * self.roughness <= EPSILON
    }

    fn split(&self, colour: Rgb, cosine: f64) -> Split {
        let smooth = self.is_smooth();
        let fresnel_applies = smooth && self.specular >= FRESNEL_FROM;
        let f = if fresnel_applies { fresnel(cosine) } else { 0.0 };
        let reflected = self.specular + f * (1.0 - self.specular);
        let (through, through_specular) = if self.kind == NormalKind::Trans {
            let t = self.transmission * (1.0 - reflected);
            (t, t * self.transmitted_specular)
        } else {
            (0.0, 0.0)
        };
        let mirror = if self.kind == NormalKind::Metal {
            if f > EPSILON {
                Rgb::splat(f as f32) + colour * (self.specular * (1.0 - f)) as f32
            } else {
                colour * reflected as f32
            }
        } else {
            Rgb::splat(reflected as f32)
        };
        Split {
            reflected,
            mirror,
            through,
            through_specular,
            through_diffuse: through - through_specular,
            diffuse: 1.0 - through - reflected,
            smooth,
            fresnel: fresnel_applies,
        }
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn normal(&mut self, ray: &mut Ray<'_>, m: &Normal, finish: Finish) -> bool {
        if ray.is_shadow() && m.kind != NormalKind::Trans {
            return true;
        }
        if m.is_matte() {
            return self.matte(ray, m.colour * finish.pattern, finish.tilt);
        }
        let Some(facing) = self.visible_side(ray, finish.tilt) else { return false };
        let colour = m.colour * finish.pattern;
        let cosine = facing.cosine.max(LEAST_COSINE);
        let split = m.split(colour, cosine);

        let through = self.through_direction(ray, &facing);
        if split.smooth && split.through_specular > EPSILON {
            self.smooth_transmission(ray, colour * split.through_specular as f32, through, &split);
        }
        if ray.is_shadow() {
            return true;
        }
        if split.smooth && split.reflected > EPSILON {
            let straight = !facing.textured && ray.is_ambient();
            self.reflect(ray, mirror_direction(ray.direction, &facing), split.mirror, straight);
        }
        if split.smooth && split.diffuse <= EPSILON && split.through_diffuse <= EPSILON {
            return true;
        }
        let lump_reflected = !split.smooth && self.is_lumped(split.reflected);
        let lump_through = !split.smooth && self.is_lumped(split.through_specular);
        if !split.smooth {
            // Of either lobe: what leaves through the surface, too, spreads along it.
            let facets = Facets::isotropic(facing.normal, m.roughness);
            if split.reflected > EPSILON && !lump_reflected {
                self.sample_reflection(ray, &facing, split.mirror, &facets);
            }
            if split.through_specular > EPSILON && !lump_through {
                let k = colour * split.through_specular as f32;
                self.sample_transmission(ray, &facing, through, k, &facets);
            }
        }
        let diffuse = colour * split.diffuse as f32;
        let lump = lump_reflected.then_some(split.mirror);
        self.ambient_with_lump(ray, split.diffuse, diffuse, lump, facing.normal);
        let diffuse = colour * split.through_diffuse as f32;
        let lump = lump_through.then(|| colour * split.through_specular as f32);
        self.ambient_with_lump(ray, split.through_diffuse, diffuse, lump, -facing.normal);
        let flat = !split.smooth && !facing.textured && self.is_flat(ray);
        let jitter = self.tracer.options.direct.jitter;
        let alpha2 = m.roughness * m.roughness;
        let lobes = Lobes { split: &split, colour, normal: facing.normal, cosine, through, flat, jitter, alpha2 };
        let d = ray.direction;
        let above = (split.through <= EPSILON).then_some(facing.normal);
        self.direct_with(ray, above, |_, l, omega| lobes.coefficient(d, l, omega));
        true
    }

    /// Plastic and metal without a specular part.
    fn matte(&mut self, ray: &mut Ray<'_>, colour: Rgb, tilt: DVec3) -> bool {
        let Some(facing) = self.visible_side(ray, tilt) else { return false };
        let n = facing.normal;
        self.ambient(ray, colour, n);
        self.direct_with(ray, Some(n), |_, l, omega| {
            let c = n.dot(l);
            if c > EPSILON { colour * (c * omega / PI) as f32 } else { Rgb::ZERO }
        });
        true
    }

    /// The view direction through a thin textured surface: d − p, if that still crosses it.
    pub(super) fn through_direction(&self, ray: &Ray<'_>, facing: &Facing) -> DVec3 {
        let d = ray.direction;
        if !facing.textured || ray.is_shadow() || ray.is_ambient() || self.is_phong(ray) {
            return d;
        }
        crossing(d - facing.tilt, d, facing)
    }

    fn smooth_transmission(&mut self, ray: &mut Ray<'_>, k: Rgb, direction: DVec3, split: &Split) {
        let Some(mut child) = self.child(ray, Kinds::TRANSFERRED, direction, k, 3) else { return };
        self.evaluate(&mut child);
        let k = child.coefficient;
        let light = k * child.value;
        let mirrored = k * child.mirrored;
        let (r, x, e) = (child.mirrored_length, child.unmirrored_length, child.length_of(light));
        ray.value += light;
        if split.through_specular >= 1.0 - EPSILON {
            ray.mirrored = mirrored;
            ray.mirrored_length = ray.distance + r;
            ray.unmirrored_length = ray.distance + x;
        } else if split.through_specular > split.through_diffuse + split.diffuse {
            ray.unmirrored_length = ray.distance + e;
        }
    }

    /// Shades a hit as a white Lambertian surface whose radiance equals its irradiance, tilted by what lies between the
    /// surface and its material.
    pub(crate) fn lambertian(&mut self, ray: &mut Ray<'_>, tilt: DVec3) {
        let facing = Facing::of(ray, tilt, true);
        ray.normal = facing.normal;
        let white = Rgb::splat(std::f32::consts::PI);
        self.ambient(ray, white, facing.normal);
        let n = facing.normal;
        self.direct_with(ray, Some(n), |_, l, omega| {
            let c = n.dot(l);
            if c > EPSILON { Rgb::splat((c * omega) as f32) } else { Rgb::ZERO }
        });
    }
}

/// The response of plastic, metal or trans to light from one direction.
struct Lobes<'a> {
    split: &'a Split,
    colour: Rgb,
    /// The shading normal.
    normal: DVec3,
    /// Clamped cosine of the view.
    cosine: f64,
    through: DVec3,
    flat: bool,
    jitter: f64,
    alpha2: f64,
}

impl Lobes<'_> {
    fn coefficient(&self, d: DVec3, l: DVec3, omega: f64) -> Rgb {
        let s = self.split;
        let n = self.normal;
        let lambda = n.dot(l);
        if (lambda < 0.0 && s.through <= EPSILON) || (lambda >= 0.0 && s.through >= 1.0 - EPSILON) {
            return Rgb::ZERO;
        }
        let loss = if s.fresnel { 1.0 - fresnel(lambda.abs()) } else { 1.0 };
        let mut sum = Rgb::ZERO;
        if lambda > EPSILON {
            if s.diffuse > EPSILON {
                sum += self.colour * (s.diffuse * loss * lambda * omega / PI) as f32;
            }
            if !s.smooth && s.reflected > EPSILON {
                let widen = if self.flat { (1.0 - self.jitter) * omega / (4.0 * PI) } else { 0.0 };
                let beta = self.alpha2 + widen;
                let h = l - d;
                let (q, m) = (h.length_squared(), h.dot(n));
                let lobe = q * (-(q - m * m) / (m * m * beta)).exp() / (PI * beta * m.powi(4));
                if lobe > EPSILON {
                    sum += s.mirror * (lobe * lambda * omega) as f32;
                }
            }
        } else if lambda < -EPSILON {
            if s.through_diffuse > EPSILON {
                sum += self.colour * (s.through_diffuse * loss * -lambda * omega / PI) as f32;
            }
            if !s.smooth && s.through_specular > EPSILON {
                let beta = self.alpha2 + omega / PI;
                let lobe = ((2.0 * self.through.dot(l) - 2.0) / beta).exp() / (PI * beta);
                if lobe > EPSILON {
                    let k = s.through_specular * omega * lobe * (-lambda / self.cosine).sqrt();
                    sum += self.colour * k as f32;
                }
            }
        }
        sum
    }
}
