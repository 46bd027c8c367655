//! From triangles to a compiled mesh, the way Radiance orders them: an octree of the triangles, whose leaves are gone
//! through from the last to the first; a triangle that is met for the first time is stored, and with it its vertices.

use super::STEPS;
use super::obj::{Obj, Triangle};
use super::store::{Corner, Store};
use crate::error::Problem;
use crate::tree::{Node, Tree};
use crate::{Cube, Error, Geometry, Limits, build};
use ambit_base::{DVec3, EPSILON, Notify};
use ambit_file::{encode_direction, text_of};
use ambit_scene::{Facet, Kind, NewObject, ObjectId, Scene, VOID};
use glam::DVec2;

/// Triangles are flat, normals or not, if no normal differs more than this from the triangle's (cosine).
const FLAT: f64 = 0.999995;

/// Share of their range by which texture coordinates' limits are widened.
const UV_MARGIN: f64 = 2.0 / 65536.0;

/// When cubes of meshes are divided, unless something else is asked for.
pub const MESH_LIMITS: Limits = Limits { objects: 9, resolution: 16384 };

/// A mesh ready to be written.
#[derive(Debug)]
pub struct CompiledMesh {
    pub(super) cube: Cube,
    pub(super) uv_low: DVec2,
    pub(super) uv_high: DVec2,
    pub(super) tree: Tree,
    pub(super) materials: Scene,
    /// How many of the materials are written.
    pub(super) used: ObjectId,
    pub(super) store: Store,
}

/// Compiles Wavefront OBJ text. `name` is what errors call it; `materials` are what faces may be made of, by name.
pub fn compile_mesh(
    text: &[u8],
    name: &str,
    materials: Scene,
    limits: Limits,
    notify: &dyn Notify,
) -> Result<CompiledMesh, Error> {
    let obj = Obj::read(text, name, notify)?;
    let numbers = material_numbers(&obj, &materials, name)?;
    let (scene, geometry, kept) = surfaces(&obj, materials.len(), notify);
    if kept.is_empty() {
        return Err(Error::NoPolygons);
    }
    let cube = Cube::around(geometry.bounds());
    let tree = build(&scene, &geometry, cube, limits)?;
    drop((scene, geometry));
    let used = kept.iter().filter_map(|t| numbers[t.material? as usize]).max().map_or(0, |m| m + 1);
    if let Some(id) = (0..used).find(|&id| !materials.object(id).kind.is_modifier()) {
        return Err(Error::Mesh(Problem::NonModifier(materials.describe(id))));
    }
    let mut mesh = CompiledMesh {
        cube,
        uv_low: DVec2::ZERO,
        uv_high: DVec2::ZERO,
        tree,
        materials,
        used,
        store: Store::default(),
    };
    mesh.limit_uv(&obj, &kept);
    mesh.fill(&obj, &kept, &numbers)?;
    Ok(mesh)
}

/// Number of the material of each name; none for `void`, and for all if there are no materials.
fn material_numbers(obj: &Obj, materials: &Scene, file: &str) -> Result<Vec<Option<ObjectId>>, Error> {
    let number = |name: &Vec<u8>| {
        if materials.is_empty() || name == b"void" {
            return Ok(None);
        }
        let undefined = || Error::UndefinedMaterial { file: file.to_owned(), material: text_of(name).into_owned() };
        materials.modifier(name).map(Some).ok_or_else(undefined)
    };
    obj.materials.iter().map(number).collect()
}

/// The triangles with an area, as polygons to be sorted. Those without get a warning that names them by their number
/// among all objects, the materials included.
fn surfaces(obj: &Obj, materials: usize, notify: &dyn Notify) -> (Scene, Geometry, Vec<Triangle>) {
    let mut scene = Scene::new();
    let file = scene.add_file("mesh");
    let mut geometry = Geometry::starting_at(0);
    let mut kept = Vec::with_capacity(obj.triangles.len());
    for triangle in &obj.triangles {
        let corners = triangle.corners.map(|c| obj.positions[c.position as usize].to_array());
        let reals = corners.as_flattened();
        let facet = Facet::new(reals).filter(|f| !f.is_degenerate());
        let Some(facet) = facet else {
            if triangle.corners.iter().all(|c| c.normal.is_some()) {
                notify.warn("degenerate triangle");
                continue;
            }
            notify.warn(&format!("zero area for polygon \"t{}\"", materials + kept.len()));
            continue;
        };
        geometry.push_polygon(&facet, reals.len());
        scene.push(NewObject { kind: Kind::Polygon, modifier: VOID, name: b"t", strings: &[], reals, file, line: 0 });
        kept.push(*triangle);
    }
    (scene, geometry, kept)
}

