//! The hemispheres of a round: planned, sampled, completed by what their samples missed, and made into records.
//!
//! Each goes its own way in parallel as far as it can: samples, extra samples, record. Where samples miss the cache it
//! waits; when all have stopped, what they miss is resolved together, in order, and they go on. At the deepest level,
//! where nothing can be missed, and whenever the cache is warm, a round is a single parallel step.

use crate::cache::Cache;
use crate::fill::key;
use crate::finish::{Cell, Outcome, finish, least_distance, mean, once};
use crate::gather::{Sampled, trace};
use crate::hemisphere::Hemisphere;
use crate::light::Light;
use crate::reuse::RENT;
use crate::sampler::{Query, Sample, Sampler};
use crate::steps::Chain;
use crate::supersample::allocate;
use ambit_base::{Colour, Stream, Vec3};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Whether hemispheres are to become records.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kept {
    Yes,
    No,
}

/// An extra sample: its cell, and its number within the cell.
type Extra = (usize, u32);

/// How far a hemisphere has come.
enum State<O> {
    Done(Outcome),
    Waiting(Box<Waiting<O>>),
}

/// A hemisphere whose last samples missed the cache.
struct Waiting<O> {
    plan: Hemisphere,
    /// Nothing while it waits for its first samples; then its cells in all passes, and where the extra ones belong.
    before: Option<(Vec<Cell>, Vec<Extra>)>,
    sampled: Sampled<O>,
}

/// What all hemispheres of a round share.
struct Round<'a, S: Sampler> {
    cache: &'a Cache,
    sampler: &'a S,
    kept: Kept,
    samples: &'a AtomicU64,
    repaired: &'a AtomicU64,
}

impl Cache {
    /// Samples the hemispheres of a round and makes their records.
    pub(crate) fn hemispheres<S: Sampler>(
        &mut self,
        sampler: &S,
        level: u8,
        queries: &[Query<S::Origin>],
        chosen: &[usize],
        kept: Kept,
    ) -> Vec<Outcome> {
        let (samples, repaired) = (AtomicU64::new(0), AtomicU64::new(0));
        let first = Round { cache: &*self, sampler, kept, samples: &samples, repaired: &repaired };
        let numbers = (0..chosen.len()).collect();
        let mut stopped = self.steps.chains(numbers, |k: usize, chain| (k, first.begin(&queries[chosen[k]], k, chain)));
        let mut outcomes = vec![Outcome::Nothing; chosen.len()];
        loop {
            let mut waiting = Vec::new();
            for (k, state) in stopped {
                match state {
                    State::Done(outcome) => outcomes[k] = outcome,
                    State::Waiting(hemisphere) => waiting.push((k, hemisphere)),
                }
            }
            if waiting.is_empty() {
                break;
            }
            let mut misses = Vec::with_capacity(waiting.iter().map(|(_, w)| w.sampled.misses.len()).sum());
            let mut work = Vec::with_capacity(waiting.len());
            for (k, mut hemisphere) in waiting {
                let begin = misses.len();
                misses.append(&mut hemisphere.sampled.misses);
                work.push((k, hemisphere, begin..misses.len()));
            }
            let answers = self.answers(sampler, &misses);
            let next = Round { cache: &*self, sampler, kept, samples: &samples, repaired: &repaired };
            stopped = self.steps.chains(work, |(k, hemisphere, missed), chain| {
                let answered = misses[missed.clone()].iter().zip(&answers[missed]);
                let light = answered.map(|(miss, answer)| answer.times(miss.coefficient));
                (k, next.go_on(&queries[chosen[k]], *hemisphere, light, chain))
            });
        }
        let level = usize::from(level);
        if self.statistics.samples.len() <= level {
            self.statistics.samples.resize(level + 1, 0);
        }
        self.statistics.samples[level] += samples.into_inner();
        self.statistics.repaired += repaired.into_inner();
        outcomes
    }
}

