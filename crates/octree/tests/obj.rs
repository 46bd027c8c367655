//! Whatever stands in an OBJ file, nothing panics; what is refused is refused by the name of the file and, where a
//! statement is to blame, a line that exists; what is taken makes a mesh that can be read again.

use ambit_base::Silent;
use ambit_file::Header;
use ambit_octree::{Error, MESH_LIMITS, compile_mesh, read_mesh};
use ambit_scene::Scene;
use proptest::collection::vec;
use proptest::prelude::*;

const LINES: [&str; 28] = [
    "v 0 0 0",
    "v 4 0 0",
    "v 4 4 1",
    "v 0 4 0",
    "v -1e3 2 .5",
    "v 1 x 2",
    "v 1e300 0 0",
    "vt 0 0",
    "vt 1 .5",
    "vt 2",
    "vn 0 0 1",
    "vn 1 0 1",
    "vn 0 0 0",
    "f 1 2 3",
    "f 1 2 3 4",
    "f 4 3 2 1 2",
    "f -1 -2 -3",
    "f 1/1 2/2 3/1",
    "f 1//1 2//2 3//1",
    "f 1/1/1 2/2/2 3/1/2 4/1/1",
    "f 1 2 9",
    "f 1 1 1 1",
    "usemtl m",
    "g void",
    "# comment \\",
    "\\",
    "f 1 \\\n2 3",
    "zork \0",
];

fn texts() -> impl Strategy<Value = Vec<u8>> {
    let corners = Just("v 0 0 0\nv 4 0 0\nv 4 4 1\nv 0 4 0\n".to_owned());
    let lines = (corners, vec(0..LINES.len(), 0..24)).prop_map(|(mut text, lines)| {
        for line in lines {
            text.push_str(LINES[line]);
            text.push('\n');
        }
        text.into_bytes()
    });
    prop_oneof![4 => lines, 1 => vec(any::<u8>(), 0..120)]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn obj_files(text in texts()) {
        match compile_mesh(&text, "t.obj", Scene::new(), MESH_LIMITS, &Silent) {
            Ok(mesh) => {
                let mut bytes = Vec::new();
                let mut header = Header::empty();
                header.push("#?RADIANCE");
                mesh.write(&mut bytes, &header).unwrap();
                let read = read_mesh(&bytes, "t.rtm", &mut Scene::new(), &Silent);
                prop_assert!(read.is_ok(), "{}", read.unwrap_err());
                prop_assert!(!read.unwrap().triangles.is_empty());
            }
            Err(Error::Obj { name, line, .. }) => {
                prop_assert_eq!(name, "t.obj");
                let lines = text.split(|b| *b == b'\n').count();
                prop_assert!((1..=lines).contains(&line), "{line} of {lines}");
            }
            Err(e) => prop_assert!(matches!(e, Error::NoPolygons), "{e}"),
        }
    }
}
