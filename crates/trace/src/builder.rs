//! Collects surfaces, instances and meshes, and builds a [`World`] from them.

use crate::block::{LANES, Scale};
use crate::bounds::{self, Box32};
use crate::facet::{Facet, Facets};
use crate::frame::Frame;
use crate::item::{Content, Item, Placed};
use crate::mesh::Mesh;
use crate::node::{self, ITEMS, NOWHERE, QUADS, TRIANGLES};
use crate::polygon::{self, Outline};
use crate::quadric::Frustum;
use crate::ray::Rank;
use crate::simd::Vector;
use crate::tree::{self, Tree};
use crate::walk::{Gate, STACK, stack_needed};
use crate::world::World;
use ambit_base::Transform;
use ambit_scene::{Bounds, ObjectId, Polygon, Shape};
use std::collections::HashMap;
use std::sync::Arc;

/// What keeps a world from being built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// More surfaces than a tree can name.
    #[error("too many surfaces: at most {limit} fit into one octree")]
    TooManySurfaces {
        /// The most there can be.
        limit: usize,
    },
    /// Instances of instances multiply beyond what can be numbered.
    #[error("too many instances within instances")]
    TooManyPlacements,
    /// A mesh triangle names a vertex, normal, coordinate or material that is not there.
    #[error("mesh triangle {triangle} refers to what the mesh does not hold")]
    BadMesh {
        /// Number of the triangle, from 0.
        triangle: usize,
    },
}

/// Entries of the lists that grow, so that no more than this much is reserved in vain.
const CHUNK: usize = 1 << 14;

/// A list that grows without moving.
#[derive(Debug)]
struct Chunks<T> {
    full: Vec<Vec<T>>,
    len: usize,
}

impl<T: Copy> Chunks<T> {
    fn push(&mut self, value: T) {
        if self.len.is_multiple_of(CHUNK) {
            self.full.push(Vec::with_capacity(if self.len == 0 { 4 } else { CHUNK }));
        }
        if let Some(last) = self.full.last_mut() {
            last.push(value);
            self.len += 1;
        }
    }

    /// Ways to fetch each value once, giving memory back as chunks are used up.
    fn drain(self) -> Drain<T> {
        Drain { left: self.full.iter().map(Vec::len).collect(), full: self.full }
    }

    fn iter(&self) -> impl Iterator<Item = &T> {
        self.full.iter().flatten()
    }
}

/// See [`Chunks::drain`].
struct Drain<T> {
    full: Vec<Vec<T>>,
    left: Vec<usize>,
}

impl<T: Copy> Drain<T> {
    fn fetch(&mut self, i: u32) -> T {
        let chunk = i as usize / CHUNK;
        let value = self.full[chunk][i as usize % CHUNK];
        self.left[chunk] -= 1;
        if self.left[chunk] == 0 {
            self.full[chunk] = Vec::new();
        }
        value
    }
}

impl<T> Default for Chunks<T> {
    fn default() -> Self {
        Self { full: Vec::new(), len: 0 }
    }
}

/// Boxes around what bends light that every shadow ray is compared with.
const BENDERS: usize = 8;

/// Collects what a world holds.
#[derive(Debug, Default)]
pub struct WorldBuilder {
    triangles: Chunks<Facet<3>>,
    quads: Chunks<Facet<4>>,
    items: Vec<(Item, Bounds, u32)>,
    points: Vec<[f64; 2]>,
    ranks: Vec<Rank>,
    known: HashMap<Rank, u32>,
    placements: u32,
    overflow: bool,
    benders: Vec<Bounds>,
}

impl WorldBuilder {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a surface. Sources and degenerate shapes are ignored, as are shapes with coordinates that are no numbers.
    pub fn add(&mut self, object: ObjectId, shape: &Shape, rank: Rank) {
        let item = match shape {
            Shape::Polygon(p) => return self.add_polygon(object, p, rank),
            Shape::Sphere(s) => Item::Sphere(*s, object),
            Shape::Cone(c) => Item::Cone(Box::new(Frustum::new(*c)), object),
            Shape::Ring(r) => Item::Ring(*r, object),
            Shape::Source(_) | Shape::Degenerate => return,
        };
        if let Some(b) = shape.bounds() {
            self.push(item, b, rank);
        }
    }