impl<S: Sampler> Round<'_, S> {
    /// Plans the so-manieth hemisphere, takes its samples and goes on as far as it can.
    fn begin(&self, query: &Query<S::Origin>, number: usize, chain: &mut Chain) -> State<S::Origin> {
        let params = &self.cache.params;
        let weight = self.cache.limits.record_weight(query.level, query.weight);
        let stream = Stream::new(0, key(query, params.seed));
        let plan = match self.kept {
            Kept::Yes => {
                let share = self.cache.worth.share(query.level, weight, number);
                Hemisphere::new(params, share, 1.0, query.normal, stream, true)
            }
            Kept::No => Hemisphere::few(params, weight / RENT as f32, query.normal, stream),
        };
        // A cache without divisions ends before this.
        let Some(plan) = plan else { return State::Done(Outcome::Nothing) };
        let wanted = (plan.len(), self.passes(query));
        let sampled =
            trace(self.cache, self.sampler, query, wanted, chain, |sample| plan.ray(plan.direction(sample), sample));
        self.count(plan.len(), &sampled);
        if sampled.misses.is_empty() {
            self.extend(query, plan, &sampled.returned, chain)
        } else {
            State::Waiting(Waiting { plan, before: None, sampled }.into())
        }
    }

    /// Goes on with the light of all that it missed.
    fn go_on(
        &self,
        query: &Query<S::Origin>,
        waiting: Waiting<S::Origin>,
        light: impl Iterator<Item = Light>,
        chain: &mut Chain,
    ) -> State<S::Origin> {
        let Waiting { plan, before, sampled: Sampled { mut returned, owners, .. } } = waiting;
        for (owner, light) in owners.into_iter().zip(light) {
            if let Some(sample) = &mut returned[owner as usize] {
                sample.light += light;
            }
        }
        match before {
            None => self.extend(query, plan, &returned, chain),
            Some((cells, extras)) => State::Done(self.refine(query, &plan, cells, &extras, &returned)),
        }
    }

    /// Takes extra samples, if there are to be any, and ends.
    fn extend(
        &self,
        query: &Query<S::Origin>,
        plan: Hemisphere,
        returned: &[Option<Sample>],
        chain: &mut Chain,
    ) -> State<S::Origin> {
        let least = least_distance(&self.cache.limits);
        let cells: Vec<Cell> = returned.iter().map(|r| cell(*r, least)).collect();
        let extras = Self::extras(&plan, &together(&cells, plan.len()));
        if extras.is_empty() {
            return State::Done(self.finish(query, &plan, &cells));
        }
        let wanted = (extras.len(), self.passes(query));
        let sampled = trace(self.cache, self.sampler, query, wanted, chain, |sample| {
            let (cell, k) = extras[sample];
            let direction = plan.frame().to_world(plan.extra_local(cell, k));
            plan.ray(direction, plan.len() + sample)
        });
        self.count(extras.len(), &sampled);
        if sampled.misses.is_empty() {
            State::Done(self.refine(query, &plan, cells, &extras, &sampled.returned))
        } else {
            State::Waiting(Waiting { plan, before: Some((cells, extras)), sampled }.into())
        }
    }

    /// Where a hemisphere takes extra samples: where cells differ from their neighbours.
    fn extras(plan: &Hemisphere, cells: &[Cell]) -> Vec<Extra> {
        if plan.extra() == 0 || cells.iter().any(|c| c.distance <= 0.0) {
            return Vec::new();
        }
        let brightness: Vec<f32> = cells.iter().map(|c| c.light.value.brightness()).collect();
        let counts =
            allocate([plan.grid().rows(), plan.grid().columns()], &brightness, plan.extra(), |cell| plan.share(cell));
        counts.iter().enumerate().flat_map(|(cell, &m)| (0..m).map(move |k| (cell, k))).collect()
    }

    /// Takes extra samples into their cells' means, those of a cell follow each other, and ends.
    fn refine(
        &self,
        query: &Query<S::Origin>,
        plan: &Hemisphere,
        mut cells: Vec<Cell>,
        extras: &[Extra],
        returned: &[Option<Sample>],
    ) -> Outcome {
        let least = least_distance(&self.cache.limits);
        let passes = self.passes(query).len();
        let mut returned = returned;
        for run in extras.chunk_by(|a, b| a.0 == b.0) {
            let (own, rest) = returned.split_at(run.len() * passes);
            returned = rest;
            for (pass, cell) in cells[run[0].0 * passes..][..passes].iter_mut().enumerate() {
                let (mut sum, mut count) = (cell.light, 1.0);
                let mut at = pass;
                while let Some(sample) = own.get(at) {
                    if let Some(sample) = sample {
                        sum += sample.light;
                        count += 1.0;
                        cell.nearness = cell.nearness.max(1.0 / sample.distance.max(least));
                    }
                    at += passes;
                }
                cell.light = sum * (1.0 / count);
            }
        }
        self.finish(query, plan, &cells)
    }

    fn finish(&self, query: &Query<S::Origin>, plan: &Hemisphere, cells: &[Cell]) -> Outcome {
        if self.kept == Kept::No {
            return match once(query, plan, cells) {
                Outcome::Once(light) => Outcome::Once(self.cache.ending(query.level, light)),
                other => other,
            };
        }
        let passes = cells.len() / plan.len();
        let lights = (0..passes).map(|pass| mean(cells.iter().skip(pass).step_by(passes)));
        let lights: Vec<Light> = lights.map(|light| self.cache.ending(query.level, light)).collect();
        let outcome = finish(&self.cache.limits, query, plan, &together(cells, plan.len()), &lights);
        let outcome = match &self.cache.quantised {
            Some(components) => outcome.quantised(query, components),
            None => outcome,
        };
        match outcome {
            Outcome::Record(mut record, value, _) => {
                let survey = self.cache.survey(&mut record);
                Outcome::Record(record, value, survey)
            }
            other => other,
        }
    }

    /// The passes that a hemisphere's samples are traced in: all that a record has values of, or the one that asks.
    fn passes(&self, query: &Query<S::Origin>) -> Range<u8> {
        match self.kept {
            Kept::Yes => 0..self.cache.params.passes.max(1),
            Kept::No => query.pass..query.pass + 1,
        }
    }

    fn count(&self, samples: usize, sampled: &Sampled<S::Origin>) {
        self.samples.fetch_add(samples as u64, Relaxed);
        self.repaired.fetch_add(sampled.repaired, Relaxed);
    }
}

/// The `count` cells by which extra samples, derivatives and radii are decided: the mean of each over all passes, which
/// follow each other cell by cell.
fn together(cells: &[Cell], count: usize) -> Cow<'_, [Cell]> {
    if cells.len() == count {
        return Cow::Borrowed(cells);
    }
    let passes = cells.len() / count;
    let mean =
        |all: &[Cell]| Cell { light: all.iter().map(|c| c.light).sum::<Light>() * (1.0 / passes as f32), ..all[0] };
    cells.chunks(passes).map(mean).collect()
}

/// The cell of a first sample.
fn cell(returned: Option<Sample>, least: f64) -> Cell {
    match returned {
        Some(s) => {
            let distance = s.distance.max(least);
            Cell { light: s.light, distance, nearness: 1.0 / distance, normal: s.normal }
        }
        None => Cell { light: Light::default(), distance: 0.0, nearness: 0.0, normal: Vec3::ZERO },
    }
}
