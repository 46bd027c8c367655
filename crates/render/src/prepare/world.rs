//! Surfaces, instances and meshes into one hierarchy of bounding volumes.

use super::load::{Contents, Placed, Volumes};
use super::{Environment, Modifiers};
use crate::Error;
use ambit_base::DVec3;
use ambit_octree::Mesh;
use ambit_scene::{Class, Kind, ObjectId, Scene, Shape, VOID};
use ambit_trace::{MeshGeometry, Rank, World, WorldBuilder};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Worlds and meshes that several instances share, by what tells them apart.
#[derive(Default)]
struct Shared {
    octrees: HashMap<ObjectId, Arc<World>>,
    meshes: HashMap<*const Mesh, Arc<ambit_trace::Mesh>>,
}

/// Builds the world of the objects `range`, with all that they instance.
pub(crate) fn build(
    scene: &Scene,
    range: Range<ObjectId>,
    volumes: &Volumes,
    modifiers: &Modifiers,
    environment: &Environment<'_>,
) -> Result<World, Error> {
    let mut shared = Shared::default();
    build_range(scene, range, volumes, modifiers, environment, &mut shared)
}

fn build_range(
    scene: &Scene,
    range: Range<ObjectId>,
    volumes: &Volumes,
    modifiers: &Modifiers,
    environment: &Environment<'_>,
    shared: &mut Shared,
) -> Result<World, Error> {
    let mut builder = WorldBuilder::new();
    for id in range {
        let object = scene.object(id);
        let rank = rank(modifiers, object.modifier);
        match object.kind.class() {
            Class::Surface if object.kind != Kind::Source => {
                let (shape, warnings) = Shape::from_object(scene, id)?;
                // What is never hit is in no octree, and oconv has told of it.
                for warning in warnings.iter().filter(|w| !w.complaint.is_degenerate()) {
                    environment.notify.warn(&warning.text);
                }
                builder.add(id, &shape, rank);
            }
            Class::Volume => {
                let Some(Placed { contents, placement }) = volumes.get(id) else { continue };
                let over = (object.modifier != VOID).then_some(rank);
                match contents {
                    Contents::Octree(inner) => {
                        let world = if let Some(world) = shared.octrees.get(&inner.start) {
                            world.clone()
                        } else {
                            let world = build_range(scene, inner.clone(), volumes, modifiers, environment, shared)?;
                            shared.octrees.entry(inner.start).or_insert(Arc::new(world)).clone()
                        };
                        builder.add_instance(id, *placement, world, over);
                    }
                    Contents::Mesh(mesh) => {
                        let key = Arc::as_ptr(mesh);
                        let traced = if let Some(traced) = shared.meshes.get(&key) {
                            traced.clone()
                        } else {
                            let traced = ambit_trace::Mesh::build(geometry(mesh, modifiers))
                                .map_err(|e| Error::user(e.to_string()))?;
                            shared.meshes.entry(key).or_insert(Arc::new(traced)).clone()
                        };
                        builder.add_mesh(id, *placement, traced, over);
                    }
                }
            }
            _ => {}
        }
    }
    builder.build().map_err(|e| Error::user(e.to_string()))
}

fn rank(modifiers: &Modifiers, modifier: ObjectId) -> Rank {
    Rank {
        opacity: modifiers.opacity(modifier),
        modifier,
        blocks: modifiers.blocks(modifier),
        bends: modifiers.bends(modifier),
    }
}

/// A mesh file's triangles in the tracer's terms.
fn geometry(mesh: &Mesh, modifiers: &Modifiers) -> MeshGeometry {
    let mut ranks: Vec<Rank> = Vec::new();
    let mut index = HashMap::new();
    let materials = mesh
        .materials
        .iter()
        .map(|&m| {
            *index.entry(m).or_insert_with(|| {
                ranks.push(rank(modifiers, m));
                ranks.len() as u32 - 1
            })
        })
        .collect();
    let mut normals = Vec::new();
    let mut uvs = Vec::new();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        if let Some(n) = mesh.normals(t) {
            normals.resize(mesh.vertices.len(), DVec3::ZERO);
            for (&v, n) in corners.iter().zip(n) {
                normals[v as usize] = n;
            }
        }
        if let Some(uv) = mesh.uv(t) {
            uvs.resize(mesh.vertices.len(), None);
            for (&v, uv) in corners.iter().zip(uv) {
                uvs[v as usize] = Some(uv.into());
            }
        }
    }
    MeshGeometry { vertices: mesh.vertices.clone(), triangles: mesh.triangles.clone(), normals, uvs, materials, ranks }
}
