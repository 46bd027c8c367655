//! Triangle meshes: shared by every primitive that places them, traced in their own coordinates.
//!
//! A triangle is hit if the volumes spanned by the ray and its three edges have one sign. The volume of a shared edge is
//! the same number for both neighbours but for its sign, and a volume of exactly zero counts as negative for the
//! direction from the lower to the higher vertex number; so a ray through an edge hits one of the two, never none or
//! both.

use crate::BuildError;
use crate::bounds::{self, Box32};
use crate::facet::LANES;
use crate::frame::Frame;
use crate::node::{self, Node};
use crate::ray::{Hit, Rank, Ray};
use crate::search::{Aim, Found};
use crate::simd::Vector;
use crate::tree;
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

/// Four triangles, component by component.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Trios {
    /// By corner, axis and lane.
    pub(crate) corners: [[[f64; LANES]; 3]; 3],
    pub(crate) triangle: [u32; LANES],
    /// By edge: lanes in which it runs from the higher to the lower vertex number.
    pub(crate) reversed: [u8; 3],
    /// Lanes in use.
    used: u8,
}

impl Trios {
    fn corner(&self, k: usize, lane: usize) -> DVec3 {
        DVec3::new(self.corners[k][0][lane], self.corners[k][1][lane], self.corners[k][2][lane])
    }

    /// The volumes of the three edges (0→1, 1→2, 2→0) with the ray.
    fn volumes(&self, lane: usize, o: DVec3, d: DVec3) -> [f64; 3] {
        let v = [0, 1, 2].map(|k| self.corner(k, lane) - o);
        [0, 1, 2].map(|k| {
            let (p, q) = (v[k], v[(k + 1) % 3]);
            let cross = [p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x];
            d.x * cross[0] + d.y * cross[1] + d.z * cross[2]
        })
    }

    /// Lanes whose triangle the line passes through.
    pub(crate) fn test(&self, o: DVec3, d: DVec3) -> u32 {
        let mut mask = 0;
        for lane in 0..LANES {
            let v = self.volumes(lane, o, d);
            let positive = |k: usize| v[k] > 0.0 || (v[k] == 0.0 && self.reversed[k] >> lane & 1 == 1);
            let all = positive(0) && positive(1) && positive(2);
            let none = !positive(0) && !positive(1) && !positive(2);
            mask |= u32::from(all || none) << lane;
        }
        mask
    }
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
        let trios = tree.blocks[0].iter().map(|list| pack(list, &geometry.triangles, &vertices)).collect();
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

    fn rank(&self, triangle: u32) -> Rank {
        let material = self.materials.get(triangle as usize).copied().unwrap_or(0);
        self.ranks[material as usize]
    }

    /// The nearest triangle, in the mesh's own coordinates; `object` of the hit is left to the caller.
    pub(crate) fn search(&self, ray: &Ray, aim: Aim) -> Found {
        let mut s = MeshSearch {
            mesh: self,
            ray: *ray,
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
        let normal = normal(block, lane).normalize_or_zero();
        let v = block.volumes(lane, ray.origin, d);
        let sum = v[0] + v[1] + v[2];
        // The edge opposite a corner is the one after the next.
        let weights = [v[1] / sum, v[2] / sum, v[0] / sum];
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

fn pack(list: &[u32; LANES], triangles: &[[u32; 3]], vertices: &[DVec3]) -> Trios {
    let mut out = Trios { corners: [[[0.0; LANES]; 3]; 3], triangle: [u32::MAX; LANES], reversed: [0; 3], used: 0 };
    for (lane, &number) in list.iter().enumerate().filter(|(_, t)| **t != u32::MAX) {
        let t = triangles[number as usize];
        for k in 0..3 {
            for (axis, slot) in out.corners[k].iter_mut().enumerate() {
                slot[lane] = vertices[t[k] as usize][axis];
            }
            out.reversed[k] |= u8::from(t[k] > t[(k + 1) % 3]) << lane;
        }
        out.triangle[lane] = number;
        out.used |= 1 << lane;
    }
    out
}

fn normal(block: &Trios, lane: usize) -> DVec3 {
    let a = block.corner(0, lane);
    (block.corner(1, lane) - a).cross(block.corner(2, lane) - a)
}

/// The state of a search through a mesh.
pub(crate) struct MeshSearch<'m> {
    pub(crate) mesh: &'m Mesh,
    pub(crate) ray: Ray,
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
            let mask = m.trios[index].test(self.ray.origin, self.ray.direction);
            self.take(index, mask);
            self.reach(&entry)
        });
    }

    pub(crate) fn reach(&self, entry: &Entry) -> f32 {
        if self.blocked { -1.0 } else { entry.reach(self.bound) }
    }

    /// Looks closer at the lanes of a block whose triangles the line passes through.
    #[inline]
    pub(crate) fn take(&mut self, index: usize, mask: u32) {
        let mut mask = mask & u32::from(self.mesh.trios[index].used);
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            self.consider(index, lane);
        }
    }

    fn consider(&mut self, index: usize, lane: usize) {
        let block = &self.mesh.trios[index];
        let n = normal(block, lane);
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