/// A triangle with what of its normals and texture coordinates is kept.
struct Dressed {
    positions: [DVec3; 3],
    normals: Option<[DVec3; 3]>,
    uv: Option<[DVec2; 3]>,
}

impl Dressed {
    fn new(obj: &Obj, triangle: &Triangle) -> Self {
        let corners = triangle.corners;
        let all = |f: fn(&super::obj::Corner) -> Option<u32>| -> Option<[usize; 3]> {
            let [a, b, c] = corners.each_ref().map(|c| f(c).map(|i| i as usize));
            Some([a?, b?, c?])
        };
        let mut dressed = Self {
            positions: corners.map(|c| obj.positions[c.position as usize]),
            normals: all(|c| c.normal).map(|n| n.map(|i| obj.normals[i])),
            uv: all(|c| c.uv).map(|t| t.map(|i| obj.uv[i])),
        };
        dressed.turn_to_normals();
        dressed
    }

    /// Turns the triangle the way its normals point, and drops normals that say nothing.
    fn turn_to_normals(&mut self) {
        let Some(normals) = &mut self.normals else { return };
        let [a, b, c] = self.positions;
        let across = (b - a).cross(c - b).normalize_or_zero();
        let mut cosines = normals.map(|n| across.dot(n));
        if cosines.iter().all(|c| *c < 0.0) {
            self.positions.reverse();
            normals.reverse();
            if let Some(uv) = &mut self.uv {
                uv.reverse();
            }
            cosines = cosines.map(|c| -c);
        }
        if cosines.iter().all(|c| *c >= FLAT) {
            self.normals = None;
        }
    }
}

impl CompiledMesh {
    fn limit_uv(&mut self, obj: &Obj, triangles: &[Triangle]) {
        let used = triangles.iter().filter(|t| t.corners.iter().all(|c| c.uv.is_some()));
        let mut all = used.flat_map(|t| t.corners).filter_map(|c| Some(obj.uv[c.uv? as usize]));
        let Some(first) = all.next() else { return };
        let (low, high) = all.fold((first, first), |(l, h), uv| (l.min(uv), h.max(uv)));
        let margin = (high - low) * UV_MARGIN + EPSILON;
        (self.uv_low, self.uv_high) = (low - margin, high + margin);
    }

    /// Stores the triangles in the order in which the leaves are gone through, and puts their numbers there into the tree.
    fn fill(&mut self, obj: &Obj, triangles: &[Triangle], numbers: &[Option<ObjectId>]) -> Result<(), Error> {
        let mut leaves = Vec::new();
        let mut at = 0;
        for node in self.tree.nodes() {
            if let Node::Full(set) = node {
                leaves.push(at + 1..at + 1 + set.len());
            }
            at += crate::tree::length(node);
        }
        let mut ids = vec![None; triangles.len()];
        for leaf in leaves.into_iter().rev() {
            for place in leaf.clone().rev() {
                let number = self.tree.words[place] as usize;
                let id = match ids[number] {
                    Some(id) => id,
                    None => self.add(obj, &triangles[number], numbers)?,
                };
                ids[number] = Some(id);
                self.tree.words[place] = id;
            }
            self.tree.words[leaf].sort_unstable();
        }
        Ok(())
    }

    fn add(&mut self, obj: &Obj, triangle: &Triangle, numbers: &[Option<ObjectId>]) -> Result<u32, Error> {
        let material = triangle.material.and_then(|m| numbers[m as usize]);
        if material.is_none() && self.used > 0 {
            return Err(Error::Mesh(Problem::Triangle("local", "material")));
        }
        let material = match material {
            Some(m) => i16::try_from(m).map_err(|_| Error::Mesh(Problem::TooManyObjects))?,
            None => -1,
        };
        let dressed = Dressed::new(obj, triangle);
        let corners = std::array::from_fn(|i| Corner {
            position: self.fraction(dressed.positions[i]),
            normal: dressed.normals.map_or(0, |n| encode_direction(n[i])),
            uv: dressed.uv.map_or([0; 2], |uv| self.uv_fraction(uv[i])),
        });
        self.store.add(corners, material).map_err(Error::Mesh)
    }

    /// A position as fractions of the cube.
    fn fraction(&self, p: DVec3) -> [u32; 3] {
        ((p - self.cube.origin) * (STEPS / self.cube.edge)).to_array().map(|x| x as u32)
    }

    /// Texture coordinates as fractions of their range.
    fn uv_fraction(&self, uv: DVec2) -> [u32; 2] {
        ((uv - self.uv_low) * (STEPS / (self.uv_high - self.uv_low))).to_array().map(|x| x as u32)
    }
}
