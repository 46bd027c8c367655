//! Everything that is not a triangle or a convex quadrilateral: one to a leaf.

use crate::mesh::Mesh;
use crate::polygon::Outline;
use crate::quadric;
use crate::ray::Rank;
use crate::world::World;
use ambit_base::{DVec3, Transform};
use ambit_scene::{Cone, ObjectId, Ring, Sphere};
use std::sync::Arc;

/// A surface, or what a transform places.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    Outline(Outline),
    Sphere(Sphere, ObjectId),
    Cone(Box<Cone>, ObjectId),
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

    /// The nearest hit of a surface no farther than `bound`; none for what is placed.
    #[inline]
    pub(crate) fn hit(&self, points: &[[f64; 2]], o: DVec3, d: DVec3, bound: f64) -> Option<quadric::Found> {
        match self {
            Self::Outline(p) => p.hit(points, o, d, bound).map(|(t, cosine)| (t, p.normal, cosine)),
            Self::Sphere(s, _) => quadric::sphere(s, o, d, bound),
            Self::Cone(c, _) => quadric::cone(c, o, d, bound),
            Self::Ring(r, _) => quadric::ring(r, o, d, bound),
            Self::Placed(_) => None,
        }
    }
}
