//! A mesh made by Radiance 6.0a's obj2mesh of `tests/recorded/roof.obj`, four triangles over five corners, and what is
//! said of damaged ones.

mod common;

use ambit_base::{DVec3, Silent};
use ambit_octree::{Mesh, read_mesh};
use ambit_scene::{Scene, VOID};
use common::recorded;

fn roof() -> (Mesh, Scene) {
    let mut scene = Scene::new();
    let mesh = read_mesh(&recorded("roof.rtm"), "roof.rtm", &mut scene, &Silent).unwrap();
    (mesh, scene)
}

/// The triangle with these corners in this cyclic order.
fn find(mesh: &Mesh, corners: [[f64; 3]; 3]) -> usize {
    let step = mesh.cube.edge / 4_294_967_296.0;
    let found = (0..mesh.triangles.len()).find(|&t| {
        let p = mesh.positions(t);
        (0..3).any(|turn| (0..3).all(|i| p[(i + turn) % 3].distance(corners[i].into()) < 2.0 * step))
    });
    found.unwrap_or_else(|| panic!("no triangle {corners:?}"))
}

const APEX: [f64; 3] = [2.0, 2.0, 1.5];

#[test]
fn corners_normals_and_texture_are_decoded() {
    let (mesh, scene) = roof();
    assert_eq!(mesh.triangles.len(), 4);
    let south = find(&mesh, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], APEX]);
    let at = |p: [f64; 3]| mesh.positions(south).iter().position(|q| q.distance(p.into()) < 1e-6).unwrap();
    let normals = mesh.normals(south).unwrap();
    // Half a step of the direction code.
    assert!(normals[at(APEX)].distance(DVec3::Z) < 1e-4);
    assert!(normals[at([4.0, 0.0, 0.0])].distance(DVec3::new(0.0, -0.6, 0.8)) < 1e-4);
    let uv = mesh.uv(south).unwrap();
    for (p, expected) in [([0.0, 0.0, 0.0], [0.0, 0.0]), ([4.0, 0.0, 0.0], [1.0, 0.0]), (APEX, [0.5, 1.0])] {
        assert!(uv[at(p)].distance(expected.into()) < 1e-8, "{p:?}: {}", uv[at(p)]);
    }
    let east = find(&mesh, [[4.0, 0.0, 0.0], [4.0, 4.0, 0.0], APEX]);
    assert!(mesh.normals(east).is_some() && mesh.uv(east).is_some());
    let west = find(&mesh, [[0.0, 4.0, 0.0], [0.0, 0.0, 0.0], APEX]);
    assert!(mesh.normals(west).is_some() && mesh.uv(west).is_none());
    let north = find(&mesh, [[4.0, 4.0, 0.0], [0.0, 4.0, 0.0], APEX]);
    assert!(mesh.normals(north).is_none() && mesh.uv(north).is_none());
    let material = |t: usize| scene.name(mesh.materials[t]).into_owned();
    assert_eq!([material(south), material(east), material(north)], ["tile", "tile", "slate"]);
}

#[test]
fn materials_are_numbered_after_what_the_scene_has() {
    let mut scene = Scene::new();
    let bytes = recorded("roof.rtm");
    read_mesh(&bytes, "a", &mut scene, &Silent).unwrap();
    let again = read_mesh(&bytes, "b", &mut scene, &Silent).unwrap();
    assert_eq!(scene.len(), 4);
    assert!(again.materials.iter().all(|m| (2..4).contains(m)));
}

/// A mesh of one patch: three vertices, one local triangle, its last fields given.
fn patch(tail: &[u8], materials: bool) -> Vec<u8> {
    let mut b = b"#?RADIANCE\nFORMAT=Radiance_tmesh\n\n\x01\x430\x000\x000\x004\0".to_vec();
    b.extend([0; 20]);
    b.push(0);
    b.extend(b"plastic\0\0");
    if materials {
        b.extend(b"\0\xff\xff\xff\xffm\0\0\0\0\0");
    }
    b.extend(b"\xff\0\0\0\x01\x01\0\x03");
    for corner in [[0u32, 0, 0], [1 << 30, 0, 0], [0, 1 << 30, 0]] {
        b.extend(corner.iter().flat_map(|q| q.to_be_bytes()));
    }
    b.extend(tail);
    b
}

const PLAIN: &[u8] = b"\0\x01\0\x01\x02\0\x01\xff\xff\0\0\0\0";

