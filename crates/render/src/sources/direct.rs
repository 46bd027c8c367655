//! The direct component: sample every source, rank the samples by what they could contribute, test shadows in that
//! order until the rest cannot matter, and estimate the untested rest from each source's record so far
//! (Ward 1991, *Adaptive Shadow Testing*).

use crate::observer::Observer;
use crate::ray::{Kinds, Ray, transmittance};
use crate::sources::few::TESTED;
use crate::sources::lamp::{Place, View};
use crate::sources::partition::{Part, parts};
use crate::sources::{Emitter, Lamp, Source, SourceId};
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, EPSILON, FAR, Rgb, Stream, mix};
use ambit_trace::Shadow;

/// A sample that could light the point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(super) source: SourceId,
    pub(super) direction: DVec3,
    /// What the surface makes of radiance from there.
    pub(super) coefficient: Rgb,
    /// `coefficient` × emitted radiance, unobstructed.
    pub(super) potential: Rgb,
    pub(super) brightness: f32,
}

/// A sample of one part of a source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(super) direction: DVec3,
    pub(super) distance: f64,
    pub(super) solid_angle: f64,
}

impl Candidate {
    /// None if nothing comes from there.
    #[inline]
    fn new(source: SourceId, direction: DVec3, coefficient: Rgb, emitted: Rgb) -> Option<Self> {
        let potential = coefficient * emitted;
        let brightness = potential.brightness();
        (brightness > 0.0).then_some(Self { source, direction, coefficient, potential, brightness })
    }

    /// The same, counted so many times.
    pub(super) fn times(&self, factor: f32) -> Self {
        let (coefficient, potential) = (self.coefficient * factor, self.potential * factor);
        Self { coefficient, potential, brightness: self.brightness * factor, ..*self }
    }
}

/// A number that sorts the brightest candidate first, of equals that of the least index.
pub(super) fn rank(index: usize, candidate: &Candidate) -> u64 {
    // The bits of positive numbers are in their order.
    u64::from(!candidate.brightness.to_bits()) << 32 | index as u64
}

pub(super) fn index(rank: u64) -> usize {
    rank as u32 as usize
}

pub(super) fn brightness(rank: u64) -> f32 {
    f32::from_bits(!((rank >> 32) as u32))
}

/// Above this jitter a round source that is not divided is sampled all over.
const BENDING_JITTER: f64 = 0.7;

