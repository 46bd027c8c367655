//! Surfaces as geometry: the arguments of polygon, sphere, cone, ring and their kin checked, cleaned, in
//! scene units and world coordinates.
//!
//! The rules are those of Radiance: a sphere of negative radius is a bubble and the reverse, a cone of equal radii a
//! cylinder, a last vertex equal to the first is dropped, degenerate surfaces are kept as [`Shape::Degenerate`].

mod bounds;
mod polygon;
mod round;

pub use bounds::Bounds;
pub use polygon::Facet;

use crate::{Error, ErrorKind, Kind, ObjectId, Problem, Scene};
use ambit_base::DVec3;
use std::fmt;

/// A surface, cleaned.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Planar polygon, even–odd.
    Polygon(Polygon),
    /// Sphere or bubble.
    Sphere(Sphere),
    /// Cone, cup, cylinder or tube: an open lateral surface.
    Cone(Cone),
    /// Flat annulus or disk.
    Ring(Ring),
    /// Disk at infinity.
    Source(Source),
    /// Never hit, never in the octree (zero area, illegal radii …).
    Degenerate,
}

/// A planar polygon.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Vertices, counter-clockwise about `normal`; a repeated last one dropped.
    pub vertices: Box<[DVec3]>,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Mean of `normal · v`.
    pub offset: f64,
    /// Area from the sum of cross products.
    pub area: f64,
}

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub centre: DVec3,
    /// Radius, positive.
    pub radius: f64,
    /// True if the front faces the centre (bubble).
    pub inward: bool,
}

/// A cone frustum without its ends.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// End with the smaller radius `r0`.
    pub p0: DVec3,
    /// End with the larger radius `r1`.
    pub p1: DVec3,
    /// Smaller radius.
    pub r0: f64,
    /// Larger radius; equal to `r0` for cylinders.
    pub r1: f64,
    /// Unit axis from `p0` to `p1`.
    pub axis: DVec3,
    /// Length along the axis.
    pub length: f64,
    /// True if the front faces the axis (cup, tube).
    pub inward: bool,
}

/// A flat annulus.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// Centre.
    pub centre: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Inner radius, possibly 0.
    pub r0: f64,
    /// Outer radius.
    pub r1: f64,
}

/// A disk at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Unit direction towards it.
    pub direction: DVec3,
    /// Solid angle in steradians.
    pub solid_angle: f64,
}

/// Something odd about a surface that was put right, or made it vanish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Complaint {
    /// Sphere, bubble, cylinder or tube turned inside out.
    NegativeRadius,
    /// Cone or cup turned inside out.
    NegativeRadii,
    /// Sphere or bubble that is never hit.
    ZeroRadius,
    /// Polygon that is never hit.
    ZeroArea,
    /// Polygon flattened to its mean plane.
    NonPlanarVertex,
    /// Cone, cylinder or ring that is ignored.
    IllegalRadii,
    /// Cone, cylinder or ring without axis, ignored.
    UnknownOrientation,
    /// Coordinates that are infinite or overflow; the surface is ignored. (Radiance does not look.)
    NotFinite,
}

impl Complaint {
    /// True if the surface is ignored for it.
    pub fn is_degenerate(self) -> bool {
        !matches!(self, Self::NegativeRadius | Self::NegativeRadii | Self::NonPlanarVertex)
    }
}

impl fmt::Display for Complaint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NegativeRadius => "negative radius",
            Self::NegativeRadii => "negative radii",
            Self::ZeroRadius => "zero radius",
            Self::ZeroArea => "zero area",
            Self::NonPlanarVertex => "non-planar vertex",
            Self::IllegalRadii => "illegal radii",
            Self::UnknownOrientation => "unknown orientation",
            Self::NotFinite => "coordinates out of range",
        })
    }
}

/// A complaint about one surface, worded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What was found.
    pub complaint: Complaint,
    /// As Radiance words it: `negative radius for sphere "s"`.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Shape {
    /// The geometry of a surface as given by its arguments, and what there is to warn about. The scene is not changed;
    /// see [`Scene::clean`] for that.
    ///
    /// # Errors
    /// A wrong number of arguments, a source without direction or size, or a primitive that is no surface with
    /// geometry of its own (instance, mesh, any modifier).
    pub fn from_object(scene: &Scene, id: ObjectId) -> Result<(Self, Vec<Warning>), Error> {
        let kind = scene.object(id).kind;
        let reals = scene.reals(id);
        let fail = |problem| scene.problem(id, problem);
        let mut warnings = Vec::new();
        let shape = match kind {
            Kind::Polygon => {
                let facet = Facet::new(reals).ok_or_else(|| fail(Problem::BadArgumentCount))?;
                if let Some(complaint) = facet.complaint() {
                    warnings.push(scene.warning(id, kind, complaint));
                }
                facet.to_shape()
            }
            Kind::Source => Self::Source(Source::new(reals).map_err(fail)?),
            _ => {
                let tidy = round::Tidy::new(kind, reals).map_err(fail)?;
                warnings.extend(tidy.complaints.iter().flatten().map(|&(k, c)| scene.warning(id, k, c)));
                tidy.shape()
            }
        };
        Ok((shape, warnings))
    }
}

impl Scene {
    /// Puts a surface right in place, the way frozen octrees store it: negative radii swap the type and become positive,
    /// radii of cones and rings within [`ambit_base::EPSILON`] of zero become 0, cones of equal radii become cylinders.
    /// Polygons, sources, volumes and modifiers stay as they are. Gives the same warnings as [`Shape::from_object`],
    /// which afterwards repeats only those about degenerate surfaces and non-planar polygons.
    ///
    /// # Errors
    /// A wrong number of arguments of a round surface.
    pub fn clean(&mut self, id: ObjectId) -> Result<Vec<Warning>, Error> {
        let kind = self.object(id).kind;
        if !round::is_round(kind) {
            return Ok(Vec::new());
        }
        let tidy = round::Tidy::new(kind, self.reals(id)).map_err(|p| self.problem(id, p))?;
        self.object_mut(id).kind = tidy.kind;
        self.shrink_reals(id, tidy.reals());
        Ok(tidy.complaints.iter().flatten().map(|&(k, c)| self.warning(id, k, c)).collect())
    }

    fn warning(&self, id: ObjectId, kind: Kind, complaint: Complaint) -> Warning {
        Warning { complaint, text: format!("{complaint} for {} \"{}\"", kind.name(), self.name(id)) }
    }

    /// The error that something is wrong with the arguments of a primitive.
    pub fn problem(&self, id: ObjectId, problem: Problem) -> Error {
        Error::new(ErrorKind::Primitive { problem, primitive: self.describe(id) }, self.location(id))
    }
}

/// Three numbers as a point.
fn point(reals: &[f64]) -> DVec3 {
    DVec3::new(reals[0], reals[1], reals[2])
}

#[cfg(test)]
mod tests;
