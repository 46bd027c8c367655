//! Virtual sources: the images of light sources in flat mirrors and prisms, sampled like the originals and lit along the
//! folded path.
//!
//! Every shadow ray to an image is followed along its whole path, so obstacles of any size between mirror and source
//! count; nothing is decided by presampling (`-dp`).

use super::emitter::{BALL_HALF_EDGE, Emitter, Image, Restriction, Source};
use crate::Options;
use crate::materials::{Alternate, Finish, Light, Material, Prism};
use crate::observer::Observer;
use crate::prepare::{Environment, Modifiers, Prepared};
use crate::ray::{Interior, Kinds, Ray};
use crate::sources::SourceId;
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, EPSILON, FAR, Rgb, Stream};
use ambit_scene::{Class, ObjectId, Scene, Shape};
use ambit_trace::Shadow;
use std::f64::consts::PI;

/// A flat mirror or prism that relays light.
#[derive(Clone, Debug)]
pub(crate) struct Relay {
    pub(crate) object: ObjectId,
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

    /// Where a ray meets the relay, from the front or, if `both`, from either side.
    fn intersect(&self, origin: DVec3, l: DVec3, both: bool) -> Option<f64> {
        let c = self.normal.dot(l);
        if c.abs() <= EPSILON || (c > 0.0 && !both) {
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

    /// The hit of a ray on the relay.
    fn hit(&self, distance: f64, l: DVec3) -> ambit_trace::Hit {
        let mut hit = super::distant::stand_in(self.object, self.modifier, distance, self.normal);
        hit.cosine = -l.dot(self.normal);
        hit
    }
}

/// How a relay maps space to where it seems to be: x + ((x − relay)·n) shear, then mirrored in the plane if `flips`.
#[derive(Clone, Copy, Debug)]
struct Projection {
    normal: DVec3,
    offset: f64,
    shear: DVec3,
    flips: bool,
}

impl Projection {
    fn mirror(relay: &Relay) -> Self {
        Self { normal: relay.normal, offset: relay.offset, shear: DVec3::ZERO, flips: true }
    }

    /// How a branch of a prism moves `source`, by a test ray from the source's centre to the relay's.
    fn prism(relay: &Relay, prism: &Prism, branch: u8, source: &Source) -> Option<Self> {
        let distant = matches!(source.emitter, Emitter::Distant);
        let (from, incoming) = if distant {
            (relay.centre + source.centre * relay.radius, -source.centre)
        } else {
            (source.centre, (relay.centre - source.centre).try_normalize()?)
        };
        let n = relay.normal;
        let mut ray = Ray::primary(from, incoming, FAR, Interior::VACUUM, Stream::new(0, 0));
        ray.distance = relay.centre.distance(from);
        ray.point = relay.centre;
        ray.hit = Some(relay.hit(ray.distance, incoming));
        let (_, outgoing) = prism.deflect(&ray, branch)?;
        let (i, o) = (incoming.dot(n), outgoing.dot(n));
        if i.abs() <= EPSILON || o.abs() <= EPSILON {
            return None;
        }
        let shear = outgoing / o - incoming / i;
        let flips = (i < 0.0) != (o < 0.0);
        // Undeviated light has no image.
        (flips || shear.length() > EPSILON).then_some(Self { normal: n, offset: relay.offset, shear, flips })
    }

    fn point(&self, p: DVec3) -> DVec3 {
        let height = self.normal.dot(p) - self.offset;
        // The shear leaves a plane's points at their height.
        let p = p + self.shear * height;
        if self.flips { p - self.normal * (2.0 * height) } else { p }
    }

    fn vector(&self, v: DVec3) -> DVec3 {
        let height = self.normal.dot(v);
        let v = v + self.shear * height;
        if self.flips { v - self.normal * (2.0 * height) } else { v }
    }

    /// A unit vector for a unit vector.
    fn direction(&self, v: DVec3) -> DVec3 {
        let moved = self.vector(v);
        if self.shear == DVec3::ZERO { moved } else { moved.normalize_or(v) }
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
            project(&mut prepared.sources, &prepared.modifiers, &relays, id as SourceId, options.direct.relays);
        }
    }
    prepared.relays = relays;
}

fn relays_light(modifiers: &Modifiers, modifier: ObjectId) -> bool {
    relaying_material(modifiers, modifier).is_some()
}

/// The mirror or prism that a chain leads to, directly or as an illum's alternate, and the chain it stands on.
fn relaying_material(modifiers: &Modifiers, modifier: ObjectId) -> Option<(&Material, ObjectId)> {
    let is_relay = |m: &Material| matches!(m, Material::Mirror(_) | Material::Prism(_));
    match modifiers.material(modifier)?.0 {
        m if is_relay(m) => Some((m, modifier)),
        Material::Light(Light { alternate: Some(Alternate::Modifier(a)), .. }) => {
            let (m, _) = modifiers.material(*a)?;
            is_relay(m).then_some((m, *a))
        }
        _ => None,
    }
}

fn project(sources: &mut Vec<Source>, modifiers: &Modifiers, relays: &[Relay], id: SourceId, depth: i32) {
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
            let height = previous.normal.dot(relay.centre) - previous.offset;
            let height = if image.in_front { -height } else { height };
            if height + relay.radius <= EPSILON {
                continue;
            }
        }
        let Some((material, _)) = relaying_material(modifiers, relay.modifier) else { continue };
        let branches = if let Material::Prism(prism) = material { prism.branches() } else { 1 };
        for branch in 0..branches {
            let parent = &sources[id as usize];
            let projection = match material {
                Material::Prism(prism) => Projection::prism(relay, prism, branch, parent),
                _ => faces(parent, relay).then(|| Projection::mirror(relay)),
            };
            let image = projection.and_then(|p| image(parent, relay, &p));
            if let Some(mut source) = image {
                let height = relay.normal.dot(source.centre);
                let plane = if matches!(source.emitter, Emitter::Distant) { 0.0 } else { relay.offset };
                source.image = Some(Image { of: id, relay: index as u32, branch, in_front: height > plane });
                sources.push(source);
                let child = sources.len() as SourceId - 1;
                project(sources, modifiers, relays, child, depth - 1);
            }
        }
    }
}

