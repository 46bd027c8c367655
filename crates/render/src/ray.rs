//! Rays: what they inherit, what they carry, and where their trees end.
//!
//! A spawned ray has a coefficient colour (its contribution relative to the parent) and a weight, the product of the
//! largest channels along its path. Weight and the number of reflections end the tree, by a limit or by Russian
//! roulette.

use crate::options::Limits;
use crate::sources::SourceId;
use ambit_base::{DVec3, EPSILON, FAR, Rgb, Stream};
use ambit_scene::{ObjectId, VOID};
use ambit_trace::Hit;

/// How a ray came to be, as a set: a ray's own kind, or the union over it and all its ancestors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kinds(u16);

impl Kinds {
    /// No ray, but a place on one.
    pub(crate) const NONE: Self = Self(0);
    pub(crate) const PRIMARY: Self = Self(1);
    pub(crate) const REFLECTED: Self = Self(2);
    pub(crate) const REFRACTED: Self = Self(4);
    pub(crate) const TRANSFERRED: Self = Self(8);
    pub(crate) const SPECULAR_REFLECTED: Self = Self(16);
    pub(crate) const SPECULAR_TRANSMITTED: Self = Self(32);
    pub(crate) const AMBIENT_REFLECTED: Self = Self(64);
    pub(crate) const AMBIENT_TRANSMITTED: Self = Self(128);
    pub(crate) const SHADOW_REFLECTED: Self = Self(256);
    pub(crate) const SHADOW_TRANSMITTED: Self = Self(512);

    /// Either shadow kind.
    pub(crate) const SHADOW: Self = Self(256 | 512);
    /// Either ambient kind.
    pub(crate) const AMBIENT: Self = Self(64 | 128);
    /// Rays whose light the direct calculation has counted already.
    pub(crate) const INDIRECT: Self = Self(16 | 32 | 64 | 128);
    /// Kinds that count as a reflection.
    const RAISING: Self = Self(2 | 16 | 64 | 256);
    /// Kinds that see as far as there is light, however near the aft clipping plane is; the others end with their parents.
    const UNLIMITED: Self = Self(2 | 16 | 64 | 256 | 512);
    /// Kinds that stay aimed at the parent's source.
    const AIMED: Self = Self(4 | 8 | 32 | 128);
    /// Kinds that pass through, so far as the `-i` switch is concerned.
    pub(crate) const STRAIGHT: Self = Self(1 | 8);

    pub(crate) const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(crate) const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    pub(crate) const fn within(self, other: Self) -> bool {
        self.0 & !other.0 == 0
    }

    const fn bits(self) -> u64 {
        self.0 as u64
    }
}

/// A set of sources that mists name, by their numbers among these.
pub(crate) type SourceSet = u64;

/// What fills space along a ray: extinction and albedo per channel, eccentricity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interior {
    pub(crate) extinction: Rgb,
    pub(crate) albedo: Rgb,
    pub(crate) eccentricity: f32,
    /// Sources whose scattered light counts.
    pub(crate) sources: SourceSet,
}

impl Interior {
    pub(crate) const VACUUM: Self = Self { extinction: Rgb::ZERO, albedo: Rgb::ZERO, eccentricity: 0.0, sources: 0 };

    /// The same, within the mists that `around` lies in: a body displaces their matter, but what they list still holds.
    pub(crate) fn within(self, around: Self) -> Self {
        Self { sources: around.sources, ..self }
    }
}

/// Extinction times length below which nothing happens, and above which nothing is left.
const THIN: f32 = 1e-6;
const THICK: f32 = 92.0;
/// Extinctions with no component of this size are none, even on the way to distant sources. Negative ones, as patterns below
/// zero make them, are none either unless another component is above.
pub(crate) const THINNEST: f32 = (1.0 / FAR) as f32;

/// exp(−σt) per channel.
pub(crate) fn transmittance(extinction: Rgb, distance: f64) -> Rgb {
    let one = |sigma: f32| {
        let m = sigma * distance as f32;
        if m <= THIN {
            1.0
        } else if m > THICK {
            0.0
        } else {
            (-m).exp()
        }
    };
    Rgb::new(one(extinction.x), one(extinction.y), one(extinction.z))
}

/// Reflections after which a ray ends whatever `-lr` says. A ray waits on the stack for those that follow from it, some 4 kB
/// each, and between perfect mirrors there is no end; mirrors that keep .999 have lost all but e^-10 by then.
pub(crate) const MOST_REFLECTIONS: i32 = 10_000;

