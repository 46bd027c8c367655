//! plastic2, metal2 and trans2: as plastic, metal and trans, but always rough, with one roughness along an axis that a
//! function file gives and another across (Ward 1992). No Fresnel effect; opaque to shadow rays.

use super::normal::{LEAST_COSINE, crossing};
use super::rough::Facets;
use super::{Facing, Finish, NormalKind};
use crate::Error;
use crate::observer::Observer;
use crate::patterns::{Compiler, Functions};
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Rgb};
use ambit_scene::{Kind, ObjectId, Scene};
use std::f64::consts::PI;

/// Arguments of plastic2, metal2 or trans2.
#[derive(Debug)]
pub(crate) struct Anisotropic {
    pub(crate) kind: NormalKind,
    colour: Rgb,
    specular: f64,
    /// RMS facet slopes along the axis and across.
    roughness: [f64; 2],
    transmission: f64,
    transmitted_specular: f64,
    /// The axis.
    axis: Functions,
}

impl Anisotropic {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let r = scene.reals(id);
        if r[4] <= EPSILON || r[5] <= EPSILON {
            return Err(Error::primitive(scene, id, "roughness too small"));
        }
        Ok(Self {
            kind: match scene.object(id).kind {
                Kind::Plastic2 => NormalKind::Plastic,
                Kind::Metal2 => NormalKind::Metal,
                _ => NormalKind::Trans,
            },
            colour: Rgb::new(r[0] as f32, r[1] as f32, r[2] as f32),
            specular: r[3],
            roughness: [r[4], r[5]],
            transmission: r.get(6).copied().unwrap_or(0.0),
            transmitted_specular: r.get(7).copied().unwrap_or(0.0),
            axis: compiler.functions(scene, id, &[0, 1, 2], 3)?,
        })
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn anisotropic(&mut self, ray: &mut Ray<'_>, m: &Anisotropic, finish: Finish) -> bool {
        if ray.is_shadow() {
            return true;
        }
        let Some(facing) = self.visible_side(ray, finish.tilt) else { return false };
        let colour = m.colour * finish.pattern;
        let channels = self.turned_channels(ray, &m.axis, &facing, colour);
        let u = self.axis(&channels, &m.axis, 0);
        let facets = Facets::oriented(facing.normal, u, m.roughness);

        let reflected = m.specular;
        let through = m.transmission * (1.0 - reflected);
        let through_specular = m.transmitted_specular * through;
        let through_diffuse = through - through_specular;
        let diffuse = 1.0 - through - reflected;
        let tint = if m.kind == NormalKind::Metal { colour } else { Rgb::ONE };
        let lobes = Lobes {
            facets,
            facing,
            cosine: facing.cosine.max(LEAST_COSINE),
            direction: if facing.textured && !self.is_phong(ray) {
                crossing(ray.direction - facing.tilt, ray.direction, &facing)
            } else {
                ray.direction
            },
            colour,
            mirror: tint * reflected as f32,
            reflected,
            through,
            through_specular,
            through_diffuse,
            diffuse,
            widening: if self.is_flat(ray) && !facing.textured {
                (1.0 - self.tracer.options.direct.jitter) / (4.0 * PI)
            } else {
                0.0
            },
        };
        let lump_reflected = self.is_lumped(reflected);
        let lump_through = self.is_lumped(through_specular);
        if reflected > EPSILON && !lump_reflected {
            self.sample_reflection(ray, &facing, lobes.mirror, &facets);
        }
        if through_specular > EPSILON && !lump_through {
            let k = colour * through_specular as f32;
            self.sample_transmission(ray, &facing, lobes.direction, k, &facets);
        }
        let lump = lump_reflected.then_some(lobes.mirror);
        self.ambient_with_lump(ray, diffuse, colour * diffuse as f32, lump, facing.normal);
        let lump = lump_through.then(|| colour * through_specular as f32);
        self.ambient_with_lump(ray, through_diffuse, colour * through_diffuse as f32, lump, -facing.normal);
        let d = ray.direction;
        self.direct(ray, |l, omega| lobes.coefficient(d, l, omega));
        true
    }
}

/// The response of one hit to light from one direction.
struct Lobes {
    facets: Facets,
    facing: Facing,
    /// Clamped cosine of the view.
    cosine: f64,
    /// The view direction behind the surface.
    direction: DVec3,
    colour: Rgb,
    /// Specular reflection with its colour.
    mirror: Rgb,
    reflected: f64,
    through: f64,
    through_specular: f64,
    through_diffuse: f64,
    diffuse: f64,
    /// What the source's solid angle adds to the variances of slopes, per steradian.
    widening: f64,
}

impl Lobes {
    fn coefficient(&self, d: DVec3, l: DVec3, omega: f64) -> Rgb {
        let n = self.facing.normal;
        let lambda = n.dot(l);
        if (lambda < 0.0 && self.through <= EPSILON) || (lambda >= 0.0 && self.through >= 1.0 - EPSILON) {
            return Rgb::ZERO;
        }
        let mut sum = Rgb::ZERO;
        if lambda > EPSILON {
            if self.diffuse > EPSILON {
                sum += self.colour * (self.diffuse * lambda * omega / PI) as f32;
            }
            if self.reflected > EPSILON {
                let lobe = self.facets.reflection(n, l - d, self.widening * omega);
                sum += self.mirror * (lobe * lambda * omega) as f32;
            }
        } else if lambda < -EPSILON {
            if self.through_diffuse > EPSILON {
                sum += self.colour * (self.through_diffuse * -lambda * omega / PI) as f32;
            }
            if self.through_specular > EPSILON {
                let lobe = self.facets.transmission(n, l - self.direction, omega);
                let k = self.through_specular * omega * lobe * (-lambda / self.cosine).sqrt();
                sum += self.colour * k as f32;
            }
        }
        sum
    }
}
