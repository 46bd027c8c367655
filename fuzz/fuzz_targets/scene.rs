//! Scene text, and the shapes of its surfaces. Commands are not run.
#![no_main]

use ambit_base::Silent;
use ambit_scene::{NoCommands, Reader, Scene, Shape};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut scene = Scene::new();
    if let Err(error) = Reader::new(&mut scene, &Silent, &mut NoCommands).read_bytes("fuzz.rad", data) {
        assert!(!error.to_string().is_empty());
    }
    for id in scene.ids() {
        if let Ok((shape, _)) = Shape::from_object(&scene, id) {
            let _ = shape.bounds();
        }
    }
});
