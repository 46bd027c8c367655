//! From an octree to all objects it leads to: its own, those of the octrees it instances, and its meshes.

use crate::Error;
use ambit_base::{Notify, Transform};
use ambit_file::{Header, name_of, os_text};
use ambit_octree::{Cube, Mesh, Source};
use ambit_scene::{Class, Commands, Kind, ObjectId, Scene};
use std::collections::HashMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// What the outside world lends to a calculation: files by name, and somewhere to warn.
#[derive(Clone, Copy)]
pub struct Environment<'a> {
    /// Finds an auxiliary file by the name that a scene gives it, along the search path.
    pub find: &'a (dyn Fn(&str) -> Option<PathBuf> + Sync),
    /// Runs what scene files run.
    pub commands: Commands<'a>,
    /// Receives warnings.
    pub notify: &'a dyn Notify,
    /// Definitions for function files from the command line, in order.
    pub definitions: &'a [Definition],
}

/// A definition that precedes those of the scene's function files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Definition {
    /// `-e`: text in the language of function files.
    Text(String),
    /// `-f`: the name of a function file.
    File(String),
}

impl std::fmt::Debug for Environment<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Environment")
    }
}

/// A scene with everything it refers to.
#[derive(Debug)]
pub struct Loaded {
    pub(crate) scene: Scene,
    /// Objects of the main octree.
    pub(crate) top_level: Range<ObjectId>,
    pub(crate) volumes: Volumes,
    pub(crate) cube: Cube,
    header: Header,
}

impl Loaded {
    /// The octree's header.
    pub fn header(&self) -> &Header {
        &self.header
    }
}

/// Octrees and meshes that instances and meshes place, by the object that names them.
#[derive(Debug, Default)]
pub(crate) struct Volumes {
    placed: HashMap<ObjectId, Placed>,
}

/// The contents of an `instance` or `mesh` and where they stand.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) contents: Contents,
    pub(crate) placement: Transform,
}

/// What is inside.
#[derive(Clone, Debug)]
pub(crate) enum Contents {
    Octree(Range<ObjectId>),
    Mesh(Arc<Mesh>),
}

impl Volumes {
    pub(crate) fn get(&self, id: ObjectId) -> Option<&Placed> {
        self.placed.get(&id)
    }
}

/// Loads an octree and what it refers to.
pub fn load(source: Source, environment: &Environment<'_>) -> Result<Loaded, Error> {
    let mut scene = Scene::new();
    let main = read(&source.bytes, &source.name, &mut scene, environment)?;
    source.complain(environment.notify);
    drop(source);
    let top_level = main.objects();
    let mut volumes = Volumes::default();
    let mut known = HashMap::new();
    let mut next = top_level.clone();
    // Octrees found on the way append their objects, which may place further ones.
    while !next.is_empty() {
        let end = scene.len() as ObjectId;
        for id in next {
            if scene.object(id).kind.class() == Class::Volume {
                let placed = place(&mut scene, id, &mut known, environment)?;
                volumes.placed.insert(id, placed);
            }
        }
        next = end..scene.len() as ObjectId;
    }
    Ok(Loaded { scene, top_level, volumes, cube: main.cube, header: main.header })
}

fn read(
    bytes: &[u8],
    name: &str,
    scene: &mut Scene,
    environment: &Environment<'_>,
) -> Result<ambit_octree::Loaded, Error> {
    let mut commands = environment.commands;
    Ok(ambit_octree::read_scene(bytes, name, scene, &mut commands, environment.notify)?)
}

fn place(
    scene: &mut Scene,
    id: ObjectId,
    known: &mut HashMap<(Kind, String), Contents>,
    environment: &Environment<'_>,
) -> Result<Placed, Error> {
    let kind = scene.object(id).kind;
    let mut words = scene.strings(id).map(std::borrow::Cow::into_owned).collect::<Vec<_>>().into_iter();
    let name = words.next().ok_or_else(|| Error::primitive(scene, id, "bad # of arguments"))?;
    let words: Vec<String> = words.collect();
    let placement = Transform::parse(&words).map_err(|_| Error::primitive(scene, id, "bad transform"))?;
    let key = (kind, name.clone());
    if let Some(contents) = known.get(&key) {
        return Ok(Placed { contents: contents.clone(), placement });
    }
    let what = if kind == Kind::Mesh { "mesh" } else { "octree" };
    let path = (environment.find)(&name)
        .ok_or_else(|| Error::system(format!("cannot find {what} file \"{name}\": No such file or directory")))?;
    let shown = name_of(&path);
    let bytes = std::fs::read(&path)
        .map_err(|e| Error::system(format!("cannot open {what} file \"{shown}\": {}", os_text(&e))))?;
    let contents = if kind == Kind::Mesh {
        Contents::Mesh(Arc::new(ambit_octree::read_mesh(&bytes, &shown, scene, environment.notify)?))
    } else {
        Contents::Octree(read(&bytes, &shown, scene, environment)?.objects())
    };
    known.insert(key, contents.clone());
    Ok(Placed { contents, placement })
}