/// True if some of the source is in front of a mirror.
fn faces(source: &Source, relay: &Relay) -> bool {
    let reach: f64 = source.axes.iter().map(|a| a.dot(relay.normal).abs()).sum();
    let (enlarged, plane) = match source.emitter {
        Emitter::Distant => (reach * 2.0 / PI.sqrt(), 0.0),
        Emitter::Ring(_) => (reach * 2.0 / PI.sqrt(), relay.offset),
        Emitter::Sphere(_) => (reach / BALL_HALF_EDGE, relay.offset),
        _ => (reach, relay.offset),
    };
    source.centre.dot(relay.normal) + enlarged > plane + EPSILON
}

/// The image of `parent` by way of `relay`, unless no light can take that way.
fn image(parent: &Source, relay: &Relay, projection: &Projection) -> Option<Source> {
    let distant = matches!(parent.emitter, Emitter::Distant);
    if parent.glow && relay.centre.distance(parent.centre) > parent.reach + parent.radius + relay.radius {
        return None;
    }
    let mut image = parent.clone();
    image.centre = if distant { projection.direction(parent.centre) } else { projection.point(parent.centre) };
    image.axes = parent.axes.map(|a| projection.vector(a));
    image.normal = projection.direction(parent.normal);
    if let Some(spot) = &mut image.spot {
        spot.aim = projection.direction(spot.aim);
    }
    if let Emitter::Cylinder(c) = &mut image.emitter {
        c.axis = projection.direction(c.axis);
        (c.p0, c.p1) = (projection.point(c.p0), projection.point(c.p1));
    }
    // A shear does not leave circles round.
    if projection.shear == DVec3::ZERO {
        image.restrictions = parent.restrictions.iter().map(|r| r.moved(projection)).collect();
    } else {
        image.restrictions.clear();
    }
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
    Some(image)
}

