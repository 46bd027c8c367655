//! Bounces without end (`--unbounded-bounces`): where the calculation would stop, a path goes on in one direction, and at
//! each further diffuse surface it goes on with a probability equal to the largest channel of the reflectance. Survivors
//! make up for the others, so that the expected value has all bounces in it (Arvo & Kirk 1990, *Particle Transport and
//! Image Synthesis*).
//!
//! Paths are followed one after the other, not one inside the other: their length is not limited by the stack. Ray trees
//! are the exception, where a path is shown as a branch of the ray that it comes from.

use crate::Error;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::tracer::Origin;
use crate::walk::Walk;
use ambit_ambient::{Miss, Query};
use ambit_base::{Frame, Rgb, Stream, hash_bits, hash_point, square_to_disk};

/// Largest probability of going on: between perfectly white walls paths end, too, after ten thousand bounces on average.
const LIKELIEST: f32 = 0.9999;
/// Followed so far, the paths of one sample do not end: surfaces send out more than they get. Between perfectly white walls
/// so many bounces come to pass once in e¹⁰⁰ samples.
const MOST: usize = 1_000_000;
/// So many paths at once are only where each becomes several.
const CROWD: usize = 10_000;
/// Tag of the number that decides; the far side's is the next.
const SURVIVAL: u64 = 0xe0;

impl<O: Observer> Walk<'_, O> {
    /// True if paths go on after the last bounce. `-ab 0` asks for no bounces, and `-ad 0` for none of any kind.
    pub(crate) fn is_endless(&self) -> bool {
        let a = &self.tracer.options.ambient;
        a.unbounded && a.bounces > 0 && a.divisions > 0
    }

    /// Russian roulette at a diffuse surface behind the last bounce; what survives waits among the misses, unless somebody
    /// looks on, who wants each path where it belongs.
    pub(crate) fn survive(&mut self, ray: &mut Ray<'_>, coefficient: Rgb, query: Query<Origin>) {
        // A negative pattern takes light away.
        let chance = coefficient.abs().max_element().min(LIKELIEST);
        let side = u64::from(query.origin.is_transmitted());
        if ray.stream.child(SURVIVAL + side).one() < f64::from(chance) {
            if O::ACTIVE {
                self.nested(ray, coefficient / chance, &query);
                return;
            }
            let coefficient = ray.throughput * ray.attenuation() * coefficient / chance;
            self.misses.push(Miss { coefficient, query });
        }
    }

    /// Follows the rest of a path inside of what its beginning is followed by.
    fn nested(&mut self, ray: &mut Ray<'_>, coefficient: Rgb, query: &Query<Origin>) {
        let Some(mut child) = self.continued(query) else { return };
        if self.tracer.scene.fault.is_set() {
            return;
        }
        child.parent = Some(ray);
        child.throughput = ray.throughput * ray.attenuation() * coefficient;
        child.coefficient = coefficient;
        self.evaluate(&mut child);
        let value = child.value;
        ray.value += coefficient * value;
    }

    /// The ray that goes on where a question behind the last bounce was asked; none if it would go through the surface.
    fn continued(&self, query: &Query<Origin>) -> Option<Ray<'static>> {
        let stream = Stream::new(
            0,
            hash_bits(&[hash_point(query.position), hash_point(query.shading), self.tracer.options.seed, SURVIVAL]),
        );
        let [s, t] = stream.two();
        let [p, q] = square_to_disk(s, t);
        let frame = Frame::around(query.shading);
        let direction = frame.u * p + frame.v * q + frame.n * (1.0 - p * p - q * q).max(f64::EPSILON).sqrt();
        if direction.dot(query.normal) <= 0.0 {
            return None;
        }
        let mut ray = query.origin.go_on(query.position, direction.normalize(), stream);
        // The roulette keeps weights as they are, and stands for the limits.
        ray.weight = query.weight;
        ray.depth = query.level;
        Some(ray)
    }

    /// Follows all paths that wait among the misses from `first` on, and returns what they bring together. Questions to
    /// the cache stay.
    pub(crate) fn endless(&mut self, first: usize) -> Rgb {
        if !self.is_endless() {
            return Rgb::ZERO;
        }
        let end = self.tracer.options.ambient.bounces.min(255);
        let mut sum = Rgb::ZERO;
        let mut at = first;
        let mut followed = 0;
        while at < self.misses.len() {
            if i32::from(self.misses[at].query.level) < end {
                at += 1;
                continue;
            }
            let Miss { coefficient, query } = self.misses.swap_remove(at);
            followed += 1;
            if self.tracer.scene.fault.is_set() {
                // The calculation ends anyway.
                self.misses.truncate(first);
                return Rgb::ZERO;
            }
            if followed > MOST || self.misses.len() - first > CROWD || !coefficient.is_finite() {
                self.fail(Error::user(
                    "bounces without end bring endless light: surfaces reflect more than they receive",
                ));
                self.misses.truncate(first);
                return Rgb::ZERO;
            }
            let Some(mut ray) = self.continued(&query) else { continue };
            let new = self.misses.len();
            self.evaluate(&mut ray);
            sum += coefficient * ray.value;
            for miss in &mut self.misses[new..] {
                miss.coefficient *= coefficient;
            }
        }
        sum
    }
}
