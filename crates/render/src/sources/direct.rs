//! The direct component: sample every source, rank the samples by what they could contribute, test shadows in that
//! order until the rest cannot matter, and estimate the untested rest from each source's record so far
//! (Ward 1991, *Adaptive Shadow Testing*).

use crate::observer::Observer;
use crate::ray::{Kinds, Ray, transmittance};
use crate::sources::partition::{Part, parts};
use crate::sources::{Emitter, Source, SourceId};
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, EPSILON, FAR, Rgb, Stream, mix};
use ambit_scene::VOID;
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

/// Above this jitter a round source that is not divided is sampled all over.
const BENDING_JITTER: f64 = 0.7;

impl<O: Observer> Walk<'_, O> {
    /// Adds to `ray.value` what all sources send to its hit point. `coefficient` gives the surface's response to a
    /// unit direction and a solid angle: BSDF × cosine × solid angle.
    pub(crate) fn direct(&mut self, ray: &mut Ray<'_>, coefficient: impl Fn(DVec3, f64) -> Rgb) {
        self.direct_with(ray, None, |_, l, omega| coefficient(l, omega));
    }

    /// As [`Walk::direct`], for responses that take a walk to be found, or that are 0 below the plane of a unit vector.
    pub(crate) fn direct_with(
        &mut self,
        ray: &mut Ray<'_>,
        above: Option<DVec3>,
        mut coefficient: impl FnMut(&mut Self, DVec3, f64) -> Rgb,
    ) {
        if self.tracer.scene.sources.is_empty() {
            return;
        }
        let mut candidates = std::mem::take(&mut self.work.candidates);
        let mut divided = std::mem::take(&mut self.work.parts);
        candidates.clear();
        let scene = self.tracer.scene;
        let options = self.tracer.options;
        // The weight that counts is a shadow ray's.
        let ratio = if options.direct.sampling > EPSILON {
            options.direct.sampling / f64::from(ray.weight * ray.extinction_factor())
        } else {
            f64::INFINITY
        };
        let own = ray.hit.as_ref().filter(|_| self.is_flat(ray)).map_or(VOID, |h| h.object);
        for (id, source) in scene.sources.iter().enumerate() {
            if !source.sampled
                || source.is_out_of_reach(ray.point)
                || above.is_some_and(|n| source.is_below(ray.point, n, options.direct.jitter))
            {
                continue;
            }
            parts(source, ray.point, ratio, &mut divided);
            let known = divided.len() == 1;
            let bend = divided.len() > 1 || options.direct.jitter > BENDING_JITTER;
            for (i, part) in divided.iter().enumerate() {
                let stream = ray.stream.child(mix(id as u64, 0x5000 + i as u64));
                let Some(sample) = self.sample(source, ray.point, part, bend, stream) else { continue };
                let k = coefficient(self, sample.direction, sample.solid_angle);
                if k.max_element() <= 0.0 {
                    continue;
                }
                if known && scene.obstacles.block(id, source, &scene.world, own, ray.point, &sample) {
                    self.work.note_test(id as SourceId, false);
                    self.work.known_blocked.push(id as SourceId);
                    continue;
                }
                let emitted = self.emitted(ray, id as SourceId, sample, bend);
                let potential = k * emitted;
                let brightness = potential.brightness();
                if brightness > 0.0 {
                    candidates.push(Candidate {
                        source: id as SourceId,
                        direction: sample.direction,
                        coefficient: k,
                        potential,
                        brightness,
                    });
                }
            }
        }
        self.work.parts = divided;
        self.test_shadows(ray, &mut candidates);
        self.work.candidates = candidates;
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
        if !source.restrictions.iter().all(|r| r.admits(point, direction)) {
            return None;
        }
        let mut solid_angle = source.solid_angle(direction, distance, part.share)?;
        if let Some(spot) = &source.spot {
            if -spot.aim.dot(direction) < spot.cosine {
                return None;
            }
            if distance < FAR {
                let r = distance / (distance + spot.focal);
                solid_angle *= r * r;
            }
        }
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
    fn test_shadows(&mut self, ray: &mut Ray<'_>, candidates: &mut [Candidate]) {
        candidates.sort_unstable_by(|a, b| b.brightness.total_cmp(&a.brightness).then(a.source.cmp(&b.source)));
        let count = candidates.len();
        // Two are always tested.
        let ahead =
            if count > 2 { ((count as f64).powf(self.tracer.options.direct.certainty) + 0.5) as usize } else { count };
        let threshold = (self.tracer.options.direct.threshold / f64::from(ray.weight)) as f32;
        let mut rest: f32 = candidates.iter().map(|c| c.brightness).sum();
        // `window` is the sum over the samples looked ahead: T(i) − T(i+K).
        let mut window: f32 = candidates.iter().take(ahead).map(|c| c.brightness).sum();
        let mut tested = 0;
        let mut clear = 0u32;
        while tested < count {
            if tested >= 2 && window.min(rest) < threshold * ray.value.brightness() {
                break;
            }
            let candidate = candidates[tested];
            let arrived = self.shadow(ray, &candidate);
            self.work.note_test(candidate.source, arrived.is_some());
            if let Some(light) = arrived {
                clear += 1;
                ray.value += light;
            }
            rest -= candidate.brightness;
            window -= candidate.brightness;
            if let Some(next) = candidates.get(tested + ahead) {
                window += next.brightness;
            }
            tested += 1;
        }
        if tested < count {
            self.estimate_rest(ray, candidates, tested, clear);
        }
        let mut blocked = std::mem::take(&mut self.work.known_blocked);
        self.work.settle(candidates[..tested].iter().map(|c| c.source).chain(blocked.drain(..)));
        self.work.known_blocked = blocked;
    }

    /// Adds what the samples from `tested` on should bring, by the record of their sources.
    fn estimate_rest(&self, ray: &mut Ray<'_>, candidates: &[Candidate], tested: usize, clear: u32) {
        let expected: f64 = candidates[..tested].iter().map(|c| self.clear_ratio(c.source)).sum();
        let overall = if expected > EPSILON { f64::from(clear) / expected } else { 0.5 };
        for candidate in &candidates[tested..] {
            let share = (overall * self.clear_ratio(candidate.source)).min(1.0);
            ray.value += candidate.potential * share as f32;
        }
    }

    /// Share of a source's shadow tests that came out clear: those of earlier batches and of this very hit.
    fn clear_ratio(&self, source: SourceId) -> f64 {
        let (a, b) = (self.tracer.tally.counts[source as usize], self.work.tests_here(source));
        (a.hits + b.hits) as f64 / (a.tests + b.tests) as f64
    }

    /// Light that arrives from a candidate, or None if it is blocked.
    pub(super) fn shadow(&mut self, ray: &Ray<'_>, candidate: &Candidate) -> Option<Rgb> {
        let tracer = self.tracer;
        let source = &tracer.scene.sources[candidate.source as usize];
        let direction = candidate.direction;
        // Most rays either arrive or meet something opaque: only what is neither needs a ray to shade with.
        let plain =
            !O::ACTIVE && ray.clipped == 0 && ray.next_clipped == 0 && ray.limit >= FAR && source.image.is_none();
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
