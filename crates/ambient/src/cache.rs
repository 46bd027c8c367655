//! The cache: options, records, and questions to them.

use crate::average::Average;
use crate::clamping::{Reins, Survey};
use crate::components::Components;
use crate::file::Habits;
use crate::light::Light;
use crate::lookup::Sum;
use crate::observe::{Observer, Stopwatch};
use crate::params::{Clamping, Limits, Params};
use crate::radii::ANISOTROPY;
use crate::record::Record;
use crate::reuse::Reuse;
use crate::sampler::{Answer, Query, Sampler};
use crate::steps::Steps;
use crate::store::Store;
use crate::worth::Worth;
use ambit_base::{DVec3, Rgb};
use std::sync::Arc;

/// What filling the cache took.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Records that were loaded, by level.
    pub loaded: Vec<u64>,
    /// Hemisphere samples by the level of the hemisphere; entry 0 is the eye's.
    pub samples: Vec<u64>,
    /// Rounds of filling.
    pub rounds: u64,
    /// Hemispheres whose value could be used but once, because samples were refused.
    pub unstored: u64,
    /// Hemispheres whose values were used but once, because records are hardly reused there.
    pub rented: u64,
    /// Samples with a negative or undefined radiance or distance, taken as black.
    pub repaired: u64,
}

/// The irradiance cache. Shared by `&` while light is computed, changed only by [`Cache::load`] and [`Cache::resolve`].
#[derive(Clone, Debug)]
pub struct Cache {
    pub(crate) params: Params,
    pub(crate) limits: Limits,
    pub(crate) store: Store,
    pub(crate) average: Average,
    /// What ambient files keep of a value, if records are to be as they return them.
    pub(crate) quantised: Option<Components>,
    pub(crate) statistics: Statistics,
    records: Vec<Record>,
    /// Radii that rein each other in.
    reins: Option<Reins>,
    /// Where records are hardly reused, if that is to be found out.
    pub(crate) reuse: Option<Reuse>,
    /// How many samples further records are worth.
    pub(crate) worth: Worth,
    /// Records that the last one has reined in, and their radii before widening.
    pub(crate) changed: Vec<(u32, f64)>,
    /// Counts look-ups, if they are to be counted.
    pub(crate) observer: Option<Arc<Observer>>,
    pub(crate) stopwatch: Stopwatch,
    pub(crate) steps: Arc<Steps>,
    /// True if look-ups are answered from records and not counted.
    pub(crate) plain: bool,
}

impl Cache {
    /// An empty cache for a scene whose cube has the given low corner and edge.
    pub fn new(params: Params, cube_origin: DVec3, cube_edge: f64) -> Self {
        Self {
            limits: Limits::new(&params, cube_edge),
            store: Store::new(cube_origin, cube_edge, params.passes, params.tells_bounces_apart()),
            plain: params.caches(),
            observer: None,
            stopwatch: Stopwatch::default(),
            steps: Arc::default(),
            params,
            average: Average::default(),
            quantised: None,
            statistics: Statistics::default(),
            records: Vec::new(),
            reins: Reins::new(&params, cube_origin, cube_edge),
            reuse: params.systems.measured_reuse.then(|| Reuse::new(&Limits::new(&params, cube_edge), params.passes)),
            worth: Worth::default(),
            changed: Vec::new(),
        }
    }

    /// The options.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Radii and angles that follow from them.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// All records in the order they came, loaded ones included. New ones are appended: remember a length to find them.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// What filling has taken so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Stores new records as an ambient file of such components would return them, so that those who compute and those
    /// who read agree.
    pub fn quantise(&mut self, components: Components) {
        self.quantised = Some(components);
    }

    /// Uses records as those of a file are to be used, which are loaded next.
    pub fn adopt(&mut self, habits: Habits) {
        self.limits.smoothing = self.limits.smoothing.min(habits.smoothing).max(1.0);
        if habits.ours {
            return;
        }
        self.limits.step = f32::INFINITY;
        if self.params.systems.clamping == Clamping::Deeper {
            self.reins = None;
        }
    }

    /// Takes in records from a file. Implausible ones and duplicates are dropped; returns how many.
    pub fn load(&mut self, records: impl IntoIterator<Item = Record>) -> usize {
        let mut dropped = 0;
        for record in records {
            let level = usize::from(record.level);
            if self.insert(record, Survey::NONE, true) {
                let loaded = &mut self.statistics.loaded;
                loaded.resize(loaded.len().max(level + 1), 0);
                loaded[level] += 1;
            } else {
                dropped += 1;
            }
        }
        dropped
    }

