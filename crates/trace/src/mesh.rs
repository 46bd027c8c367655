//! Triangle meshes: shared by every primitive that places them, traced in their own coordinates.
//!
//! Triangles are tested by [`crate::trio`], four at a time, without cracks.

use crate::BuildError;
use crate::bounds::{self, Box32};
use crate::frame::Frame;
use crate::node::{self, Node};
use crate::pages;
use crate::ray::{Hit, Rank, Ray};
use crate::search::{Aim, Found};
use crate::simd::Vector;
use crate::tree;
use crate::trio::{Shear, Trios};
use crate::walk::{DEEP_STACK, Entry, STACK, stack_needed, walk};
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
    centre: DVec3,
    bounds: Bounds,
    pub(crate) trios: Vec<Trios>,
    /// Vertex numbers of each triangle, if there are normals or texture coordinates.
    triangles: Vec<[u32; 3]>,
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
        let mut trios = pages::list(tree.blocks[0].len());
        trios.extend(tree.blocks[0].iter().map(|list| Trios::pack(list, &geometry.triangles, &vertices)));
        let shaded = geometry.normals.len() + geometry.uvs.len() > 0;
        Ok(Self {
            deep: stack_needed(tree.depth) > STACK,
            nodes: tree.nodes,
            centre: frame.centre,
            bounds: frame.bounds,
            trios,
            triangles: if shaded { geometry.triangles } else { Vec::new() },
            normals: geometry.normals,
            uvs: geometry.uvs,
            materials: geometry.materials,
            ranks: geometry.ranks,
            vector: Vector::detect(),
        })
    }

    /// The box around everything, wider than the triangles by the tolerances of the hit tests.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        fn held<T>(v: &Vec<T>) -> usize {
            v.capacity() * size_of::<T>()
        }
        size_of::<Self>()
            + held(&self.nodes)
            + held(&self.trios)
            + held(&self.triangles)
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
            entry: Entry::new(&self.bounds, self.centre, ray),
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
        s.found.map_or(Found::Nothing, |(block, lane)| self.describe(&self.trios[block], lane, ray, s.bound))
    }

    fn describe(&self, block: &Trios, lane: usize, ray: &Ray, distance: f64) -> Found {
        let d = ray.direction;
        let triangle = block.triangle[lane];
        let rank = self.rank(triangle);
        let normal = block.normal(lane).normalize_or_zero();
        let weights = block.weights(&Shear::new(ray.origin, d), lane);
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
        if let Some(corners) = self.triangles.get(triangle as usize) {
            if let Some(n) = self.interpolated_normal(corners, weights) {
                hit.tilt = n - normal;
            }
            if let [Some(a), Some(b), Some(c)] = corners.map(|i| self.uvs.get(i as usize).copied().flatten()) {
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

/// The state of a search through a mesh.
pub(crate) struct MeshSearch<'m> {
    pub(crate) mesh: &'m Mesh,
    pub(crate) ray: Ray,
    pub(crate) shear: Shear,
    pub(crate) entry: Option<Entry>,
    /// Distance of the nearest triangle so far, or what limits it.
    pub(crate) bound: f64,
    found: Option<(usize, usize)>,
    aim: Aim,
    blocked: bool,
}

impl MeshSearch<'_> {
    fn scalar<const N: usize>(&mut self) {
        let Some(entry) = self.entry else { return };
        let m = self.mesh;
        walk::<N>(&m.nodes, &entry, self.bound, |word| {
            let index = node::index(word);
            let mask = m.trios[index].test(&self.shear);
            self.take(index, mask);
            self.reach(&entry)
        });
    }

    pub(crate) fn reach(&self, entry: &Entry) -> f32 {
        if self.blocked { -1.0 } else { entry.reach(self.bound) }
    }

    /// Looks closer at the lanes of a block that the line may pass through.
    #[inline]
    pub(crate) fn take(&mut self, index: usize, mask: u32) {
        let mut mask = mask & u32::from(self.mesh.trios[index].used());
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            if self.mesh.trios[index].passes(&self.shear, lane) {
                self.consider(index, lane);
            }
        }
    }

    fn consider(&mut self, index: usize, lane: usize) {
        let block = &self.mesh.trios[index];
        let n = block.normal(lane);
        let t = n.dot(block.corner(0, lane) - self.ray.origin) / n.dot(self.ray.direction);
        if !(t > EPSILON && t <= self.bound && t.is_finite()) {
            return;
        }
        // Of triangles at the very same distance the one with the highest number is kept, whatever the order.
        let number = block.triangle[lane];
        if let Some((b, l)) = self.found
            && t == self.bound
            && self.mesh.trios[b].triangle[l] > number
        {
            return;
        }
        self.bound = t;
        self.found = Some((index, lane));
        if t < self.aim.blocked_before && self.aim.all_block.unwrap_or_else(|| self.mesh.rank(number).blocks) {
            self.blocked = true;
        }
    }
}
