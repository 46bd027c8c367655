//! From a scene's objects to the geometry that the build tests: surfaces are put right, instances and meshes get the
//! cubes of the files they refer to.

use crate::{Cube, Error, Geometry, Volume, mesh, read};
use ambit_base::{EPSILON, Notify, Transform};
use ambit_file::name_of;
use ambit_scene::{Class, Facet, Kind, ObjectId, Problem, Scene, Shape};
use std::collections::HashMap;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::PathBuf;

/// Finds a library file by its name as a scene gives it, along the search path.
pub type Find<'a> = dyn Fn(&str) -> Option<PathBuf> + 'a;

/// Objects that are about to go into a tree.
#[derive(Debug)]
pub struct Prepared {
    /// What the build tests.
    pub geometry: Geometry,
    /// What Radiance only warns of when it builds the tree, after it has found that everything is inside the cube.
    pub warnings: Vec<String>,
}

/// Prepares a run of objects that are about to go into a tree. Surfaces are corrected in the scene, the way frozen
/// octrees store them, with Radiance's warnings.
pub fn prepare(
    scene: &mut Scene,
    objects: Range<ObjectId>,
    find: &Find<'_>,
    notify: &dyn Notify,
) -> Result<Prepared, Error> {
    let mut geometry = Geometry::starting_at(objects.start);
    let mut cubes = Cubes::new(find);
    // Most warnings come with the bounding boxes; those about spheres come when the tree is built, which is later, and
    // those about cones that are ignored come both times.
    let mut later = Vec::new();
    for id in objects {
        match scene.object(id).kind {
            Kind::Source => geometry.push_nothing(),
            kind if kind.is_modifier() => geometry.push_nothing(),
            kind if kind.class() == Class::Volume => geometry.push_volume(cubes.place(scene, id)?),
            Kind::Polygon => {
                let facet = facet(scene, id)?;
                if let Some(complaint) = facet.complaint() {
                    notify.warn(&format!("{complaint} for {}", scene.describe(id)));
                }
                geometry.push_polygon(&facet, scene.reals(id).len());
            }
            kind => {
                for warning in scene.clean(id)? {
                    let sphere = matches!(kind, Kind::Sphere | Kind::Bubble);
                    if !sphere {
                        notify.warn(&warning.text);
                    }
                    if sphere || warning.complaint.is_degenerate() {
                        later.push(warning.text);
                    }
                }
                let (shape, _) = Shape::from_object(scene, id)?;
                geometry.push_shape(scene, &shape);
            }
        }
    }
    Ok(Prepared { geometry, warnings: later })
}

/// Prepares a run of objects that are in a tree already: nothing is changed and nobody warned.
pub fn prepare_present(scene: &Scene, objects: Range<ObjectId>, find: &Find<'_>) -> Result<Geometry, Error> {
    let mut geometry = Geometry::starting_at(objects.start);
    let mut cubes = Cubes::new(find);
    for id in objects {
        match scene.object(id).kind {
            Kind::Source => geometry.push_nothing(),
            kind if kind.is_modifier() => geometry.push_nothing(),
            kind if kind.class() == Class::Volume => geometry.push_volume(cubes.place(scene, id)?),
            Kind::Polygon => geometry.push_polygon(&facet(scene, id)?, scene.reals(id).len()),
            _ => geometry.push_shape(scene, &Shape::from_object(scene, id)?.0),
        }
    }
    Ok(geometry)
}

fn facet(scene: &Scene, id: ObjectId) -> Result<Facet<'_>, Error> {
    Ok(Facet::new(scene.reals(id)).ok_or_else(|| scene.problem(id, Problem::BadArgumentCount))?)
}

/// The cubes of the files that instances and meshes refer to, each read once.
struct Cubes<'a> {
    find: &'a Find<'a>,
    known: HashMap<(Kind, String), Cube>,
}

impl<'a> Cubes<'a> {
    fn new(find: &'a Find<'a>) -> Self {
        Self { find, known: HashMap::new() }
    }

    /// The volume of an instance or mesh: strings are the file's name and a transform.
    fn place(&mut self, scene: &Scene, id: ObjectId) -> Result<Volume, Error> {
        let bad = |problem| Error::Volume { problem, primitive: scene.describe(id) };
        let mut words = scene.strings(id);
        let name = words.next().ok_or_else(|| bad("bad # of arguments"))?;
        let words: Vec<_> = words.collect();
        let placement = Transform::parse(&words).map_err(|_| bad("bad transform"))?;
        let cube = self.cube(scene.object(id).kind, &name)?;
        Ok(Volume::new(cube, placement))
    }

    fn cube(&mut self, kind: Kind, name: &str) -> Result<Cube, Error> {
        let key = (kind, name.to_owned());
        if let Some(&cube) = self.known.get(&key) {
            return Ok(cube);
        }
        let (what, action) =
            if kind == Kind::Mesh { ("mesh", "cannot open mesh file") } else { ("octree", "cannot open octree file") };
        let path = (self.find)(name).ok_or_else(|| Error::NotFound { what, name: name.to_owned() })?;
        let shown = name_of(&path).into_owned();
        let file = File::open(&path).map_err(|source| Error::Open { action, name: shown.clone(), source })?;
        let mut input = BufReader::new(file);
        let cube = if kind == Kind::Mesh {
            mesh::read_cube(&mut input, &shown)?
        } else {
            read::read_cube(&mut input, &shown)?
        };
        self.known.insert(key, cube);
        Ok(cube)
    }
}

/// True if the edge is too short for anything to be inside.
pub(crate) fn is_too_small(cube: &Cube) -> bool {
    cube.edge <= EPSILON
}
