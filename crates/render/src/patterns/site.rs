//! What a function file sees of a hit: the channels, in the coordinates that the function is written in.

use super::compiler::Functions;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{DVec3, Transform};
use ambit_cal::{CHANNELS, Channel, ChannelSet};

impl<O: Observer> Walk<'_, O> {
    /// The transform from a function's coordinates to the world: the modifier's own, then the instance's.
    pub(crate) fn function_frame(&self, ray: &Ray<'_>, placement: &Transform) -> Transform {
        match ray.hit.as_ref().and_then(|h| h.placement) {
            Some(i) => placement.then(&self.tracer.scene.world.placement(i)),
            None => *placement,
        }
    }

    /// Fills the channels that `functions` reads.
    pub(crate) fn channels(&self, ray: &Ray<'_>, functions: &Functions) -> [f64; CHANNELS] {
        let mut c = [0.0; CHANNELS];
        let wanted = functions.channels;
        if !wanted.is_empty() {
            fill(&mut c, wanted, ray, &self.function_frame(ray, &functions.placement));
        }
        c
    }
}

/// Fills the wanted channels of a hit; `frame` carries the function's coordinates to the world.
pub(crate) fn fill(c: &mut [f64; CHANNELS], wanted: ChannelSet, ray: &Ray<'_>, frame: &Transform) {
    let mut set = |first: Channel, v: DVec3| {
        let i = first as usize;
        c[i..i + 3].copy_from_slice(&v.to_array());
    };
    let (normal, cosine, uv) = match &ray.hit {
        Some(h) => (h.normal, h.cosine, h.uv),
        None => (-ray.direction, 1.0, [0.0; 2]),
    };
    if wanted.intersects(ChannelSet::of(&[Channel::Dx, Channel::Dy, Channel::Dz])) {
        set(Channel::Dx, frame.direction_back(ray.direction));
    }
    if wanted.intersects(ChannelSet::of(&[Channel::Nx, Channel::Ny, Channel::Nz])) {
        set(Channel::Nx, frame.direction_back(normal));
    }
    if wanted.intersects(ChannelSet::of(&[Channel::Px, Channel::Py, Channel::Pz])) {
        set(Channel::Px, frame.point_back(ray.point));
    }
    set(Channel::Tx, frame.point_back(DVec3::ZERO));
    set(Channel::Ix, frame.direction_back(DVec3::X));
    set(Channel::Jx, frame.direction_back(DVec3::Y));
    set(Channel::Kx, frame.direction_back(DVec3::Z));
    let scale = 1.0 / frame.scale().abs();
    c[Channel::S as usize] = scale;
    c[Channel::T as usize] = (ray.travelled + ray.distance) * scale;
    c[Channel::Ts as usize] = shadow_length(ray) * scale;
    c[Channel::Rdot as usize] = cosine.clamp(-1.0, 1.0);
    c[Channel::Lu as usize] = uv[0];
    c[Channel::Lv as usize] = uv[1];
}

/// Length of this segment and of the shadow rays right before it.
fn shadow_length(ray: &Ray<'_>) -> f64 {
    let mut sum = ray.distance;
    let mut link = ray;
    while link.kind.meets(Kinds::SHADOW) {
        let Some(parent) = link.parent else { break };
        if !parent.kind.meets(Kinds::SHADOW) {
            break;
        }
        sum += parent.distance;
        link = parent;
    }
    sum
}
