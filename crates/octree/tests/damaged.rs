//! Octrees and meshes that are cut off, damaged, old or made up: an error that says what is wrong, never a panic.

mod common;

use ambit_base::Silent;
use ambit_octree::{read_mesh, read_octree, read_scene};
use ambit_scene::{ErrorClass, NoCommands, Scene};
use common::{Kept, recorded};
use proptest::prelude::*;

/// The error of reading an octree; empty if there is none.
fn complaint(bytes: &[u8]) -> String {
    let mut scene = Scene::new();
    let plain = read_scene(bytes, "x.oct", &mut scene, &mut NoCommands, &Silent).err().map(|e| e.to_string());
    let mut scene = Scene::new();
    let full = read_octree(bytes, "x.oct", &mut scene, &mut NoCommands, &Silent).err().map(|e| e.to_string());
    assert_eq!(plain, full, "with and without the tree");
    plain.unwrap_or_default()
}

/// The frozen octree of two spheres, with the offsets of its data and of its tree.
fn spheres() -> (Vec<u8>, usize, usize) {
    let bytes = recorded("spheres-frozen.oct");
    let data = bytes.windows(2).position(|w| w == b"\n\n").unwrap() + 2;
    let mut tree = data + 2;
    for _ in 0..4 {
        tree += bytes[tree..].iter().position(|b| *b == 0).unwrap() + 1;
    }
    (bytes, data, tree + 1 + 4)
}

fn patched(bytes: &[u8], at: usize, new: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    out[at..at + new.len()].copy_from_slice(new);
    out
}

#[test]
fn damage_is_named_as_radiance_names_it() {
    let (good, data, tree) = spheres();
    assert_eq!(complaint(&good), "");
    let text = |from: &str, to: &str| {
        let at = good.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        [&good[..at], to.as_bytes(), &good[at + from.len()..]].concat()
    };
    let set = tree + 1;
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (Vec::new(), "(x.oct): not an octree (nothing in it)"),
        (text("#?RADIANCE", "\0?RADIANCE"), "(x.oct): not an octree"),
        (b"void light l\n".to_vec(), "(x.oct): not an octree (no header; oconv makes octrees of scene files)"),
        (
            b"# a scene\n\nvoid light l\n".to_vec(),
            "(x.oct): incompatible octree format (no header; oconv makes octrees of scene files)",
        ),
        (text("Radiance_octree", "Radiance_tmesh"), "(x.oct): not an octree (FORMAT=Radiance_tmesh)"),
        (text("FORMAT=Radiance_octree\n", ""), ""),
        (good[..data].to_vec(), "(x.oct): truncated octree"),
        (patched(&good, data, &[1, 0x1b]), "(x.oct): incompatible octree format"),
        (patched(&good, data, &[1, 0x24]), "(x.oct): incompatible octree format"),
        (text("8.00002", "1e99999"), "(x.oct): damaged octree"),
        (good[..data + 9].to_vec(), "(x.oct): truncated octree"),
        (patched(&good, tree, &[3]), "(x.oct): damaged octree"),
        (patched(&good, set + 1, &[0, 0, 0x20, 0]), "(x.oct): bad set in getfullnode"),
        (patched(&good, set + 1, &[0xff; 4]), "(x.oct): bad set in getfullnode"),
        (patched(&good, set + 5, &[0, 0, 0, 7]), "(x.oct): tree refers to object 7 of 3; octree damaged?"),
        (patched(&good, set + 5, &[0xff; 4]), "(x.oct): damaged octree"),
        (patched(&good, set + 5, &[0; 4]), "(x.oct): modifier in tree; octree stale?"),
        (good[..good.len() - 3].to_vec(), "unexpected EOF in getobj (x.oct)"),
        (good[..good.len() - 1].to_vec(), ""),
        (text("plastic\0", "plastix\0"), "reference to unknown type (x.oct)"),
        (text("specpict\0", "specpicu\0"), ""),
    ];
    for (i, (bytes, expected)) in cases.iter().enumerate() {
        assert_eq!(complaint(bytes), *expected, "case {i}");
    }
}

#[test]
fn frozen_objects_refer_to_earlier_modifiers() {
    let (good, ..) = spheres();
    let at = good.windows(2).position(|w| w == b"A\0").unwrap();
    for (modifier, shown) in [([0, 0, 0, 1], 1), ([0, 0, 0, 9], 9), ([0xff, 0xff, 0xff, 0xfe], -2)] {
        let expected = format!("(x.oct): bad modifier {shown} for sphere \"A\"; expected an earlier modifier");
        assert_eq!(complaint(&patched(&good, at - 4, &modifier)), expected);
    }
    let negative = patched(&good, at + 2, &[0xff, 0xff]);
    assert_eq!(complaint(&negative), "(x.oct): negative argument count for sphere \"A\"");
    // B's modifier is the surface A.
    let at = good.windows(2).rposition(|w| w == b"B\0").unwrap();
    let surface = patched(&good, at - 4, &[0, 0, 0, 1]);
    assert_eq!(complaint(&surface), "(x.oct): bad modifier 1 for sphere \"B\"; expected an earlier modifier");
}

#[test]
fn unknown_types_cost_a_warning_until_they_are_used() {
    let (good, ..) = spheres();
    let at = good.windows(8).position(|w| w == b"specpict").unwrap();
    let kept = Kept::default();
    read_scene(&patched(&good, at, b"newthing"), "x.oct", &mut Scene::new(), &mut NoCommands, &kept).unwrap();
    assert_eq!(kept.texts(), ["unknown object type \"newthing\""]);
}

