//! What the direct calculation reads of every sampled source at every hit, in one row; and the sample of sources that
//! are taken whole and at their centre, which is nearly all of them.

use super::direct::Sample;
use super::{Emitter, Source, SourceId};
use ambit_base::{DVec3, EPSILON, FAR, Rgb};

/// A sampled source, as far as the direct calculation goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lamp {
    pub(crate) source: SourceId,
    form: Form,
    /// It lies at infinity.
    distant: bool,
    /// Restrictions or the cone of a spotlight keep its light from some points.
    guarded: bool,
    /// It emits `emission` wherever a sample at its centre can see it from.
    pub(crate) uniform: bool,
    pub(crate) emission: Rgb,
    /// Where the sample is taken: a point, or the unit direction of a distant source.
    centre: DVec3,
    normal: DVec3,
    /// The radius of a ball.
    radius: f64,
    size: f64,
    /// No sample lies farther than this from the centre.
    extent: f64,
    /// Farther than this from the centre it lights nothing directly.
    reach: f64,
    /// Its width along the longer axis: where the distance over `-ds` is no less, it is not divided.
    width: f64,
}

/// How solid angles of samples are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Flat,
    Ball,
    Distant,
    /// By way of the source itself.
    Other,
}

/// What is lit, and how sources are sampled there.
pub(crate) struct Place {
    pub(crate) point: DVec3,
    /// Nothing below the plane of this unit vector matters.
    pub(crate) above: Option<DVec3>,
    /// The least ratio of distance to width at which sources stay whole: `-ds` over the weight of the ray, or infinite.
    pub(crate) ratio: f64,
    /// `-dj`.
    pub(crate) jitter: f64,
}

/// How a place sees a lamp.
pub(crate) enum View {
    /// Not at all.
    Dark,
    /// As a whole, by a sample at its centre.
    Whole(Sample),
    /// By what the source itself says of its parts.
    Parts,
}

impl Lamp {
    /// The lamps among `sources`, in their order.
    pub(crate) fn all(sources: &[Source]) -> Vec<Self> {
        let sampled = |(_, s): &(usize, &Source)| s.sampled;
        sources.iter().enumerate().filter(sampled).map(|(id, s)| Self::of(id as SourceId, s)).collect()
    }

    fn of(id: SourceId, source: &Source) -> Self {
        let form = match source.emitter {
            Emitter::Polygon(_) | Emitter::Ring(_) => Form::Flat,
            Emitter::Sphere(_) => Form::Ball,
            Emitter::Distant => Form::Distant,
            Emitter::Cylinder(_) => Form::Other,
        };
        let distant = matches!(source.emitter, Emitter::Distant);
        let centre = source.sample_point([0.0; 3], false);
        Self {
            source: id,
            form,
            distant,
            guarded: source.spot.is_some() || !source.restrictions.is_empty(),
            uniform: !source.patterned && source.image.is_none(),
            emission: source.emission,
            centre: if distant { centre.normalize() } else { centre },
            normal: source.normal,
            radius: source.radius,
            size: source.size,
            extent: source.extent,
            reach: if source.reach < FAR { source.reach } else { f64::INFINITY },
            width: 2.0 * source.axes[0].length().max(source.axes[1].length()),
        }
    }

