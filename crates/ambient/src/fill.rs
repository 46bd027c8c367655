//! Filling the cache in parallel, with results that do not depend on the number of threads.
//!
//! Breadth first, level by level, in rounds of misses that cannot cover each other: picks stand at least the largest
//! reach a·R₊ apart. Their samples are traced in parallel against the frozen cache; what those miss is resolved together
//! one level down; then the records are made in parallel and published in order. Queries a round's records do not answer
//! stay for the next; once every query has been considered at a distance, the distance is quartered. Where records were reined
//! in meanwhile and do not reach any more what they answered, that is open once more.
//!
//! Nothing depends on time, threads or the order in which they finish: streams are keyed by the bits of position, normal
//! and level, sums follow list order, and the constants below are part of the result.

use crate::cache::Cache;
use crate::finish::Outcome;
use crate::light::Light;
use crate::reuse::RENT;
use crate::round::Kept;
use crate::sampler::{Miss, Query, Sampler};
use crate::select::{CAP, Selection, select};
use crate::store::Store;
use ambit_base::{Rgb, hash_bits, hash_point};

/// Misses of a pass that are resolved together; later windows profit from the records of earlier ones.
const WINDOW: usize = 4096;
/// Picks of the first round where a level has no records yet; later rounds have twice as many up to [`CAP`]. Where the
/// records of one level are few, those of a round see only the few below them and share their noise: records that come
/// one after the other also see each other.
const FIRST: usize = 2;
/// Where it has records, the first round may add one for so many.
const GROWTH: usize = 8;
/// What the distance that picks keep is multiplied by once every query has been considered at it. With a half there are more
/// rounds, and no fewer records.
const CLOSER: f64 = 0.25;
/// Look-ups below which a parallel step costs more than it saves.
const FEW: usize = 64;

impl Cache {
    /// Computes what records are needed and answers every miss, in order. Values are irradiance/π at the query, to be
    /// multiplied by the miss's coefficient.
    pub fn resolve<S: Sampler>(&mut self, sampler: &S, misses: &[Miss<S::Origin>]) -> Vec<Rgb> {
        self.answers(sampler, misses).into_iter().map(|light| light.value).collect()
    }

    /// As [`Cache::resolve`], by bounces.
    pub(crate) fn answers<S: Sampler>(&mut self, sampler: &S, misses: &[Miss<S::Origin>]) -> Vec<Light> {
        let start = self.stopwatch.start();
        let mut values = vec![Light::NONE; misses.len()];
        let mut levels: Vec<u8> = misses.iter().map(|m| m.query.level).collect();
        levels.sort_unstable();
        levels.dedup();
        let window = WINDOW * usize::from(self.params.passes.max(1));
        for level in levels {
            let at: Vec<usize> = (0..misses.len()).filter(|&k| misses[k].query.level == level).collect();
            if level == 0 {
                // What is asked in several passes is one query.
                self.worth.expect(at.iter().filter(|&&k| misses[k].query.pass == 0).count().min(WINDOW));
            }
            for (number, window) in at.chunks(window).enumerate() {
                self.window(sampler, misses, level, window, number > 0, &mut values);
            }
        }
        self.stopwatch.stop(start);
        values
    }

    /// Answers the misses `window` points at, all of one level; `stale` if records have come since they missed.
    fn window<S: Sampler>(
        &mut self,
        sampler: &S,
        misses: &[Miss<S::Origin>],
        level: u8,
        window: &[usize],
        stale: bool,
        values: &mut [Light],
    ) {
        if self.ends_at(level) || !self.params.caches() {
            let fallback = self.fallback();
            for &k in window {
                values[k] = fallback.into();
            }
            return;
        }
        let mut open = window.to_vec();
        if stale {
            let cache = &*self;
            let found =
                self.steps.in_order(open.len(), FEW, FEW / 2, |i| cache.lookup(sampler, &misses[open[i]].query));
            open = settle(&open, &found, values);
        }
        let queries: Vec<Query<S::Origin>> = open.iter().map(|&k| misses[k].query).collect();
        let answers = self.rounds(sampler, level, &queries);
        for (&k, answer) in open.iter().zip(answers) {
            values[k] = answer;
        }
    }

