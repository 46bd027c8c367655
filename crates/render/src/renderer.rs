//! The renderer: batches of primary rays in, answers out.
//!
//! A batch is shaded in parallel against a frozen cache and frozen shadow counts; what missed the cache is then
//! resolved in rounds, and everything learnt becomes visible to the next batch. The answers depend on the requests and
//! the borders of batches, never on threads.

use crate::observer::Observer;
use crate::picture::{SourceOutline, outlines};
use crate::prepare::{Environment, Loaded, Prepared};
use crate::ray::{Interior, Kinds, Ray};
use crate::reply::{Rays, Reply, Seen};
use crate::request::{Aim, Answer, Request};
use crate::sharing::Sharing;
use crate::sources::{Tally, sensor};
use crate::spectral::Spectra;
use crate::tracer::{Origin, Tracer};
use crate::walk::Walk;
use crate::work::Work;
use crate::{Error, Options};
use ambit_ambient::{Bounces, Cache, Miss, Params, Systems};
use ambit_base::{DVec3, FAR, Notify, Stream, hash_bits};
use ambit_scene::{Kind, ObjectId, VOID};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Most requests that are shaded against one state of the cache.
const BATCH: usize = 4096;
/// Fewer requests than this are shaded on the calling thread; more in as many tasks at least.
const PARALLEL_FROM: usize = 8;
/// Most requests of one task.
const TOGETHER: usize = 16;

/// `rtrace -I` starts its rays this far in front of the point of measurement, and declares them to hit a little
/// behind that, scene units.
const SENSOR_LIFT: f64 = 1.1e-4;
const SENSOR_DISTANCE: f64 = 1e-5;

/// What one task of a batch brings.
struct Part<R> {
    /// In each pass.
    answers: Vec<Vec<R>>,
    /// Diffuse questions that are open, and the numbers of the answers that wait for them.
    misses: Vec<Miss<Origin>>,
    owners: Vec<usize>,
}

/// A scene ready to be asked for light.
#[derive(Debug)]
pub struct Renderer {
    pub(crate) scene: Prepared,
    pub(crate) options: Options,
    pub(crate) cache: Cache,
    pub(crate) tally: Tally,
    pub(crate) works: Vec<Mutex<Work>>,
    /// Failed operations of function files that have been warned about.
    told: Vec<ambit_cal::Warning>,
    rays: u64,
    pub(crate) sharing: Option<Sharing>,
}

impl Renderer {
    /// Compiles `loaded` for `options`.
    pub fn new(loaded: Loaded, options: Options, environment: &Environment<'_>) -> Result<Self, Error> {
        let scene = Prepared::new(loaded, &options, environment)?;
        let passes = if scene.modifiers.spectral() { options.spectrum.passes() } else { 1 };
        let cache = Cache::new(params(&options, passes), scene.cube.origin, scene.cube.edge);
        let sources = scene.sources.len();
        let works = (0..=rayon::current_num_threads()).map(|_| Mutex::new(Work::new(sources))).collect();
        Ok(Self { cache, scene, options, tally: Tally::new(sources), works, told: Vec::new(), rays: 0, sharing: None })
    }

    /// Begins anew with an empty cache and other settings: the seed, and what trades time for error, which is `-aa -ad
    /// -as -ar -ds -dt`. Everything else stays as the scene was compiled for, whatever `settings` say of it. Rays are
    /// counted on. An ambient file must not be shared yet.
    pub fn restart(&mut self, settings: &Options) {
        let (own, other) = (&mut self.options, settings);
        own.seed = other.seed;
        (own.direct.sampling, own.direct.threshold) = (other.direct.sampling, other.direct.threshold);
        let (a, b) = (&mut own.ambient, &other.ambient);
        (a.accuracy, a.resolution) = (b.accuracy, b.resolution);
        (a.divisions, a.super_samples) = (b.divisions, b.super_samples);
        let cube = &self.scene.cube;
        self.cache = Cache::new(params(&self.options, self.passes()), cube.origin, cube.edge);
        self.tally = Tally::new(self.scene.sources.len());
    }

