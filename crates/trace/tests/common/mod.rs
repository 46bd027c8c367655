//! Scenes, random numbers and the brute force that the tests hold the tree against.
#![allow(dead_code)]

use ambit_base::{DVec3, EPSILON};
use ambit_scene::{Kind, NewObject, ObjectId, Ring, Scene, Shape, Sphere, VOID};
use ambit_trace::{Opacity, Rank, Ray, World, WorldBuilder};

/// `SplitMix64`.
pub(crate) struct Rng(u64);

impl Rng {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (s, c) = (self.unit() * std::f64::consts::TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * c, r * s, z).normalize()
    }
}

/// A polygon as the scene crate makes it.
pub(crate) fn polygon(vertices: &[DVec3]) -> Shape {
    let reals: Vec<f64> = vertices.iter().flat_map(DVec3::to_array).collect();
    shape(Kind::Polygon, &reals)
}

/// A surface as the scene crate makes it.
pub(crate) fn shape(kind: Kind, reals: &[f64]) -> Shape {
    let mut scene = Scene::new();
    let object = NewObject { kind, modifier: VOID, name: b"s", strings: &[], reals, file: 0, line: 0 };
    let id = scene.push(object);
    Shape::from_object(&scene, id).unwrap().0
}

/// Opaque, all with the same modifier.
pub(crate) fn plain(modifier: ObjectId) -> Rank {
    Rank { opacity: Opacity::Opaque, modifier, blocks: true, bends: false }
}

/// A world of these shapes, numbered from 0.
pub(crate) fn world_of(shapes: &[Shape]) -> World {
    let mut b = WorldBuilder::new();
    for (i, s) in shapes.iter().enumerate() {
        b.add(i as ObjectId, s, plain(0));
    }
    b.build().unwrap()
}

/// Spheres, cones, rings and polygons of all sorts within about 5 of the origin.
pub(crate) fn soup(rng: &mut Rng, count: usize) -> Vec<Shape> {
    (0..count)
        .map(|i| {
            let p = rng.direction() * 5.0 * rng.unit();
            let r = 0.05 + rng.unit();
            match i % 7 {
                0 => Shape::Sphere(Sphere { centre: p, radius: r, inward: i % 2 == 0 }),
                1 => Shape::Ring(Ring { centre: p, normal: rng.direction(), r0: 0.3 * r, r1: r }),
                2 | 3 => {
                    let q = p + rng.direction() * 2.0 * r;
                    let r1 = if i % 7 == 2 { r } else { 0.2 * r };
                    shape(Kind::Cone, &[p.x, p.y, p.z, q.x, q.y, q.z, 0.5 * r, r1])
                }
                4 => polygon(&[p, p + rng.direction() * r, p + rng.direction() * r]),
                5 => {
                    let (u, v) = (rng.direction() * r, rng.direction() * r);
                    polygon(&[p, p + u, p + u + v, p + v])
                }
                _ => {
                    let (u, v) = (rng.direction() * r, rng.direction() * r);
                    polygon(&[p, p + u, p + u + v, p + u * 0.5 + v * 0.2, p + v])
                }
            }
        })
        .collect()
}

/// Tests every surface by itself. All have the same rank, so of those within ε of the nearest a front hit wins, then
/// the one defined last.
pub(crate) fn brute_force(world: &World, shapes: &[Shape], ray: &Ray) -> Option<(ObjectId, f64)> {
    let all: Vec<(ObjectId, f64)> =
        (0..shapes.len() as ObjectId).filter_map(|id| world.distance(id, ray).map(|t| (id, t))).collect();
    let nearest = all.iter().map(|h| h.1).fold(f64::INFINITY, f64::min);
    let ties: Vec<(ObjectId, f64)> = all.into_iter().filter(|h| h.1 <= nearest + EPSILON).collect();
    if ties.len() < 2 {
        return ties.first().copied();
    }
    let front = |id: ObjectId| match &shapes[id as usize] {
        Shape::Polygon(p) => p.normal.dot(ray.direction) < 0.0,
        Shape::Ring(r) => r.normal.dot(ray.direction) < 0.0,
        other => panic!("no ties expected with {other:?}"),
    };
    ties.iter().copied().max_by_key(|&(id, _)| (front(id), id))
}
