//! Virtual sources: the images of light sources in flat mirrors, sampled like the originals and lit along the folded
//! path.
//!
//! Every shadow ray to an image is followed along its whole path, so obstacles of any size between mirror and source
//! count; nothing is decided by presampling (`-dp`).

use super::emitter::{BALL_HALF_EDGE, Emitter, Image, Restriction, Source};
use crate::Options;
use crate::materials::{Alternate, Finish, Light, Material};
use crate::prepare::{Environment, Modifiers, Prepared};
use crate::ray::{Kinds, Ray};
use crate::sources::SourceId;
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, EPSILON, FAR, Rgb};
use ambit_scene::{Class, ObjectId, Scene, Shape};
use ambit_trace::Shadow;
use std::f64::consts::PI;

/// A flat mirror that relays light.
#[derive(Clone, Debug)]
pub(crate) struct Relay {
    object: ObjectId,
    modifier: ObjectId,
    shape: Shape,
    normal: DVec3,
    offset: f64,
    centre: DVec3,
    radius: f64,
}

impl Relay {
    fn new(scene: &Scene, id: ObjectId) -> Option<Self> {
        let (shape, _) = Shape::from_object(scene, id).ok()?;
        let modifier = scene.object(id).modifier;
        let (normal, offset, centre, radius) = match &shape {
            Shape::Polygon(p) => {
                let centre = p.vertices.iter().sum::<DVec3>() / p.vertices.len() as f64;
                let radius = p.vertices.iter().map(|v| v.distance(centre)).fold(0.0, f64::max);
                (p.normal, p.offset, centre, radius)
            }
            Shape::Ring(r) => (r.normal, r.normal.dot(r.centre), r.centre, r.r1),
            _ => return None,
        };
        Some(Self { object: id, modifier, shape, normal, offset, centre, radius })
    }

    /// Where a ray meets the relay's front.
    fn intersect(&self, origin: DVec3, l: DVec3) -> Option<f64> {
        let c = self.normal.dot(l);
        if c >= -EPSILON {
            return None;
        }
        let t = (self.offset - self.normal.dot(origin)) / c;
        let p = origin + l * t;
        let within = match &self.shape {
            Shape::Polygon(polygon) => polygon.contains(p),
            Shape::Ring(r) => {
                let d = p.distance(r.centre);
                (r.r0..=r.r1).contains(&d)
            }
            _ => false,
        };
        (t > EPSILON && within).then_some(t)
    }

    fn mirror_point(&self, p: DVec3) -> DVec3 {
        p - self.normal * (2.0 * (self.normal.dot(p) - self.offset))
    }

    fn mirror_vector(&self, v: DVec3) -> DVec3 {
        v - self.normal * (2.0 * self.normal.dot(v))
    }
}

/// Appends the images of all sources in all relays, over at most `-dr` reflections.
pub(crate) fn add_virtual_sources(prepared: &mut Prepared, options: &Options, environment: &Environment<'_>) {
    if options.direct.relays <= 0 || prepared.sources.is_empty() {
        return;
    }
    let scene = &prepared.objects;
    let mut relays = Vec::new();
    for id in prepared.top_level.clone() {
        let object = scene.object(id);
        if object.kind.class() != Class::Surface || !relays_light(&prepared.modifiers, object.modifier) {
            continue;
        }
        match Relay::new(scene, id) {
            Some(relay) => relays.push(relay),
            None if object.kind != ambit_scene::Kind::Source => {
                environment.notify.warn(&format!("secondary sources not supported for {}", scene.describe(id)));
            }
            None => {}
        }
    }
    let real = prepared.sources.len();
    for id in (0..real).rev() {
        if prepared.sources[id].sampled {
            project(&mut prepared.sources, &relays, id as SourceId, options.direct.relays);
        }
    }
    prepared.relays = relays;
}

