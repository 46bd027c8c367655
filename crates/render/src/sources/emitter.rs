//! A light source as the direct calculation sees it: a centre, a size, and axes that span what is sampled.
//!
//! Solid angles are Radiance's: projected size over the squared distance to the *sample point*, so a sphere of radius
//! r always subtends π r²/D², and large near sources are off in the same way.

use super::SourceId;
use ambit_base::{DVec3, EPSILON, FAR, Frame, Rgb};
use ambit_scene::{Cone, ObjectId, Polygon, Ring, Shape, Sphere};
use std::f64::consts::PI;

/// Half the edge of the cube that stands for a ball of radius 1: edge (4π/3)^⅓ would fill it, Radiance takes 0.7236.
pub(crate) const BALL_HALF_EDGE: f64 = 0.7236;
/// Half the edge, over the radius, of the square box around a cylinder's axis: its section has the same mean chord.
const CYLINDER_HALF_EDGE: f64 = 0.8559;

/// Geometry of a source.
#[derive(Clone, Debug)]
pub(crate) enum Emitter {
    Polygon(Polygon),
    Ring(Ring),
    Sphere(Sphere),
    Cylinder(Cone),
    Distant,
}

/// A cone of light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    /// Unit aim.
    pub(crate) aim: DVec3,
    /// Cosine of half the cone's angle.
    pub(crate) cosine: f64,
    /// How far behind the surface the light seems to come from.
    pub(crate) focal: f64,
}

/// A light source.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent properties, each asked alone")]
pub(crate) struct Source {
    pub(crate) object: ObjectId,
    /// Immediate modifier of the object.
    pub(crate) modifier: ObjectId,
    pub(crate) emitter: Emitter,
    /// Centre, or the unit direction of a distant source.
    pub(crate) centre: DVec3,
    /// Half-axes of what is sampled; flat and distant sources use two.
    pub(crate) axes: [DVec3; 3],
    /// Area, cross section or solid angle.
    pub(crate) size: f64,
    /// Farthest extent from the centre.
    pub(crate) radius: f64,
    /// No sample lies farther than this from the centre.
    pub(crate) extent: f64,
    /// Unit normal of a flat emitter.
    pub(crate) normal: DVec3,
    /// Emitted radiance before any pattern.
    pub(crate) emission: Rgb,
    /// A pattern may change the emission: it has to be evaluated for each sample.
    pub(crate) patterned: bool,
    /// Points farther than this from the sample see nothing of it directly (glow).
    pub(crate) reach: f64,
    pub(crate) glow: bool,
    pub(crate) illum: bool,
    /// An illum without alternate material: invisible to rays that are not aimed at it.
    pub(crate) clear: bool,
    pub(crate) spot: Option<Spot>,
    /// False: seen, but not sampled.
    pub(crate) sampled: bool,
    /// Set for the image of another source in a mirror or prism.
    pub(crate) image: Option<Image>,
    /// Where an image's light can get to.
    pub(crate) restrictions: Vec<Restriction>,
}

/// What makes a source virtual.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image {
    /// The source that it is an image of.
    pub(crate) of: SourceId,
    /// Index of the relay that forms it.
    pub(crate) relay: u32,
    /// Which of the relay's ways the light takes.
    pub(crate) branch: u8,
    /// The image lies on the side of the relay that its normal points to.
    pub(crate) in_front: bool,
}

/// Where the light of an image can get to at all.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Restriction {
    /// Within a cone from the image's centre.
    Cone { aim: DVec3, cosine: f64 },
    /// Within a cylinder along the unit direction `axis`.
    Beam { through: DVec3, axis: DVec3, radius: f64 },
}

impl Source {
    /// Projected shares no larger than this are dropped.
    pub(super) const LEAST_SHARE: f64 = 1e-4;

