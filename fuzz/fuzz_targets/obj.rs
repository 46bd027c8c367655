//! Wavefront OBJ files, of the materials `a` and `b`; an MTL file is not read, for materials come from scene files.
#![no_main]

use ambit_base::Silent;
use ambit_octree::{MESH_LIMITS, compile_mesh};
use ambit_scene::{NoCommands, Reader, Scene};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut materials = Scene::new();
    let text = b"void plastic a 0 0 5 1 1 1 0 0 void plastic b 0 0 5 1 1 1 0 0";
    Reader::new(&mut materials, &Silent, &mut NoCommands).read_bytes("fuzz.mat", text).expect("it is right");
    let _ = compile_mesh(data, "fuzz.obj", materials, MESH_LIMITS, &Silent);
});
