//! Triangle meshes: shared by every primitive that places them, traced in their own coordinates.
//!
//! Triangles that [`crate::block`] lets through are tested by [`crate::trio`], without cracks.

use crate::BuildError;
use crate::block::Block;
use crate::bounds::{self, Box32};
use crate::frame::Frame;
use crate::node::{self, Node};
use crate::pages;
use crate::ray::{Hit, Rank, Ray};
use crate::search::{Aim, End, Found};
use crate::simd::Vector;
use crate::tree;
use crate::trio::{self, Shear, Trio};
use crate::walk::{DEEP_STACK, Entry, Gate, STACK, stack_needed, walk};
use ambit_base::{DVec3, EPSILON};
use ambit_scene::{Bounds, ObjectId};

/// A mesh as a file gives it.
#[derive(Clone, Debug, Default)]
pub struct MeshGeometry {
    /// Positions.
    pub vertices: Vec<DVec3>,
    /// Vertex numbers, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// One a vertex, zero where it has none; or empty.
    pub normals: Vec<DVec3>,
    /// One a vertex; or empty.
    pub uvs: Vec<Option<[f64; 2]>>,
    /// One a triangle, an index into `ranks`; or empty if all have the first.
    pub materials: Vec<u32>,
    /// The materials.
    pub ranks: Vec<Rank>,
}

/// A mesh ready for rays.
#[derive(Debug)]
pub struct Mesh {
    pub(crate) nodes: Vec<Node>,
    pub(crate) deep: bool,
    pub(crate) gate: Gate,
    pub(crate) blocks: Vec<Block>,
    /// In the order of the blocks.
    pub(crate) trios: Vec<Trio>,
    vertices: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<Option<[f64; 2]>>,
    materials: Vec<u32>,
    ranks: Vec<Rank>,
    vector: Option<Vector>,
}

impl Mesh {
    /// Builds the tree over a mesh.
    ///
    /// # Errors
    /// If a triangle refers to what is not there, or there are too many.
    pub fn build(mut geometry: MeshGeometry) -> Result<Self, BuildError> {
        check(&geometry)?;
        let vertices = std::mem::take(&mut geometry.vertices);
        let of = |t: &[u32; 3]| t.map(|i| vertices[i as usize]);
        let sound = |t: &[u32; 3]| of(t).iter().all(|v| v.is_finite());
        let exact = || geometry.triangles.iter().map(|t| if sound(t) { bounds::around(of(t)) } else { NOWHERE });
        let frame = Frame::around(exact());
        let boxes: Vec<Box32> = exact().map(|b| frame.child(b)).collect();
        let tree = tree::build(boxes, [geometry.triangles.len(), 0])?;
        let gate = Gate::new(frame.bounds, frame.centre);
        let scale = gate.scale();
        let mut blocks = pages::list(tree.blocks[0].len());
        let mut trios: Vec<Trio> = pages::list(geometry.triangles.len());
        for list in &tree.blocks[0] {
            let mut block = Block::new(trios.len() as u32);
            for &number in list.iter().filter(|t| **t != u32::MAX) {
                let corners = geometry.triangles[number as usize];
                let material = geometry.materials.get(number as usize).copied().unwrap_or(0);
                let blocks = geometry.ranks[material as usize].blocks;
                block.push(&scale, &of(&corners), 0.0, 0, blocks);
                trios.push(Trio { corners, number });
            }
            blocks.push(block);
        }
        let vertices = reorder(&mut geometry, vertices, &mut trios);
        Ok(Self {
            deep: stack_needed(tree.depth) > STACK,
            nodes: tree.nodes,
            gate,
            blocks,
            trios,
            vertices,
            normals: geometry.normals,
            uvs: geometry.uvs,
            materials: geometry.materials,
            ranks: geometry.ranks,
            vector: Vector::detect(),
        })
    }

