//! mist: the boundary of a volume that absorbs and scatters. What happens along the way is the walk's affair.

use super::{Facing, Finish};
use crate::Error;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray, SourceSet};
use crate::walk::Walk;
use ambit_base::Rgb;
use ambit_scene::{ObjectId, Scene};

/// Arguments of mist.
#[derive(Clone, Debug)]
pub(crate) struct Mist {
    /// Per unit length, before any pattern.
    extinction: Rgb,
    /// Scattering albedo, where it differs from the global one.
    albedo: Option<Rgb>,
    /// Henyey–Greenstein eccentricity, where it differs from the global one.
    eccentricity: Option<f32>,
    /// Sources whose scattered light is calculated; known once all sources are.
    pub(crate) sources: SourceSet,
}

/// Sources that a mist may name.
const MOST_SOURCES: usize = 32;

impl Mist {
    pub(crate) fn compile(scene: &Scene, id: ObjectId) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        if scene.string_count(id) > MOST_SOURCES {
            return Err(Error::primitive(scene, id, "too many sources in list"));
        }
        let r = scene.reals(id);
        let rgb = |i: usize| (r.len() >= i + 3).then(|| Rgb::new(r[i] as f32, r[i + 1] as f32, r[i + 2] as f32));
        Ok(Self {
            extinction: rgb(0).unwrap_or(Rgb::ZERO),
            albedo: rgb(3),
            eccentricity: r.get(6).map(|&g| g as f32),
            sources: 0,
        })
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn mist(&mut self, ray: &mut Ray<'_>, m: &Mist, finish: Finish) -> bool {
        ray.normal = Facing::of(ray, finish.tilt, false).normal;
        let extinction = m.extinction * finish.pattern;
        let mut beyond = ray.interior;
        if ray.cosine() > 0.0 {
            beyond.extinction += extinction;
            beyond.albedo = m.albedo.unwrap_or(beyond.albedo);
            beyond.eccentricity = m.eccentricity.unwrap_or(beyond.eccentricity);
            beyond.sources |= m.sources;
        } else {
            if ray.interior.sources & m.sources != m.sources {
                // The ray started inside without knowing it.
                ray.interior.extinction += extinction;
                ray.interior.albedo = m.albedo.unwrap_or(ray.interior.albedo);
                ray.interior.eccentricity = m.eccentricity.unwrap_or(ray.interior.eccentricity);
                ray.interior.sources |= m.sources;
                beyond = ray.interior;
            }
            let global = self.tracer.global_interior();
            beyond.extinction = (beyond.extinction - extinction).max(global.extinction);
            if m.albedo.is_some() {
                beyond.albedo = global.albedo;
            }
            if m.eccentricity.is_some() {
                beyond.eccentricity = global.eccentricity;
            }
            beyond.sources &= !m.sources;
        }
        let limits = &self.tracer.options.limits;
        let (mut child, alive) = ray.spawn(Kinds::TRANSFERRED, ray.direction, None, limits, 1);
        if !alive {
            return true;
        }
        child.throughput *= ray.attenuation();
        child.interior = beyond;
        self.evaluate(&mut child);
        let (value, mirrored) = (child.value, child.mirrored);
        let (r, x) = (child.mirrored_length, child.unmirrored_length);
        ray.value = value;
        ray.mirrored = mirrored;
        ray.mirrored_length = ray.distance + r;
        ray.unmirrored_length = ray.distance + x;
        true
    }
}
