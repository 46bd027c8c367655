//! Following rays: the nearest hit, what passes through, the medium on the way, and the distant sources.

use crate::Error;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray, THINNEST, transmittance};
use crate::tracer::{Origin, Tracer};
use crate::work::Work;
use ambit_ambient::{Cache, Miss};
use ambit_base::{EPSILON, FAR, Rgb};
use ambit_trace::Hit;

/// One item's way through the scene: what shading reads, and what it leaves behind.
///
/// Everything read is frozen while a batch is computed. Diffuse questions that the cache cannot answer are pushed on
/// `misses` with their coefficients; the item's value lacks them until they are resolved.
pub(crate) struct Walk<'s, O = ()> {
    pub(crate) tracer: &'s Tracer<'s>,
    pub(crate) cache: &'s Cache,
    pub(crate) work: &'s mut Work,
    pub(crate) misses: &'s mut Vec<Miss<Origin>>,
    /// Which pass of a calculation by wavelength this is.
    pub(crate) pass: u8,
    /// Sees the rays; `()` where nobody wants to.
    pub(crate) observer: O,
}

impl<O: Observer> Walk<'_, O> {
    /// Traces a ray and shades what it meets.
    pub(crate) fn evaluate(&mut self, ray: &mut Ray<'_>) {
        self.work.rays += 1;
        if self.work.nested >= MOST_NESTED {
            self.fail(Error::user(format!("more than {MOST_NESTED} rays that wait for each other are not supported")));
            // Of those that wait none goes on; without this each would follow its other rays as deep again.
            self.work.nested = u32::MAX / 2;
            return;
        }
        self.work.nested += 1;
        if let Some(hit) = self.tracer.scene.world.nearest(&ray.query()) {
            self.shade_hit(ray, hit);
        } else {
            if ray.limit < FAR {
                ray.point = ray.origin + ray.direction * ray.limit;
            } else {
                self.distant(ray);
            }
            self.observer.finished(self.tracer, ray);
            // A medium goes on without end, whatever the limit of sight.
            self.medium(ray);
        }
        self.work.nested -= 1;
    }

    /// Shades a ray that meets `hit` first.
    pub(crate) fn shade_hit(&mut self, ray: &mut Ray<'_>, hit: Hit) {
        ray.distance = hit.distance;
        ray.unmirrored_length = hit.distance;
        ray.point = ray.origin + ray.direction * hit.distance;
        ray.hit = Some(hit);
        ray.next_clipped = ray.clipped;
        let hidden = ray.clipped != 0 && self.tracer.scene.clip_sets.contains(ray.clipped, hit.modifier);
        if hidden || !self.shade(ray) {
            self.pass_through(ray);
        }
        self.observer.finished(self.tracer, ray);
        self.medium(ray);
    }

    /// Continues a ray unchanged behind its hit.
    pub(crate) fn pass_through(&mut self, ray: &mut Ray<'_>) {
        let (mut child, _) = ray.spawn(Kinds::TRANSFERRED, ray.direction, None, &self.tracer.options.limits, PASS);
        // The extinction on this segment is applied once, by `medium`.
        child.throughput *= ray.attenuation();
        self.evaluate(&mut child);
        let (value, mirrored) = (child.value, child.mirrored);
        let (r, x) = (child.mirrored_length, child.unmirrored_length);
        ray.value = value;
        ray.mirrored = mirrored;
        ray.mirrored_length = ray.distance + r;
        ray.unmirrored_length = ray.distance + x;
    }

    /// Applies the medium between a ray's origin and its hit.
    #[inline]
    fn medium(&mut self, ray: &mut Ray<'_>) {
        if ray.interior.extinction.max_element() >= THINNEST {
            self.cross_medium(ray);
        }
    }

    #[inline(never)]
    fn cross_medium(&mut self, ray: &mut Ray<'_>) {
        let interior = ray.interior;
        let t = ray.attenuation();
        ray.value *= t;
        ray.mirrored *= t;
        if !ray.is_shadow() && interior.albedo.max_element() > EPSILON as f32 {
            let lost = Rgb::ONE - transmittance(interior.extinction, ray.distance);
            ray.value += interior.albedo * self.tracer.options.ambient.value * lost;
            if interior.sources != 0 {
                self.in_scatter(ray);
            }
        }
    }

    /// A child of a shaded ray: spawned with its share of the parent's throughput, the medium before the hit included.
    #[expect(clippy::inline_always, reason = "a ray is large: built in place it is not copied")]
    #[inline(always)]
    pub(crate) fn child<'p>(
        &self,
        ray: &'p Ray<'_>,
        kind: Kinds,
        direction: ambit_base::DVec3,
        coefficient: Rgb,
        tag: u64,
    ) -> Option<Ray<'p>> {
        let (mut child, alive) = ray.spawn(kind, direction, Some(coefficient), &self.tracer.options.limits, tag);
        child.throughput *= ray.attenuation();
        alive.then_some(child)
    }

    /// Notes the first error of a calculation; the caller of the renderer gets it after the batch.
    pub(crate) fn fail(&self, error: Error) {
        self.tracer.scene.fault.set(error);
    }
}

/// Rays that wait for each other, each on the stack: all the reflections that a ray may have, and what it crosses between
/// them. Programs give each 11 KiB; the most that was measured is 4 (white plastic in a tree of endless paths).
const MOST_NESTED: u32 = 12_000;
const _: () = assert!(MOST_NESTED > crate::ray::MOST_REFLECTIONS as u32);
/// Tag of pass-through rays.
const PASS: u64 = 1;