impl<O: Observer> Walk<'_, O> {
    /// Adds to `ray.value` what all sources send to its hit point. `coefficient` gives the surface's response to a
    /// unit direction and a solid angle: BSDF × cosine × solid angle.
    pub(crate) fn direct(&mut self, ray: &mut Ray<'_>, coefficient: impl Fn(DVec3, f64) -> Rgb) {
        self.direct_with(ray, None, |_, l, omega| coefficient(l, omega));
    }

    /// As [`Walk::direct`], for responses that take a walk to be found, or that are 0 below the plane of a unit vector.
    #[expect(clippy::inline_always, reason = "materials know much of their response: it is compiled for each")]
    #[inline(always)]
    pub(crate) fn direct_with(
        &mut self,
        ray: &mut Ray<'_>,
        above: Option<DVec3>,
        mut coefficient: impl FnMut(&mut Self, DVec3, f64) -> Rgb,
    ) {
        let scene = self.tracer.scene;
        if scene.lamps.is_empty() {
            return;
        }
        let mut candidates = std::mem::take(&mut self.work.candidates);
        candidates.clear();
        let direct = &self.tracer.options.direct;
        // The weight that counts is a shadow ray's.
        let ratio = if direct.sampling > EPSILON {
            direct.sampling / f64::from(ray.weight * ray.extinction_factor())
        } else {
            f64::INFINITY
        };
        let place = Place { point: ray.point, above, ratio, jitter: direct.jitter };
        let few = self.asks_few(ray);
        // Where most lamps are not looked at, a ray is as cheap as to ask for obstacles of those that are.
        let known = !few || scene.lamps.len() <= TESTED;
        let chosen = few.then(|| self.choose_lamps(ray, above)).flatten();
        let count = chosen.as_ref().map_or(scene.lamps.len(), Vec::len);
        for i in 0..count {
            let (lamp, factor) = match &chosen {
                None => (&scene.lamps[i], 1.0),
                Some(list) => (&scene.lamps[list[i].lamp as usize], list[i].factor),
            };
            match lamp.view(&scene.sources, &place) {
                View::Dark => {}
                View::Whole(sample) => {
                    let k = coefficient(self, sample.direction, sample.solid_angle) * factor;
                    if k.max_element() > 0.0 {
                        self.consider(ray, lamp, &sample, k, known, &mut candidates);
                    }
                }
                View::Parts => {
                    let mut coefficient = |w: &mut Self, l: DVec3, omega: f64| coefficient(w, l, omega) * factor;
                    self.consider_parts(ray, lamp.source, ratio, known, &mut coefficient, &mut candidates);
                }
            }
        }
        if few && candidates.len() > TESTED {
            self.test_few(ray, &candidates);
        } else {
            self.test_shadows(ray, &candidates);
        }
        self.work.candidates = candidates;
        if let Some(list) = chosen {
            self.work.chosen = list;
        }
    }

    /// Makes the sample of a whole lamp a candidate, unless an obstacle is `known`.
    #[inline]
    fn consider(
        &mut self,
        ray: &Ray<'_>,
        lamp: &Lamp,
        sample: &Sample,
        k: Rgb,
        known: bool,
        candidates: &mut Vec<Candidate>,
    ) {
        let scene = self.tracer.scene;
        if known && scene.obstacles.block(lamp.source, scene, ray, sample) {
            self.work.tally.counts[lamp.source as usize].note(false);
            return;
        }
        let emitted = if lamp.uniform && ray.interior.extinction == Rgb::ZERO {
            if lamp.encloses(sample.distance) { Rgb::ZERO } else { lamp.emission }
        } else {
            self.emitted(ray, lamp.source, *sample, false)
        };
        if let Some(candidate) = Candidate::new(lamp.source, sample.direction, k, emitted) {
            candidates.push(candidate);
        }
    }

    /// Makes the samples of a source's parts candidates.
    #[inline(never)]
    fn consider_parts(
        &mut self,
        ray: &Ray<'_>,
        id: SourceId,
        ratio: f64,
        known: bool,
        coefficient: &mut impl FnMut(&mut Self, DVec3, f64) -> Rgb,
        candidates: &mut Vec<Candidate>,
    ) {
        let scene = self.tracer.scene;
        let source = &scene.sources[id as usize];
        if source.is_out_of_reach(ray.point) {
            return;
        }
        let mut divided = std::mem::take(&mut self.work.parts);
        parts(source, ray.point, ratio, &mut divided);
        let whole = divided.len() == 1;
        let bend = !whole || self.tracer.options.direct.jitter > BENDING_JITTER;
        for (i, part) in divided.iter().enumerate() {
            let stream = ray.stream.child(mix(u64::from(id), 0x5000 + i as u64));
            let Some(sample) = self.sample(source, ray.point, part, bend, stream) else { continue };
            let k = coefficient(self, sample.direction, sample.solid_angle);
            if k.max_element() <= 0.0 {
                continue;
            }
            if known && whole && scene.obstacles.block(id, scene, ray, &sample) {
                self.work.tally.counts[id as usize].note(false);
                continue;
            }
            let emitted = self.emitted(ray, id, sample, bend);
            candidates.extend(Candidate::new(id, sample.direction, k, emitted));
        }
        self.work.parts = divided;
    }

    /// One sample of a part, or None where the source does not face, reach or aim at the point.
    pub(super) fn sample(
        &self,
        source: &Source,
        point: DVec3,
        part: &Part,
        bend: bool,
        stream: Stream,
    ) -> Option<Sample> {
        let jitter = self.tracer.options.direct.jitter;
        let mut at = part.centre;
        if jitter > EPSILON {
            let flat = matches!(source.emitter, Emitter::Polygon(_) | Emitter::Ring(_) | Emitter::Distant);
            let [x, y, z] = if flat {
                let [x, y] = stream.two();
                [x, y, 0.5]
            } else {
                stream.three()
            };
            for (c, (h, x)) in at.iter_mut().zip(part.half.into_iter().zip([x, y, z])) {
                *c += jitter * h * (2.0 * x - 1.0);
            }
        }
        let target = source.sample_point(at, bend);
        let (direction, distance) = if matches!(source.emitter, Emitter::Distant) {
            (target.normalize(), FAR)
        } else {
            let to = target - point;
            let d = to.length();
            if d <= EPSILON {
                return None;
            }
            (to / d, d)
        };
        if distance < FAR && distance > source.reach {
            return None;
        }
        let admitted = source.admitted(point, direction, distance)?;
        let solid_angle = source.solid_angle(direction, distance, part.share)? * admitted;
        Some(Sample { direction, distance, solid_angle })
    }

    /// Radiance of a source towards the ray's point along a sample, nothing in between but the medium.
    pub(super) fn emitted(&mut self, ray: &Ray<'_>, id: SourceId, sample: Sample, bend: bool) -> Rgb {
        let source = &self.tracer.scene.sources[id as usize];
        let emission = if source.image.is_some() {
            self.relayed(ray, id, sample.direction)
        } else if source.patterned {
            self.source_value(ray, id, sample.direction)
        } else if source.encloses(ray.point) {
            Rgb::ZERO
        } else if source.filled(bend) || source.intersect(ray.point, sample.direction).is_some() {
            source.emission
        } else {
            Rgb::ZERO
        };
        let interior = ray.interior;
        if interior.extinction == Rgb::ZERO {
            emission
        } else {
            // The medium ends at the source's surface, not at the sample inside it.
            let reach = source.intersect(ray.point, sample.direction).map_or(sample.distance, |(t, _)| t);
            emission * transmittance(interior.extinction * (Rgb::ONE - interior.albedo), reach)
        }
    }

    /// Tests shadows in order of potential, adds what arrives and estimates the rest.
    fn test_shadows(&mut self, ray: &mut Ray<'_>, candidates: &[Candidate]) {
        match candidates {
            [] => {}
            // Two are always tested.
            [one] => self.test_shadow(ray, one),
            [a, b] => {
                let (first, second) = if b.brightness > a.brightness { (b, a) } else { (a, b) };
                self.test_shadow(ray, first);
                self.test_shadow(ray, second);
            }
            many => self.test_ranked(ray, many),
        }
    }

    fn test_shadow(&mut self, ray: &mut Ray<'_>, candidate: &Candidate) {
        let arrived = self.shadow(ray, candidate);
        self.work.tally.counts[candidate.source as usize].note(arrived.is_some());
        if let Some(light) = arrived {
            ray.value += light;
        }
    }

    #[inline(never)]
    fn test_ranked(&mut self, ray: &mut Ray<'_>, candidates: &[Candidate]) {
        let mut ranks = std::mem::take(&mut self.work.ranks);
        ranks.clear();
        ranks.extend(candidates.iter().enumerate().map(|(i, c)| rank(i, c)));
        ranks.sort_unstable();
        let count = candidates.len();
        let ahead = ((count as f64).powf(self.tracer.options.direct.certainty) + 0.5) as usize;
        let threshold = (self.tracer.options.direct.threshold / f64::from(ray.weight)) as f32;
        let mut rest: f32 = ranks.iter().map(|&r| brightness(r)).sum();
        // `window` is the sum over the samples looked ahead: T(i) − T(i+K).
        let mut window: f32 = ranks.iter().take(ahead).map(|&r| brightness(r)).sum();
        let mut tested = 0;
        let mut clear = 0u32;
        while tested < count {
            if tested >= 2 && window.min(rest) < threshold * ray.value.brightness() {
                break;
            }
            let candidate = &candidates[index(ranks[tested])];
            let arrived = self.shadow(ray, candidate);
            self.work.note_test(candidate.source, arrived.is_some());
            if let Some(light) = arrived {
                clear += 1;
                ray.value += light;
            }
            rest -= candidate.brightness;
            window -= candidate.brightness;
            if let Some(&next) = ranks.get(tested + ahead) {
                window += brightness(next);
            }
            tested += 1;
        }
        let ranked = ranks.iter().map(|&r| &candidates[index(r)]);
        if tested < count {
            self.estimate_rest(ray, ranked.clone(), tested, clear);
        }
        self.work.settle(ranked.take(tested).map(|c| c.source));
        self.work.ranks = ranks;
    }

    /// Adds what the samples from `tested` on should bring, by the record of their sources.
    fn estimate_rest<'c>(
        &self,
        ray: &mut Ray<'_>,
        ranked: impl Iterator<Item = &'c Candidate> + Clone,
        tested: usize,
        clear: u32,
    ) {
        let expected: f64 = ranked.clone().take(tested).map(|c| self.clear_ratio(c.source)).sum();
        let overall = if expected > EPSILON { f64::from(clear) / expected } else { 0.5 };
        for candidate in ranked.skip(tested) {
            let share = (overall * self.clear_ratio(candidate.source)).min(1.0);
            ray.value += candidate.potential * share as f32;
        }
    }

    /// Share of a source's shadow tests that came out clear: those of earlier batches and of this very hit.
    fn clear_ratio(&self, source: SourceId) -> f64 {
        let here = self.work.tests_here(source);
        if here.tests == 0 {
            return self.tracer.tally.clear[source as usize];
        }
        let before = self.tracer.tally.counts[source as usize];
        (before.hits + here.hits) as f64 / (before.tests + here.tests) as f64
    }

    /// Light that arrives from a candidate, or None if it is blocked.
    pub(super) fn shadow(&mut self, ray: &Ray<'_>, candidate: &Candidate) -> Option<Rgb> {
        let tracer = self.tracer;
        let source = &tracer.scene.sources[candidate.source as usize];
        let direction = candidate.direction;
        // Most rays either arrive or meet something opaque: only what is neither needs a ray to shade with.
        let plain = !O::ACTIVE && ray.clipped == 0 && ray.next_clipped == 0 && source.image.is_none();
        let mut found = None;
        if plain {
            let mut query = ambit_trace::Ray { origin: ray.point, direction, limit: FAR };
            let target = if matches!(source.emitter, Emitter::Distant) { None } else { Some(source.object) };
            let mut panes = Rgb::ONE;
            loop {
                self.work.rays += 1;
                match tracer.scene.world.shadow(&query, target) {
                    Shadow::Reaches => return Some(candidate.potential * panes),
                    Shadow::Blocked(_) => return None,
                    Shadow::Other(hit) => {
                        found = found.or(Some(hit));
                        // A pattern of a source without a place is told where the last pane is.
                        if target.is_none() && source.patterned {
                            break;
                        }
                        let Some(k) = self.through_pane(&hit) else { break };
                        panes *= k;
                        if panes == Rgb::ZERO {
                            return None;
                        }
                        query.origin += direction * hit.distance;
                    }
                }
            }
        }
        let behind = ray.hit.as_ref().is_some_and(|h| h.normal.dot(direction) * h.normal.dot(ray.direction) > 0.0);
        let kind = if behind { Kinds::SHADOW_TRANSMITTED } else { Kinds::SHADOW_REFLECTED };
        let (child, _) = ray.spawn(kind, direction, None, &tracer.options.limits, 0);
        let mut child = child.aimed(candidate.source);
        if O::ACTIVE {
            child.coefficient = candidate.coefficient;
            child.throughput = ray.throughput * ray.attenuation() * candidate.coefficient;
        }
        if source.image.is_some() {
            return self.shadow_by_relay(child, candidate.coefficient);
        }
        match found {
            Some(hit) => self.shade_hit(&mut child, hit),
            None => self.evaluate(&mut child),
        }
        let value = child.value;
        (value.mean() > EPSILON as f32).then_some(candidate.coefficient * value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_sort_by_brightness_and_then_by_place() {
        let candidate = |x: f32| Candidate::new(0, DVec3::X, Rgb::splat(x), Rgb::ONE);
        assert!(candidate(0.0).is_none() && candidate(f32::NAN).is_none());
        let candidates: Vec<Candidate> =
            [0.5, 3e-30, 7.0, 0.5, 1e30, f32::INFINITY].into_iter().filter_map(candidate).collect();
        let mut ranks: Vec<u64> = candidates.iter().enumerate().map(|(i, c)| rank(i, c)).collect();
        ranks.sort_unstable();
        let order: Vec<usize> = ranks.iter().map(|&r| index(r)).collect();
        assert_eq!(order, [5, 4, 2, 0, 3, 1]);
        assert!(ranks.iter().all(|&r| brightness(r) == candidates[index(r)].brightness));
    }
}
