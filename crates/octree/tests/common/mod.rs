//! What the tests share: warnings kept for inspection, and oconv's way from scene text to the bytes of an octree.

#![allow(dead_code, reason = "each test program uses a part of it")]

use ambit_base::Notify;
use ambit_file::Header;
use ambit_octree::{Cube, Error, Limits, Objects, build, extend, prepare, prepare_present, read_octree, write};
use ambit_scene::{NoCommands, Reader, Scene};
use std::path::PathBuf;
use std::sync::Mutex;

/// Keeps warnings.
#[derive(Default)]
pub(crate) struct Kept(Mutex<Vec<String>>);

impl Notify for Kept {
    fn warn(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

impl Kept {
    /// What came so far.
    pub(crate) fn texts(&self) -> Vec<String> {
        self.0.lock().unwrap().clone()
    }
}

/// The bytes of a recorded file.
pub(crate) fn recorded(name: &str) -> Vec<u8> {
    std::fs::read(format!("tests/recorded/{name}")).unwrap()
}

/// What to make an octree of, and how.
#[derive(Default)]
pub(crate) struct Job<'a> {
    pub(crate) files: &'a [&'a str],
    pub(crate) start: Option<&'a str>,
    pub(crate) cube: Option<Cube>,
    pub(crate) limits: Limits,
    pub(crate) frozen: bool,
    /// The command line in the header.
    pub(crate) command: &'a str,
}

impl Job<'_> {
    /// Reads, builds and writes, as oconv does.
    pub(crate) fn run(&self, notify: &dyn Notify) -> Result<Vec<u8>, Error> {
        let find = |name: &str| Some(PathBuf::from(name)).filter(|p| p.exists());
        let mut scene = Scene::new();
        let mut header = Header::new();
        let mut names = Vec::new();
        let mut start = None;
        if let Some(name) = self.start {
            let bytes = std::fs::read(name).unwrap();
            let (loaded, tree) = read_octree(&bytes, name, &mut scene, &mut NoCommands, notify)?;
            header = Header::empty();
            header.extend(loaded.header.lines_without_format());
            names = loaded.scene_files;
            start = Some((loaded.cube, tree));
        }
        let first = scene.ids().end;
        let mut runner = NoCommands;
        let mut reader = Reader::new(&mut scene, notify, &mut runner);
        for name in self.files {
            names.push((*name).to_owned());
            reader.read(name)?;
        }
        let objects = first..scene.ids().end;
        let prepared = prepare(&mut scene, objects, &find, notify)?;
        prepared.warnings.iter().for_each(|w| notify.warn(w));
        let fitting = Cube::around(prepared.geometry.bounds());
        let cube = start.as_ref().map(|s| s.0).or(self.cube).unwrap_or(fitting);
        let tree = match start {
            None => build(&scene, &prepared.geometry, cube, self.limits)?,
            Some((_, tree)) => {
                let present = prepare_present(&scene, 0..first, &find)?;
                let extended = extend(&scene, &prepared.geometry, cube, self.limits, &tree, &present)?;
                for &id in &extended.moved {
                    scene.clean(id)?;
                }
                extended.tree
            }
        };
        header.push(self.command);
        let objects =
            if self.frozen { Objects::Frozen(&scene) } else { Objects::InFiles { names: &names, count: scene.len() } };
        let mut bytes = Vec::new();
        write(&mut bytes, &header, &cube, objects, &tree)?;
        Ok(bytes)
    }
}