    fn add_polygon(&mut self, object: ObjectId, p: &Polygon, rank: Rank) {
        let (normal, offset) = (p.normal, p.offset);
        if !(normal.is_finite() && offset.is_finite() && p.vertices.iter().all(|v| v.is_finite())) {
            return;
        }
        if let Some(facet) = Facet::<3>::new(&p.vertices, normal, offset, object, || self.rank(rank)) {
            self.bend(rank.bends, || facet.bounds());
            self.triangles.push(facet);
        } else if let Some(facet) = Facet::<4>::new(&p.vertices, normal, offset, object, || self.rank(rank)) {
            self.bend(rank.bends, || facet.bounds());
            self.quads.push(facet);
        } else {
            let dropped = polygon::dropped_axis(normal);
            let start = self.points.len();
            self.points.extend(p.vertices.iter().map(|&v| polygon::project(v, dropped)));
            let b = polygon::bounds(normal, offset, dropped, &self.points[start..]);
            let outline = Outline {
                object,
                dropped: dropped as u32,
                normal,
                offset,
                start: start as u32,
                len: p.vertices.len() as u32,
            };
            self.push(Item::Outline(outline), b, rank);
        }
    }

    /// Adds an instance of another world. `over` is the primitive's modifier unless that is void.
    pub fn add_instance(&mut self, object: ObjectId, transform: Transform, world: Arc<World>, over: Option<Rank>) {
        if over.is_none() {
            for inner in &world.benders {
                self.bend(true, || bounds::around(inner.corners().map(|p| transform.point(p))));
            }
        }
        let (inner, below) = (world.bounds(), world.placements);
        self.place(object, transform, Content::World(world), over, inner, below);
    }

    /// Adds a placed mesh. `over` is the primitive's modifier unless that is void.
    pub fn add_mesh(&mut self, object: ObjectId, transform: Transform, mesh: Arc<Mesh>, over: Option<Rank>) {
        let inner = mesh.bounds();
        if over.is_none() && mesh.bends() && !inner.is_empty() {
            self.bend(true, || bounds::around(inner.corners().map(|p| transform.point(p))));
        }
        self.place(object, transform, Content::Mesh(mesh), over, inner, 0);
    }

    fn place(
        &mut self,
        object: ObjectId,
        transform: Transform,
        content: Content,
        over: Option<Rank>,
        inner: Bounds,
        below: u32,
    ) {
        if inner.is_empty() {
            return;
        }
        let b = bounds::around(inner.corners().map(|p| transform.point(p)));
        let placement = self.placements;
        match below.checked_add(1).and_then(|n| placement.checked_add(n)) {
            Some(n) => self.placements = n,
            None => self.overflow = true,
        }
        let rank = over.unwrap_or(Rank {
            opacity: crate::Opacity::Nothing,
            modifier: ambit_scene::VOID,
            blocks: false,
            bends: false,
        });
        self.push(Item::Placed(Box::new(Placed { object, transform, content, over, placement })), b, rank);
    }

    fn push(&mut self, item: Item, b: Bounds, rank: Rank) {
        if b.min.is_finite() && b.max.is_finite() {
            self.bend(rank.bends, || b);
            let rank = self.rank(rank);
            self.items.push((item, b, rank));
        }
    }

    /// Notes a box around something that bends light: those after the first few share one.
    fn bend(&mut self, bends: bool, around: impl FnOnce() -> Bounds) {
        if !bends {
            return;
        }
        if self.benders.len() < BENDERS {
            self.benders.push(around());
        } else {
            self.benders[BENDERS - 1].join(&around());
        }
    }