/// A ray, and after evaluation what it met and what it is worth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray<'p> {
    pub(crate) parent: Option<&'p Ray<'p>>,
    pub(crate) origin: DVec3,
    /// Unit length.
    pub(crate) direction: DVec3,
    /// Surfaces at this distance or beyond are out of sight ([`Ray::query`]); [`FAR`] for none.
    pub(crate) limit: f64,
    pub(crate) kind: Kinds,
    /// Union of the kinds of this ray and all its ancestors.
    pub(crate) lineage: Kinds,
    /// Reflections so far.
    pub(crate) level: i32,
    /// Hemispheres open on the path.
    pub(crate) depth: u8,
    pub(crate) weight: f32,
    /// Contribution of this ray's value to its parent's; Russian roulette raises it.
    pub(crate) coefficient: Rgb,
    /// Contribution of this ray's value to the item it belongs to (a pixel, or one hemisphere sample).
    pub(crate) throughput: Rgb,
    /// The light source it is aimed at.
    pub(crate) target: Option<SourceId>,
    pub(crate) interior: Interior,
    /// Modifiers that antimatter has made invisible.
    pub(crate) clipped: ClipSet,
    /// What `clipped` becomes for rays that go on behind the surface.
    pub(crate) next_clipped: ClipSet,
    pub(crate) stream: Stream,
    /// Length of the path before this ray.
    pub(crate) travelled: f64,

    pub(crate) hit: Option<Hit>,
    /// Distance to the surface, or [`FAR`].
    pub(crate) distance: f64,
    pub(crate) point: DVec3,
    pub(crate) value: Rgb,
    pub(crate) mirrored: Rgb,
    /// Effective lengths of the mirrored and the other part.
    pub(crate) mirrored_length: f64,
    pub(crate) unmirrored_length: f64,
    /// Shading normal on the viewer's side.
    pub(crate) normal: DVec3,
    pub(crate) material: ObjectId,
}

/// Index of a set of clipped modifiers; 0 is the empty set.
pub(crate) type ClipSet = u32;

impl<'p> Ray<'p> {
    /// What is asked of the world. A surface right at the limit is out of sight whichever way its distance is rounded,
    /// or planes that cut a scene along a wall would show it in speckles.
    pub(crate) fn query(&self) -> ambit_trace::Ray {
        let limit = if self.limit < FAR { self.limit - EPSILON } else { self.limit };
        ambit_trace::Ray { origin: self.origin, direction: self.direction, limit }
    }

    /// A ray without ancestors.
    pub(crate) fn primary(origin: DVec3, direction: DVec3, limit: f64, interior: Interior, stream: Stream) -> Self {
        Self {
            parent: None,
            origin,
            direction,
            limit,
            kind: Kinds::PRIMARY,
            lineage: Kinds::PRIMARY,
            level: 0,
            depth: 0,
            weight: 1.0,
            coefficient: Rgb::ONE,
            throughput: Rgb::ONE,
            target: None,
            interior,
            clipped: 0,
            next_clipped: 0,
            stream,
            travelled: 0.0,
            hit: None,
            distance: FAR,
            point: origin,
            value: Rgb::ZERO,
            mirrored: Rgb::ZERO,
            mirrored_length: FAR,
            unmirrored_length: FAR,
            normal: DVec3::ZERO,
            material: VOID,
        }
    }

    /// A ray from this one's hit point, and whether it may live. `coefficient` is None where no colour goes with it
    /// (pass-through, mist), which keeps Russian roulette out.
    #[expect(clippy::inline_always, reason = "a ray is large: built in place it is not copied")]
    #[inline(always)]
    pub(crate) fn spawn(
        &'p self,
        kind: Kinds,
        direction: DVec3,
        coefficient: Option<Rgb>,
        limits: &Limits,
        tag: u64,
    ) -> (Ray<'p>, bool) {
        let k = coefficient.unwrap_or(Rgb::ONE);
        let mut child = Ray {
            parent: Some(self),
            kind,
            lineage: self.lineage.union(kind),
            level: self.level + i32::from(kind.meets(Kinds::RAISING)),
            depth: self.depth + u8::from(kind.meets(Kinds::AMBIENT)),
            weight: self.weight * k.max_element().min(1.0) * self.extinction_factor(),
            coefficient: k,
            throughput: self.throughput * k,
            target: if kind.meets(Kinds::AIMED) { self.target } else { None },
            limit: if !kind.meets(Kinds::UNLIMITED) && self.limit < FAR && self.limit > EPSILON {
                self.limit - self.distance
            } else {
                FAR
            },
            stream: self.stream.child(tag.wrapping_mul(1024) ^ kind.bits()),
            travelled: self.travelled + self.distance,
            ..Ray::primary(self.point, direction, FAR, self.interior, self.stream)
        };
        child.clipped = if kind.meets(Kinds::RAISING) { self.clipped } else { self.next_clipped };
        child.next_clipped = child.clipped;
        let alive = self.distance < 0.99 * FAR && child.fate(coefficient.is_some(), limits) == Fate::Alive;
        (child, alive)
    }