fn complaint(bytes: &[u8]) -> String {
    let result = read_mesh(bytes, "m.rtm", &mut Scene::new(), &Silent);
    result.err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn joiner_triangles_come_after_local_ones() {
    let tail = b"\0\x01\0\x01\x02\0\x01\xff\xff\0\x01\0\0\0\0\x01\x02\xff\xff\0\x01\0\0\0\x01\0\0\0\x02\0\xff\xff";
    let mesh = read_mesh(&patch(tail, false), "m", &mut Scene::new(), &Silent).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 2], [1, 2, 0]]);
    assert_eq!(mesh.materials, [VOID; 3]);
    let half = 0.5 * 4.0 / 4_294_967_296.0;
    assert_eq!(mesh.vertices[1], DVec3::new(1.0 + half, half, half));
}

#[test]
fn damage_is_named_as_radiance_names_it() {
    assert_eq!(complaint(&patch(PLAIN, false)), "");
    for (tail, materials, expected) in [
        (&b"\x02\x01"[..], false, "bad number of local triangles"),
        (b"\xff\xff", false, "bad number of local triangles"),
        (b"\0\x01\0\x01\x03\0\x01\xff\xff\0\0\0\0", false, "bad local triangle index"),
        (b"\0\x01\0\x01\x02\0\x01\xff\xff\0\0\0\0", true, "bad local triangle material"),
        (b"\0\x01\0\x01\x02\0\x01\0\x05\0\0\0\0", true, "bad local triangle material"),
        (b"\0\x01\0\x01\x02\0\x01\0\0\x01\x01", true, "bad number of joiner triangles"),
        (b"\0\x01\0\x01\x02\0\x01\0\0\0\0\x01\x01", true, "bad number of double joiner triangles"),
        (b"\0\0\0\x01\0\0\0\x01\0\0\0\0\x01\x02\xff\xff\0\0", true, "bad j1 triangle material"),
        (b"\0\0\0\x01\0\0\0\x01\0\0\0\0\x01\x07\0\0\0\0", true, "bad j1 triangle local index"),
        (b"\0\0\0\x01\0\0\0\x01\0\0\x01\0\x01\x02\0\0\0\0", true, "bad j1 triangle joiner"),
        (b"\0\0\0\x01\0\0\0\0\0\x01\0\0\0\0\0\0\0\x03\x02\0\0", true, "bad j2 triangle joiner"),
        (b"\0\0\0\x01\0\0\0\0\0\x01\0\0\0\0\0\0\0\x01\x07\0\0", true, "bad j2 triangle local index"),
        (b"\0\0\0\x01\0\0\0\0\0\x01\0\0\0\0\0\0\0\x01\x02\xff\xff", true, "bad j2 triangle material"),
        (b"\0\x01\0\x01\x02\0\x01\xff", false, "truncated mesh file"),
    ] {
        assert_eq!(complaint(&patch(tail, materials)), format!("(m.rtm): {expected}"));
    }
    let good = patch(PLAIN, false);
    let flags = good.len() - PLAIN.len() - 36 - 3;
    let changed = |at: usize, new: &[u8]| {
        let mut b = good.clone();
        b[at..at + new.len()].copy_from_slice(new);
        complaint(&b)
    };
    assert_eq!(changed(flags, &[6]), "(m.rtm): bad patch flags");
    assert_eq!(changed(flags, &[9]), "(m.rtm): bad patch flags");
    assert_eq!(changed(flags + 1, &[0, 0]), "(m.rtm): bad number of patch vertices");
    assert_eq!(changed(flags + 1, &[1, 1]), "(m.rtm): bad number of patch vertices");
    let magic = good.windows(2).position(|w| w == b"\n\n").unwrap() + 2;
    assert_eq!(changed(magic, &[1, 0x3f]), "(m.rtm): incompatible mesh format");
    assert_eq!(changed(magic + 8, b"0"), "(m.rtm): illegal octree bounds in mesh");
    assert_eq!(changed(magic + 30, &[5]), "(m.rtm): damaged mesh octree");
    let surface = patch(PLAIN, true);
    let at = surface.windows(7).position(|w| w == b"plastic").unwrap();
    let surface = [&surface[..at], b"sphere", &surface[at + 7..]].concat();
    assert_eq!(complaint(&surface), "(m.rtm): non-modifier in mesh (sphere \"m\")");
}
