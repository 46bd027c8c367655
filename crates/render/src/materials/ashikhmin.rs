//! ashik2: a diffuse part under an anisotropic Phong lobe with Fresnel reflection (Ashikhmin & Shirley 2000, *An
//! Anisotropic Phong BRDF Model*). Opaque.

use super::normal::LEAST_COSINE;
use super::rough::{tangents, trial};
use super::{Facing, Finish};
use crate::Error;
use crate::observer::Observer;
use crate::patterns::{Compiler, Functions};
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, EPSILON, Frame, Rgb, mix};
use ambit_scene::{ObjectId, Scene};
use std::f64::consts::PI;

/// Arguments of ashik2.
#[derive(Debug)]
pub(crate) struct Ashikhmin {
    diffuse: Rgb,
    specular: Rgb,
    /// Exponents along the axis and across.
    powers: [f64; 2],
    /// The axis.
    axis: Functions,
}

/// Trials for each ray that is wanted.
const TRIALS: usize = 10;
/// Tag of the lobe's numbers.
const LOBE: u64 = 0x73;

impl Ashikhmin {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let r = scene.reals(id);
        let rgb = |i: usize| Rgb::new(r[i] as f32, r[i + 1] as f32, r[i + 2] as f32);
        Ok(Self {
            diffuse: rgb(0),
            specular: rgb(3),
            powers: [r[6], r[7]],
            axis: compiler.functions(scene, id, &[0, 1, 2], 3)?,
        })
    }
}

/// The response of one hit to light from one direction.
struct Lobe {
    diffuse: Rgb,
    /// Specular colour at the view angle.
    specular: Rgb,
    normal: DVec3,
    /// Clamped cosine of the view.
    cosine: f64,
    axes: [DVec3; 2],
    powers: [f64; 2],
}

impl Lobe {
    fn coefficient(&self, d: DVec3, l: DVec3, omega: f64) -> Rgb {
        let lambda = self.normal.dot(l);
        if lambda <= EPSILON {
            return Rgb::ZERO;
        }
        let mut sum = self.diffuse * (lambda * omega / PI * (1.0 - (1.0 - lambda).powi(5))) as f32;
        if self.specular.max_element() > EPSILON as f32 {
            let h = (l - d).normalize_or(self.normal);
            let [nu, nv] = self.powers;
            let m = h.dot(self.normal).clamp(0.0, 1.0);
            let sine2 = 1.0 - m * m;
            let power = if sine2 <= EPSILON {
                1.0
            } else {
                m.powf((nu * h.dot(self.axes[0]).powi(2) + nv * h.dot(self.axes[1]).powi(2)) / sine2)
            };
            let scale = ((nu + 1.0) * (nv + 1.0)).sqrt() / (8.0 * PI);
            let lobe = scale * power / (l.dot(h) * lambda.max(self.cosine)).max(EPSILON);
            sum += self.specular * (lobe * lambda * omega) as f32;
        }
        sum
    }

    /// The half vector for an azimuth and a uniform number.
    fn facet(&self, phi: f64, x: f64) -> DVec3 {
        let [nu, nv] = self.powers;
        let (s, c) = phi.sin_cos();
        let (c, s) = ((nv + 1.0).sqrt() * c, (nu + 1.0).sqrt() * s);
        let length = (c * c + s * s).sqrt();
        let (c, s) = (c / length, s / length);
        let cosine = x.powf(1.0 / (nu * c * c + nv * s * s + 1.0));
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        (self.axes[0] * c + self.axes[1] * s) * sine + self.normal * cosine
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn ashikhmin(&mut self, ray: &mut Ray<'_>, m: &Ashikhmin, finish: Finish) -> bool {
        if ray.is_shadow() {
            return true;
        }
        let Some(facing) = self.visible_side(ray, finish.tilt) else { return false };
        let diffuse = m.diffuse * finish.pattern;
        let cosine = facing.cosine.max(LEAST_COSINE);
        let channels = self.turned_channels(ray, &m.axis, &facing, diffuse);
        let u = self.axis(&channels, &m.axis, 0);
        let (axes, powers) = if let Some(axes) = u.and_then(|u| tangents(facing.normal, u)) {
            (axes, m.powers)
        } else {
            let frame = Frame::around(facing.normal);
            let [nu, nv] = m.powers;
            // The harmonic mean; no power along either axis leaves none.
            let mean = if nu + nv > EPSILON { 2.0 * nu * nv / (nu + nv) } else { 0.0 };
            ([frame.u, frame.v], [mean; 2])
        };
        let specular = m.specular + (Rgb::ONE - m.specular) * (1.0 - cosine).powi(5) as f32;
        let lobe = Lobe { diffuse, specular, normal: facing.normal, cosine, axes, powers };
        let strength = f64::from(m.specular.brightness());
        let lump = self.is_lumped(strength);
        if m.specular.max_element() > EPSILON as f32 && !lump {
            self.sample_ashikhmin(ray, &facing, &lobe);
        }
        if diffuse.max_element() > EPSILON as f32 {
            self.positive_ambient(ray, if lump { diffuse + specular } else { diffuse }, facing.normal);
        }
        let d = ray.direction;
        self.direct(ray, |l, omega| lobe.coefficient(d, l, omega));
        true
    }

    fn sample_ashikhmin(&mut self, ray: &mut Ray<'_>, facing: &Facing, lobe: &Lobe) {
        let wanted = self.lobe_rays(ray, lobe.specular);
        let k = lobe.specular / wanted as f32;
        let stream = ray.stream.child(mix(LOBE, u64::from(ray.material)));
        let d = ray.direction;
        let (mut sent, mut trials) = (0, 0);
        while sent < wanted && trials < TRIALS * wanted {
            let [x1, x2] = trial(stream, LOBE, trials, wanted);
            trials += 1;
            let h = lobe.facet(2.0 * PI * x1, x2);
            let direction = d - h * (2.0 * d.dot(h));
            if direction.dot(facing.geometric) <= EPSILON {
                continue;
            }
            sent += 1;
            let tag = mix(LOBE, trials as u64);
            let direction = direction.normalize();
            let Some(mut child) = self.child(ray, Kinds::SPECULAR_REFLECTED, direction, k, tag) else { continue };
            self.evaluate(&mut child);
            let light = child.coefficient * child.value;
            ray.value += light;
        }
    }
}
