//! Tracing many samples at once: in parallel tasks, laid out by index.

use crate::cache::Cache;
use crate::parallel::in_order;
use crate::sampler::{Miss, Query, Sample, SampleRay, Sampler};
use ambit_base::Rgb;

/// The samples `from..to` of a hemisphere.
pub(crate) struct Job {
    pub(crate) pick: usize,
    pub(crate) from: usize,
    pub(crate) to: usize,
}

/// What all jobs brought back, in order.
pub(crate) struct Sampled<O> {
    pub(crate) returned: Vec<Option<Sample>>,
    /// Of each miss, the sample it belongs to.
    pub(crate) owners: Vec<u32>,
    pub(crate) misses: Vec<Miss<O>>,
    /// Samples that were no light: negative or undefined.
    pub(crate) repaired: u64,
}

impl<O> Sampled<O> {
    fn with_capacity(samples: usize) -> Self {
        Self { returned: Vec::with_capacity(samples), owners: Vec::new(), misses: Vec::new(), repaired: 0 }
    }
}

/// Traces the samples of all jobs; `ray` gives the query and the ray of a sample of a pick.
pub(crate) fn trace<'q, S: Sampler>(
    cache: &Cache,
    sampler: &S,
    jobs: &[Job],
    ray: impl Fn(usize, usize) -> (&'q Query<S::Origin>, SampleRay) + Sync + Send,
) -> Sampled<S::Origin>
where
    S::Origin: 'q,
{
    let parts = in_order(jobs.len(), 2, 1, |k| {
        let job = &jobs[k];
        let mut part = Sampled::with_capacity(job.to - job.from);
        let mut scratch = sampler.scratch();
        for sample in job.from..job.to {
            let (query, ray) = ray(job.pick, sample);
            let returned = sampler.sample(&mut scratch, cache, query, ray, &mut part.misses);
            let index = part.returned.len() as u32;
            part.owners.resize(part.misses.len(), index);
            part.returned.push(returned.map(|s| repair(s, &mut part.repaired)));
        }
        part
    });
    let mut all = Sampled::with_capacity(parts.iter().map(|p| p.returned.len()).sum());
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
    let sound = sample.radiance.to_array().into_iter().all(light) && sample.distance >= 0.0;
    if !sound {
        *repaired += 1;
        sample.radiance = Rgb::from_array(sample.radiance.to_array().map(|c| if light(c) { c } else { 0.0 }));
        if sample.distance.is_nan() || sample.distance < 0.0 {
            sample.distance = ambit_base::FAR;
        }
    }
    sample
}
