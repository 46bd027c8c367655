//! Function files as materials use them: to the channels of the hit come the perturbed normal, the material's colour and
//! the light sought, and lobes are functions of the direction to the light.

use super::Facing;
use crate::observer::Observer;
use crate::patterns::Functions;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, Rgb};
use ambit_cal::{CHANNELS, Channel, Fault, Flag, Inputs, Pass};

/// Values of all channels at one hit.
pub(super) type Channels = [f64; CHANNELS];

impl<O: Observer> Walk<'_, O> {
    /// The channels of a hit with those that only materials provide.
    pub(super) fn material_channels(
        &self,
        ray: &Ray<'_>,
        functions: &Functions,
        facing: &Facing,
        colour: Rgb,
    ) -> Channels {
        let mut c = self.channels(ray, functions);
        if functions.channels.intersects(ambit_cal::ChannelSet::MATERIAL) {
            let normal = self.function_frame(ray, &functions.placement).direction_back(facing.normal);
            put(&mut c, Channel::NxP, normal);
            c[Channel::RdotP as usize] = facing.cosine.clamp(-1.0, 1.0);
            put(&mut c, Channel::CrP, colour.as_dvec3());
        }
        c
    }

    /// As [`Walk::material_channels`], for materials whose functions see the surface turned to the viewer: N and Rdot, too.
    pub(super) fn turned_channels(
        &self,
        ray: &Ray<'_>,
        functions: &Functions,
        facing: &Facing,
        colour: Rgb,
    ) -> Channels {
        let mut c = self.material_channels(ray, functions, facing, colour);
        if ray.cosine() < 0.0 {
            let frame = self.function_frame(ray, &functions.placement);
            put(&mut c, Channel::Nx, frame.direction_back(facing.geometric));
            c[Channel::Rdot as usize] *= -1.0;
        }
        c
    }

    /// Runs programs on one hit. None if an operation failed or a value is no finite number; faults end the
    /// calculation.
    pub(super) fn run<const N: usize>(
        &mut self,
        channels: &Channels,
        functions: &Functions,
        run: impl FnOnce(&mut Pass<'_>) -> Result<[f64; N], Fault>,
    ) -> Option<[f64; N]> {
        let mut pass = self.work.cal.pass(Inputs { channels, reals: &functions.reals });
        match run(&mut pass) {
            Ok(values) if pass.flag() == Flag::Clear => values.iter().all(|v| v.is_finite()).then_some(values),
            Ok(_) => {
                self.tracer.scene.complaints.raise(functions.owner);
                None
            }
            Err(fault) => {
                self.evaluation_failed(&fault, functions.owner);
                None
            }
        }
    }

    /// The values of `N` successive expressions.
    pub(super) fn expressions<const N: usize>(
        &mut self,
        channels: &Channels,
        functions: &Functions,
        first: usize,
    ) -> Option<[f64; N]> {
        self.run(channels, functions, |pass| {
            let mut values = [0.0; N];
            for (value, program) in values.iter_mut().zip(&functions.programs[first..first + N]) {
                *value = pass.eval(program)?;
            }
            Ok(values)
        })
    }

    /// The vector that three expressions give, in world coordinates of a modifier outside instances.
    pub(super) fn axis(&mut self, channels: &Channels, functions: &Functions, first: usize) -> Option<DVec3> {
        let v: [f64; 3] = self.expressions(channels, functions, first)?;
        Some(functions.placement.direction(v.into()))
    }
}

/// Sets three successive channels.
pub(super) fn put(channels: &mut Channels, first: Channel, v: DVec3) {
    let i = first as usize;
    channels[i..i + 3].copy_from_slice(&v.to_array());
}
