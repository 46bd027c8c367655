//! Light of sources that a participating medium scatters towards the viewer, and which sources a mist names.

use super::direct::Candidate;
use super::partition::parts;
use super::{Source, SourceId};
use crate::Error;
use crate::materials::Material;
use crate::observer::Observer;
use crate::prepare::{Environment, Prepared};
use crate::ray::{Kinds, Ray, SourceSet};
use crate::walk::Walk;
use ambit_base::{Colour, EPSILON, FAR, Rgb, mix};
use ambit_file::text_of;
use ambit_scene::{Kind, ObjectId, Scene};
use std::f64::consts::PI;

/// Most points on a segment at which the light of a source is looked for.
const MOST_POINTS: f64 = 16.0;
/// Greatest exponent of light that grows on its way: e^40 times the light of any source is still a number.
const MOST_GROWTH: Rgb = Rgb::splat(40.0);
/// Tag of the points' places.
const PLACES: u64 = 0x3157;

impl<O: Observer> Walk<'_, O> {
    /// Adds to a ray's value what the sources named by the mists around its segment send into it (single scattering):
    /// for each source one shadow ray from each of several points, one in each equal part of the segment.
    pub(crate) fn in_scatter(&mut self, ray: &mut Ray<'_>) {
        let medium = ray.interior;
        let g = f64::from(medium.eccentricity);
        if ray.distance >= 0.99 * FAR || g >= 1.0 - EPSILON {
            return;
        }
        let spacing = self.tracer.options.medium.sampling;
        let points =
            if spacing > EPSILON { (ray.distance / spacing + 0.5).floor().clamp(1.0, MOST_POINTS) } else { 1.0 };
        let scene = self.tracer.scene;
        let mut rest = medium.sources;
        while rest != 0 {
            let id = scene.scatterers[rest.trailing_zeros() as usize];
            rest &= rest - 1;
            for i in 0..points as u32 {
                let stream = ray.stream.child(mix(PLACES, u64::from(id))).child(u64::from(i));
                let t = ray.distance * (f64::from(i) + stream.one()) / points;
                let mut from = *ray;
                from.point = ray.origin + ray.direction * t;
                from.distance = t;
                from.hit = None;
                if O::ACTIVE {
                    from.kind = Kinds::NONE;
                }
                let Some(light) = self.scattered(&from, id, g, stream) else { continue };
                let weight = (ray.distance / (4.0 * PI * points)) as f32;
                // Not `transmittance`: where a pattern makes the extinction negative, this light grows on its way.
                let along = (-medium.extinction * t as f32).min(MOST_GROWTH).exp() * medium.extinction * medium.albedo;
                ray.value += light * along * weight;
            }
        }
    }

    /// Radiance of a source at the end of `from` × solid angle × phase function, or None if none arrives.
    fn scattered(&mut self, from: &Ray<'_>, id: SourceId, g: f64, stream: ambit_base::Stream) -> Option<Rgb> {
        let source = &self.tracer.scene.sources[id as usize];
        if !source.sampled || source.is_out_of_reach(from.point) {
            return None;
        }
        let mut whole = std::mem::take(&mut self.work.parts);
        parts(source, from.point, f64::INFINITY, &mut whole);
        let sample = whole.first().and_then(|part| self.sample(source, from.point, part, false, stream.child(PLACES)));
        self.work.parts = whole;
        let sample = sample?;
        let cosine = from.direction.dot(sample.direction);
        let phase = if g <= EPSILON { 1.0 } else { (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine).powf(1.5) };
        let coefficient = Rgb::splat((phase * sample.solid_angle) as f32);
        // What arrives where nothing is in between; the edge of the mist mostly is, and beyond it the air is clearer.
        let potential = coefficient * self.emitted(from, id, sample, false);
        let brightness = potential.brightness();
        let candidate = Candidate { source: id, direction: sample.direction, coefficient, potential, brightness };
        self.shadow(from, &candidate)
    }
}

/// Finds the sources that each mist names and numbers them.
pub(crate) fn name_scatterers(prepared: &mut Prepared, environment: &Environment<'_>) {
    let mists: Vec<ObjectId> =
        prepared.objects.ids().filter(|&id| prepared.objects.object(id).kind == Kind::Mist).collect();
    for id in mists {
        let named = named(prepared, id, environment);
        let mut set: SourceSet = 0;
        let mut fault = None;
        for source in named {
            let known = prepared.scatterers.iter().position(|&s| s == source);
            let index = known.unwrap_or_else(|| {
                prepared.scatterers.push(source);
                prepared.scatterers.len() - 1
            });
            if index >= SourceSet::BITS as usize {
                fault = Some(Error::primitive(&prepared.objects, id, "too many sources in the lists of all mists"));
                break;
            }
            set |= 1 << index;
        }
        if let Some(Material::Mist(mist)) = prepared.modifiers.material_mut(id) {
            mist.sources = set;
        }
        if let Some(error) = fault {
            prepared.modifiers.disable(id, error);
        }
    }
}

/// The sources that a mist's strings name, each once. Of several sources of a name the last counts.
fn named(prepared: &Prepared, mist: ObjectId, environment: &Environment<'_>) -> Vec<SourceId> {
    let scene = &prepared.objects;
    let mut found = Vec::new();
    for name in scene.strings_bytes(mist) {
        let last = (0..prepared.sources.len()).rev().find(|&s| is_called(prepared, &prepared.sources[s], name));
        let complain = |what: &str| {
            let name = text_of(name);
            environment.notify.warn(&format!("{what} source \"{name}\" for {}", scene.describe(mist)));
        };
        match last {
            None => complain("unknown"),
            Some(s) if found.contains(&(s as SourceId)) => complain("duplicate"),
            Some(s) => found.push(s as SourceId),
        }
    }
    found
}

/// True if `name` means the source: its surface's identifier, or for an image `relay>name of what it is an image of`.
fn is_called(prepared: &Prepared, source: &Source, name: &[u8]) -> bool {
    let scene: &Scene = &prepared.objects;
    let Some(image) = source.image else { return scene.name_bytes(source.object) == name };
    let relay = scene.name_bytes(prepared.relays[image.relay as usize].object);
    name.strip_prefix(relay)
        .and_then(|rest| rest.strip_prefix(b">"))
        .is_some_and(|rest| is_called(prepared, &prepared.sources[image.of as usize], rest))
}
