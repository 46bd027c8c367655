//! What the cache asks of its user (radiance along a direction) and what it is asked.

use crate::{Cache, Light};
use ambit_base::{DVec3, Rgb, Stream, Vec3};

/// A question for the diffuse indirect light at a point.
///
/// `origin` is opaque to the cache: what the user's sampler needs to continue the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<O> {
    /// The point on the surface, scene units.
    pub position: DVec3,
    /// The geometric normal on the side that is lit, unit length.
    pub normal: DVec3,
    /// The normal as textures turn it, unit length.
    pub shading: DVec3,
    /// The weight of the asking ray, 1 at the eye.
    pub weight: f32,
    /// The number of hemispheres open on the path, 0 at the eye.
    pub level: u8,
    /// The pass of a calculation by wavelength that asks, 0 if there is but one.
    pub pass: u8,
    /// The user's.
    pub origin: O,
}

/// A question the cache could not answer yet: the asker's radiance lacks `coefficient × answer(query)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miss<O> {
    /// What the answer is multiplied by, relative to the radiance of the ray that asked.
    pub coefficient: Rgb,
    /// The question.
    pub query: Query<O>,
}

/// What a hemisphere ray brought back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Radiance arriving against the ray, without the answers still missing.
    pub light: Light,
    /// Effective distance to what sends it, scene units; [`ambit_base::FAR`] if nothing was hit.
    pub distance: f64,
    /// The geometric normal of the surface that sends it, either side, unit length; 0 if that is none or unknown.
    pub normal: Vec3,
}

/// A hemisphere ray to trace.
#[derive(Clone, Copy, Debug)]
pub struct SampleRay {
    /// Unit length, world coordinates, pointing away from the query.
    pub direction: DVec3,
    /// What the ray's weight is multiplied by, beside the medium's extinction.
    pub weight: f32,
    /// Its random numbers.
    pub stream: Stream,
    /// The pass of a calculation by wavelength whose radiance is wanted, and that asks what the ray asks.
    pub pass: u8,
}

/// Traces rays for the cache.
pub trait Sampler: Sync {
    /// What a query carries for the sampler.
    type Origin: Copy + Send + Sync;
    /// What a thread keeps at hand while it traces several samples.
    type Scratch<'a>
    where
        Self: 'a;

    /// This thread's scratch memory; only one is asked for at a time.
    fn scratch(&self) -> Self::Scratch<'_>;

    /// The radiance that arrives at the query's position along `ray`, which weighs `query.weight × ray.weight × extinction`.
    ///
    /// Diffuse questions met on the way have level `query.level + 1`; those that
    /// `cache` answers are added at once, the others are pushed on `misses`, with coefficients relative to the radiance
    /// returned, and left out of it. None: the ray was refused by the limits of depth or weight. A ray that Russian
    /// roulette ends is not refused: it returns zero radiance. `misses` must be left as found when None is returned.
    fn sample(
        &self,
        scratch: &mut Self::Scratch<'_>,
        cache: &Cache,
        query: &Query<Self::Origin>,
        ray: &SampleRay,
        misses: &mut Vec<Miss<Self::Origin>>,
    ) -> Option<Sample>;

    /// True if an opaque surface crosses the segment `from + t · direction`, 0 < t < 1. `from` is the query's position.
    fn occluded(&self, query: &Query<Self::Origin>, from: DVec3, direction: DVec3) -> bool;
}

/// What [`Cache::ask`] knows about a query. Values are irradiance/π, to be multiplied by the asking coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Interpolated from records.
    Value(Light),
    /// The calculation stops here: the constant or running average that stands for the rest.
    Fallback(Rgb),
    /// No record qualifies: collect the query and hand it to [`Cache::resolve`].
    Miss,
    /// Caching is off: evaluate one [`crate::Hemisphere`] here.
    Uncached,
}
