//! The build against insertion one by one, written down as plainly as possible.

use super::*;
use crate::Volume;
use ambit_base::{DVec3, Transform};
use ambit_scene::{Kind, NewObject, VOID};

/// A tree of boxes, grown object by object.
enum Plain {
    Leaf(Vec<ObjectId>),
    Branch(Box<[Plain; 8]>),
}

struct Inserter<'a> {
    scene: &'a Scene,
    geometry: &'a Geometry,
    limits: Limits,
    smallest: f64,
}

impl Inserter<'_> {
    fn add(&self, node: &mut Plain, cube: &Cube, id: ObjectId) {
        let relation = |id| self.geometry.relation(self.scene, id, cube, self.smallest);
        let found = relation(id);
        if found == Relation::Miss {
            return;
        }
        let set = match node {
            Plain::Branch(children) => {
                for (number, child) in children.iter_mut().enumerate() {
                    self.add(child, &cube.child(number), id);
                }
                return;
            }
            Plain::Leaf(set) => set,
        };
        let room = (set.len() as i64) < self.limits.objects || cube.edge * 0.5 < self.smallest;
        if set.is_empty() || found == Relation::Inside || room {
            set.push(id);
            set.sort_unstable();
            return;
        }
        let is_volume = |id: &ObjectId| self.geometry.is_volume(*id);
        let (volumes, mut order): (Vec<_>, Vec<_>) = set.iter().copied().partition(is_volume);
        let (inside, across): (Vec<_>, Vec<_>) = volumes.into_iter().partition(|&v| relation(v) == Relation::Inside);
        order.push(id);
        order.extend(across);
        order.extend(inside);
        let mut children = Box::new(std::array::from_fn(|_| Plain::Leaf(Vec::new())));
        for member in order {
            for (number, child) in children.iter_mut().enumerate() {
                self.add(child, &cube.child(number), member);
            }
        }
        *node = Plain::Branch(children);
    }
}

fn flatten(node: &Plain, words: &mut Vec<u32>) {
    match node {
        Plain::Leaf(set) => {
            words.push(set.len() as u32);
            words.extend(set);
        }
        Plain::Branch(children) => {
            let at = words.len();
            words.push(BRANCH);
            children.iter().for_each(|c| flatten(c, words));
            tree::merge_equal_children(words, at);
        }
    }
}

/// Numbers in [0, 1) that look random and are always the same.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = ambit_base::mix(self.0, 1);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self, size: f64) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * size
    }
}

/// Triangles, spheres and, one object in `every`, a volume.
fn scene(seed: u64, count: usize, size: f64, every: usize) -> (Scene, Geometry) {
    let mut numbers = Numbers(seed);
    let mut scene = Scene::new();
    let file = scene.add_file("made up");
    let mut geometry = Geometry::starting_at(0);
    for i in 0..count {
        let place = numbers.point(10.0);
        let mut push = |kind, reals: &[f64]| {
            let new = NewObject { kind, modifier: VOID, name: b"o", strings: &[], reals, file, line: 0 };
            scene.push(new)
        };
        if every > 0 && i % every == 0 {
            push(Kind::Instance, &[]);
            let cube = Cube { origin: DVec3::splat(-1.0), edge: 2.0 };
            let turn = Transform::rotation(i % 3, 360.0 * numbers.next()).then(&Transform::translation(place));
            geometry.push_volume(Volume::new(cube, turn));
            continue;
        }
        let id = if i % 5 == 4 {
            push(Kind::Sphere, &[place.x, place.y, place.z, size * numbers.next()])
        } else {
            let corners = [place, place + numbers.point(size), place + numbers.point(size)];
            push(Kind::Polygon, &corners.map(|p| p.to_array()).concat())
        };
        let (shape, _) = ambit_scene::Shape::from_object(&scene, id).unwrap();
        geometry.push_shape(&scene, &shape);
    }
    (scene, geometry)
}

#[test]
fn the_tree_is_that_of_insertion_one_by_one() {
    for (seed, count, size, every, objects, resolution) in [
        (1, 40, 3.0, 0, 2, 64),
        (2, 300, 1.0, 0, 6, 256),
        (3, 200, 2.0, 7, 3, 32),
        (4, 60, 3.0, 2, 1, 16),
        (5, 60, 1.0, 3, 5, 64),
        (6, 12_000, 0.3, 0, 6, 256),
        (7, 6_000, 0.4, 40, 4, 64),
    ] {
        let (scene, geometry) = scene(seed, count, size, every);
        let cube = Cube::around(geometry.bounds());
        let limits = Limits { objects, resolution };
        let smallest = cube.edge / resolution as f64 - EPSILON;
        let inserter = Inserter { scene: &scene, geometry: &geometry, limits, smallest };
        let mut root = Plain::Leaf(Vec::new());
        geometry.placed().for_each(|id| inserter.add(&mut root, &cube, id));
        let mut expected = Vec::new();
        flatten(&root, &mut expected);
        let tree = build(&scene, &geometry, cube, limits).unwrap();
        assert!(tree.words.len() > 100, "seed {seed}: a tree worth comparing");
        assert!(tree.words == expected, "seed {seed}");
    }
}

#[test]
fn a_tree_is_the_same_in_one_go_and_in_two() {
    // Without volumes the order of insertion does not matter.
    let (scene, geometry) = scene(8, 400, 1.5, 0);
    let cube = Cube::around(geometry.bounds());
    let limits = Limits { objects: 4, resolution: 64 };
    let whole = build(&scene, &geometry, cube, limits).unwrap();
    let part = |ids: std::ops::Range<ObjectId>| {
        let mut part = Geometry::starting_at(ids.start);
        ids.for_each(|id| part.push_shape(&scene, &ambit_scene::Shape::from_object(&scene, id).unwrap().0));
        part
    };
    let (early, late) = (part(0..250), part(250..400));
    let first = build(&scene, &early, cube, limits).unwrap();
    let second = extend(&scene, &late, cube, limits, &first, &early).unwrap();
    assert!(second.tree == whole);
    assert!(!second.moved.is_empty() && second.moved.iter().all(|id| *id < 250));
}

#[test]
fn crowded_points_end_the_build_with_an_error() {
    let mut scene = Scene::new();
    let file = scene.add_file("made up");
    let mut geometry = Geometry::starting_at(0);
    for _ in 0..=MOST_IN_SET {
        let reals = &[1.0, 1.0, 1.0, 2e-6];
        let new = NewObject { kind: Kind::Sphere, modifier: VOID, name: b"dot", strings: &[], reals, file, line: 0 };
        let id = scene.push(new);
        geometry.push_shape(&scene, &ambit_scene::Shape::from_object(&scene, id).unwrap().0);
    }
    let cube = Cube { origin: DVec3::ZERO, edge: 8.0 };
    let coarse = Limits { objects: 6, resolution: 4 };
    let e = build(&scene, &geometry, cube, coarse).unwrap_err();
    assert_eq!(e, BuildError::SetOverflow { name: "dot".to_owned() });
    let endless = Limits { objects: 6, resolution: i64::MAX };
    assert_eq!(build(&scene, &geometry, cube, endless).unwrap_err(), BuildError::TooDeep { objects: 6 });
}