    /// As [`Renderer::trace`], by wavelength: the first pass's answers, and the spectra of all.
    pub fn trace_spectra(
        &mut self,
        requests: &[Request],
        notify: &dyn Notify,
    ) -> Result<(Vec<Answer>, Spectra), Error> {
        let mut passes: Vec<Vec<Answer>> = vec![Vec::new(); self.passes()];
        self.trace_passes(requests, notify, &mut passes)?;
        let spectra = Spectra::gather(&self.options.spectrum, &passes);
        Ok((passes.swap_remove(0), spectra))
    }

    /// How many passes a calculation by wavelength takes in this scene.
    pub fn passes(&self) -> usize {
        usize::from(self.cache.params().passes)
    }

    /// Answers `requests`, in order. Warnings (of the ambient file, of function files) go to `notify`. Answers replace what
    /// is in `answers`, so that one piece of memory serves many batches.
    pub fn trace(&mut self, requests: &[Request], notify: &dyn Notify, answers: &mut Vec<Answer>) -> Result<(), Error> {
        self.trace_into(requests, notify, answers)
    }

    /// As [`Renderer::trace`], of rays that are made where they are needed, and kept as far as a picture needs it. What there
    /// is no ray for is black and without length.
    pub fn see(&mut self, rays: &dyn Rays, notify: &dyn Notify, seen: &mut Vec<Seen>) -> Result<(), Error> {
        self.trace_into(rays, notify, seen)
    }

    fn trace_into<R: Reply>(
        &mut self,
        rays: &(impl Rays + ?Sized),
        notify: &dyn Notify,
        answers: &mut Vec<R>,
    ) -> Result<(), Error> {
        let mut passes = vec![Vec::new(); self.passes()];
        passes[0] = std::mem::take(answers);
        passes[0].clear();
        let outcome = self.trace_passes(rays, notify, &mut passes);
        *answers = passes.swap_remove(0);
        outcome
    }

    /// Adds the answers of all passes.
    fn trace_passes<R: Reply>(
        &mut self,
        rays: &(impl Rays + ?Sized),
        notify: &dyn Notify,
        answers: &mut [Vec<R>],
    ) -> Result<(), Error> {
        let count = rays.count();
        for all in &mut *answers {
            all.reserve(count);
        }
        for first in (0..count).step_by(BATCH) {
            let outcome = self.batch(rays, first..count.min(first + BATCH), answers);
            self.complain(notify);
            outcome?;
            self.exchange(notify, false)?;
        }
        Ok(())
    }

    fn batch<R: Reply>(
        &mut self,
        rays: &(impl Rays + ?Sized),
        batch: Range<usize>,
        answers: &mut [Vec<R>],
    ) -> Result<(), Error> {
        let tracer = Tracer { scene: &self.scene, options: &self.options, tally: &self.tally, works: &self.works };
        let cache = &self.cache;
        let (first, passes) = (answers[0].len(), answers.len());
        let piece = (batch.len() / PARALLEL_FROM).clamp(1, TOGETHER);
        let parts = cache.steps().in_order(batch.len().div_ceil(piece), PARALLEL_FROM, 1, |k| {
            let numbers = batch.start + k * piece..batch.end.min(batch.start + (k + 1) * piece);
            let answers = (0..passes).map(|_| Vec::with_capacity(numbers.len())).collect();
            let mut part = Part { answers, misses: Vec::new(), owners: Vec::new() };
            let mut work = tracer.work();
            for number in numbers {
                let request = rays.ray(number);
                for (pass, answers) in part.answers.iter_mut().enumerate() {
                    let (misses, pass) = (&mut part.misses, pass as u8);
                    let mut walk = Walk { tracer: &tracer, cache, work: &mut work, misses, pass, observer: () };
                    answers.push(request.as_ref().map_or_else(R::none, |request| R::of(walk.answer(request))));
                }
                part.owners.resize(part.misses.len(), first + number - batch.start);
            }
            part
        });
        let (mut misses, mut owners) = (Vec::new(), Vec::new());
        for part in parts {
            answers.iter_mut().zip(&part.answers).for_each(|(all, own)| all.extend_from_slice(own));
            misses.extend(part.misses);
            owners.extend(part.owners);
        }
        if !misses.is_empty() && !self.scene.fault.is_set() {
            let values = self.cache.resolve(&tracer, &misses);
            for ((miss, value), owner) in misses.iter().zip(values).zip(owners) {
                answers[usize::from(miss.query.pass)][owner].add(miss.coefficient * value);
            }
        }
        for answer in answers.iter_mut().flat_map(|all| &mut all[first..]) {
            answer.make_finite();
        }
        self.settle()
    }

