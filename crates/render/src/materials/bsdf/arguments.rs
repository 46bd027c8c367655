//! Arguments of BSDF and aBSDF.

use super::data::Distribution;
use crate::Error;
use crate::patterns::{Compiler, Functions};
use ambit_base::Rgb;
use ambit_scene::{Kind, ObjectId, Scene};
use std::sync::Arc;

/// A BSDF or aBSDF.
#[derive(Debug)]
pub(crate) struct Bsdf {
    pub(super) data: Arc<Distribution>,
    /// The up vector's coordinates, then (not for aBSDF) the thickness.
    pub(super) functions: Functions,
    /// aBSDF: looks for a peak to see through.
    pub(crate) see_through: bool,
    /// A stand-in for geometry: its thickness is not given as plain 0.
    pub(crate) proxy: bool,
    /// Lambertian reflectance of front and back and transmittance to add.
    pub(super) extra: [Rgb; 3],
}

impl Bsdf {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let see_through = scene.object(id).kind == Kind::ABsdf;
        let (expressions, file): (&[usize], usize) = if see_through { (&[1, 2, 3], 0) } else { (&[2, 3, 4, 0], 1) };
        let name = scene.string(id, file).ok_or_else(|| Error::primitive(scene, id, "bad # arguments"))?;
        let mut extra = [Rgb::ZERO; 3];
        for (sum, r) in extra.iter_mut().zip(scene.reals(id).chunks_exact(3)) {
            *sum = Rgb::new(r[0] as f32, r[1] as f32, r[2] as f32);
        }
        Ok(Self {
            data: compiler.files.distribution(scene, id, &name)?,
            functions: compiler.functions(scene, id, expressions, file + 4)?,
            see_through,
            proxy: !see_through && scene.string_bytes(id, 0) != Some(b"0"),
            extra,
        })
    }
}
