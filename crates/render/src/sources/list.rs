//! Which surfaces are light sources: those of the main scene whose material emits.

use super::emitter::{Geometry, Source};
use crate::Error;
use crate::materials::{Light, Material};
use crate::prepare::{Environment, Modifiers};
use ambit_base::{EPSILON, FAR};
use ambit_scene::{Class, Kind, ObjectId, Scene, Shape};

/// The sources among the objects `top_level`, in scene order. `indirect` tells whether light is followed from surface
/// to surface; without it and without sources a warning says that all will be dark, unless darkness is `fine`.
pub(crate) fn find_sources(
    scene: &Scene,
    top_level: std::ops::Range<ObjectId>,
    modifiers: &Modifiers,
    indirect: bool,
    fine: bool,
    environment: &Environment<'_>,
) -> Result<Vec<Source>, Error> {
    let mut found = Vec::new();
    let mut lit = false;
    for id in top_level {
        let object = scene.object(id);
        if object.kind.class() != Class::Surface {
            continue;
        }
        let Some(node) = modifiers.light(scene, object.modifier)? else { continue };
        if let Some(source) = source(scene, id, node, modifiers, environment)? {
            // A glow that is not sampled lights something only by interreflection.
            lit |= source.sampled || (source.glow && indirect);
            found.push(source);
        } else {
            lit |= indirect && node.kind == Kind::Glow && node.emission.max_element() > EPSILON as f32;
        }
    }
    if !lit && !fine {
        environment.notify.warn("no light sources found");
    }
    Ok(found)
}

fn source(
    scene: &Scene,
    id: ObjectId,
    light: &Light,
    modifiers: &Modifiers,
    environment: &Environment<'_>,
) -> Result<Option<Source>, Error> {
    let object = scene.object(id);
    let distant = object.kind == Kind::Source;
    let glow = light.kind == Kind::Glow;
    if light.emission.max_element() <= EPSILON as f32 || (glow && !distant && light.radius <= EPSILON) {
        return Ok(None);
    }
    let bad = |text: &str| Error::primitive(scene, id, text);
    let (shape, _) = Shape::from_object(scene, id)?;
    let Geometry { emitter, centre, axes, size, radius, normal } = Source::from_shape(shape).map_err(bad)?;
    let mut sampled = !(distant && glow);
    if let Some(spot) = &light.spot {
        if distant {
            environment.notify.warn(&format!("distant source is a spotlight for {}", scene.describe(id)));
        } else if normal.length_squared() > 0.0 && misdirected(spot.aim.dot(normal), spot.cosine) {
            environment.notify.warn(&format!("invalid spotlight direction for {}", scene.describe(id)));
            sampled = false;
        }
    }
    Ok(Some(Source {
        object: id,
        modifier: object.modifier,
        emitter,
        centre,
        axes,
        size,
        radius,
        extent: SPREAD * axes.iter().map(|a| a.length_squared()).sum::<f64>().sqrt(),
        normal,
        emission: light.emission,
        patterned: modifiers.patterned(object.modifier),
        reach: if glow && !distant { light.radius } else { FAR },
        glow,
        illum: light.kind == Kind::Illum,
        clear: light.is_clear_illum(),
        spot: light.spot,
        sampled,
        image: None,
        restrictions: Vec::new(),
    }))
}

/// How far samples may lie outside the box of a source's half-axes, where square coordinates are bent to a disc or ball.
const SPREAD: f64 = 1.5;

/// True if a spotlight of half-angle acos(`half`) about an aim at `cosine` to the normal is dropped: where it points
/// backwards but not so far that the sine of its angle would be exceeded. (A cone wholly behind the surface lights
/// nothing anyway.)
fn misdirected(cosine: f64, half: f64) -> bool {
    let sine = (1.0 - half * half).max(0.0).sqrt();
    (-sine..=0.0).contains(&cosine)
}

impl Modifiers {
    /// The light-source material that a chain leads to, if it does; a faulty one is an error.
    pub(crate) fn light(&self, scene: &Scene, modifier: ObjectId) -> Result<Option<&Light>, Error> {
        match self.material(modifier) {
            Some((Material::Light(light), _)) => Ok(Some(light)),
            Some(_) => Ok(None),
            None => self.faulty_light(scene, modifier).map_or(Ok(None), Err),
        }
    }
}