    /// Lets the next batch see what this one has counted.
    pub(crate) fn settle(&mut self) -> Result<(), Error> {
        for work in &self.works {
            let mut work = work.lock().unwrap_or_else(PoisonError::into_inner);
            self.tally.take(&mut work.tally);
            self.rays += std::mem::take(&mut work.rays);
            // A refusal leaves it high (see `Walk::evaluate`).
            work.nested = 0;
        }
        self.scene.fault.take().map_or(Ok(()), Err)
    }

    /// Tells what function files had no values for: each failed operation and each modifier once.
    pub(crate) fn complain(&mut self, notify: &dyn Notify) {
        for work in &self.works {
            let mut work = work.lock().unwrap_or_else(PoisonError::into_inner);
            for warning in work.cal.drain_warnings() {
                if !self.told.contains(&warning) {
                    self.told.push(warning);
                    notify.warn(&warning.to_string());
                }
            }
        }
        let objects = &self.scene.objects;
        self.scene.complaints.drain(|text, id| notify.warn(&format!("{text} for {}", objects.describe(id))));
    }

    /// Rays traced so far, in all passes.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// The irradiance cache.
    pub fn cache(&self) -> &Cache {
        &self.cache
    }

    /// The irradiance cache, to load records into.
    pub(crate) fn cache_mut(&mut self) -> &mut Cache {
        &mut self.cache
    }

    /// Outlines of the light sources that pictures may have to draw ([`Aim::Source`] asks for their light).
    pub fn source_outlines(&self) -> Vec<SourceOutline> {
        outlines(&self.scene.sources)
    }

    /// Identifier of an object, in whatever encoding the scene has; `*` for [`VOID`] as a surface is the caller's affair.
    /// `modifier` is that of the surface that was hit.
    pub fn name(&self, id: ObjectId, modifier: ObjectId) -> &[u8] {
        if id == VOID {
            return b"void";
        }
        let object = self.scene.objects.object(id);
        // Triangles that keep materials of their own tell the name that Radiance gives them; those without, the mesh's.
        let triangles = object.kind == Kind::Mesh && object.modifier == VOID && modifier != VOID;
        if triangles { b"M-Tri" } else { self.scene.objects.name_bytes(id) }
    }
}

/// What of the options the irradiance cache has to know.
fn params(options: &Options, passes: usize) -> Params {
    let a = &options.ambient;
    Params {
        bounces: a.bounces,
        accuracy: a.accuracy,
        resolution: a.resolution,
        divisions: a.divisions,
        super_samples: a.super_samples,
        value: a.value,
        weight: a.weight,
        min_weight: options.limits.weight,
        overlap: a.overlap,
        smoothing: a.smoothing,
        passes: passes as u8,
        seed: options.seed,
        // Without an end to bounces none is the last.
        systems: if a.unbounded { Systems { bounces: Bounces::Mixed, ..a.systems } } else { a.systems },
    }
}

