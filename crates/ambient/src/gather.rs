//! Tracing the samples of a hemisphere: in parallel tasks, laid out by index.

use crate::cache::Cache;
use crate::sampler::{Miss, Query, Sample, SampleRay, Sampler};
use crate::steps::Chain;
use ambit_base::Rgb;
use std::ops::Range;

/// Samples one task traces: few enough that no core waits long for the last.
const CHUNK: usize = 16;

/// What samples brought back, in order, each in all passes.
pub(crate) struct Sampled<O> {
    pub(crate) returned: Vec<Option<Sample>>,
    /// Of each miss, the place in `returned` that it belongs to.
    pub(crate) owners: Vec<u32>,
    pub(crate) misses: Vec<Miss<O>>,
    /// Samples that were no light: negative or undefined.
    pub(crate) repaired: u64,
}

impl<O> Sampled<O> {
    fn with_capacity(samples: usize, misses: usize) -> Self {
        let (owners, misses) = (Vec::with_capacity(misses), Vec::with_capacity(misses));
        Self { returned: Vec::with_capacity(samples), owners, misses, repaired: 0 }
    }
}

/// Traces so many samples of a query's hemisphere in some passes; `ray` gives each one's ray.
pub(crate) fn trace<S: Sampler>(
    cache: &Cache,
    sampler: &S,
    query: &Query<S::Origin>,
    (count, passes): (usize, Range<u8>),
    chain: &mut Chain,
    ray: impl Fn(usize) -> SampleRay + Sync + Send,
) -> Sampled<S::Origin> {
    let parts = chain.in_order(count.div_ceil(CHUNK), 1, |task| {
        let samples = task * CHUNK..count.min((task + 1) * CHUNK);
        let mut part = Sampled::with_capacity(samples.len() * passes.len(), 0);
        let mut scratch = sampler.scratch();
        let mut follow = |ray: &SampleRay| {
            let returned = sampler.sample(&mut scratch, cache, query, ray, &mut part.misses);
            let index = part.returned.len() as u32;
            part.owners.resize(part.misses.len(), index);
            part.returned.push(returned.map(|s| repair(s, &mut part.repaired)));
        };
        for sample in samples {
            let mut ray = ray(sample);
            ray.pass = passes.start;
            follow(&ray);
            for pass in passes.start + 1..passes.end {
                follow(&SampleRay { pass, ..ray });
            }
        }
        part
    });
    let mut all = Sampled::with_capacity(count * passes.len(), parts.iter().map(|p| p.misses.len()).sum());
    for part in parts {
        let base = all.returned.len() as u32;
        all.owners.extend(part.owners.iter().map(|o| o + base));
        all.returned.extend(part.returned);
        all.misses.extend(part.misses);
        all.repaired += part.repaired;
    }
    all
}

/// A sample without negative or undefined numbers.
fn repair(mut sample: Sample, repaired: &mut u64) -> Sample {
    let light = |c: f32| c.is_finite() && c >= 0.0;
    let sound = sample.light.value.to_array().into_iter().all(light) && sample.distance >= 0.0;
    if !sound {
        *repaired += 1;
        sample.light = Rgb::from_array(sample.light.value.to_array().map(|c| if light(c) { c } else { 0.0 })).into();
        if sample.distance.is_nan() || sample.distance < 0.0 {
            sample.distance = ambit_base::FAR;
        }
    }
    sample
}
