//! BSDF files, as a material in a scene that rays meet from both sides.
#![no_main]

use ambit_base::{DVec3, FAR, Silent};
use ambit_file::Header;
use ambit_octree::{Cube, Limits, Objects, Source, build, prepare, write};
use ambit_render::{Aim, Environment, Options, Renderer, Request, load};
use ambit_scene::{NoCommands, Reader, Scene};
use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;

const SCENE: &[u8] = b"void BSDF m 6 0 fuzz.xml 0 1 0 . 0 0 m polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0 \
                       void glow g 0 0 4 1 1 1 0 g source s 0 0 4 0 0 1 360";

/// A folder of this process with the scene's octree.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("ambit-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("there is room for files");
    let mut scene = Scene::new();
    Reader::new(&mut scene, &Silent, &mut NoCommands).read_bytes("fuzz.rad", SCENE).expect("it is right");
    let objects = 0..scene.len() as u32;
    let prepared = prepare(&mut scene, objects, &|_| None, &Silent).expect("it is right");
    let cube = Cube::around(prepared.geometry.bounds());
    let tree = build(&scene, &prepared.geometry, cube, Limits::default()).expect("it is right");
    let mut bytes = Vec::new();
    write(&mut bytes, &Header::default(), &cube, Objects::Frozen(&scene), &tree).expect("it is right");
    std::fs::write(folder.join("fuzz.oct"), bytes).expect("there is room for files");
    folder
});

fuzz_target!(|data: &[u8]| {
    let path = FOLDER.join("fuzz.xml");
    std::fs::write(&path, data).expect("there is room for files");
    let find = |_: &str| Some(path.clone());
    let environment = Environment { find: &find, notify: &Silent, definitions: &[] };
    let octree = FOLDER.join("fuzz.oct").to_string_lossy().into_owned();
    let source = Source::open(&octree, &mut NoCommands).expect("it is there");
    let loaded = load(source, &environment).expect("it is right");
    let mut options = Options::rtrace();
    options.ambient.bounces = 0;
    let Ok(mut renderer) = Renderer::new(loaded, options, &environment) else { return };
    let request = |z: f64, index| Request {
        origin: DVec3::new(0.0, 0.0, z),
        direction: DVec3::new(0.3, 0.2, -z),
        limit: FAR,
        index,
        aim: Aim::Radiance,
    };
    let mut answers = Vec::new();
    if renderer.trace(&[request(1.0, 0), request(-1.0, 1)], &Silent, &mut answers).is_ok() {
        assert!(answers.iter().all(|a| a.value.is_finite()));
    }
});