    fn rank(&mut self, rank: Rank) -> u32 {
        *self.known.entry(rank).or_insert_with(|| {
            self.ranks.push(rank);
            self.ranks.len() as u32 - 1
        })
    }

    /// Builds the world.
    ///
    /// # Errors
    /// If there are more surfaces or nested instances than can be numbered.
    pub fn build(mut self) -> Result<World, BuildError> {
        if self.overflow {
            return Err(BuildError::TooManyPlacements);
        }
        let exact = || {
            let tri = self.triangles.iter().map(Facet::bounds);
            let quad = self.quads.iter().map(Facet::bounds);
            tri.chain(quad).chain(self.items.iter().map(|i| i.1))
        };
        let frame = Frame::around(exact());
        let boxes: Vec<Box32> = exact().map(|b| frame.child(b)).collect();
        let tree = tree::build(boxes, [self.triangles.len, self.quads.len])?;
        self.known = HashMap::new();
        Ok(self.assemble(tree, frame))
    }

    fn assemble(self, mut tree: Tree, frame: Frame) -> World {
        let (first, span) = self.objects();
        let mut place_of = vec![NOWHERE; span];
        let mut record = |object: ObjectId, place: u32| place_of[(object - first) as usize] = place;
        let gate = Gate::new(frame.bounds, frame.centre);
        let scale = gate.scale();
        let triangles = pack(TRIANGLES, &scale, &self.ranks, &mut tree.blocks[0], self.triangles, 0, &mut record);
        let from = tree.counts[0] as u32;
        let quads = pack(QUADS, &scale, &self.ranks, &mut tree.blocks[1], self.quads, from, &mut record);
        let mut placed = Vec::new();
        for (i, (item, ..)) in self.items.iter().enumerate() {
            record(item.object(), node::place(ITEMS, i as u32));
            if let Item::Placed(_) = item {
                placed.push(i as u32);
            }
        }
        // Hits have tolerances, and so have these.
        let benders = self.benders.iter().map(|&b| frame.widened(b)).collect();
        let mut points = self.points;
        points.shrink_to_fit();
        World {
            deep: stack_needed(tree.depth) > STACK,
            nodes: tree.nodes,
            gate,
            triangles,
            quads,
            item_ranks: self.items.iter().map(|i| i.2).collect(),
            items: self.items.into_iter().map(|i| i.0).collect(),
            points,
            first,
            place_of,
            ranks: self.ranks,
            placed,
            placements: self.placements,
            benders,
            vector: Vector::detect(),
        }
    }

    /// Least number of an object, and how many numbers there are up to the greatest.
    fn objects(&self) -> (ObjectId, usize) {
        let tri = self.triangles.iter().map(|k| k.object);
        let quad = self.quads.iter().map(|k| k.object);
        let all = tri.chain(quad).chain(self.items.iter().map(|i| i.0.object()));
        let (low, high) = all.fold((ObjectId::MAX, 0), |(a, b), id| (a.min(id), b.max(id)));
        if low > high { (0, 0) } else { (low, (high - low) as usize + 1) }
    }
}

/// Blocks from the tree's lists of surfaces, which are numbered from `from`.
fn pack<const K: usize>(
    kind: u32,
    scale: &Scale,
    ranks: &[Rank],
    lists: &mut Vec<[u32; LANES]>,
    kept: Chunks<Facet<K>>,
    from: u32,
    record: &mut impl FnMut(ObjectId, u32),
) -> Facets<K> {
    let lists = std::mem::take(lists);
    let mut facets = Facets::with_capacity(lists.len(), kept.len);
    let mut kept = kept.drain();
    for list in &lists {
        let first = facets.list.len();
        facets.push(scale, ranks, list.iter().filter(|s| **s != u32::MAX).map(|&s| kept.fetch(s - from)));
        for number in first..facets.list.len() {
            record(facets.list[number].object, node::place(kind, number as u32));
        }
    }
    facets
}
