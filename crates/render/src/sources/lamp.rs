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

    /// True for points inside a spherical lamp or on it, at the distance of its centre: they see it from behind.
    pub(crate) fn encloses(&self, distance: f64) -> bool {
        self.form == Form::Ball && distance <= self.radius + EPSILON
    }
}