fn relays_light(modifiers: &Modifiers, modifier: ObjectId) -> bool {
    match modifiers.material(modifier) {
        Some((Material::Mirror(_), _)) => true,
        Some((Material::Light(Light { alternate: Some(Alternate::Modifier(m)), .. }), _)) => {
            matches!(modifiers.material(*m), Some((Material::Mirror(_), _)))
        }
        _ => false,
    }
}

fn project(sources: &mut Vec<Source>, relays: &[Relay], id: SourceId, depth: i32) {
    if depth <= 0 {
        return;
    }
    for (index, relay) in relays.iter().enumerate() {
        let parent = &sources[id as usize];
        if relay.object == parent.object
            || parent.image.is_some_and(|i| relays[i.relay as usize].object == relay.object)
        {
            continue;
        }
        // The disc of a further relay must not lie wholly on the image's side of the previous one.
        if let Some(image) = parent.image {
            let previous = &relays[image.relay as usize];
            if previous.normal.dot(relay.centre) + relay.radius <= previous.offset + EPSILON {
                continue;
            }
        }
        if let Some(source) = reflect(parent, id, relay, index as u32) {
            sources.push(source);
            let child = sources.len() as SourceId - 1;
            project(sources, relays, child, depth - 1);
        }
    }
}

/// The image of `parent` in `relay`, unless no light can take that way.
fn reflect(parent: &Source, id: SourceId, relay: &Relay, index: u32) -> Option<Source> {
    let distant = matches!(parent.emitter, Emitter::Distant);
    let reach: f64 = parent.axes.iter().map(|a| a.dot(relay.normal).abs()).sum();
    let enlarged = match parent.emitter {
        Emitter::Ring(_) | Emitter::Distant => reach * 2.0 / PI.sqrt(),
        Emitter::Sphere(_) => reach / BALL_HALF_EDGE,
        _ => reach,
    };
    let plane = if distant { 0.0 } else { relay.offset };
    if parent.centre.dot(relay.normal) + enlarged <= plane + EPSILON {
        return None;
    }
    if parent.glow && relay.centre.distance(parent.centre) > parent.reach + parent.radius + relay.radius {
        return None;
    }
    let mut image = parent.clone();
    image.centre = if distant { relay.mirror_vector(parent.centre) } else { relay.mirror_point(parent.centre) };
    image.axes = parent.axes.map(|a| relay.mirror_vector(a));
    image.normal = relay.mirror_vector(parent.normal);
    if let Some(spot) = &mut image.spot {
        spot.aim = relay.mirror_vector(spot.aim);
    }
    if let Emitter::Cylinder(c) = &mut image.emitter {
        c.axis = relay.mirror_vector(c.axis);
        (c.p0, c.p1) = (relay.mirror_point(c.p0), relay.mirror_point(c.p1));
    }
    image.restrictions = parent.restrictions.iter().map(|r| r.mirrored(relay)).collect();
    if distant {
        image.restrictions.push(Restriction::Beam {
            through: relay.centre,
            axis: image.centre,
            radius: relay.radius + EPSILON,
        });
    } else {
        let to = relay.centre - image.centre;
        let distance = to.length();
        let sine = (relay.radius + image.radius) / distance.max(EPSILON);
        if sine < 1.0 {
            let (aim, cosine) = (to / distance, (1.0 - sine * sine).sqrt());
            if image.normal != DVec3::ZERO && image.normal.dot(aim) <= -sine {
                return None;
            }
            image.restrictions.push(Restriction::Cone { aim, cosine });
        }
    }
    image.image = Some(Image { of: id, relay: index });
    Some(image)
}

impl Restriction {
    fn mirrored(&self, relay: &Relay) -> Self {
        match *self {
            Self::Cone { aim, cosine } => Self::Cone { aim: relay.mirror_vector(aim), cosine },
            Self::Beam { through, axis, radius } => {
                Self::Beam { through: relay.mirror_point(through), axis: relay.mirror_vector(axis), radius }
            }
        }
    }

