//! The bundled scenes, as `fixtures/list.tsv` names them.

use std::path::{Path, PathBuf};

use crate::programs::{Program, root};

/// One bundled scene.
#[derive(Debug, Clone)]
pub struct Fixture {
    /// Its name and folder.
    pub name: String,
    /// The folder, which the scene's auxiliary files are found from.
    pub folder: PathBuf,
    /// Scene files in the order of compilation.
    pub scenes: String,
    /// View files.
    pub views: Vec<PathBuf>,
    /// The rays of its sensors: one a line, position and direction.
    pub sensors: PathBuf,
}

impl Fixture {
    /// All bundled scenes.
    ///
    /// # Panics
    /// If the list is not as its head describes.
    pub fn all() -> Vec<Self> {
        let home = root().join("fixtures");
        let list = std::fs::read_to_string(home.join("list.tsv")).expect("the list is checked in");
        let read = |line: &str| {
            let [name, scenes, views, sensors] = line.split('\t').collect::<Vec<_>>()[..] else {
                panic!("not a line of the list of scenes: {line}")
            };
            let folder = home.join(name);
            Self {
                name: name.to_owned(),
                scenes: scenes.to_owned(),
                views: views.split_whitespace().map(|v| folder.join(v)).collect(),
                sensors: folder.join(sensors),
                folder,
            }
        };
        list.lines().filter(|l| !l.starts_with('#')).map(read).collect()
    }

    /// The scene of this name.
    ///
    /// # Panics
    /// If there is none.
    pub fn named(name: &str) -> Self {
        Self::all().into_iter().find(|f| f.name == name).unwrap_or_else(|| panic!("no bundled scene {name}"))
    }

    /// Compiles the scene to a frozen octree in `scratch`; returns its path.
    ///
    /// # Panics
    /// If oconv fails or the folder cannot be written.
    pub fn compile(&self, scratch: &Path) -> PathBuf {
        let answer = Program::new("oconv").line("-f -w").line(&self.scenes).within(&self.folder).run();
        let octree = scratch.join(format!("{}.oct", self.name));
        std::fs::write(&octree, answer.well(&self.name).out).expect("the scratch folder can be written");
        octree
    }
}
