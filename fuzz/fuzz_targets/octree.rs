//! Octrees, with their trees and without. Scene files that they name are looked for, and not there.
#![no_main]

use ambit_base::Silent;
use ambit_octree::{read_cube, read_octree, read_scene};
use ambit_scene::{NoCommands, Scene};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let plain = read_scene(data, "fuzz.oct", &mut Scene::new(), &mut NoCommands, &Silent);
    let full = read_octree(data, "fuzz.oct", &mut Scene::new(), &mut NoCommands, &Silent);
    assert_eq!(plain.err().map(|e| e.to_string()), full.err().map(|e| e.to_string()));
    let _ = read_cube(&mut &data[..], "fuzz.oct");
});
