//! A world: everything an octree holds, ready for rays.

use crate::bounds;
use crate::facet::Facets;
use crate::item::{Content, Item};
use crate::node::{self, NOWHERE, Node, QUADS, TRIANGLES};
use crate::ray::{Hit, Rank, Ray, Shadow};
use crate::search::{Aim, Found, Search};
use crate::simd::Vector;
use crate::walk::Gate;
use ambit_base::{DVec3, EPSILON, Transform};
use ambit_scene::{Bounds, ObjectId};

/// Surfaces, instances and meshes in one coordinate system. Immutable; made by [`WorldBuilder`](crate::WorldBuilder).
#[derive(Debug)]
pub struct World {
    pub(crate) nodes: Vec<Node>,
    /// True if the walk needs the large stack.
    pub(crate) deep: bool,
    pub(crate) gate: Gate,
    pub(crate) triangles: Facets<3>,
    pub(crate) quads: Facets<4>,
    pub(crate) items: Vec<Item>,
    /// Indices into `ranks`, by item.
    pub(crate) item_ranks: Vec<u32>,
    /// Projected vertices of general polygons.
    pub(crate) points: Vec<[f64; 2]>,
    /// Numbers of the objects with a place start here.
    pub(crate) first: ObjectId,
    /// By object: where it is.
    pub(crate) place_of: Vec<u32>,
    pub(crate) ranks: Vec<Rank>,
    /// Items that place something, by placement.
    pub(crate) placed: Vec<u32>,
    pub(crate) placements: u32,
    /// Around what bends light: a shadow ray that meets none of these boxes goes straight.
    pub(crate) benders: Vec<Bounds>,
    pub(crate) vector: Option<Vector>,
}

impl World {
    /// The nearest hit.
    pub fn nearest(&self, ray: &Ray) -> Option<Hit> {
        let aim = Aim { bound: f64::INFINITY, blocked_before: f64::NEG_INFINITY, all_block: None };
        match Search::new(self, ray, aim).run() {
            Found::Hit(hit, _) => Some(hit),
            _ => None,
        }
    }

    /// What decides the light that comes along `ray` from `target`, a surface of this world, or from infinity.
    ///
    /// This is the nearest hit, looked at; but where nothing on the line bends light the search ends at the first
    /// surface that surely stops it and is nearer than the target by more than the tolerance of ties, whatever
    /// transparent surfaces may come before.
    pub fn shadow(&self, ray: &Ray, target: Option<ObjectId>) -> Shadow {
        let distance = target.and_then(|t| self.distance(t, ray));
        let bound = distance.map_or(f64::INFINITY, |t| t + EPSILON);
        let blocked_before = match distance {
            _ if self.bends(ray) => f64::NEG_INFINITY,
            Some(t) => t - EPSILON,
            None => f64::INFINITY,
        };
        match Search::new(self, ray, Aim { bound, blocked_before, all_block: None }).run() {
            Found::Nothing => Shadow::Reaches,
            Found::Hit(hit, _) if target == Some(hit.object) => Shadow::Reaches,
            Found::Hit(hit, rank) if rank.blocks => Shadow::Blocked(hit.object),
            Found::Blocked(object) => Shadow::Blocked(object),
            Found::Hit(hit, _) => Shadow::Other(hit),
        }
    }

    /// True if something on the ray's line may send it off that, or hide other surfaces from it.
    pub fn bends(&self, ray: &Ray) -> bool {
        self.benders.iter().any(|b| bounds::meets(b, ray.origin, ray.direction))
    }

    /// Distance at which the ray would hit this surface of the world if nothing else were there. None if it is missed,
    /// unknown, an instance or a mesh.
    pub fn distance(&self, object: ObjectId, ray: &Ray) -> Option<f64> {
        let place = *self.place_of.get(object.checked_sub(self.first)? as usize)?;
        if place == NOWHERE {
            return None;
        }
        let (o, d) = (ray.origin, ray.direction);
        let (kind, index) = node::split(place);
        let t = match kind {
            TRIANGLES => self.triangles.list[index].hit(o, d, f64::INFINITY)?,
            QUADS => self.quads.list[index].hit(o, d, f64::INFINITY)?,
            _ => self.items[index].hit(&self.points, o, d, f64::INFINITY)?,
        };
        (t < ray.limit).then_some(t)
    }

    /// The transform of a placement ([`Hit::placement`]), instances inside instances composed.
    ///
    /// # Panics
    /// If no hit of this world can have that number.
    pub fn placement(&self, i: u32) -> Transform {
        let base = |k: u32| match &self.items[k as usize] {
            Item::Placed(p) => p.placement,
            _ => 0,
        };
        let at = self.placed.partition_point(|&k| base(k) <= i);
        let Item::Placed(p) = &self.items[self.placed[at - 1] as usize] else { return Transform::IDENTITY };
        match (&p.content, i - p.placement) {
            (Content::World(inner), rest) if rest > 0 => inner.placement(rest - 1).then(&p.transform),
            _ => p.transform,
        }
    }

    /// The box around everything, wider than the surfaces by the tolerances of the hit tests; empty if nothing is there.
    pub fn bounds(&self) -> Bounds {
        self.gate.bounds
    }

    /// Counts for those who tune: nodes, blocks of triangles, blocks of quadrilaterals, other items.
    pub fn sizes(&self) -> [usize; 4] {
        [self.nodes.len(), self.triangles.blocks.len(), self.quads.blocks.len(), self.items.len()]
    }

    /// Bytes held by this world alone, without the instances and meshes it shares.
    pub fn memory(&self) -> usize {
        fn held<T>(v: &Vec<T>) -> usize {
            v.capacity() * size_of::<T>()
        }
        size_of::<Self>()
            + held(&self.nodes)
            + self.triangles.memory()
            + self.quads.memory()
            + held(&self.items)
            + held(&self.item_ranks)
            + held(&self.points)
            + held(&self.place_of)
            + held(&self.ranks)
            + held(&self.placed)
            + held(&self.benders)
    }

    /// Uses the scalar walk and leaf tests from now on, as on processors without AVX2. Hits are the same bits.
    #[must_use]
    pub fn without_vectors(mut self) -> Self {
        self.vector = None;
        self
    }

    /// The rank of the surface at a place.
    #[inline]
    pub(crate) fn rank(&self, place: u32) -> Rank {
        let (kind, index) = node::split(place);
        let rank = match kind {
            TRIANGLES => self.triangles.list[index].rank(),
            QUADS => self.quads.list[index].rank(),
            _ => self.item_ranks[index] as usize,
        };
        self.ranks[rank]
    }

    /// The object at a place.
    #[inline]
    pub(crate) fn object(&self, place: u32) -> ObjectId {
        let (kind, index) = node::split(place);
        match kind {
            TRIANGLES => self.triangles.list[index].object,
            QUADS => self.quads.list[index].object,
            _ => self.items[index].object(),
        }
    }

    /// The normal of the surface at a place, where the ray hits it.
    #[inline]
    pub(crate) fn normal(&self, place: u32, ray: &Ray) -> DVec3 {
        let (kind, index) = node::split(place);
        match kind {
            TRIANGLES => self.triangles.list[index].normal,
            QUADS => self.quads.list[index].normal,
            _ => self.items[index].normal(ray.origin, ray.direction),
        }
    }
}
