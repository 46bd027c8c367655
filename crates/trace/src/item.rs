//! Everything that is not a triangle or a convex quadrilateral: one to a leaf.

use crate::mesh::Mesh;
use crate::polygon::Outline;
use crate::quadric::{self, Frustum};
use crate::ray::Rank;
use crate::world::World;
use ambit_base::{DVec3, Transform};
use ambit_scene::{ObjectId, Ring, Sphere};
use std::sync::Arc;

/// A surface, or what a transform places.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    Outline(Outline),
    Sphere(Sphere, ObjectId),
    Cone(Box<Frustum>, ObjectId),
    Ring(Ring, ObjectId),
    Placed(Box<Placed>),
}

/// What an instance or mesh primitive places.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    World(Arc<World>),
    Mesh(Arc<Mesh>),
}

/// An instance or mesh primitive.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) object: ObjectId,
    pub(crate) transform: Transform,
    pub(crate) content: Content,
    /// The primitive's modifier where it replaces those inside.
    pub(crate) over: Option<Rank>,
    /// Number of its placement; those inside follow.
    pub(crate) placement: u32,
}

impl Item {
    pub(crate) fn object(&self) -> ObjectId {
        match self {
            Self::Outline(o) => o.object,
            Self::Sphere(_, id) | Self::Cone(_, id) | Self::Ring(_, id) => *id,
            Self::Placed(p) => p.object,
        }
    }

    /// Distance of the nearest hit of a surface if no farther than `bound`; none for what is placed.
    #[inline]
    pub(crate) fn hit(&self, points: &[[f64; 2]], o: DVec3, d: DVec3, bound: f64) -> Option<f64> {
        match self {
            Self::Outline(p) => p.hit(points, o, d, bound),
            Self::Sphere(s, _) => quadric::sphere(s, o, d, bound).map(|f| f.0),
            Self::Cone(c, _) => quadric::cone(c, o, d, bound).map(|f| f.0),
            Self::Ring(r, _) => quadric::ring(r, o, d, bound).map(|f| f.0),
            Self::Placed(_) => None,
        }
    }

    /// Unit normal of the front of a surface where it is hit first.
    pub(crate) fn normal(&self, o: DVec3, d: DVec3) -> DVec3 {
        let (found, inward) = match self {
            Self::Outline(p) => return p.normal,
            Self::Ring(r, _) => return r.normal,
            Self::Sphere(s, _) => (quadric::sphere(s, o, d, f64::INFINITY).map(|f| (f.0, f.1 / s.radius)), s.inward),
            Self::Cone(c, _) => (quadric::cone(c, o, d, f64::INFINITY), c.inward()),
            Self::Placed(_) => return DVec3::ZERO,
        };
        found.map_or(DVec3::ZERO, |f| quadric::normal(f.1, inward))
    }
}