impl Tracer<'_> {
    /// The medium outside every mist and dielectric.
    pub(crate) fn global_interior(&self) -> Interior {
        let m = &self.options.medium;
        Interior { extinction: m.extinction, albedo: m.albedo, eccentricity: m.eccentricity as f32, sources: 0 }
    }

    /// What is known of a ray that has been followed; its hit only if that was `met`.
    pub(crate) fn describe(&self, ray: &Ray<'_>, met: bool) -> Answer {
        let mut answer = Answer::nothing(ray.origin, ray.direction);
        answer.value = ray.value;
        answer.mirrored = ray.mirrored;
        answer.length = ray.effective_length();
        answer.mirrored_length = ray.mirrored_length;
        answer.unmirrored_length = ray.unmirrored_length;
        answer.first_length = ray.distance;
        answer.point = ray.point;
        answer.weight = ray.weight;
        answer.coefficient = ray.throughput * ray.attenuation();
        if let Some(hit) = &ray.hit
            && met
        {
            // What lets rays pass, and the back of a light, turn no normal.
            answer.normal = if ray.normal == DVec3::ZERO { hit.normal } else { ray.normal };
            answer.geometric_normal = hit.normal;
            answer.uv = hit.uv;
            answer.surface = hit.object;
            answer.modifier = hit.modifier;
            answer.material = self.scene.modifiers.shader(hit.modifier);
        }
        answer
    }

    fn stream(&self, index: u32) -> Stream {
        let key = hash_bits(&[self.options.seed, 0x0a11]);
        if self.options.uncorrelated { Stream::uncorrelated(index, key) } else { Stream::new(index, key) }
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn answer(&mut self, request: &Request) -> Answer {
        let tracer = self.tracer;
        // Those before are other requests'.
        let first = self.misses.len();
        let direction = request.direction.normalize_or_zero();
        if direction == DVec3::ZERO || !request.origin.is_finite() {
            return Answer::nothing(request.origin, direction);
        }
        let stream = tracer.stream(request.index);
        let interior = tracer.global_interior();
        let mut ray = match request.aim {
            Aim::Irradiance => {
                let start = request.origin + direction * SENSOR_LIFT;
                Ray::primary(start, -direction, FAR, interior, stream)
            }
            Aim::Radiance | Aim::Geometry | Aim::Source(_) => {
                Ray::primary(request.origin, direction, request.limit, interior, stream)
            }
        };
        match request.aim {
            Aim::Irradiance => {
                self.work.rays += 1;
                ray.distance = SENSOR_DISTANCE;
                ray.point = ray.origin + ray.direction * SENSOR_DISTANCE;
                ray.hit = Some(sensor(SENSOR_DISTANCE, direction));
                ray.unmirrored_length = SENSOR_DISTANCE;
                self.lambertian(&mut ray, DVec3::ZERO);
            }
            Aim::Radiance => self.evaluate(&mut ray),
            Aim::Geometry => self.locate(&mut ray),
            Aim::Source(id) => {
                ray.kind = Kinds::SHADOW_REFLECTED;
                ray.lineage = Kinds::SHADOW_REFLECTED;
                let mut ray_to_source = ray.aimed(id);
                self.evaluate(&mut ray_to_source);
                ray = ray_to_source;
            }
        }
        let value = ray.value + self.endless(first);
        Answer { value, ..tracer.describe(&ray, request.aim != Aim::Irradiance) }
    }

    /// Finds the nearest surface and shades nothing.
    fn locate(&mut self, ray: &mut Ray<'_>) {
        self.work.rays += 1;
        let Some(hit) = self.tracer.scene.world.nearest(&ray.query()) else {
            if ray.limit < FAR {
                ray.point = ray.origin + ray.direction * ray.limit;
            } else {
                self.meet_distant(ray);
            }
            return;
        };
        ray.distance = hit.distance;
        ray.unmirrored_length = hit.distance;
        ray.point = ray.origin + ray.direction * hit.distance;
        ray.normal = if hit.cosine < 0.0 { -hit.normal } else { hit.normal };
        ray.hit = Some(hit);
    }
}
