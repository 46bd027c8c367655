//! What is asked and what is answered: rays, hits, shadow answers, and how a surface ranks among coincident ones.

use ambit_base::{DVec3, FAR};
use ambit_scene::ObjectId;

/// A ray in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, scene units.
    pub origin: DVec3,
    /// Where it goes, unit length.
    pub direction: DVec3,
    /// Clip distance in scene units: hits at or beyond it are refused. [`FAR`] for none.
    pub limit: f64,
}

impl Ray {
    /// A ray without clip distance.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, limit: FAR }
    }
}

/// How a surface's modifier takes part in ties between coincident surfaces, least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Opacity {
    /// No material: the surface is invisible.
    Nothing,
    /// A material that is nominally transparent.
    Transparent,
    /// Any other material.
    Opaque,
}

/// What the tracer has to know of a surface's modifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rank {
    /// The class that decides ties first.
    pub opacity: Opacity,
    /// The immediate modifier; of two in the same class and orientation the one defined later wins.
    pub modifier: ObjectId,
    /// Surely stops every shadow ray, whatever its direction: opaque surfaces, and transparent ones that only scatter.
    pub blocks: bool,
    /// Can send shadow rays off their line, or make other surfaces invisible to them (dielectric, antimatter …).
    pub bends: bool,
}

/// The nearest surface along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin, scene units, above ε.
    pub distance: f64,
    /// The surface: inside an instance the inner one, for a mesh the mesh primitive.
    pub object: ObjectId,
    /// The immediate modifier that applies: the surface's own, the triangle's material, or the instance's override.
    pub modifier: ObjectId,
    /// Unit geometric normal as the surface defines it, world frame.
    pub normal: DVec3,
    /// −d·n: positive if the front was hit.
    pub cosine: f64,
    /// The transform that function coordinates go through ([`World::placement`](crate::World::placement)): that of
    /// the instances or mesh around the surface, none at the top level or when the modifier was overridden.
    pub placement: Option<u32>,
    /// Mesh texture coordinates, 0 where absent.
    pub uv: [f64; 2],
    /// Interpolated unit vertex normal − face normal, world frame; 0 where a mesh has none and on other surfaces.
    pub tilt: DVec3,
    /// True for a triangle of a mesh.
    pub mesh_triangle: bool,
}

/// What a shadow ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shadow {
    /// The target is the first hit, or nothing is hit at all.
    Reaches,
    /// A surface that stops every shadow ray lies nearer than the target.
    Blocked(ObjectId),
    /// Something else comes first and has to be shaded.
    Other(Hit),
}
