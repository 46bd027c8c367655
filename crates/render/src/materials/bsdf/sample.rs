//! Rays that sample a lobe, and what weak lobes add to the ambient part instead.

use super::material::Lit;
use super::through::distance_squared;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, EPSILON, Rgb, mix};

/// Above this `-ss` a lobe gets more than one ray.
const SEVERAL_FROM: f64 = 1.5;
/// Tags of the two lobes.
const REFLECTION: u64 = 0xb1;
const TRANSMISSION: u64 = 0xb2;
/// Tag of the view's jitter.
const JITTER: u64 = 0xb3;

/// Which lobe is sampled, and where its rays start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampling {
    pub(super) transmitted: bool,
    pub(super) origin: DVec3,
}

/// Draws a pair of numbers towards the middle by `-ss` below 1.
fn narrowed(x: f64, sampling: f64) -> f64 {
    if (0.0..1.0).contains(&sampling) { 0.5 + sampling * (x - 0.5) } else { x }
}

impl<O: Observer> Walk<'_, O> {
    /// Samples the reflected or transmitted lobe; the total of one that is too weak to be sampled is returned for the
    /// ambient part.
    pub(super) fn sample_bsdf(&mut self, ray: &mut Ray<'_>, lit: &Lit<'_>, sampling: Sampling) -> f32 {
        let scattering = if sampling.transmitted { lit.transmission } else { lit.reflection };
        let Some(lobe) = &scattering.lobe else { return 0.0 };
        let through = lit.through.as_ref().filter(|_| sampling.transmitted);
        let tag = if sampling.transmitted { TRANSMISSION } else { REFLECTION };
        let stream = ray.stream.child(mix(tag, u64::from(ray.material)));
        // How far views are moved, and how much around each is the peak. Each use of the view moves it anew.
        let area = lobe.size(lit.view);
        let jittered = |i: u32| {
            if lit.jitter > 0.0 { lit.jittered(area, stream.child(mix(JITTER, u64::from(i))).two()) } else { lit.view }
        };
        let total = lobe.total(jittered(0));
        let options = &self.tracer.options.specular;
        // What the pattern keeps from the peak counts as scattered: so Radiance has it.
        let seen = through.map_or(0.0, |t| (t.colour * lit.pattern).brightness());
        let rest = (total - f64::from(seen)).max(0.0);
        if rest <= options.threshold + EPSILON {
            return rest as f32;
        }
        let ss = options.sampling;
        let wanted = if ss > SEVERAL_FROM { (ss * f64::from(ray.weight) + 0.5).floor().max(1.0) as u32 } else { 1 };
        let kind = if sampling.transmitted { Kinds::SPECULAR_TRANSMITTED } else { Kinds::SPECULAR_REFLECTED };
        let hemisphere = if sampling.transmitted { -lit.view.z } else { lit.view.z };
        let mut sum = Rgb::ZERO;
        for i in 0..wanted {
            let numbers = if i == 0 { stream.two() } else { stream.split(tag, i).two() };
            let view = jittered(i + 1);
            let Some(mut local) = lobe.sample(view, numbers.map(|x| narrowed(x, ss))) else { continue };
            local.z = local.z.copysign(hemisphere);
            if through.is_some() && distance_squared(view, local) <= area {
                continue;
            }
            // Where a texture tilts the normal, some go to the wrong side of the surface. Their light is not lost.
            let direction = lit.axes.to_world(local).normalize();
            let Some(cell) = lobe.cell(view, local) else { continue };
            let mut k = lobe.colour(&cell, view, local).hue() * (lobe.total(view) / f64::from(wanted)) as f32;
            if sampling.transmitted {
                k *= lit.pattern;
            }
            let Some(mut child) = self.child(ray, kind, direction, k, mix(tag, u64::from(i))) else { continue };
            child.origin = sampling.origin;
            self.evaluate(&mut child);
            sum += child.coefficient * child.value;
        }
        ray.value += sum;
        0.0
    }
}
