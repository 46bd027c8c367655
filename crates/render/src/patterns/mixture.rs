//! Mixtures: two modifiers blended.

use super::compiler::{Compiler, Functions};
use super::lookup::{Layout, Lookup};
use crate::Error;
use crate::materials::{Facing, Finish};
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{Colour, EPSILON};
use ambit_file::text_of;
use ambit_scene::{Kind, ObjectId, Scene, TextBlock, VOID};

/// A compiled mixture.
#[derive(Debug)]
pub(crate) struct Mixture {
    /// The two sides; [`VOID`] is transparent.
    pub(crate) sides: [ObjectId; 2],
    id: ObjectId,
    share: Share,
}

/// How the foreground's share is found.
#[derive(Debug)]
enum Share {
    /// mixfunc.
    Function(Functions),
    /// mixdata, mixpict.
    Lookup(Lookup),
    /// mixtext: all inside glyphs, nothing elsewhere.
    Text(Box<TextBlock>),
}

/// Index of mixtext's spacing among its numbers.
const MIXTEXT_SPACING: usize = 9;

impl Mixture {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let share = match scene.object(id).kind {
            Kind::MixFunc => Share::Function(compiler.functions(scene, id, &[2], 3)?.without_material()?),
            Kind::MixData => Share::Lookup(Lookup::compile(scene, id, compiler, Layout::MIXDATA, true)?),
            Kind::MixPict => Share::Lookup(Lookup::compile(scene, id, compiler, Layout::MIXPICT, true)?),
            Kind::MixText => Share::Text(compiler.lettering(scene, id, 2, MIXTEXT_SPACING)?.into()),
            _ => return Err(Error::unsupported(scene, id)),
        };
        let side = |i: usize| {
            let name = scene.string_bytes(id, i).unwrap_or_default();
            if name == b"void" {
                return Ok(VOID);
            }
            scene.modifier_before(name, id).ok_or_else(|| {
                let name = text_of(name);
                Error::primitive(scene, id, &format!("undefined modifier \"{name}\""))
            })
        };
        Ok(Self { sides: [side(0)?, side(1)?], id, share })
    }
}

impl<O: Observer> Walk<'_, O> {
    /// Applies a mixture. Where a side has a material the hit is shaded and the answer is whether it was; otherwise
    /// the sides' patterns and textures are blended into `finish` and there is no answer: the chain goes on.
    pub(crate) fn mix(
        &mut self,
        ray: &mut Ray<'_>,
        mixture: &Mixture,
        next: ObjectId,
        finish: &mut Finish,
    ) -> Option<bool> {
        let fore = match &mixture.share {
            Share::Function(functions) => self.three(ray, functions)?[0].clamp(0.0, 1.0),
            Share::Lookup(lookup) => self.look_up(ray, lookup)?[0].clamp(0.0, 1.0),
            Share::Text(text) => f64::from(u8::from(self.lettered(ray, text))),
        };
        let shares = [fore, 1.0 - fore];
        let scene = self.tracer.scene;
        // A side without a share is as if it were not there.
        let solid = |(&side, share): (&ObjectId, f64)| share > EPSILON && scene.modifiers.has_material(side);
        let solid = mixture.sides.iter().zip(shares).any(solid);
        if !solid {
            let mut blend = Finish { pattern: finish.pattern * 0.0, tilt: finish.tilt * 0.0 };
            for (&side, share) in mixture.sides.iter().zip(shares) {
                if share > EPSILON {
                    let mut own = *finish;
                    if !self.gather(ray, side, &mut own) {
                        return Some(true);
                    }
                    blend.pattern += own.pattern * share as f32;
                    blend.tilt += own.tilt * share;
                }
            }
            *finish = blend;
            return None;
        }
        if next != VOID {
            self.fail(Error::primitive(&scene.objects, mixture.id, "inappropriate modifier"));
            return Some(true);
        }
        ray.normal = Facing::of(ray, finish.tilt, false).normal;
        let mut parts = shares.map(|share| {
            (share > EPSILON).then(|| {
                let mut part = *ray;
                part.weight *= share as f32;
                part.throughput *= share as f32;
                (part, share as f32)
            })
        });
        // A side without material lets its ray pass after the other one is shaded: ray trees show it in that order.
        let mut passing = [false; 2];
        for ((part, &side), passes) in parts.iter_mut().zip(&mixture.sides).zip(&mut passing) {
            if let Some((part, _)) = part {
                *passes = !self.shade_with(part, side, *finish);
            }
        }
        for (part, passes) in parts.iter_mut().zip(passing) {
            if let (Some((part, _)), true) = (part, passes) {
                self.pass_through(part);
            }
        }
        let (mut most, mut most_mirrored) = (-1.0, -1.0);
        for (part, k) in parts.into_iter().flatten() {
            ray.value += part.value * k;
            ray.mirrored += part.mirrored * k;
            let mirrored = part.mirrored.brightness() * k;
            let other = part.value.brightness() * k - mirrored;
            // Of equals, as where all is black, the latter counts.
            if mirrored >= most_mirrored {
                most_mirrored = mirrored;
                ray.mirrored_length = part.mirrored_length;
            }
            if other >= most {
                most = other;
                ray.unmirrored_length = part.unmirrored_length;
            }
        }
        Some(true)
    }
}