#[test]
fn stale_octrees_are_noticed() {
    let mut bytes = recorded("spheres.oct");
    let count = bytes.windows(6).position(|w| w == [0, 0, 0, 0, 0, 3]).unwrap() + 5;
    bytes[count] = 4;
    assert_eq!(complaint(&bytes), "(x.oct): bad object count; octree stale?");
    bytes[count] = 3;
    let last = bytes.len() - 1;
    bytes[last] = 0;
    assert_eq!(complaint(&bytes), "(x.oct): modifier in tree; octree stale?");
    let missing = recorded("spheres.oct");
    let at = missing.windows(5).rposition(|w| w == b"s.rad").unwrap();
    let mut scene = Scene::new();
    let e = read_scene(&patched(&missing, at, b"X"), "x", &mut scene, &mut NoCommands, &Silent).unwrap_err();
    assert_eq!(e.class(), ErrorClass::System);
    assert_eq!(e.to_string(), "cannot open scene file \"tests/recorded/sphereX.rad\": No such file or directory");
}

#[test]
fn a_tree_deeper_than_numbers_is_damaged() {
    let (good, _, tree) = spheres();
    let mut deep = good[..tree].to_vec();
    deep.extend(std::iter::repeat_n(2, 100_000));
    assert_eq!(complaint(&deep), "(x.oct): damaged octree");
}

#[test]
fn every_width_of_object_numbers_is_read() {
    let (good, data, tree) = spheres();
    for width in 1..=8usize {
        let number = |n: i64| n.to_be_bytes()[8 - width..].to_vec();
        let mut bytes = good[..data].to_vec();
        bytes.extend([1, 0x1b + width as u8]);
        bytes.extend(&good[data + 2..tree - 4]);
        bytes.extend(number(3));
        bytes.push(2);
        for object in [1, 2] {
            bytes.push(1);
            bytes.extend([number(1), number(object)].concat());
            if object == 1 {
                bytes.extend([0; 6]);
            }
        }
        let objects = good.windows(7).position(|w| w == b"polygon").unwrap();
        let types = good[objects..].windows(9).position(|w| w == b"specpict\0").unwrap() + objects + 10;
        bytes.extend(&good[objects..types]);
        let mut rest = &good[types..];
        while rest[0] != 0xff {
            let name = rest[5..].iter().position(|b| *b == 0).unwrap() + 6;
            let reals = u16::from_be_bytes([rest[name + 2], rest[name + 3]]) as usize;
            let end = name + 4 + 5 * reals;
            bytes.push(rest[0]);
            bytes.extend(number(i64::from(i32::from_be_bytes(rest[1..5].try_into().unwrap()))));
            bytes.extend(&rest[5..end]);
            rest = &rest[end..];
        }
        bytes.push(0xff);
        let mut scene = Scene::new();
        let loaded = read_scene(&bytes, "k.oct", &mut scene, &mut NoCommands, &Silent).unwrap();
        assert_eq!(loaded.object_count, 3, "{width}");
        assert_eq!((scene.object(2).modifier, scene.name(2).as_ref()), (0, "B"), "{width}");
    }
}

#[test]
fn no_beginning_of_an_octree_passes_for_a_whole() {
    for (name, frozen) in [("spheres-frozen.oct", true), ("shapes.oct", false), ("shapes-frozen.oct", true)] {
        let bytes = recorded(name);
        let accepted: Vec<usize> = (0..bytes.len()).filter(|&end| complaint(&bytes[..end]).is_empty()).collect();
        // Like Radiance, take the end of the file for the byte that ends the list of objects.
        let expected = if frozen { vec![bytes.len() - 1] } else { Vec::new() };
        assert_eq!(accepted, expected, "{name}");
    }
}

#[test]
fn no_beginning_of_a_mesh_passes_for_a_whole() {
    let bytes = recorded("roof.rtm");
    for end in 0..bytes.len() {
        assert!(read_mesh(&bytes[..end], "x.rtm", &mut Scene::new(), &Silent).is_err(), "{end}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_change_makes_reading_panic(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        mesh in any::<bool>(),
    ) {
        let mut bytes = recorded(if mesh { "roof.rtm" } else { "shapes-frozen.oct" });
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let mut scene = Scene::new();
        if mesh {
            if let Ok(mesh) = read_mesh(&bytes, "x.rtm", &mut scene, &Silent) {
                prop_assert!(mesh.vertices.iter().all(|v| v.is_finite()));
                for t in 0..mesh.triangles.len() {
                    let _ = (mesh.positions(t), mesh.normals(t), mesh.uv(t));
                }
            }
        } else {
            let _ = read_octree(&bytes, "x.oct", &mut scene, &mut NoCommands, &Silent);
        }
    }
}

/// A file that the system refuses to read.
struct Refused(std::io::ErrorKind);

impl std::io::Read for Refused {
    fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
        Err(self.0.into())
    }
}

#[test]
fn files_that_cannot_be_read_are_not_called_empty() {
    use std::io::ErrorKind;
    let read =
        |kind| ambit_octree::read_cube(&mut std::io::BufReader::new(Refused(kind)), "o").unwrap_err().to_string();
    assert_eq!(read(ErrorKind::IsADirectory), "(o): not an octree (a directory)");
    assert!(read(ErrorKind::PermissionDenied).starts_with("cannot read octree file \"o\": "));
    assert_eq!(
        ambit_octree::read_cube(&mut &b""[..], "o").unwrap_err().to_string(),
        "(o): not an octree (nothing in it)"
    );
}