impl Restriction {
    fn moved(&self, projection: &Projection) -> Self {
        match *self {
            Self::Cone { aim, cosine } => Self::Cone { aim: projection.direction(aim), cosine },
            Self::Beam { through, axis, radius } => {
                Self::Beam { through: projection.point(through), axis: projection.direction(axis), radius }
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

impl<O: Observer> Walk<'_, O> {
    /// The image that the ray is aimed at, if its hit is on the relay that forms it.
    pub(crate) fn relaying(&self, ray: &Ray<'_>) -> Option<Image> {
        let scene = self.tracer.scene;
        let image = scene.sources[ray.target? as usize].image?;
        let hit = ray.hit.as_ref()?;
        (scene.relays[image.relay as usize].object == hit.object).then_some(image)
    }

    /// The source to aim at next, if the ray's hit is on the relay of the image it is aimed at.
    pub(crate) fn relays_target(&self, ray: &Ray<'_>) -> Option<SourceId> {
        self.relaying(ray).map(|image| image.of)
    }

    /// Unit direction from a point to a source's centre.
    pub(crate) fn towards(&self, id: SourceId, point: DVec3) -> DVec3 {
        let source = &self.tracer.scene.sources[id as usize];
        if matches!(source.emitter, Emitter::Distant) {
            source.centre
        } else {
            (source.centre - point).normalize_or_zero()
        }
    }

    /// Radiance of an image towards a ray's point along `l`, with no obstacles on the folded path.
    pub(crate) fn relayed(&mut self, ray: &Ray<'_>, mut id: SourceId, mut l: DVec3) -> Rgb {
        let scene = self.tracer.scene;
        let mut from = *ray;
        let mut factor = Rgb::ONE;
        while let Some(image) = scene.sources[id as usize].image {
            let relay = &scene.relays[image.relay as usize];
            let Some((material, chain)) = relaying_material(&scene.modifiers, relay.modifier) else { return Rgb::ZERO };
            let both = matches!(material, Material::Prism(_));
            let Some(t) = relay.intersect(from.point, l, both) else { return Rgb::ZERO };
            let (mut child, _) = from.spawn(Kinds::SHADOW_REFLECTED, l, None, &self.tracer.options.limits, 0);
            child.distance = t;
            child.point = child.origin + l * t;
            child.hit = Some(relay.hit(t, l));
            if let Material::Prism(prism) = material {
                let sought = self.towards(image.of, child.point);
                let Some((k, onward)) = self.prism_branch(&child, prism, image.branch, sought) else {
                    return Rgb::ZERO;
                };
                factor *= k as f32;
                l = onward;
            } else {
                factor *= self.mirror_colour(&mut child, material, chain);
                l -= relay.normal * (2.0 * relay.normal.dot(l));
            }
            let (point, distance) = (child.point, child.travelled + t);
            from.point = point;
            from.travelled = distance;
            from.distance = 0.0;
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

    fn mirror_colour(&mut self, ray: &mut Ray<'_>, material: &Material, chain: ObjectId) -> Rgb {
        let Material::Mirror(mirror) = material else { return Rgb::ZERO };
        let mut finish = Finish { pattern: Rgb::ONE, tilt: DVec3::ZERO };
        if self.tracer.scene.modifiers.patterned(chain) {
            self.gather_patterns(ray, chain, &mut finish);
        }
        mirror.colour * finish.pattern
    }

    /// Light from an image by a shadow ray that starts towards its relay, or None if it is blocked.
    pub(crate) fn shadow_by_relay(&mut self, mut child: Ray<'_>, coefficient: Rgb) -> Option<Rgb> {
        let scene = self.tracer.scene;
        let relay = child.target.and_then(|t| scene.sources[t as usize].image).map(|i| &scene.relays[i.relay as usize]);
        if !O::ACTIVE
            && child.clipped == 0
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
