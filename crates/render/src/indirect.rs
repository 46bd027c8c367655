//! Diffuse interreflection at one hit: ask the cache, defer what it cannot answer, or sample a hemisphere on the spot
//! where nothing is cached (`-aa 0`).

use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::tracer::Origin;
use crate::walk::Walk;
use ambit_ambient::{Answer, Hemisphere, Miss, Query, Tilt};
use ambit_base::{DVec3, EPSILON, Rgb};

/// Tag of a hemisphere's point set; the far side's is the next.
const HEMISPHERE: u64 = 0xa0;
/// Fewer samples than these do not tell what a texture's tilt does, and count alike, as in Radiance: their own noise is
/// most of the gradient that they give.
const LEAST_FOR_TILT: usize = 49;

impl<O: Observer> Walk<'_, O> {
    /// As [`Walk::ambient`], for materials that take a coefficient without a positive channel as none.
    pub(crate) fn positive_ambient(&mut self, ray: &mut Ray<'_>, coefficient: Rgb, shading: DVec3) {
        if coefficient.max_element() > EPSILON as f32 {
            self.ambient(ray, coefficient, shading);
        }
    }

    /// Adds `coefficient` × (irradiance/π) on the side of the surface that `shading` points to. `shading` is the
    /// textured normal, or its negative for the far side.
    pub(crate) fn ambient(&mut self, ray: &mut Ray<'_>, coefficient: Rgb, shading: DVec3) {
        // A negative pattern takes light away here, though not from the light of sources.
        if coefficient.abs().max_element() <= EPSILON as f32 {
            return;
        }
        let facing = ray.facing_normal();
        let transmitted = shading.dot(facing) < 0.0;
        let normal = if transmitted { -facing } else { facing };
        let modifier = ray.hit.as_ref().map(|h| h.modifier);
        if !modifier.is_none_or(|m| self.tracer.scene.takes_part(m)) {
            ray.value += coefficient * self.cache.fallback();
            return;
        }
        let query = Query {
            position: ray.point,
            normal,
            shading,
            weight: ray.weight,
            level: ray.depth,
            pass: self.pass,
            origin: Origin::of(ray, transmitted, coefficient.max_element().min(1.0)),
        };
        if O::ACTIVE {
            self.follow_hemisphere(ray, &query, coefficient);
        }
        match self.cache.ask(self.tracer, &query) {
            Answer::Fallback(_) if self.is_endless() => self.survive(ray, coefficient, query),
            Answer::Value(light) => {
                ray.value += coefficient * light.value;
                if ray.depth > 0 {
                    let k = ray.throughput * ray.attenuation() * coefficient;
                    self.work.late.iter_mut().zip(light.late).for_each(|(sum, late)| *sum += k * late);
                }
            }
            Answer::Fallback(v) => ray.value += coefficient * v,
            Answer::Miss => {
                let k = ray.throughput * ray.attenuation() * coefficient;
                let origin = query.origin.moved(self.off_edges(ray, normal));
                self.misses.push(Miss { coefficient: k, query: Query { origin, ..query } });
            }
            Answer::Uncached => self.hemisphere(ray, coefficient, normal, shading, transmitted),
        }
    }

    /// Samples the hemisphere about `normal` by rays of this very path (irradiance caching off).
    fn hemisphere(&mut self, ray: &mut Ray<'_>, coefficient: Rgb, normal: DVec3, shading: DVec3, transmitted: bool) {
        let params = self.cache.params();
        let stream = ray.stream.child(HEMISPHERE + u64::from(transmitted));
        let about = if self.tracer.options.ambient.exact_textures { shading } else { normal };
        let Some(plan) = Hemisphere::new(params, ray.weight, coefficient.max_element(), about, stream, false) else {
            ray.value += coefficient * self.cache.fallback();
            return;
        };
        let kind = if transmitted { Kinds::AMBIENT_TRANSMITTED } else { Kinds::AMBIENT_REFLECTED };
        let k = coefficient / plan.len() as f32;
        let mut sum = Rgb::ZERO;
        let mut tilt = Tilt::default();
        let mut alive = 0;
        for cell in 0..plan.len() {
            if about != normal && plan.direction(cell).dot(normal) <= 0.0 {
                // Below the surface there is nothing to be seen.
                alive += 1;
                continue;
            }
            let Some(mut child) = self.child(ray, kind, plan.direction(cell), k, cell as u64) else { continue };
            child.stream = plan.stream(cell);
            self.evaluate(&mut child);
            alive += 1;
            let light = child.coefficient * child.value;
            if plan.len() >= LEAST_FOR_TILT {
                tilt.add(&plan, cell, light);
            }
            sum += light;
        }
        if alive == 0 && !self.is_endless() {
            ray.value += coefficient * self.cache.fallback();
            return;
        }
        ray.value += sum * tilt.factor(&plan, shading);
    }
}