    /// Clamps a record's radii to what those of others allow; returns what [`Cache::insert`] needs to know of that.
    pub(crate) fn survey(&self, record: &mut Record) -> Survey {
        let Some(reins) = self.reins.as_ref().filter(|reins| reins.hold(record.level)) else { return Survey::NONE };
        clamp(record, reins.allowed(record.position, unwidened(record), Survey::NONE));
        reins.survey(record.position, unwidened(record))
    }

    /// Stores a record, computed by this run or `found`; false if it is implausible or there already.
    pub(crate) fn insert(&mut self, mut record: Record, survey: Survey, found: bool) -> bool {
        if !record.is_plausible() || record.further.len() + 1 != usize::from(self.params.passes.max(1)) {
            return false;
        }
        record.radii[1] = record.radii[1].max(record.radii[0]);
        // The direction code errs by up to 0.006°.
        record.u = (record.u - record.normal * record.u.dot(record.normal)).normalize_or(record.u);
        self.changed.clear();
        let level = record.level;
        if let Some(reins) = self.reins.as_ref().filter(|reins| reins.hold(level)) {
            let radius = reins.allowed(record.position, unwidened(&record), survey);
            clamp(&mut record, radius);
        }
        if !self.store.insert(&record, &self.limits, found) {
            return false;
        }
        self.average.add(record.level, record.values());
        self.worth.made(record.level);
        let (position, radius) = (record.position, unwidened(&record));
        let id = self.records.len() as u32;
        self.records.push(record);
        if let Some(reins) = self.reins.as_mut().filter(|reins| reins.hold(level)) {
            reins.insert(id, position, radius, survey, &mut self.changed);
            for &(id, radius) in &self.changed {
                let record = &mut self.records[id as usize];
                clamp(record, radius);
                self.store.shrink(id, record.radii);
            }
        }
        true
    }

    /// The radiance that stands for what is not computed: `-av`, or the average of `-aw`.
    pub fn fallback(&self) -> Rgb {
        self.average.fallback(&self.params)
    }

    /// True if a query of this depth gets the fallback.
    pub(crate) fn ends_at(&self, level: u8) -> bool {
        self.params.divisions <= 0 || i32::from(level) >= self.params.bounces.min(255)
    }

    /// The light of a hemisphere at a level, in place of whose last bounces stands the fallback.
    pub(crate) fn ending(&self, level: u8, light: Light) -> Light {
        if !self.params.tells_bounces_apart() {
            return light.value.into();
        }
        let left = self.params.bounces.min(255) - i32::from(level);
        light.ending(left.max(1) as usize, self.fallback())
    }

    /// What records come to for a question of a level. Where no bounce is left below, what the last one brought is known even of
    /// records that have forgotten it.
    pub(crate) fn answer(&self, sum: &Sum, level: u8) -> Option<Light> {
        let light = sum.answer()?;
        Some(if level == 0 { light } else { self.ending(level, light) })
    }

    /// Answers from what is stored. Include and exclude lists are the caller's business, before this.
    pub fn ask<S: Sampler>(&self, sampler: &S, query: &Query<S::Origin>) -> Answer {
        if self.ends_at(query.level) {
            return Answer::Fallback(self.fallback());
        }
        if !self.plain {
            return self.ask_observed(sampler, query);
        }
        self.lookup(sampler, query).map_or(Answer::Miss, Answer::Value)
    }

    /// The interpolated value, if records of enough weight qualify.
    pub(crate) fn lookup<S: Sampler>(&self, sampler: &S, query: &Query<S::Origin>) -> Option<Light> {
        let sum = self.store.lookup(&self.limits, sampler, query);
        self.answer(&sum, query.level).filter(|_| sum.is_enough(self.params.enough(query.level)))
    }
}

/// A record's shorter radius before it was widened for its weight.
fn unwidened(record: &Record) -> f64 {
    f64::from(record.radii[0]) * f64::from(record.weight).sqrt()
}

/// Lowers the shorter radius to `radius`, before widening, and the longer with it: their ratio is 2 at most.
fn clamp(record: &mut Record, radius: f64) {
    let shorter = (radius / f64::from(record.weight).sqrt()) as f32;
    if shorter < record.radii[0] {
        record.radii = [shorter, record.radii[1].min(ANISOTROPY as f32 * shorter)];
    }
}
