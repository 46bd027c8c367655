//! Textures: tilts of the surface normal.

use super::compiler::{Compiler, Functions};
use crate::Error;
use crate::materials::Finish;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::DVec3;
use ambit_scene::{Kind, ObjectId, Scene};

/// A compiled texture.
#[derive(Debug)]
pub(crate) enum Texture {
    /// texfunc.
    Function(Functions),
}

impl Texture {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        match scene.object(id).kind {
            Kind::TexFunc => Ok(Self::Function(compiler.functions(scene, id, &[0, 1, 2], 3)?)),
            _ => Err(Error::unsupported(scene, id)),
        }
    }
}

impl Walk<'_> {
    /// Adds a texture's tilt, carried to world coordinates at its length.
    pub(crate) fn apply_texture(&mut self, ray: &Ray<'_>, texture: &Texture, finish: &mut Finish) {
        match texture {
            Texture::Function(functions) => {
                if let Some(tilt) = self.three(ray, functions) {
                    let frame = self.function_frame(ray, &functions.placement);
                    finish.tilt += frame.direction(DVec3::from(tilt));
                }
            }
        }
    }
}
