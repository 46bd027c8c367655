//! Patterns: factors on the colour.

use super::compiler::{Compiler, Functions};
use super::lookup::{Layout, Lookup};
use super::spectral::{self, Spectral};
use crate::Error;
use crate::materials::Finish;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::Rgb;
use ambit_scene::{Kind, ObjectId, Scene, TextBlock};

/// A compiled pattern.
#[derive(Debug)]
pub(crate) enum Pattern {
    /// brightfunc, colorfunc: one expression for all channels, or one for each.
    Function(Functions),
    /// brightdata: one value for all channels.
    Bright(Lookup),
    /// colordata, colorpict.
    Colour(Lookup),
    /// brighttext, colortext.
    Text {
        /// The glyphs.
        text: Box<TextBlock>,
        /// Factor inside glyphs.
        fore: Rgb,
        /// Factor elsewhere.
        back: Rgb,
    },
    /// spectrum, specfile.
    Constant(Rgb),
    /// The same in several passes.
    Constants(Box<[Rgb]>),
    /// specfunc, specdata, specpict.
    Spectral(Box<Spectral>),
}

/// Where the numbers of a text begin after its origin and motion vectors.
const TEXT_COLOURS: usize = 9;

impl Pattern {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let mut functions = |expressions: &[usize], file| {
            compiler.functions(scene, id, expressions, file)?.without_material().map(Self::Function)
        };
        let r = scene.reals(id);
        match scene.object(id).kind {
            Kind::BrightFunc => functions(&[0], 1),
            Kind::ColorFunc => functions(&[0, 1, 2], 3),
            Kind::BrightData => Lookup::compile(scene, id, compiler, Layout::BRIGHTDATA, false).map(Self::Bright),
            Kind::ColorData => Lookup::compile(scene, id, compiler, Layout::COLORDATA, false).map(Self::Colour),
            Kind::ColorPict => Lookup::compile(scene, id, compiler, Layout::COLORPICT, false).map(Self::Colour),
            Kind::BrightText => {
                let text = compiler.lettering(scene, id, 0, TEXT_COLOURS + 2)?.into();
                let grey = |i: usize| Rgb::splat(r[TEXT_COLOURS + i] as f32);
                Ok(Self::Text { text, fore: grey(0), back: grey(1) })
            }
            Kind::ColorText => {
                let text = compiler.lettering(scene, id, 0, TEXT_COLOURS + 6)?.into();
                let colour = |i: usize| Rgb::new(r[i] as f32, r[i + 1] as f32, r[i + 2] as f32);
                Ok(Self::Text { text, fore: colour(TEXT_COLOURS), back: colour(TEXT_COLOURS + 3) })
            }
            Kind::Spectrum => spectral::spectrum(scene, id, compiler),
            Kind::SpecFile => spectral::specfile(scene, id, compiler),
            Kind::SpecFunc | Kind::SpecData | Kind::SpecPict => Spectral::compile(scene, id, compiler),
            _ => Err(Error::unsupported(scene, id)),
        }
    }

    /// True if passes of a calculation by wavelength differ in it.
    pub(crate) fn is_spectral(&self) -> bool {
        matches!(self, Self::Constants(_) | Self::Spectral(_))
    }
}

impl<O: Observer> Walk<'_, O> {
    /// Multiplies the colour by a pattern; one that has no value here leaves it alone.
    pub(crate) fn apply_pattern(&mut self, ray: &Ray<'_>, pattern: &Pattern, finish: &mut Finish) {
        let value = match pattern {
            Pattern::Function(functions) => self.three(ray, functions),
            Pattern::Bright(lookup) => self.look_up(ray, lookup).map(|v| [v[0]; 3]),
            Pattern::Colour(lookup) => self.look_up(ray, lookup),
            Pattern::Text { text, fore, back } => {
                finish.pattern *= if self.lettered(ray, text) { *fore } else { *back };
                return;
            }
            Pattern::Constant(colour) => {
                finish.pattern *= *colour;
                return;
            }
            Pattern::Constants(passes) => {
                finish.pattern *= passes[usize::from(self.pass)];
                return;
            }
            Pattern::Spectral(spectral) => self.spectral(ray, spectral).map(|c| c.as_dvec3().to_array()),
        };
        if let Some([r, g, b]) = value {
            finish.pattern *= Rgb::new(r as f32, g as f32, b as f32);
        }
    }
}