    /// Fills the cache until every query has an answer.
    fn rounds<S: Sampler>(&mut self, sampler: &S, level: u8, queries: &[Query<S::Origin>]) -> Vec<Light> {
        let limits = self.limits;
        let mut values = vec![Light::NONE; queries.len()];
        let mut picked = vec![false; queries.len()];
        let mut exempt = vec![false; queries.len()];
        // Whose hemispheres are the whole answer: all, unless records smooth each other.
        let mut whole = vec![false; queries.len()];
        let smooth = level == 0 && limits.smoothing > 1.0;
        let mut open: Vec<usize> = (0..queries.len()).collect();
        let farthest = limits.accuracy * limits.max_radius;
        let mut apart = farthest;
        // True once questions are open that were settled before.
        let mut again = false;
        let least = 0.5 * limits.accuracy * limits.min_radius;
        let mut most = (self.worth.records(level) / GROWTH).clamp(FIRST, CAP);
        // What the records around each query weigh together, where that matters.
        let enough = self.params.enough(level);
        let mut weights = vec![0.0; queries.len()];
        self.weigh(sampler, enough, queries, &open, &mut weights);
        loop {
            if open.is_empty() {
                // The round's records alone gave a provisional answer; all of them give the final one, unless those that
                // gave it were reined in.
                let last = self.steps.in_order(queries.len(), FEW, FEW / 2, |q| {
                    if whole[q] { None } else { self.answer(&self.store.lookup(&limits, sampler, &queries[q]), level) }
                });
                open = (0..queries.len()).filter(|&q| last[q].is_none() && !picked[q]).collect();
                for (value, last) in values.iter_mut().zip(last) {
                    *value = last.unwrap_or(*value);
                }
                if open.is_empty() {
                    return values;
                }
                self.weigh(sampler, enough, queries, &open, &mut weights);
                (apart, again) = (farthest, true);
            }
            for q in self.rent(sampler, level, queries, &mut open, &mut values) {
                (picked[q], whole[q]) = (true, true);
            }
            if open.is_empty() {
                continue;
            }
            self.statistics.rounds += 1;
            let Selection { picks, maximal, blocked } = select(&limits, queries, &open, &exempt, apart, most);
            most = (2 * most).min(CAP);
            let outcomes = self.hemispheres(sampler, level, queries, &picks, Kept::Yes);
            let mut wasted = [false; CAP];
            for (k, outcome) in outcomes.iter().enumerate() {
                picked[picks[k]] = true;
                wasted[k] = !matches!(outcome, Outcome::Record(..));
                whole[picks[k]] = wasted[k] || !smooth;
            }
            let delta = self.publish(sampler, queries, &picks, outcomes, &mut values);
            // Those that waited for a record that could not be stored need not keep away from it again.
            for (query, pick) in blocked {
                exempt[query] |= wasted[pick];
            }
            open.retain(|&q| !picked[q]);
            let found =
                self.steps.in_order(open.len(), FEW, FEW / 2, |i| delta.lookup(&limits, sampler, &queries[open[i]]));
            for (&q, sum) in open.iter().zip(&found) {
                weights[q] += sum.weight;
            }
            let found: Vec<_> = open
                .iter()
                .zip(found)
                .map(|(&q, sum)| self.answer(&sum, level).filter(|_| weights[q] >= enough || sum.is_enough(enough)))
                .collect();
            if let Some(reuse) = self.reuse.as_mut().filter(|_| !again) {
                let own = picks.iter().zip(wasted).filter(|(_, wasted)| !wasted);
                own.for_each(|(&q, _)| reuse.made(&queries[q]));
                // What is asked in several passes is one question.
                let others = open.iter().zip(&found).filter(|(q, f)| f.is_some() && queries[**q].pass == 0);
                others.for_each(|(&q, _)| reuse.served(&queries[q]));
            }
            open = settle(&open, &found, &mut values);
            if maximal {
                apart = (CLOSER * apart).max(least);
            }
        }
    }

