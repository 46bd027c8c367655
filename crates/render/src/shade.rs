//! From a hit to its material: the chain of modifiers is walked from the surface upwards; patterns multiply the
//! colour, textures tilt the normal, a mixture splits the walk, a material ends it.

use crate::Error;
use crate::materials::{Facing, Finish};
use crate::observer::Observer;
use crate::prepare::Node;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, Rgb};
use ambit_scene::{ObjectId, VOID};

impl<O: Observer> Walk<'_, O> {
    /// Shades a ray at its hit; false if it goes on as if nothing were there.
    pub(crate) fn shade(&mut self, ray: &mut Ray<'_>) -> bool {
        let (modifier, tilt) = ray.hit.as_ref().map_or((VOID, DVec3::ZERO), |h| (h.modifier, h.tilt));
        self.shade_with(ray, modifier, Finish { pattern: Rgb::ONE, tilt })
    }

    /// Walks the chain from `id` with what has been gathered already.
    pub(crate) fn shade_with(&mut self, ray: &mut Ray<'_>, mut id: ObjectId, mut finish: Finish) -> bool {
        let scene = self.tracer.scene;
        while id != VOID {
            let (node, definition, next) = scene.modifiers.get(id);
            match node {
                Node::Material(material) => {
                    let bare = finish;
                    // What materials tell that turn no normal to the viewer.
                    Self::note_normal(ray, bare.tilt);
                    if next != VOID && material.takes_finish() && !self.gather(ray, next, &mut finish) {
                        return true;
                    }
                    ray.material = definition;
                    return self.material(ray, material, finish, &bare);
                }
                Node::Mixture(mixture) => {
                    if let Some(shaded) = self.mix(ray, mixture, next, &mut finish) {
                        return shaded;
                    }
                }
                Node::Pattern(pattern) => self.apply_pattern(ray, pattern, &mut finish),
                Node::Texture(texture) => self.apply_texture(ray, texture, &mut finish),
                Node::Transparent => {}
                Node::Unusable(error) => {
                    self.fail(error.clone());
                    return true;
                }
            }
            id = next;
        }
        Self::note_normal(ray, finish.tilt);
        false
    }

    /// Notes the tilted normal, not turned to the viewer, of rays that are told of; nothing else asks for it.
    #[inline]
    pub(crate) fn note_normal(ray: &mut Ray<'_>, tilt: DVec3) {
        if (O::ACTIVE || ray.parent.is_none()) && tilt != DVec3::ZERO {
            ray.normal = Facing::of(ray, tilt, false).normal;
        }
    }

    /// Applies a material's own modifiers, which may only be patterns, textures and mixtures of such; false on error.
    pub(crate) fn gather(&mut self, ray: &mut Ray<'_>, mut id: ObjectId, finish: &mut Finish) -> bool {
        let scene = self.tracer.scene;
        while id != VOID {
            let (node, definition, next) = scene.modifiers.get(id);
            match node {
                Node::Material(_) => {
                    let surface = ray.hit.as_ref().map_or(VOID, |h| h.object);
                    self.fail(Error::conflicting_material(&scene.objects, definition, surface));
                    return false;
                }
                Node::Mixture(mixture) => {
                    if self.mix(ray, mixture, next, finish).is_some() {
                        return false;
                    }
                }
                Node::Pattern(pattern) => self.apply_pattern(ray, pattern, finish),
                Node::Texture(texture) => self.apply_texture(ray, texture, finish),
                // Radiance applies what has another name twice, with all above it.
                Node::Transparent => {
                    if !self.gather(ray, next, finish) {
                        return false;
                    }
                }
                Node::Unusable(error) => {
                    self.fail(error.clone());
                    return false;
                }
            }
            id = next;
        }
        true
    }

    /// Applies the patterns of a whole chain, whatever material stands on it.
    pub(crate) fn gather_patterns(&mut self, ray: &Ray<'_>, mut id: ObjectId, finish: &mut Finish) {
        let scene = self.tracer.scene;
        while id != VOID {
            let (node, _, next) = scene.modifiers.get(id);
            if let Node::Pattern(pattern) = node {
                self.apply_pattern(ray, pattern, finish);
            }
            id = next;
        }
    }

    /// True if the hits of the surface that was hit share one normal.
    pub(crate) fn is_flat(&self, ray: &Ray<'_>) -> bool {
        ray.hit.as_ref().is_some_and(|h| self.tracer.scene.is_flat(h.object))
    }

    /// True if the surface's immediate modifier is called `Phong`, which keeps textures from bending rays.
    pub(crate) fn is_phong(&self, ray: &Ray<'_>) -> bool {
        ray.hit
            .as_ref()
            .is_some_and(|h| h.modifier != VOID && self.tracer.scene.objects.name_bytes(h.modifier) == b"Phong")
    }
}
