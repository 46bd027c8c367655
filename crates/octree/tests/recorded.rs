//! Octrees made by Radiance 6.0a's oconv (`tests/recorded/*.oct`, each with its command in its header) and ours of the
//! same scenes: the same bytes.

mod common;

use ambit_base::{DVec3, Silent};
use ambit_octree::{Cube, Limits, Node, Objects, read_cube, read_octree, read_scene, write};
use ambit_scene::{NoCommands, Scene};
use common::{Job, Kept, recorded};

const SPHERES: &str = "tests/recorded/spheres.rad";
const SHAPES: &str = "tests/recorded/shapes.rad";
const MORE: &str = "tests/recorded/more.rad";
const PLACED: &str = "tests/recorded/placed.rad";

fn limits(objects: i64, resolution: i64) -> Limits {
    Limits { objects, resolution }
}

#[track_caller]
fn same(job: &Job<'_>, name: &str) {
    let ours = job.run(&Silent).unwrap();
    let theirs = recorded(name);
    let first = ours.iter().zip(&theirs).position(|(a, b)| a != b);
    assert!(ours == theirs, "{name}: {} bytes, expected {}; first difference at {first:?}", ours.len(), theirs.len());
}

#[test]
fn two_spheres() {
    let one = Limits { objects: 1, ..Limits::default() };
    let command = "oconv -n 1 tests/recorded/spheres.rad";
    same(&Job { files: &[SPHERES], limits: one, command, ..Job::default() }, "spheres.oct");
    let command = "oconv -n 1 -f tests/recorded/spheres.rad";
    same(&Job { files: &[SPHERES], limits: one, frozen: true, command, ..Job::default() }, "spheres-frozen.oct");
}

#[test]
fn every_kind_of_surface() {
    let command = "oconv -n 2 -r 64 tests/recorded/shapes.rad";
    same(&Job { files: &[SHAPES], limits: limits(2, 64), command, ..Job::default() }, "shapes.oct");
    let command = "oconv -f -n 2 -r 64 tests/recorded/shapes.rad";
    let job = Job { files: &[SHAPES], limits: limits(2, 64), frozen: true, command, ..Job::default() };
    same(&job, "shapes-frozen.oct");
}

#[test]
fn instances_and_meshes() {
    let command = "oconv -n 2 -r 32 tests/recorded/placed.rad";
    same(&Job { files: &[PLACED], limits: limits(2, 32), command, ..Job::default() }, "placed.oct");
}

#[test]
fn a_given_cube_and_what_is_added_to_it() {
    let cube = Some(Cube::given(DVec3::new(-5.0, -5.0, -1.0), 10.0));
    let command = "oconv -b -5 -5 -1 10 -n 2 -r 64 tests/recorded/shapes.rad";
    same(&Job { files: &[SHAPES], cube, limits: limits(2, 64), command, ..Job::default() }, "shapes-boxed.oct");
    let start = Some("tests/recorded/shapes-boxed.oct");
    let command = "oconv -i tests/recorded/shapes-boxed.oct -n 2 -r 64 tests/recorded/more.rad";
    same(&Job { files: &[MORE], start, limits: limits(2, 64), command, ..Job::default() }, "extended.oct");
    let command = "oconv -f -i tests/recorded/shapes-boxed.oct -n 2 -r 64 tests/recorded/more.rad";
    let job = Job { files: &[MORE], start, limits: limits(2, 64), frozen: true, command, ..Job::default() };
    same(&job, "extended-frozen.oct");
}

#[test]
fn warnings_come_in_radiances_order() {
    let kept = Kept::default();
    Job { files: &[SHAPES], ..Job::default() }.run(&kept).unwrap();
    assert_eq!(
        kept.texts(),
        [
            "zero area for polygon \"line\"",
            "illegal radii for cone \"wrong\"",
            "negative radius for tube \"hose\"",
            "unknown orientation for cylinder \"point\"",
            "negative radius for sphere \"inverse\"",
            "zero radius for bubble \"nothing\"",
            "illegal radii for cone \"wrong\"",
            "unknown orientation for cylinder \"point\"",
        ]
    );
}

#[test]
fn what_is_read_is_written_the_same() {
    for name in [
        "spheres.oct",
        "spheres-frozen.oct",
        "shapes.oct",
        "shapes-frozen.oct",
        "placed.oct",
        "extended.oct",
        "extended-frozen.oct",
    ] {
        let bytes = recorded(name);
        let mut scene = Scene::new();
        let (loaded, tree) = read_octree(&bytes, name, &mut scene, &mut NoCommands, &Silent).unwrap();
        let mut header = ambit_file::Header::empty();
        header.extend(loaded.header.lines_without_format());
        let objects = if loaded.frozen {
            Objects::Frozen(&scene)
        } else {
            Objects::InFiles { names: &loaded.scene_files, count: loaded.object_count }
        };
        let mut out = Vec::new();
        write(&mut out, &header, &loaded.cube, objects, &tree).unwrap();
        assert!(out == bytes, "{name}");
    }
}

#[test]
fn an_octree_within_a_scene_counts_on_from_it() {
    let bytes = recorded("spheres-frozen.oct");
    let mut scene = Scene::new();
    let first = read_scene(&bytes, "a", &mut scene, &mut NoCommands, &Silent).unwrap();
    let (second, tree) = read_octree(&bytes, "b", &mut scene, &mut NoCommands, &Silent).unwrap();
    assert_eq!((first.objects(), second.objects()), (0..3, 3..6));
    assert!(second.frozen && second.scene_files.is_empty());
    assert_eq!(scene.object(4).modifier, 3);
    assert_eq!(scene.name(5), "B");
    assert_eq!(scene.reals(5), [6.0, 6.0, 6.0, 1.0].map(|x| ambit_file::decode_float(ambit_file::encode_float(x))));
    let sets: Vec<_> = tree.nodes().filter(|n| matches!(n, Node::Full(_))).collect();
    assert_eq!(sets, [Node::Full(&[4]), Node::Full(&[5])]);
    assert_eq!(read_cube(&mut bytes.as_slice(), "c").unwrap(), second.cube);
    assert_eq!(second.cube.edge, 8.00002);
}
