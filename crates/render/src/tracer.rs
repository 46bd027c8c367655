//! What all threads share while a batch is computed, and the hemisphere samples it gives to the irradiance cache.

use crate::Options;
use crate::prepare::Prepared;
use crate::ray::{ClipSet, Fate, Interior, Kinds, Ray};
use crate::sources::Tally;
use crate::walk::Walk;
use crate::work::Work;
use ambit_ambient::{APART, Cache, Light, Miss, Query, Sample, SampleRay, Sampler};
use ambit_base::{DVec3, EPSILON, FAR, Rgb, Stream, Vec3};
use ambit_trace::Opacity;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Scene, options and frozen counts; one scratch memory a thread.
#[derive(Debug)]
pub(crate) struct Tracer<'s> {
    pub(crate) scene: &'s Prepared,
    pub(crate) options: &'s Options,
    pub(crate) tally: &'s Tally,
    pub(crate) works: &'s [Mutex<Work>],
}

/// What a diffuse question carries so that the path can go on from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Origin {
    level: i32,
    transmitted: bool,
    clipped: ClipSet,
    interior: Interior,
    travelled: f64,
    /// The largest channel of what the answer is multiplied by, at most 1.
    reflectance: f32,
    /// How far beside the point its hemisphere stands, scene units.
    beside: Vec3,
}

impl Origin {
    /// The path as it stands at a ray's hit, going on to the near or (`transmitted`) the far side.
    pub(crate) fn of(ray: &Ray<'_>, transmitted: bool, reflectance: f32) -> Self {
        Self {
            level: ray.level,
            transmitted,
            reflectance,
            clipped: if transmitted { ray.next_clipped } else { ray.clipped },
            interior: ray.interior,
            travelled: ray.travelled + ray.distance,
            beside: Vec3::ZERO,
        }
    }

    /// The same with a hemisphere that stands so far beside the point.
    pub(crate) fn moved(self, beside: Vec3) -> Self {
        Self { beside, ..self }
    }

    /// True if the path goes on to the far side.
    pub(crate) fn is_transmitted(&self) -> bool {
        self.transmitted
    }

    /// The ray by which the path goes on, for its depth and weight to be set.
    pub(crate) fn go_on(&self, position: DVec3, direction: DVec3, stream: Stream) -> Ray<'static> {
        let kind = if self.transmitted { Kinds::AMBIENT_TRANSMITTED } else { Kinds::AMBIENT_REFLECTED };
        let mut ray = Ray::primary(position + self.beside.as_dvec3(), direction, FAR, self.interior, stream);
        ray.kind = kind;
        ray.lineage = kind;
        ray.level = self.level;
        ray.clipped = self.clipped;
        ray.travelled = self.travelled;
        ray
    }
}

impl Tracer<'_> {
    /// A ray that is sent to answer a question to the cache; the limits have not been applied.
    #[expect(clippy::inline_always, reason = "a ray is large: built in place it is not copied")]
    #[inline(always)]
    pub(crate) fn hemisphere_ray(
        &self,
        query: &Query<Origin>,
        &SampleRay { direction, weight, stream, .. }: &SampleRay,
    ) -> Ray<'static> {
        let mut ray = query.origin.go_on(query.position, direction, stream);
        ray.level += i32::from(!query.origin.transmitted);
        ray.depth = query.level + 1;
        let actual = self.options.ambient.systems.actual_weights;
        ray.weight = query.weight * if actual { query.origin.reflectance } else { weight };
        ray
    }

    /// As [`Sampler::sample`].
    #[expect(clippy::inline_always, reason = "what it holds is large and on the path of every ray")]
    #[inline(always)]
    pub(crate) fn follow(
        &self,
        work: &mut Work,
        cache: &Cache,
        query: &Query<Origin>,
        sample: &SampleRay,
        misses: &mut Vec<Miss<Origin>>,
    ) -> Option<Sample> {
        let pass = sample.pass;
        let mut ray = self.hemisphere_ray(query, sample);
        match ray.fate(true, &self.options.limits) {
            Fate::Alive => {}
            // A path that Russian roulette ends brings nothing, and that is its fair share.
            Fate::Unlucky => return Some(Sample { light: Rgb::ZERO.into(), distance: FAR, normal: Vec3::ZERO }),
            Fate::Refused => return None,
        }
        let first = misses.len();
        work.late = [Rgb::ZERO; APART];
        let mut walk = Walk { tracer: self, cache, work, misses, pass, observer: () };
        walk.evaluate(&mut ray);
        let rest = walk.endless(first);
        let distance = ray.effective_length();
        // What is seen through glass or in a mirror lies in no plane that is known here.
        let normal = match ray.hit {
            Some(hit) if distance == hit.distance => hit.normal.as_vec3(),
            _ => Vec3::ZERO,
        };
        let light = Light { value: ray.value * ray.coefficient + rest, late: work.late };
        Some(Sample { light, distance, normal })
    }

    /// This thread's scratch memory. The lock is never waited for: each thread of the pool has its own, and a thread
    /// outside the pool works alone.
    pub(crate) fn work(&self) -> MutexGuard<'_, Work> {
        let slot = rayon::current_thread_index().map_or(0, |i| i + 1);
        self.works[slot % self.works.len()].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sampler for Tracer<'_> {
    type Origin = Origin;
    type Scratch<'a>
        = MutexGuard<'a, Work>
    where
        Self: 'a;

    fn scratch(&self) -> MutexGuard<'_, Work> {
        self.work()
    }

    fn sample(
        &self,
        work: &mut MutexGuard<'_, Work>,
        cache: &Cache,
        query: &Query<Origin>,
        sample: &SampleRay,
        misses: &mut Vec<Miss<Origin>>,
    ) -> Option<Sample> {
        self.follow(work, cache, query, sample, misses)
    }

    fn occluded(&self, query: &Query<Origin>, from: DVec3, direction: DVec3) -> bool {
        let length = direction.length();
        if length <= EPSILON {
            return false;
        }
        let unit = direction / length;
        let mut ray = ambit_trace::Ray { origin: from, direction: unit, limit: length };
        while let Some(hit) = self.scene.world.nearest(&ray) {
            let clipped =
                query.origin.clipped != 0 && self.scene.clip_sets.contains(query.origin.clipped, hit.modifier);
            let modifiers = &self.scene.modifiers;
            let stand_in = || modifiers.material(hit.modifier).is_some_and(|(m, _)| m.is_proxy());
            if !clipped && modifiers.opacity(hit.modifier) == Opacity::Opaque && !stand_in() {
                return true;
            }
            ray.origin += unit * hit.distance;
            ray.limit -= hit.distance;
            if ray.limit <= EPSILON {
                break;
            }
        }
        false
    }
}
