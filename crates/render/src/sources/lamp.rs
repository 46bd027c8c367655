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
    /// By way of the source itself: cylinders, spotlights, images.
    Other,
}

/// How a point sees a lamp that is sampled without jitter.
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
        let aimed = source.spot.is_some() || source.image.is_some() || !source.restrictions.is_empty();
        let form = match source.emitter {
            _ if aimed => Form::Other,
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
            uniform: form != Form::Other && !source.patterned,
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

    /// How `point` sees the lamp at the given ratio of distance to width (`-ds` over the weight of the ray).
    #[inline]
    pub(crate) fn view(&self, point: DVec3, ratio: f64) -> View {
        match self.form {
            Form::Other => return View::Parts,
            Form::Distant => {
                return View::Whole(Sample { direction: self.centre, distance: FAR, solid_angle: self.size });
            }
            Form::Flat | Form::Ball => {}
        }
        let to = self.centre - point;
        if self.form == Form::Flat && self.normal.dot(to) >= -EPSILON {
            return View::Dark;
        }
        let distance = to.length();
        if self.form == Form::Flat && ratio.is_finite() && distance * ratio < self.width {
            return View::Parts;
        }
        if distance <= EPSILON || distance > self.reach {
            return View::Dark;
        }
        let direction = to / distance;
        let mut size = self.size;
        if self.form == Form::Flat {
            let cosine = -self.normal.dot(direction);
            if cosine <= Source::LEAST_SHARE {
                return View::Dark;
            }
            size *= cosine;
        }
        View::Whole(Sample { direction, distance, solid_angle: size / (distance * distance) })
    }

    /// True if every sample of the given jitter lies below the plane through `point` with unit normal `n`.
    #[inline]
    pub(crate) fn is_below(&self, point: DVec3, n: DVec3, jitter: f64) -> bool {
        let to = if self.distant { self.centre } else { self.centre - point };
        to.dot(n) < -self.extent * jitter.max(1.0)
    }

    /// True for points inside a spherical lamp or on it, at the distance of its centre: they see it from behind.
    pub(crate) fn encloses(&self, distance: f64) -> bool {
        self.form == Form::Ball && distance <= self.radius + EPSILON
    }
}