    /// True if light of the image may get to `point` from unit direction `l`.
    pub(crate) fn admits(&self, point: DVec3, l: DVec3) -> bool {
        match *self {
            Self::Cone { aim, cosine } => -aim.dot(l) >= cosine - EPSILON,
            Self::Beam { through, axis, radius } => {
                let to = point - through;
                (to - axis * to.dot(axis)).length_squared() <= radius * radius
            }
        }
    }
}

impl Walk<'_> {
    /// The source to aim at next, if the ray's hit is on the relay of the image it is aimed at.
    pub(crate) fn relays_target(&self, ray: &Ray<'_>) -> Option<SourceId> {
        let scene = self.tracer.scene;
        let image = scene.sources[ray.target? as usize].image?;
        let hit = ray.hit.as_ref()?;
        (scene.relays[image.relay as usize].object == hit.object).then_some(image.of)
    }

    /// Radiance of an image towards a ray's point along `l`, with no obstacles on the folded path.
    pub(crate) fn relayed(&mut self, ray: &Ray<'_>, mut id: SourceId, mut l: DVec3) -> Rgb {
        let scene = self.tracer.scene;
        let mut from = *ray;
        let mut factor = Rgb::ONE;
        while let Some(image) = scene.sources[id as usize].image {
            let relay = &scene.relays[image.relay as usize];
            let Some(t) = relay.intersect(from.point, l) else { return Rgb::ZERO };
            let (mut child, _) = from.spawn(Kinds::SHADOW_REFLECTED, l, None, &self.tracer.options.limits, 0);
            child.distance = t;
            child.point = child.origin + l * t;
            child.hit = Some(super::distant::stand_in(relay.object, relay.modifier, t, relay.normal));
            factor *= self.relay_colour(&mut child, relay.modifier);
            let (point, distance) = (child.point, child.travelled + t);
            from.point = point;
            from.travelled = distance;
            from.distance = 0.0;
            l = relay.mirror_vector(l);
            id = image.of;
        }
        let source = &scene.sources[id as usize];
        if source.patterned {
            factor * self.source_value(&from, id, l)
        } else if source.intersect(from.point, l).is_some() {
            factor * source.emission
        } else {
            Rgb::ZERO
        }
    }

    fn relay_colour(&mut self, ray: &mut Ray<'_>, modifier: ObjectId) -> Rgb {
        let scene = self.tracer.scene;
        let mirror = match scene.modifiers.material(modifier) {
            Some((Material::Mirror(m), _)) => Some((m, modifier)),
            Some((Material::Light(Light { alternate: Some(Alternate::Modifier(a)), .. }), _)) => {
                match scene.modifiers.material(*a) {
                    Some((Material::Mirror(m), _)) => Some((m, *a)),
                    _ => None,
                }
            }
            _ => None,
        };
        let Some((mirror, chain)) = mirror else { return Rgb::ZERO };
        let mut finish = Finish { pattern: Rgb::ONE, tilt: DVec3::ZERO };
        if scene.modifiers.patterned(chain) {
            self.gather_patterns(ray, chain, &mut finish);
        }
        mirror.colour * finish.pattern
    }

    /// Light from an image by a shadow ray that starts towards its relay, or None if it is blocked.
    pub(crate) fn shadow_by_relay(&mut self, mut child: Ray<'_>, coefficient: Rgb) -> Option<Rgb> {
        let scene = self.tracer.scene;
        let relay = child.target.and_then(|t| scene.sources[t as usize].image).map(|i| &scene.relays[i.relay as usize]);
        if child.clipped == 0
            && child.limit >= FAR
            && let Some(relay) = relay
        {
            let query = ambit_trace::Ray { origin: child.origin, direction: child.direction, limit: FAR };
            if matches!(scene.world.shadow(&query, Some(relay.object)), Shadow::Blocked(_)) {
                self.work.rays += 1;
                return None;
            }
        }
        self.evaluate(&mut child);
        let value = child.value;
        (value.mean() > EPSILON as f32).then_some(coefficient * value)
    }
}