    /// The geometry of `shape` as a source, or the reason why it can't be one.
    pub(crate) fn from_shape(shape: Shape) -> Result<Geometry, &'static str> {
        match shape {
            Shape::Polygon(p) => Geometry::polygon(p),
            Shape::Ring(r) => {
                if r.r0 > 0.0 {
                    return Err("cannot hit source center");
                }
                Ok(Geometry::square(Emitter::Ring(r), r.centre, r.normal, PI * r.r1 * r.r1, r.r1))
            }
            Shape::Sphere(s) if !s.inward => {
                let half = BALL_HALF_EDGE * s.radius;
                Ok(Geometry {
                    centre: s.centre,
                    axes: [DVec3::X * half, DVec3::Y * half, DVec3::Z * half],
                    size: PI * s.radius * s.radius,
                    radius: s.radius,
                    normal: DVec3::ZERO,
                    emitter: Emitter::Sphere(s),
                })
            }
            Shape::Cone(c) if c.r0 == c.r1 && !c.inward => {
                let frame = Frame::around(c.axis);
                let half = CYLINDER_HALF_EDGE * c.r0;
                Ok(Geometry {
                    centre: (c.p0 + c.p1) * 0.5,
                    axes: [(c.p1 - c.p0) * 0.5, frame.u * half, frame.v * half],
                    size: 2.0 * c.r0 * c.length,
                    radius: 0.5 * c.length,
                    normal: DVec3::ZERO,
                    emitter: Emitter::Cylinder(c),
                })
            }
            Shape::Source(s) => {
                // Radiance keeps solid angles in 32 bits, and that decides about rays along the rim: a horizontal ray
                // meets a sky of 180 degrees only because 2 pi is rounded up.
                let size = f64::from(s.solid_angle as f32);
                Ok(Geometry::square(Emitter::Distant, s.direction, s.direction, size, (size / PI).sqrt()))
            }
            Shape::Degenerate => Err("illegal source"),
            _ => Err("illegal material"),
        }
    }

    /// True for points that a glow is too far from to light directly.
    pub(crate) fn is_out_of_reach(&self, point: DVec3) -> bool {
        self.reach < FAR && point.distance(self.centre) > self.reach + self.radius
    }

    /// The sample point for coordinates in [−1,1]³ along the axes; a direction for distant sources. `bend` maps the
    /// square of a round source to its disc and the cube of a sphere to its ball.
    #[expect(clippy::inline_always, reason = "it is asked for every sample, from the walks with and without observer")]
    #[inline(always)]
    pub(crate) fn sample_point(&self, mut at: [f64; 3], bend: bool) -> DVec3 {
        if bend {
            match self.emitter {
                Emitter::Ring(_) | Emitter::Distant => {
                    let k = 2.0 / PI.sqrt();
                    let [u, v, _] = at;
                    at = [u * k * (1.0 - 0.5 * v * v).sqrt(), v * k * (1.0 - 0.5 * u * u).sqrt(), 0.0];
                }
                Emitter::Sphere(_) => {
                    let q = DVec3::from(at);
                    let length = q.length();
                    if length > EPSILON {
                        at = (q * (q.abs().max_element() / (length * BALL_HALF_EDGE))).into();
                    }
                }
                Emitter::Polygon(_) | Emitter::Cylinder(_) => {}
            }
        }
        self.centre + self.axes[0] * at[0] + self.axes[1] * at[1] + self.axes[2] * at[2]
    }

    /// Solid angle of a share `f` of the source whose sample lies in unit direction `l` at distance `d`;
    /// None if the sample is dropped.
    pub(crate) fn solid_angle(&self, l: DVec3, d: f64, f: f64) -> Option<f64> {
        let factor = match self.emitter {
            Emitter::Distant => return Some(self.size),
            Emitter::Sphere(_) => f,
            Emitter::Polygon(_) | Emitter::Ring(_) => {
                let cosine = -self.normal.dot(l) * f;
                if cosine <= Self::LEAST_SHARE {
                    return None;
                }
                cosine
            }
            Emitter::Cylinder(c) => {
                let along = c.axis.dot(l);
                let sine = (1.0 - along * along).max(0.0).sqrt() * f;
                if sine <= Self::LEAST_SHARE {
                    return None;
                }
                sine
            }
        };
        Some(self.size * factor / (d * d))
    }

    /// What of its solid angle counts for a sample as `point` sees it; None where restrictions or the cone of a spotlight
    /// keep its light away.
    pub(super) fn admitted(&self, point: DVec3, l: DVec3, distance: f64) -> Option<f64> {
        if !self.restrictions.iter().all(|r| r.admits(point, l)) {
            return None;
        }
        let Some(spot) = &self.spot else { return Some(1.0) };
        if -spot.aim.dot(l) < spot.cosine {
            return None;
        }
        let r = if distance < FAR { distance / (distance + spot.focal) } else { 1.0 };
        Some(r * r)
    }

    /// True for points inside a spherical source or on it, which see it from behind only.
    pub(crate) fn encloses(&self, point: DVec3) -> bool {
        matches!(&self.emitter, Emitter::Sphere(s) if s.centre.distance(point) <= s.radius + EPSILON)
    }

    /// Where a ray meets the source's own surface from the front: distance and normal.
    pub(crate) fn intersect(&self, origin: DVec3, l: DVec3) -> Option<(f64, DVec3)> {
        match &self.emitter {
            Emitter::Distant => (2.0 * PI * (1.0 - self.centre.dot(l)) <= self.size).then_some((FAR, -l)),
            Emitter::Polygon(p) => {
                let t = plane(p.normal, p.offset, origin, l)?;
                p.contains(origin + l * t).then_some((t, p.normal))
            }
            Emitter::Ring(r) => {
                let t = plane(r.normal, r.normal.dot(r.centre), origin, l)?;
                ((origin + l * t - r.centre).length_squared() <= r.r1 * r.r1).then_some((t, r.normal))
            }
            Emitter::Sphere(s) => {
                let to = s.centre - origin;
                let b = to.dot(l);
                let disc = s.radius * s.radius - (to - l * b).length_squared();
                if disc < 0.0 {
                    return None;
                }
                let t = b - disc.sqrt();
                (t > EPSILON).then(|| (t, (origin + l * t - s.centre) / s.radius))
            }
            Emitter::Cylinder(c) => {
                let q = origin - c.p0;
                let lp = l - c.axis * l.dot(c.axis);
                let qp = q - c.axis * q.dot(c.axis);
                let (a, b) = (lp.length_squared(), qp.dot(lp));
                let disc = b * b - a * (qp.length_squared() - c.r0 * c.r0);
                if a <= 0.0 || disc < 0.0 {
                    return None;
                }
                let t = (-b - disc.sqrt()) / a;
                let along = (q + l * t).dot(c.axis);
                (t > EPSILON && (0.0..=c.length).contains(&along)).then(|| (t, (qp + lp * t) / c.r0))
            }
        }
    }

    /// True if every sample point inside the axes' span surely lies on the surface.
    pub(crate) fn filled(&self, bend: bool) -> bool {
        match &self.emitter {
            Emitter::Distant | Emitter::Sphere(_) => true,
            Emitter::Ring(_) => bend,
            Emitter::Polygon(p) => {
                let v = &p.vertices;
                v.len() == 4 && ((v[0] + v[2]) - (v[1] + v[3])).length() <= EPSILON
            }
            Emitter::Cylinder(_) => false,
        }
    }
}