    /// The part of the weight that a medium takes on this ray's segment.
    pub(crate) fn extinction_factor(&self) -> f32 {
        let least = self.interior.extinction.min_element();
        if least <= 0.0 {
            return 1.0;
        }
        let m = least * self.distance as f32;
        if m <= 0.1 {
            1.0
        } else if m <= THICK {
            (-m).exp()
        } else {
            0.0
        }
    }

    /// Applies the limits in Radiance's order; a survivor of Russian roulette is made heavier.
    pub(crate) fn fate(&mut self, has_coefficient: bool, limits: &Limits) -> Fate {
        if self.weight <= 0.0 {
            return Fate::Refused;
        }
        if self.lineage.meets(Kinds::SHADOW) {
            return Fate::Alive;
        }
        if self.level > MOST_REFLECTIONS {
            return Fate::Refused;
        }
        let least = limits.weight as f32;
        if limits.reflections <= 0 && has_coefficient {
            if limits.reflections < 0 && self.level > -limits.reflections {
                return Fate::Refused;
            }
            if self.weight >= least {
                return Fate::Alive;
            }
            if self.stream.child(ROULETTE).one() >= f64::from(self.weight / least) {
                return Fate::Unlucky;
            }
            self.coefficient *= least / self.weight;
            self.throughput *= least / self.weight;
            self.weight = least;
            return Fate::Alive;
        }
        if self.weight >= least && self.level <= limits.reflections.abs() { Fate::Alive } else { Fate::Refused }
    }

    /// Aims a spawned ray at a source.
    pub(crate) fn aimed(mut self, source: SourceId) -> Self {
        self.target = Some(source);
        self
    }

    /// True for rays of the direct calculation.
    pub(crate) fn is_shadow(&self) -> bool {
        self.lineage.meets(Kinds::SHADOW)
    }

    /// True once a hemisphere has been opened on the path.
    pub(crate) fn is_ambient(&self) -> bool {
        self.lineage.meets(Kinds::AMBIENT)
    }

    /// Lets the ray count for nothing to its parent, not even with what a medium on its way adds, as in Radiance.
    pub(crate) fn discount(&mut self) {
        self.coefficient = Rgb::ZERO;
        self.throughput = Rgb::ZERO;
    }

    /// −d·n of the surface's own normal: positive for a front hit.
    pub(crate) fn cosine(&self) -> f64 {
        self.hit.as_ref().map_or(1.0, |h| h.cosine)
    }

    /// Transmittance of the medium on this ray's own segment.
    pub(crate) fn attenuation(&self) -> Rgb {
        if self.interior.extinction == Rgb::ZERO {
            Rgb::ONE
        } else if self.is_shadow() {
            transmittance(self.interior.extinction * (Rgb::ONE - self.interior.albedo), self.distance)
        } else {
            transmittance(self.interior.extinction, self.distance)
        }
    }

    /// The geometric normal turned to the viewer.
    pub(crate) fn facing_normal(&self) -> DVec3 {
        self.hit.as_ref().map_or(-self.direction, |h| if h.cosine < 0.0 { -h.normal } else { h.normal })
    }

    /// Effective length: the mirrored part's if that is worth more than half of the whole.
    pub(crate) fn effective_length(&self) -> f64 {
        self.length_of(self.value)
    }

    /// Effective length for the ray before this one, to which it brings `light`: Radiance holds the mirrored part as it is
    /// against half of that.
    pub(crate) fn length_of(&self, light: Rgb) -> f64 {
        use ambit_base::Colour;
        if self.mirrored.brightness() > 0.5 * light.brightness() {
            self.mirrored_length
        } else {
            self.unmirrored_length
        }
    }
}

/// What the limits make of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    Alive,
    /// Too light or too deep.
    Refused,
    /// Ended by Russian roulette; the survivors make up for it.
    Unlucky,
}

/// Tag of the number that decides Russian roulette.
const ROULETTE: u64 = 0x0c;
