//! Compiled triangle meshes: vertices in patches of up to 256, positions as fractions of the mesh's cube, normals as
//! direction codes, texture coordinates as fractions of their range. Lengths are the units of the mesh's own
//! coordinates.

mod compile;
mod ear;
mod obj;
mod patch;
mod read;
mod store;
mod write;

pub use compile::{CompiledMesh, MESH_LIMITS, compile_mesh};
pub(crate) use read::read_cube;
pub use read::read_mesh;

use crate::Cube;
use ambit_base::DVec3;
use ambit_file::decode_direction;
use ambit_scene::ObjectId;
use glam::DVec2;

/// A mesh: triangles over shared vertices.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// The root cube of its octree, which encloses everything.
    pub cube: Cube,
    /// Three indices of vertices a triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle, or [`ambit_scene::VOID`].
    pub materials: Vec<ObjectId>,
    /// Positions of the vertices.
    pub vertices: Vec<DVec3>,
    /// Direction codes of the vertices' normals, 0 where there is none; empty if no vertex has one.
    normals: Vec<u32>,
    /// Fractions of the range of texture coordinates, 0 where there are none; empty if no vertex has any.
    uv: Vec<[u32; 2]>,
    uv_low: DVec2,
    uv_range: DVec2,
}

/// Steps of a fraction over its whole range.
const STEPS: f64 = 4_294_967_296.0;

impl Mesh {
    /// Unit normals at the corners of a triangle; none unless every corner has one.
    pub fn normals(&self, triangle: usize) -> Option<[DVec3; 3]> {
        let codes = self.corners(&self.normals, triangle)?;
        (!codes.contains(&0)).then(|| codes.map(decode_direction))
    }

    /// Texture coordinates at the corners of a triangle; none unless every corner has them.
    pub fn uv(&self, triangle: usize) -> Option<[DVec2; 3]> {
        let fractions = self.corners(&self.uv, triangle)?;
        let decode = |[u, v]: [u32; 2]| {
            let centred = DVec2::new(u as f64, v as f64) + 0.5;
            self.uv_low + self.uv_range * centred / STEPS
        };
        fractions.iter().all(|q| q[0] != 0).then(|| fractions.map(decode))
    }

    /// Positions of the corners of a triangle.
    pub fn positions(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    fn corners<T: Copy>(&self, table: &[T], triangle: usize) -> Option<[T; 3]> {
        let [a, b, c] = *self.triangles.get(triangle)?;
        Some([*table.get(a as usize)?, *table.get(b as usize)?, *table.get(c as usize)?])
    }
}
