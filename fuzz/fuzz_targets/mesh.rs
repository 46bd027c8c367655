//! Compiled meshes.
#![no_main]

use ambit_base::Silent;
use ambit_octree::read_mesh;
use ambit_scene::Scene;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = read_mesh(data, "fuzz.rtm", &mut Scene::new(), &Silent);
});
