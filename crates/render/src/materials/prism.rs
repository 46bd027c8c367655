//! prism1 and prism2: a pane that sends rays on in one or two other directions, each with a scalar coefficient, and
//! relays light sources as virtual ones.

use super::program::{Channels, put};
use crate::Error;
use crate::observer::Observer;
use crate::patterns::{Compiler, Functions, fill};
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Rgb};
use ambit_cal::{CHANNELS, Channel, Flag, Inputs, Scratch};
use ambit_scene::{Kind, ObjectId, Scene};

/// Arguments of prism1 or prism2.
#[derive(Debug)]
pub(crate) struct Prism {
    /// Coefficient and direction of each branch: four expressions.
    functions: Functions,
}

/// Expressions of a branch.
const BRANCH: usize = 4;

impl Prism {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let strings: &[usize] = match scene.object(id).kind {
            Kind::Prism1 => &[0, 1, 2, 3],
            _ => &[0, 1, 2, 3, 4, 5, 6, 7],
        };
        Ok(Self { functions: compiler.functions(scene, id, strings, strings.len())? })
    }

    /// How many ways light can take.
    pub(crate) fn branches(&self) -> u8 {
        (self.functions.programs.len() / BRANCH) as u8
    }

    /// Coefficient and unit direction of a branch for a ray that has hit, while no source is sought. For use before
    /// there is a scene to walk; the prism is in none of its instances.
    pub(crate) fn deflect(&self, ray: &Ray<'_>, branch: u8) -> Option<(f64, DVec3)> {
        let mut channels = [0.0; CHANNELS];
        fill(&mut channels, self.functions.channels, ray, &self.functions.placement);
        let mut scratch = Scratch::new();
        let mut pass = scratch.pass(Inputs { channels: &channels, reals: &self.functions.reals });
        let mut values = [0.0; BRANCH];
        for (value, program) in values.iter_mut().zip(&self.functions.programs[usize::from(branch) * BRANCH..]) {
            *value = pass.eval(program).ok()?;
        }
        if pass.flag() != Flag::Clear {
            return None;
        }
        let (k, direction) = split(values)?;
        Some((k, self.functions.placement.direction(direction)))
    }
}

/// Coefficient and unit direction, unless there is nothing to send.
fn split([k, x, y, z]: [f64; BRANCH]) -> Option<(f64, DVec3)> {
    let direction = DVec3::new(x, y, z).try_normalize()?;
    (k > EPSILON).then_some((k, direction))
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn prism(&mut self, ray: &mut Ray<'_>, m: &Prism) -> bool {
        let image = self.relaying(ray);
        if ray.target.is_some() && image.is_none() {
            return true;
        }
        let branches = image.map_or(0..m.branches(), |i| i.branch..i.branch + 1);
        let sought = image.map_or(DVec3::ZERO, |i| self.towards(i.of, ray.point));
        for branch in branches {
            let Some((k, direction)) = self.prism_branch(ray, m, branch, sought) else { continue };
            let k = Rgb::splat(k as f32);
            let tag = 3 + u64::from(branch);
            let Some(mut child) = self.child(ray, Kinds::TRANSFERRED, direction, k, tag) else { continue };
            child.target = image.map(|i| i.of);
            self.evaluate(&mut child);
            let light = child.coefficient * child.value;
            let beyond = child.length_of(light);
            ray.value += light;
            if self.is_flat(ray) {
                ray.unmirrored_length = ray.distance + beyond;
            }
        }
        true
    }

    /// Coefficient and unit direction of a branch at a hit; `sought` is the unit direction to the source that the ray
    /// is to reach, or zero.
    pub(crate) fn prism_branch(&mut self, ray: &Ray<'_>, m: &Prism, branch: u8, sought: DVec3) -> Option<(f64, DVec3)> {
        let functions = &m.functions;
        let frame = self.function_frame(ray, &functions.placement);
        let mut channels: Channels = self.channels(ray, functions);
        put(&mut channels, Channel::DxA, frame.direction_back(sought));
        let values = self.expressions(&channels, functions, usize::from(branch) * BRANCH)?;
        let (k, direction) = split(values)?;
        Some((k, frame.direction(direction)))
    }
}
