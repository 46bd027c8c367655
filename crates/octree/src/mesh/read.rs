//! Reading mesh files: header, magic number, cube, limits of the texture coordinates, tree, materials, patches.
//!
//! The tree is checked and left out, since the triangles are sorted anew.

use super::patch::{Patch, Reference};
use super::{Mesh, STEPS};
use crate::error::Problem;
use crate::format::MESH;
use crate::prepare::is_too_small;
use crate::{Cube, Error, frozen};
use ambit_base::{DVec3, EPSILON, Notify};
use ambit_file::{Cursor, Header};
use ambit_scene::{ObjectId, Scene, VOID};
use glam::DVec2;
use std::io::BufRead;

/// Vertices in all: as many as a vertex number can tell.
const MOST_VERTICES: usize = 1 << 30;

/// Reads a mesh and appends its materials to a scene. `name` is what errors call the file.
pub fn read_mesh(bytes: &[u8], name: &str, scene: &mut Scene, notify: &dyn Notify) -> Result<Mesh, Error> {
    let wrong = |p: Problem| p.of(name);
    let (_, start) = Header::parse(bytes, name).map_err(|_| wrong(Problem::IncompatibleMesh))?;
    let mut input = Cursor::new(&bytes[start..]);
    let width = MESH.width(&mut input).map_err(wrong)?;
    let cube = checked_cube(MESH.cube(&mut input)).map_err(wrong)?;
    let mut limit = || input.float().ok_or_else(|| wrong(Problem::TruncatedMesh));
    let [u0, u1, v0, v1] = [limit()?, limit()?, limit()?, limit()?];
    MESH.tree(&mut input, width, |_| Ok(())).map_err(wrong)?;
    let first = scene.len();
    let material_count = frozen::read(&mut input, width, name, scene, notify)?;
    for id in first..scene.len() {
        if !scene.object(id as ObjectId).kind.is_modifier() {
            return Err(wrong(Problem::NonModifier(scene.describe(id as ObjectId))));
        }
    }
    let patches = read_patches(&mut input).map_err(wrong)?;
    let mut mesh = Mesh {
        cube,
        triangles: Vec::new(),
        materials: Vec::new(),
        vertices: Vec::new(),
        normals: Vec::new(),
        uv: Vec::new(),
        uv_low: DVec2::new(u0, v0),
        uv_range: DVec2::new(u1 - u0, v1 - v0),
    };
    let materials = Materials { first, count: material_count };
    mesh.assemble(&patches, &materials).map_err(wrong)?;
    if !mesh.uv.is_empty() && mesh.uv_range.min_element() <= EPSILON {
        return Err(wrong(Problem::UnreferencedUv));
    }
    Ok(mesh)
}

/// The cube alone: all that is needed of a mesh to place it.
pub(crate) fn read_cube(input: &mut impl BufRead, name: &str) -> Result<Cube, Error> {
    let wrong = |p: Problem| p.of(name);
    Header::read(input, name).map_err(|_| wrong(Problem::IncompatibleMesh))?;
    checked_cube(MESH.front_cube(input)).map_err(wrong)
}

fn checked_cube(cube: Result<Cube, Problem>) -> Result<Cube, Problem> {
    let cube = cube?;
    if is_too_small(&cube) { Err(Problem::MeshBounds) } else { Ok(cube) }
}

fn read_patches<'a>(input: &mut Cursor<'a>) -> Result<Vec<Patch<'a>>, Problem> {
    let count = input.int(4).ok_or(Problem::TruncatedMesh)?;
    // Grows with what is really there, whatever the count says.
    let mut patches = Vec::new();
    for _ in 0..count {
        patches.push(Patch::read(input)?);
    }
    Ok(patches)
}

/// The objects that triangles' materials count from.
struct Materials {
    first: usize,
    count: usize,
}

impl Materials {
    /// The object of a material index; `None` if there is no such material.
    fn object(&self, index: i64) -> Option<ObjectId> {
        match usize::try_from(index) {
            Ok(i) if i < self.count => Some((self.first + i) as ObjectId),
            Err(_) if self.count == 0 => Some(VOID),
            _ => None,
        }
    }
}

impl Mesh {
    fn assemble(&mut self, patches: &[Patch<'_>], materials: &Materials) -> Result<(), Problem> {
        let mut starts = Vec::with_capacity(patches.len());
        let mut vertices = 0;
        for p in patches {
            starts.push(vertices as u32);
            vertices += p.vertex_count();
            if vertices > MOST_VERTICES {
                return Err(Problem::MeshTooLarge);
            }
        }
        self.vertices.reserve_exact(vertices);
        if patches.iter().any(|p| p.normals.is_some()) {
            self.normals.reserve_exact(vertices);
        }
        if patches.iter().any(|p| p.uv.is_some()) {
            self.uv.reserve_exact(vertices);
        }
        let triangles: usize = patches.iter().map(Patch::triangle_count).sum();
        self.triangles.reserve_exact(triangles);
        self.materials.reserve_exact(triangles);
        for p in patches {
            let scale = self.cube.edge / STEPS;
            self.vertices.extend(
                p.positions()
                    .map(|[x, y, z]| self.cube.origin + (DVec3::new(x as f64, y as f64, z as f64) + 0.5) * scale),
            );
            if self.normals.capacity() > 0 {
                self.normals.extend(p.normals());
            }
            if self.uv.capacity() > 0 {
                self.uv.extend(p.uv());
            }
        }
        for (p, &start) in patches.iter().zip(&starts) {
            for triangle in p.triangles() {
                let kind = triangle.kind;
                let bad = |what| Problem::Triangle(kind.name(), what);
                let mut indices = [0; 3];
                for (index, corner) in indices.iter_mut().zip(triangle.corners) {
                    *index = match corner {
                        Reference::Local(i) if (i as usize) < p.vertex_count() => start + i as u32,
                        Reference::Local(_) => return Err(bad(kind.local_index())),
                        Reference::Global(id) => {
                            let (patch, i) = ((id >> 8) as usize, id & 0xff);
                            let found = patches.get(patch).filter(|q| (i as usize) < q.vertex_count());
                            found.map(|_| starts[patch] + i).ok_or_else(|| bad("joiner"))?
                        }
                    };
                }
                let material = materials.object(triangle.material).ok_or_else(|| bad("material"))?;
                self.triangles.push(indices);
                self.materials.push(material);
            }
        }
        Ok(())
    }
}
