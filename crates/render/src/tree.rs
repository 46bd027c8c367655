//! Ray trees: one primary ray with all the rays that follow from it, each shown as it finishes.
//!
//! The walk is serial and watched by an observer. What the irradiance cache does not know is resolved first, as always;
//! then the ray is followed once more, when the cache answers everything, and the rays of the hemispheres that were
//! sampled for it are followed again where the question was asked.

use crate::Error;
use crate::braid::braid;
use crate::observer::Observer;
use crate::ray::{Fate, Kinds, Ray};
use crate::renderer::Renderer;
use crate::reply::Reply;
use crate::request::{Answer, Request};
use crate::spectral::{Bins, Spectra};
use crate::tracer::{Origin, Tracer};
use crate::walk::Walk;
use crate::work::Work;
use ambit_ambient::{Cache, Miss, Query, Sample, SampleRay, Sampler};
use ambit_base::{DVec3, Notify, Rgb, hash_bits, hash_point};
use ambit_scene::ObjectId;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How often a ray's questions are resolved before it is shown. Once nearly always does.
const MOST_ROUNDS: usize = 8;

/// The names of objects, as the bytes that the scene has.
pub type Names<'n> = &'n dyn Fn(ObjectId, ObjectId) -> &'n [u8];

/// What is shown a ray, its bins and what finds names.
pub type Visit<'v> = &'v mut dyn FnMut(&TreeRay, Option<Bins<'_>>, Names<'_>);

/// A ray of a tree.
#[derive(Clone, Copy, Debug)]
pub struct TreeRay {
    /// Number of rays between it and the eye; 0 for the primary ray.
    pub depth: usize,
    /// What it met. `value` lacks the medium on its own way, which `coefficient` holds: that is its share of the primary
    /// ray's value, and 0 if the ray was aimed at a light source and ends elsewhere.
    pub answer: Answer,
    /// What it brings to the primary ray's value.
    pub contribution: Rgb,
    /// True for a shadow ray that reaches its source and meets nothing else on the way.
    pub clear_shadow: bool,
}

/// Shows rays as they finish.
struct Watch<'v> {
    visit: &'v mut dyn FnMut(&TreeRay),
    hemispheres: &'v mut Hemispheres,
}

/// The rays that were sent for questions to the cache, by what identifies a question and the pass.
type Hemispheres = HashMap<u64, Vec<SampleRay>>;

fn key(query: &Query<Origin>, pass: u8) -> u64 {
    hash_bits(&[hash_point(query.position), hash_point(query.normal), u64::from(query.level), u64::from(pass)])
}

impl Observer for &mut Watch<'_> {
    const ACTIVE: bool = true;

    fn finished(&mut self, tracer: &Tracer<'_>, ray: &Ray<'_>) {
        let mut answer = tracer.describe(ray, true);
        answer.make_finite();
        let share = ray.throughput * ray.attenuation();
        let hits_target = tracer.ends_at_target(ray);
        answer.coefficient = if ray.target.is_none() || hits_target { share } else { Rgb::ZERO };
        let direct = ray.target.is_some_and(|t| tracer.scene.sources[t as usize].image.is_none());
        (self.visit)(&TreeRay {
            depth: depth(ray),
            contribution: share * answer.value,
            clear_shadow: ray.kind.meets(Kinds::SHADOW) && direct && hits_target,
            answer,
        });
    }

    fn take_hemisphere(&mut self, query: &Query<Origin>) -> Option<Vec<SampleRay>> {
        self.hemispheres.remove(&key(query, query.pass))
    }
}

/// Ancestors of a ray. Light that a medium scatters has none.
fn depth(ray: &Ray<'_>) -> usize {
    let mut count = 0;
    let mut link = ray;
    while let Some(parent) = link.parent
        && parent.kind != Kinds::NONE
    {
        count += 1;
        link = parent;
    }
    count
}

impl Tracer<'_> {
    /// True if a ray ends at the source it is aimed at, or at the relay of the image it is aimed at.
    fn ends_at_target(&self, ray: &Ray<'_>) -> bool {
        let (Some(target), Some(hit)) = (ray.target, &ray.hit) else { return false };
        let source = &self.scene.sources[target as usize];
        let object = source.image.map_or(source.object, |i| self.scene.relays[i.relay as usize].object);
        object == hit.object
    }
}

/// A tracer that remembers what hemispheres it samples.
struct Noting<'t> {
    tracer: &'t Tracer<'t>,
    hemispheres: Mutex<Hemispheres>,
}

impl Sampler for Noting<'_> {
    type Origin = Origin;
    type Scratch<'a>
        = MutexGuard<'a, Work>
    where
        Self: 'a;

    fn scratch(&self) -> MutexGuard<'_, Work> {
        self.tracer.scratch()
    }

    fn sample(
        &self,
        work: &mut MutexGuard<'_, Work>,
        cache: &Cache,
        query: &Query<Origin>,
        ray: &SampleRay,
        misses: &mut Vec<Miss<Origin>>,
    ) -> Option<Sample> {
        let mut hemispheres = self.hemispheres.lock().unwrap_or_else(PoisonError::into_inner);
        hemispheres.entry(key(query, ray.pass)).or_default().push(*ray);
        drop(hemispheres);
        self.tracer.follow(work, cache, query, ray, misses)
    }

    fn occluded(&self, query: &Query<Origin>, from: DVec3, direction: DVec3) -> bool {
        self.tracer.occluded(query, from, direction)
    }
}