    /// How a place sees the lamp, one of these sources.
    #[expect(
        clippy::inline_always,
        reason = "samples are not copied where it is compiled into the loop over all lamps"
    )]
    #[inline(always)]
    pub(crate) fn view(&self, sources: &[Source], place: &Place) -> View {
        let to = if self.distant { self.centre } else { self.centre - place.point };
        if place.above.is_some_and(|n| to.dot(n) < -self.extent * place.jitter.max(1.0)) {
            return View::Dark;
        }
        if place.jitter > EPSILON || self.form == Form::Other {
            return View::Parts;
        }
        let (mut direction, mut distance, mut solid_angle) = (to, FAR, self.size);
        if self.form != Form::Distant {
            let flat = self.form == Form::Flat;
            if flat && self.normal.dot(to) >= -EPSILON {
                return View::Dark;
            }
            distance = to.length();
            if flat && distance * place.ratio < self.width && place.ratio.is_finite() {
                return View::Parts;
            }
            if distance <= EPSILON || distance > self.reach {
                return View::Dark;
            }
            direction = to / distance;
            if flat {
                let cosine = -self.normal.dot(direction);
                if cosine <= Source::LEAST_SHARE {
                    return View::Dark;
                }
                solid_angle *= cosine;
            }
            solid_angle /= distance * distance;
        }
        if self.guarded {
            let Some(admitted) = sources[self.source as usize].admitted(place.point, direction, distance) else {
                return View::Dark;
            };
            solid_angle *= admitted;
        }
        View::Whole(Sample { direction, distance, solid_angle })
    }

    /// True if it is flat and none of these points, nor what lies between them, can be lit.
    pub(crate) fn is_behind(&self, points: &[DVec3]) -> bool {
        self.form == Form::Flat && points.iter().all(|&p| self.normal.dot(self.centre - p) >= 0.0)
    }

    /// True for points inside a spherical lamp or on it, at the distance of its centre: they see it from behind.
    pub(crate) fn encloses(&self, distance: f64) -> bool {
        self.form == Form::Ball && distance <= self.radius + EPSILON
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sources::partition::parts;
    use ambit_base::{Silent, Stream};
    use ambit_scene::{NoCommands, Reader, Scene, Shape, VOID};

    const SHAPES: &[u8] = b"
        void polygon square 0 0 12  1 0 2  1 1 2  2 1 2  2 0 2
        void polygon corner 0 0 9  0 0 2  0 1 2  1 0 2
        void ring disc 0 0 8  .3 -.2 1.5  .1 .2 -1  0 .4
        void sphere ball 0 0 4  .4 .5 .3  .2
        void cylinder tube 0 0 7  0 0 2  1 .5 2  .05
        void source sun 0 0 4  1 2 3  .5";

    fn sources() -> Vec<Source> {
        let mut scene = Scene::new();
        Reader::new(&mut scene, &Silent, &mut NoCommands).read_bytes("shapes", SHAPES).unwrap();
        let source = |id| {
            let (shape, _) = Shape::from_object(&scene, id).unwrap();
            let g = Source::from_shape(shape).unwrap();
            Source {
                object: id,
                modifier: VOID,
                emitter: g.emitter,
                centre: g.centre,
                axes: g.axes,
                size: g.size,
                radius: g.radius,
                extent: 1.0,
                normal: g.normal,
                emission: Rgb::ONE,
                patterned: false,
                reach: FAR,
                glow: false,
                illum: false,
                clear: false,
                spot: None,
                sampled: true,
                image: None,
                restrictions: Vec::new(),
            }
        };
        scene.ids().map(source).collect()
    }

    /// What the source itself makes of being sampled whole and at its centre: None in the dark, or how it is divided.
    fn longhand(source: &Source, point: DVec3, ratio: f64) -> Result<Option<(DVec3, f64)>, usize> {
        let mut divided = Vec::new();
        parts(source, point, ratio, &mut divided);
        let [part] = divided.as_slice() else {
            return if divided.is_empty() { Ok(None) } else { Err(divided.len()) };
        };
        let target = source.sample_point(part.centre, false);
        let distant = matches!(source.emitter, Emitter::Distant);
        let (to, distance) = if distant { (target, FAR) } else { (target - point, target.distance(point)) };
        let direction = if distant { to.normalize() } else { to / distance };
        Ok(source.solid_angle(direction, distance, part.share).map(|omega| (direction, omega)))
    }

    #[test]
    fn the_short_way_samples_as_the_long_one() {
        let sources = sources();
        let lamps = Lamp::all(&sources);
        assert_eq!(lamps.len(), 6);
        let (mut dark, mut whole, mut divided) = (0, 0, 0);
        for i in 0..2000 {
            let point = DVec3::from(Stream::new(i, 1).three()) * 4.0 - 1.0;
            for ratio in [f64::INFINITY, 4.0, 0.5] {
                let place = Place { point, above: None, ratio, jitter: 0.0 };
                for (lamp, source) in lamps.iter().zip(&sources) {
                    let expected = longhand(source, point, ratio);
                    match lamp.view(&sources, &place) {
                        View::Dark => {
                            dark += 1;
                            assert_eq!(expected, Ok(None));
                        }
                        View::Whole(sample) => {
                            whole += 1;
                            assert_eq!(expected, Ok(Some((sample.direction, sample.solid_angle))));
                        }
                        View::Parts if matches!(source.emitter, Emitter::Cylinder(_)) => {}
                        View::Parts => {
                            divided += 1;
                            assert!(expected.is_err_and(|n| n > 1));
                        }
                    }
                }
            }
        }
        assert!(dark > 500 && whole > 500 && divided > 500, "{dark} {whole} {divided}");
    }

    #[test]
    fn nothing_below_the_plane_is_seen_and_jitter_asks_for_parts() {
        let sources = sources();
        for lamp in Lamp::all(&sources) {
            let up = DVec3::new(1.0, 2.0, 3.0).normalize();
            let at = |height: f64, jitter| Place { point: up * height, above: Some(up), ratio: 1.0, jitter };
            if lamp.form != Form::Distant {
                assert!(matches!(lamp.view(&sources, &at(10.0, 0.0)), View::Dark));
            }
            assert!(matches!(lamp.view(&sources, &at(-10.0, 1.0)), View::Parts));
        }
    }
}