    /// Notes what the records around the open queries weigh together, if there is a weight that they must have.
    fn weigh<S: Sampler>(
        &self,
        sampler: &S,
        enough: f32,
        queries: &[Query<S::Origin>],
        open: &[usize],
        weights: &mut [f32],
    ) {
        if enough <= 0.0 {
            return;
        }
        let sums = self
            .steps
            .in_order(open.len(), FEW, FEW / 2, |i| self.store.lookup(&self.limits, sampler, &queries[open[i]]).weight);
        for (&q, weight) in open.iter().zip(sums) {
            weights[q] = weight;
        }
    }

    /// Answers the open queries where records are hardly reused, each by a hemisphere of its own that is not kept.
    fn rent<S: Sampler>(
        &mut self,
        sampler: &S,
        level: u8,
        queries: &[Query<S::Origin>],
        open: &mut Vec<usize>,
        values: &mut [Light],
    ) -> Vec<usize> {
        let Some(reuse) = &mut self.reuse else { return Vec::new() };
        let rented: Vec<usize> = open.extract_if(.., |&mut q| reuse.rents(&queries[q])).collect();
        let fallback = self.fallback();
        // As many samples at a time as in a round.
        for picks in rented.chunks(CAP * RENT as usize) {
            let outcomes = self.hemispheres(sampler, level, queries, picks, Kept::No);
            for (&q, outcome) in picks.iter().zip(outcomes) {
                values[q] = outcome.value().unwrap_or(fallback.into());
            }
        }
        self.statistics.rented += rented.len() as u64;
        rented
    }

    /// Stores the records of a round in order; returns them in a tree of their own.
    fn publish<S: Sampler>(
        &mut self,
        sampler: &S,
        queries: &[Query<S::Origin>],
        picks: &[usize],
        outcomes: Vec<Outcome>,
        values: &mut [Light],
    ) -> Store {
        let fallback = self.fallback();
        let mut delta = self.store.emptied();
        let first = self.records().len();
        for (&q, outcome) in picks.iter().zip(outcomes) {
            values[q] = match outcome {
                Outcome::Record(record, value, survey) => {
                    let sum = delta.lookup(&self.limits, sampler, &queries[q]);
                    let covered = sum.answer().is_some() && sum.is_enough(self.params.enough(record.level));
                    if !covered && self.insert(record, survey, false) {
                        // What is new is numbered alike in both trees, but for where it begins.
                        let new = &self.records()[first..];
                        for &(id, _) in self.changed.iter().filter(|(id, _)| *id as usize >= first) {
                            let k = id as usize - first;
                            delta.shrink(k as u32, new[k].radii);
                        }
                        let both = delta.insert(new.last().expect("it was just stored"), &self.limits, false);
                        debug_assert!(both, "what the store takes its part takes");
                    }
                    value
                }
                Outcome::Once(value) => {
                    self.statistics.unstored += 1;
                    value
                }
                Outcome::Nothing => fallback.into(),
            };
        }
        delta
    }
}

/// Takes what was found as values; returns what is still open.
fn settle(open: &[usize], found: &[Option<Light>], values: &mut [Light]) -> Vec<usize> {
    let mut left = Vec::new();
    for (&k, found) in open.iter().zip(found) {
        match found {
            Some(value) => values[k] = *value,
            None => left.push(k),
        }
    }
    left
}

/// Names the random numbers of a record by what it is: position, normal and level.
pub(crate) fn key<O>(query: &Query<O>, seed: u64) -> u64 {
    hash_bits(&[hash_point(query.position), hash_point(query.normal), u64::from(query.level), seed])
}