impl Renderer {
    /// Answers one request and shows every ray that follows from it to `visit` when it has finished, children before
    /// parents, with what finds names; in a calculation by wavelength with its bins. Returns the bins of the answer, too.
    /// Serial.
    pub fn trace_tree(
        &mut self,
        request: &Request,
        notify: &dyn Notify,
        visit: Visit<'_>,
    ) -> Result<(Answer, Option<Spectra>), Error> {
        let mut hemispheres = self.hemispheres(request);
        let (answer, spectra) = if self.options.spectrum.is_rgb() {
            (self.show(request, 0, &mut hemispheres, &mut |ray, names| visit(ray, None, names)), None)
        } else {
            let passes = self.cache.params().passes;
            let mut show = |pass| {
                let mut rays = Vec::new();
                let answer = self.show(request, pass, &mut hemispheres, &mut |ray, _| rays.push(*ray));
                (vec![answer], rays)
            };
            let (answers, trees): (Vec<_>, Vec<_>) = (0..passes).map(&mut show).unzip();
            let (rays, passes) = braid(trees);
            let spectra = Spectra::of_tree(&self.options.spectrum, &passes);
            for (i, ray) in rays.iter().enumerate() {
                visit(ray, Some(spectra.bins(i)), &|id, modifier| self.name(id, modifier));
            }
            (answers[0][0], Some(Spectra::gather(&self.options.spectrum, &answers)))
        };
        self.complain(notify);
        self.settle()?;
        self.exchange(notify, false)?;
        Ok((answer, spectra))
    }

    /// Has the cache learn what a request asks, and returns the rays of the hemispheres that this took.
    fn hemispheres(&mut self, request: &Request) -> Hemispheres {
        let mut hemispheres = Hemispheres::new();
        for _ in 0..MOST_ROUNDS {
            let tracer = Tracer { scene: &self.scene, options: &self.options, tally: &self.tally, works: &self.works };
            let mut misses = Vec::new();
            let mut work = tracer.work();
            for pass in 0..self.cache.params().passes {
                let misses = &mut misses;
                Walk { tracer: &tracer, cache: &self.cache, work: &mut work, misses, pass, observer: () }
                    .answer(request);
            }
            drop(work);
            if misses.is_empty() || self.scene.fault.is_set() {
                break;
            }
            let noting = Noting { tracer: &tracer, hemispheres: Mutex::new(hemispheres) };
            self.cache.resolve(&noting, &misses);
            hemispheres = noting.hemispheres.into_inner().unwrap_or_else(PoisonError::into_inner);
        }
        // Threads note them in any order.
        for rays in hemispheres.values_mut() {
            rays.sort_by_key(|r| (r.stream.index(), r.stream.key()));
        }
        hemispheres
    }

    fn show(
        &mut self,
        request: &Request,
        pass: u8,
        hemispheres: &mut Hemispheres,
        visit: &mut dyn FnMut(&TreeRay, Names<'_>),
    ) -> Answer {
        let tracer = Tracer { scene: &self.scene, options: &self.options, tally: &self.tally, works: &self.works };
        let names = |id: ObjectId, modifier: ObjectId| self.name(id, modifier);
        let mut misses = Vec::new();
        let mut work = tracer.work();
        let mut watch = Watch { visit: &mut |ray| visit(ray, &names), hemispheres };
        let mut walk = Walk {
            tracer: &tracer,
            cache: &self.cache,
            work: &mut work,
            misses: &mut misses,
            pass,
            observer: &mut watch,
        };
        let mut answer = walk.answer(request);
        drop(work);
        if !misses.is_empty() && !self.scene.fault.is_set() {
            let values = self.cache.resolve(&tracer, &misses);
            answer.value += misses.iter().zip(values).map(|(miss, value)| miss.coefficient * value).sum::<Rgb>();
        }
        answer.make_finite();
        answer
    }
}

impl<O: Observer> Walk<'_, O> {
    /// Follows again, as children of the ray that asked, the rays that were sent to answer its question. What they bring
    /// is in the answer already.
    pub(crate) fn follow_hemisphere(&mut self, ray: &Ray<'_>, query: &Query<Origin>, coefficient: Rgb) {
        let Some(rays) = self.observer.take_hemisphere(query) else { return };
        let query = &Query { origin: query.origin.moved(self.off_edges(ray, query.normal)), ..*query };
        let share = coefficient / rays.len() as f32;
        for sample in rays {
            let mut child = self.tracer.hemisphere_ray(query, &sample);
            if child.fate(true, &self.tracer.options.limits) != Fate::Alive {
                continue;
            }
            child.parent = Some(ray);
            child.throughput = ray.throughput * ray.attenuation() * share;
            child.coefficient = share;
            self.evaluate(&mut child);
        }
    }
}
