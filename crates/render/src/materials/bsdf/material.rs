//! What light does at a BSDF or aBSDF (shading.md 12.10).

use super::arguments::Bsdf;
use super::data::Scattering;
use super::sample::Sampling;
use super::through::Through;
use crate::materials::{Facing, Finish};
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Rgb, hash_point, mix};
use std::f64::consts::FRAC_1_PI;

/// The BSDF's frame in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Axes {
    /// z along the normal, y as near to `up` as can be; None if they are parallel.
    fn new(z: DVec3, up: DVec3) -> Option<Self> {
        let x = up.cross(z);
        let length = x.length();
        if !(length.is_finite() && length > EPSILON) {
            return None;
        }
        let x = x / length;
        Some(Self { x, y: z.cross(x), z })
    }

    pub(super) fn to_local(self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    pub(super) fn to_world(self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

/// Jittered views that land in cells smaller than this share of the view's own are left out.
const LEAST_CELL: f64 = 0.12;
/// Jittered views per `-ss` 1 in the response to a source.
const VIEWS: f64 = 4.0;
/// Most of them: the average of more changes nothing any more.
const MOST_VIEWS: f64 = 1000.0;
/// Tag of those views.
const DIRECT: u64 = 0xb5df;

/// One hit on a BSDF.
pub(super) struct Lit<'m> {
    pub(super) axes: Axes,
    /// Towards the viewer, in the frame of the BSDF.
    pub(super) view: DVec3,
    pub(super) reflection: &'m Scattering,
    pub(super) transmission: &'m Scattering,
    pub(super) through: Option<Through>,
    pub(super) pattern: Rgb,
    /// Lambertian coefficients, pattern included.
    near: Rgb,
    far: Rgb,
    /// How much views are jittered, in cells.
    pub(super) jitter: f64,
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn bsdf(&mut self, ray: &mut Ray<'_>, m: &Bsdf, finish: Finish) -> bool {
        let front = ray.cosine() > 0.0;
        let Some((thickness, up)) = self.bsdf_arguments(ray, m) else { return true };
        if thickness != 0.0 {
            // Only scattered light sees a stand-in, and only from the side it stands in for.
            let scattered = ray.lineage.meets(Kinds::INDIRECT) && !ray.is_shadow();
            if !scattered || front != (thickness > 0.0) {
                return false;
            }
        }
        if !front && !self.tracer.options.back_visible {
            return false;
        }
        if ray.is_shadow() && !m.see_through {
            return true;
        }
        let facing = Facing::of(ray, finish.tilt, false);
        let side = if front { 1.0 } else { -1.0 };
        ray.normal = facing.normal;
        let Some(axes) = Axes::new(facing.normal, up) else {
            self.tracer.scene.complaints.raise_orientation(m.functions.owner);
            return true;
        };
        let view = axes.to_local(-ray.direction);
        let face = usize::from(!front);
        let (reflection, transmission) = (&m.data.reflection[face], &m.data.transmission[face]);
        let sees_through = m.see_through && (ray.is_shadow() || !ray.lineage.meets(Kinds::INDIRECT));
        let through = if sees_through { Through::find(transmission, view) } else { None };
        if ray.is_shadow() {
            self.see_through(ray, through.as_ref(), finish.pattern);
            return true;
        }
        let ss = self.tracer.options.specular.sampling;
        let lit = Lit {
            axes,
            view,
            reflection,
            transmission,
            through,
            pattern: finish.pattern,
            near: (reflection.diffuse + m.extra[face]) * finish.pattern,
            far: (transmission.diffuse + m.extra[2]) * finish.pattern,
            jitter: ss.clamp(0.0, 1.0),
        };
        let geometric = facing.geometric;
        let here = ray.point;
        // Behind a stand-in light starts where what it stands for ends.
        let beyond = here - geometric * thickness;
        let mut near = lit.near;
        near += Rgb::splat(self.sample_bsdf(ray, &lit, Sampling { transmitted: false, origin: here }));
        self.see_through(ray, through.as_ref(), finish.pattern);
        let lumped = self.sample_bsdf(ray, &lit, Sampling { transmitted: true, origin: beyond });
        let far = lit.far + finish.pattern * lumped;
        let normal = facing.normal * side;
        self.positive_ambient(ray, near, normal);
        // On this side of the surface: so Radiance has it, though what is behind would be meant.
        ray.point = here + geometric * thickness;
        self.positive_ambient(ray, far, -normal);
        ray.point = here;
        let views = (VIEWS * ss * f64::from(ray.weight) + 0.5).floor().clamp(1.0, MOST_VIEWS) as u32;
        let key = ray.stream.child(mix(DIRECT, u64::from(ray.material)));
        let response = |l: DVec3, omega: f64| {
            lit.response(l, omega, views, |l, i| key.child(mix(hash_point(l), u64::from(i))).two())
        };
        if thickness == 0.0 {
            self.direct(ray, response);
        } else {
            let same_side = |l: DVec3| l.dot(normal) > 0.0;
            self.direct(ray, |l, omega| if same_side(l) { response(l, omega) } else { Rgb::ZERO });
            ray.point = beyond;
            self.direct(ray, |l, omega| if same_side(l) { Rgb::ZERO } else { response(l, omega) });
            ray.point = here;
        }
        true
    }

    /// Thickness in world units, and the up vector; None where they have no value.
    fn bsdf_arguments(&mut self, ray: &Ray<'_>, m: &Bsdf) -> Option<(f64, DVec3)> {
        let channels = self.channels(ray, &m.functions);
        let [thickness] = if m.see_through { [0.0] } else { self.expressions(&channels, &m.functions, 3)? };
        let up: [f64; 3] = self.expressions(&channels, &m.functions, 0)?;
        let frame = self.function_frame(ray, &m.functions.placement);
        let thickness = thickness * frame.scale().abs();
        Some((if thickness.abs() > EPSILON { thickness } else { 0.0 }, frame.direction(up.into())))
    }

    /// Adds what is seen through a peak.
    fn see_through(&mut self, ray: &mut Ray<'_>, through: Option<&Through>, pattern: Rgb) {
        let Some(through) = through else { return };
        let k = through.colour * pattern;
        self.pass(ray, ray.direction, k, true);
    }
}

impl Lit<'_> {
    /// Response to light of solid angle `omega` from `l`, averaged over `views` jittered views.
    fn response(&self, l: DVec3, omega: f64, views: u32, random: impl Fn(DVec3, u32) -> [f64; 2]) -> Rgb {
        let light = self.axes.to_local(l);
        let cosine = light.z.abs();
        if cosine <= EPSILON {
            return Rgb::ZERO;
        }
        let transmitted = light.z * self.view.z < 0.0;
        let (diffuse, scattering) =
            if transmitted { (self.far, self.transmission) } else { (self.near, self.reflection) };
        let mut value = diffuse * FRAC_1_PI as f32;
        if let Some(lobe) = &scattering.lobe {
            let base = scattering.diffuse * FRAC_1_PI as f32;
            let mut rest = Rgb::ZERO;
            if let Some(through) = self.through.filter(|t| transmitted && t.shows(light, omega)) {
                // A pattern counts twice here: so Radiance has it.
                rest = through.surround * self.pattern;
            } else if let Some(own) = lobe.cell(self.view, light) {
                if self.jitter <= 0.0 {
                    rest = lobe.excess(&own, self.view, light, base);
                } else {
                    let mut count = 0u16;
                    for i in 0..views {
                        let view = self.jittered(own.size(), random(l, i));
                        let Some(cell) = lobe.cell(view, light) else { continue };
                        if cell.size() >= LEAST_CELL * own.size() {
                            rest += lobe.excess(&cell, view, light, base);
                            count += 1;
                        }
                    }
                    rest = if count > 0 { rest / f32::from(count) } else { lobe.excess(&own, self.view, light, base) };
                }
            }
            rest = rest.max(Rgb::ZERO);
            if transmitted {
                rest *= self.pattern;
            }
            value += rest;
        }
        value * (cosine * omega) as f32
    }

    /// The view moved sideways within a cell's width.
    pub(super) fn jittered(&self, area: f64, [u, v]: [f64; 2]) -> DVec3 {
        let width = self.jitter * area.sqrt();
        let moved = self.view + DVec3::new(width * (u - 0.5), width * (v - 0.5), 0.0);
        moved.normalize_or(self.view)
    }
}
