//! Direct light where a hemisphere sample ends: few lamps are looked at and fewer shadows tested, chosen at random so
//! that the mean is right: of about eight candidates two shadows are tested. What that adds to the noise of the
//! hemisphere is small beside what it has anyway.

use super::choice::Share;
use super::direct::{Candidate, brightness, index, rank};
use super::lamp::{Place, View};
use super::{Chosen, Lamp};
use crate::observer::Observer;
use crate::ray::{Interior, Ray};
use crate::walk::Walk;
use ambit_base::{Colour, DVec3, FAR, Rgb, Stream};

/// What counts of light that comes from the far side of the axis nearest to a normal: surfaces lean from it by up to 55°.
const LEAN: f64 = 0.15;

/// Shadow tests at most.
pub(super) const TESTED: usize = 2;

/// Corners of a cell where lamps are asked: those of a tetrahedron.
const PROBES: [usize; 4] = [0, 3, 5, 6];

/// Tags of what chooses lamps, and the shadows to be tested.
const LAMPS: u64 = 0x4c;
const SHADOWS: u64 = 0x4d;

impl<O: Observer> Walk<'_, O> {
    /// True where a ray is one of a hemisphere's and lamps are many, so that few will do; `-dt 0` wants all. Where there are
    /// few, all are asked: what is known to block them spares more rays than choosing would.
    pub(super) fn asks_few(&self, ray: &Ray<'_>) -> bool {
        self.tracer.scene.choice.has_many() && ray.is_ambient() && self.tracer.options.direct.threshold > 0.0
    }

    /// The lamps that stand for all at a ray's hit, what lies below the plane of `above` left out. None: all.
    pub(super) fn choose_lamps(&mut self, ray: &Ray<'_>, above: Option<DVec3>) -> Option<Vec<Chosen>> {
        let choice = &self.tracer.scene.choice;
        let spot = choice.spot(ray.point, above)?;
        let mut chosen = std::mem::take(&mut self.work.chosen);
        chosen.clear();
        let table = choice.table(&spot, || self.brought(spot.centre, spot.half, spot.facing));
        table.choose(ray.stream.child(LAMPS).one(), |c| chosen.push(c));
        Some(chosen)
    }

    /// What each lamp brings to a cell, unobstructed: the mean over four of its corners.
    #[cold]
    fn brought(&mut self, centre: DVec3, half: f64, facing: Option<DVec3>) -> Vec<(u32, f32)> {
        let corner = |i: u32| {
            let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            centre + half * DVec3::new(sign(0), sign(1), sign(2))
        };
        let corners: [DVec3; 8] = std::array::from_fn(|i| corner(i as u32));
        let scene = self.tracer.scene;
        // The first pass decides for all: whichever asks first must not matter.
        let mut walk = Walk {
            tracer: self.tracer,
            cache: self.cache,
            work: self.work,
            misses: self.misses,
            pass: 0,
            observer: (),
        };
        let brought = |(i, lamp): (usize, &Lamp)| {
            if lamp.is_behind(&corners) {
                return None;
            }
            let sum: f32 = PROBES.iter().map(|&i| walk.unobstructed(lamp, corners[i], facing)).sum();
            Some((i as u32, if sum.is_finite() { sum.max(0.0) } else { 0.0 }))
        };
        scene.lamps.iter().enumerate().filter_map(brought).collect()
    }

    /// Shadow tests of a few candidates that stand for all. They leave no record: that is for what is seen directly.
    pub(super) fn test_few(&mut self, ray: &mut Ray<'_>, candidates: &[Candidate]) {
        let mut ranks = std::mem::take(&mut self.work.ranks);
        ranks.clear();
        ranks.extend(candidates.iter().enumerate().map(|(i, c)| rank(i, c)));
        ranks.sort_unstable();
        let Share { certain, scale } = Share::of(ranks.iter().map(|&r| brightness(r)), TESTED);
        for &r in &ranks[..certain] {
            let arrived = self.shadow(ray, &candidates[index(r)]);
            ray.value += arrived.unwrap_or(Rgb::ZERO);
        }
        let (mut upto, mut at) = (0.0f32, ray.stream.child(SHADOWS).one() as f32);
        for &r in &ranks[certain..] {
            let probability = brightness(r) * scale;
            upto += probability;
            if upto > at {
                at += 1.0;
                let arrived = self.shadow(ray, &candidates[index(r)].times(probability.recip()));
                ray.value += arrived.unwrap_or(Rgb::ZERO);
            }
        }
        self.work.ranks = ranks;
    }
}

impl Walk<'_> {
    /// Brightness that a lamp brings to a point of a surface that faces about a side.
    fn unobstructed(&mut self, lamp: &Lamp, point: DVec3, facing: Option<DVec3>) -> f32 {
        let place = Place { point, above: None, ratio: f64::INFINITY, jitter: 0.0 };
        let scene = self.tracer.scene;
        let sample = match lamp.view(&scene.sources, &place) {
            View::Dark => return 0.0,
            View::Whole(sample) => sample,
            View::Parts => {
                let (source, stream) = (&scene.sources[lamp.source as usize], Stream::uncorrelated(0, 0));
                let Some(sample) = self.sample(source, point, &super::partition::WHOLE, false, stream) else {
                    return 0.0;
                };
                sample
            }
        };
        // Surfaces face the side more or less.
        let cosine = facing.map_or(1.0, |n| LEAN + (1.0 - LEAN) * sample.direction.dot(n).max(0.0));
        let mut ray = Ray::primary(point, -sample.direction, FAR, Interior::VACUUM, Stream::uncorrelated(0, 0));
        ray.distance = 0.0;
        let emitted: Rgb = self.emitted(&ray, lamp.source, sample, false);
        emitted.brightness() * (sample.solid_angle * cosine) as f32
    }
}
