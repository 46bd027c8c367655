//! Textures: tilts of the surface normal.

use super::compiler::{Compiler, Functions};
use super::lookup::{Layout, Lookup};
use crate::Error;
use crate::materials::Finish;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::DVec3;
use ambit_scene::{Kind, ObjectId, Scene};

/// A compiled texture.
#[derive(Debug)]
pub(crate) enum Texture {
    /// texfunc.
    Function(Functions),
    /// texdata.
    Data(Lookup),
}

impl Texture {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        match scene.object(id).kind {
            Kind::TexFunc => compiler.functions(scene, id, &[0, 1, 2], 3)?.without_material().map(Self::Function),
            Kind::TexData => Lookup::compile(scene, id, compiler, Layout::TEXDATA, true).map(Self::Data),
            _ => Err(Error::unsupported(scene, id)),
        }
    }
}

impl<O: Observer> Walk<'_, O> {
    /// Adds a texture's tilt, carried to world coordinates at its length.
    pub(crate) fn apply_texture(&mut self, ray: &Ray<'_>, texture: &Texture, finish: &mut Finish) {
        let (tilt, functions) = match texture {
            Texture::Function(functions) => (self.vector(ray, functions), functions),
            Texture::Data(lookup) => (self.look_up(ray, lookup), lookup.functions()),
        };
        if let Some(tilt) = tilt {
            let frame = self.function_frame(ray, &functions.placement);
            finish.tilt += frame.direction(DVec3::from(tilt));
        }
    }
}