    /// The box around everything, wider than the triangles by the tolerances of the hit tests.
    pub fn bounds(&self) -> Bounds {
        self.gate.bounds
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        fn held<T>(v: &Vec<T>) -> usize {
            v.capacity() * size_of::<T>()
        }
        size_of::<Self>()
            + held(&self.nodes)
            + held(&self.blocks)
            + held(&self.trios)
            + held(&self.vertices)
            + held(&self.normals)
            + held(&self.uvs)
            + held(&self.materials)
            + held(&self.ranks)
    }

    /// Uses the scalar walk and leaf tests from now on. Hits are the same bits.
    #[must_use]
    pub fn without_vectors(mut self) -> Self {
        self.vector = None;
        self
    }

    /// True if one of its materials bends light.
    pub(crate) fn bends(&self) -> bool {
        self.ranks.iter().any(|r| r.bends)
    }

    fn rank(&self, triangle: u32) -> Rank {
        let material = self.materials.get(triangle as usize).copied().unwrap_or(0);
        self.ranks[material as usize]
    }

    /// The nearest triangle, in the mesh's own coordinates; `object` of the hit is left to the caller.
    pub(crate) fn search(&self, ray: &Ray, aim: Aim) -> Found {
        let mut s = MeshSearch {
            mesh: self,
            ray: *ray,
            shear: Shear::new(ray.origin, ray.direction),
            bound: aim.bound.min(ray.limit.next_down()),
            found: None,
            aim,
            blocked: false,
        };
        if let Some(vector) = self.vector {
            vector.search_mesh(&mut s);
        } else if self.deep {
            s.scalar::<DEEP_STACK>();
        } else {
            s.scalar::<STACK>();
        }
        if s.blocked {
            return Found::Blocked(ObjectId::MAX);
        }
        s.found.map_or(Found::Nothing, |trio| self.describe(&self.trios[trio as usize], ray, s.bound))
    }

    #[inline]
    fn corners(&self, trio: &Trio) -> [DVec3; 3] {
        trio.corners.map(|i| self.vertices[i as usize])
    }

    fn describe(&self, trio: &Trio, ray: &Ray, distance: f64) -> Found {
        let d = ray.direction;
        let rank = self.rank(trio.number);
        let corners = self.corners(trio);
        let normal = trio::normal(&corners).normalize_or_zero();
        let mut hit = Hit {
            distance,
            object: ObjectId::MAX,
            modifier: rank.modifier,
            normal,
            cosine: -d.dot(normal),
            placement: None,
            uv: [0.0; 2],
            tilt: DVec3::ZERO,
            mesh_triangle: true,
        };
        if self.normals.len() + self.uvs.len() > 0 {
            let weights = Shear::new(ray.origin, d).weights(&corners);
            if let Some(n) = self.interpolated_normal(&trio.corners, weights) {
                hit.tilt = n - normal;
            }
            if let [Some(a), Some(b), Some(c)] = trio.corners.map(|i| self.uvs.get(i as usize).copied().flatten()) {
                hit.uv = [0, 1].map(|k| a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2]);
            }
        }
        Found::Hit(hit, rank)
    }

    fn interpolated_normal(&self, corners: &[u32; 3], weights: [f64; 3]) -> Option<DVec3> {
        let mut sum = DVec3::ZERO;
        for (&i, w) in corners.iter().zip(weights) {
            let n = *self.normals.get(i as usize)?;
            if n == DVec3::ZERO {
                return None;
            }
            sum += n * w;
        }
        sum.try_normalize()
    }
}

/// The box of a triangle without a place.
const NOWHERE: Bounds = Bounds { min: DVec3::ZERO, max: DVec3::ZERO };

fn check(g: &MeshGeometry) -> Result<(), BuildError> {
    let optional = |len: usize, full: usize| len == 0 || len == full;
    let n = g.vertices.len();
    if !(optional(g.normals.len(), n) && optional(g.uvs.len(), n) && optional(g.materials.len(), g.triangles.len())) {
        return Err(BuildError::BadMesh { triangle: 0 });
    }
    for (triangle, t) in g.triangles.iter().enumerate() {
        let material = g.materials.get(triangle).copied().unwrap_or(0) as usize;
        if t.iter().any(|&i| i as usize >= n) || material >= g.ranks.len() {
            return Err(BuildError::BadMesh { triangle });
        }
    }
    Ok(())
}