fn plane(normal: DVec3, offset: f64, origin: DVec3, l: DVec3) -> Option<f64> {
    let c = normal.dot(l);
    if c.abs() <= EPSILON {
        return None;
    }
    let t = (offset - normal.dot(origin)) / c;
    (t > EPSILON).then_some(t)
}

/// The geometric part of a source.
pub(crate) struct Geometry {
    pub(crate) emitter: Emitter,
    pub(crate) centre: DVec3,
    pub(crate) axes: [DVec3; 3],
    pub(crate) size: f64,
    pub(crate) radius: f64,
    pub(crate) normal: DVec3,
}

impl Geometry {
    /// A source sampled through the square of equal area around its centre.
    fn square(emitter: Emitter, centre: DVec3, normal: DVec3, size: f64, radius: f64) -> Self {
        let frame = Frame::around(normal);
        let half = 0.5 * size.sqrt();
        Self { emitter, centre, axes: [frame.u * half, frame.v * half, DVec3::ZERO], size, radius, normal }
    }

    fn polygon(p: Polygon) -> Result<Self, &'static str> {
        let v = &p.vertices;
        let centre = v.iter().sum::<DVec3>() / v.len() as f64;
        if !p.contains(centre) {
            return Err("cannot hit source center");
        }
        let radius = v.iter().map(|q| q.distance(centre)).fold(0.0, f64::max);
        let (size, normal) = (p.area, p.normal);
        let axes = match v.len() {
            4 => [(v[1] - v[0]) * 0.5, (v[3] - v[0]) * 0.5, DVec3::ZERO],
            3 => {
                let (mut best, mut along) = (f64::INFINITY, DVec3::ZERO);
                for i in 0..3 {
                    let edge = (v[(i + 1) % 3] - v[i]).normalize();
                    let to = centre - v[i];
                    let d = (to - edge * to.dot(edge)).length();
                    if d < best {
                        (best, along) = (d, edge);
                    }
                }
                [along * best, normal.cross(along) * best, DVec3::ZERO]
            }
            _ => return Ok(Self::square(Emitter::Polygon(p), centre, normal, size, radius)),
        };
        Ok(Self { emitter: Emitter::Polygon(p), centre, axes, size, radius, normal })
    }
}