/// Those of a list that `order` names, unless the list is empty.
fn pick<T: Copy>(from: &mut Vec<T>, order: &[u32]) {
    if !from.is_empty() {
        let mut to = pages::list(order.len());
        to.extend(order.iter().map(|&i| from[i as usize]));
        *from = to;
    }
}

/// Brings vertices, and what goes with them, into the order in which the triangles name them, so that those of a block lie
/// side by side in memory. Vertices without a triangle are dropped.
fn reorder(geometry: &mut MeshGeometry, vertices: Vec<DVec3>, trios: &mut [Trio]) -> Vec<DVec3> {
    let mut place = vec![u32::MAX; vertices.len()];
    let mut order = Vec::with_capacity(vertices.len());
    for corner in trios.iter_mut().flat_map(|t| &mut t.corners) {
        let slot = &mut place[*corner as usize];
        if *slot == u32::MAX {
            *slot = order.len() as u32;
            order.push(*corner);
        }
        *corner = *slot;
    }
    drop(place);
    let mut vertices = vertices;
    pick(&mut vertices, &order);
    pick(&mut geometry.normals, &order);
    pick(&mut geometry.uvs, &order);
    vertices
}

/// The state of a search through a mesh.
pub(crate) struct MeshSearch<'m> {
    pub(crate) mesh: &'m Mesh,
    pub(crate) ray: Ray,
    pub(crate) shear: Shear,
    /// Distance of the nearest triangle so far, or what limits it.
    pub(crate) bound: f64,
    found: Option<u32>,
    aim: Aim,
    blocked: bool,
}

impl MeshSearch<'_> {
    fn scalar<const N: usize>(&mut self) {
        let Some(entry) = Entry::new(&self.mesh.gate, &self.ray) else { return };
        let m = self.mesh;
        walk::<N>(&m.nodes, &entry, self.bound, |word| {
            let index = node::index(word);
            let block = &m.blocks[index];
            for trio in block.first..block.first + block.used().count_ones() {
                self.test(trio);
            }
            self.reach(&entry)
        });
    }

    pub(crate) fn reach(&self, entry: &Entry) -> f32 {
        if self.blocked { -1.0 } else { entry.reach(self.bound) }
    }

    /// What ends the search.
    #[inline]
    pub(crate) fn end(&self) -> End {
        self.aim.end(&self.ray)
    }

    /// Ends the search at a triangle that stops shadow rays.
    #[inline]
    pub(crate) fn block(&mut self) {
        self.blocked = true;
    }

    /// Tests a triangle. True if it is hit and kept.
    #[inline(always)]
    pub(crate) fn test(&mut self, trio: u32) -> bool {
        let corners = self.mesh.corners(&self.mesh.trios[trio as usize]);
        self.shear.passes(&corners) && self.consider(trio, &corners)
    }

    #[inline]
    fn consider(&mut self, trio: u32, corners: &[DVec3; 3]) -> bool {
        let n = trio::normal(corners);
        let t = n.dot(corners[0] - self.ray.origin) / n.dot(self.ray.direction);
        if !(t > EPSILON && t <= self.bound && t.is_finite()) {
            return false;
        }
        // Of triangles at the very same distance the one with the highest number is kept, whatever the order.
        let number = self.mesh.trios[trio as usize].number;
        if let Some(other) = self.found
            && t == self.bound
            && self.mesh.trios[other as usize].number > number
        {
            return false;
        }
        self.bound = t;
        self.found = Some(trio);
        if t < self.aim.blocked_before && self.aim.all_block.unwrap_or_else(|| self.mesh.rank(number).blocks) {
            self.blocked = true;
        }
        true
    }
}
