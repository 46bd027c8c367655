//! A room of about as many triangles as wanted, and the world made of it.

use crate::clock::{cpu, resident};
use ambit_base::DVec3;
use ambit_scene::{Polygon, Shape};
use ambit_trace::{Mesh, MeshGeometry, Rank, World, WorldBuilder};
use std::sync::Arc;
use std::time::Instant;

/// Slats in the room, twelve triangles each, whatever the number of triangles.
const SLATS: usize = 2000;

/// Outline of the lamp.
pub(crate) fn lamp() -> [DVec3; 4] {
    [(5.8, 4.3), (6.2, 4.3), (6.2, 4.7), (5.8, 4.7)].map(|(x, y)| single(DVec3::new(x, y, 3.9)))
}

/// The nearest point that others can hold in f32.
fn single(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}

/// Random numbers, the same everywhere (`SplitMix64`).
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
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

    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (s, c) = (self.unit() * std::f64::consts::TAU).sin_cos();
        DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
    }
}

/// The triangles of a room 12 × 9 × 4 with a rough shell, thin slats and lumpy balls; the more, the finer are shell
/// and balls. Vertices are f32 numbers.
pub(crate) fn room(wanted: usize, mut emit: impl FnMut([DVec3; 3])) {
    let fine = ((wanted as f64 - 12.0 * SLATS as f64).max(1e4) / 979_200.0).sqrt();
    let mut emit = |t: [DVec3; 3]| emit(t.map(single));
    let mut rng = Rng(42);
    let size = DVec3::new(12.0, 9.0, 4.0);
    let n = (120.0 * fine).round() as usize;
    for face in 0..6 {
        let (axis, far) = (face / 2, face % 2 == 1);
        let mut grid = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let edge = i == 0 || j == 0 || i == n || j == n;
                let depth = if edge { 0.0 } else { 2.4 / n as f64 * rng.unit() };
                let mut p = DVec3::ZERO;
                p[axis] = if far { size[axis] - depth } else { depth };
                p[(axis + 1) % 3] = i as f64 / n as f64 * size[(axis + 1) % 3];
                p[(axis + 2) % 3] = j as f64 / n as f64 * size[(axis + 2) % 3];
                grid.push(p);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let at = |a: usize, b: usize| grid[(j + b) * (n + 1) + i + a];
                emit([at(0, 0), at(1, 0), at(1, 1)]);
                emit([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    for _ in 0..SLATS {
        let x0 = 0.5 + 10.0 * rng.unit();
        let x1 = (x0 + 0.5 + 4.0 * rng.unit()).min(11.8);
        let (y, z) = (0.3 + 8.4 * rng.unit(), 0.2 + 3.6 * rng.unit());
        let (s, c) = (rng.unit() * std::f64::consts::TAU).sin_cos();
        let up = DVec3::new(0.0, c, s) * 0.02;
        let across = DVec3::new(0.0, -s, c) * 0.001;
        let skew = DVec3::new(0.0, 0.4 * (rng.unit() - 0.5), 0.4 * (rng.unit() - 0.5));
        let ends = [DVec3::new(x0, y, z), DVec3::new(x1, y, z) + skew];
        let v: Vec<DVec3> = (0..8)
            .map(|i| ends[i & 1] + if i & 2 != 0 { up } else { -up } + if i & 4 != 0 { across } else { -across })
            .collect();
        for f in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
            emit([v[f[0]], v[f[1]], v[f[2]]]);
            emit([v[f[0]], v[f[2]], v[f[3]]]);
        }
    }
    for _ in 0..100 {
        let c = DVec3::new(0.8 + 10.4 * rng.unit(), 0.8 + 7.4 * rng.unit(), 0.6 + 2.8 * rng.unit());
        let r = 0.1 + 0.45 * rng.unit();
        let m = (64.0 * fine).round() as usize;
        let mut grid = Vec::new();
        for t in 0..=m {
            for p in 0..m {
                let theta = std::f64::consts::PI * t as f64 / m as f64;
                let phi = std::f64::consts::TAU * p as f64 / m as f64;
                let lump = if t == 0 || t == m { 1.0 } else { 1.0 + 5.12 / m as f64 * (rng.unit() - 0.5) };
                let (s, u) = theta.sin_cos();
                grid.push(c + DVec3::new(s * phi.cos(), s * phi.sin(), u) * (r * lump));
            }
        }
        for t in 0..m {
            for p in 0..m {
                let at = |a: usize, b: usize| grid[(t + b) * m + (p + a) % m];
                if t != 0 {
                    emit([at(0, 0), at(1, 0), at(1, 1)]);
                }
                if t != m - 1 {
                    emit([at(0, 0), at(1, 1), at(0, 1)]);
                }
            }
        }
    }
}

/// About as many quadrilaterals as wanted: the same room with a smooth shell, furnished with boxes that stand on the floor or on
/// each other.
fn furnished(wanted: usize, mut emit: impl FnMut([DVec3; 4])) {
    let mut rng = Rng(42);
    let mut put = |centre: DVec3, half: DVec3, turn: f64, inward: bool| {
        let (s, c) = turn.sin_cos();
        let corner = |i: usize| {
            let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
            let p = half * DVec3::new(sign(1), sign(2), sign(4));
            single(centre + DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z))
        };
        for mut f in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
            if !inward {
                f.reverse();
            }
            emit(f.map(corner));
        }
    };
    put(DVec3::new(6.0, 4.5, 2.0), DVec3::new(6.0, 4.5, 2.0), 0.0, true);
    let boxes = wanted.saturating_sub(6) / 6;
    let size = (60.0 / (boxes as f64 + 1.0)).cbrt().min(1.4);
    for i in 0..boxes {
        let half = DVec3::new(0.1 + 0.5 * rng.unit(), 0.1 + 0.5 * rng.unit(), 0.1 + 0.5 * rng.unit()) * size;
        let ground = if i % 3 == 0 { 0.0 } else { 2.5 * rng.unit() };
        let place = DVec3::new(1.0 + 10.0 * rng.unit(), 1.0 + 7.0 * rng.unit(), half.z + ground);
        let turn = if i % 2 == 0 { 0.0 } else { rng.unit() };
        put(place, half, turn, false);
    }
}

fn polygon(v: &[DVec3]) -> Option<Shape> {
    let mut sum = DVec3::ZERO;
    for i in 2..v.len() {
        sum += (v[i - 1] - v[0]).cross(v[i] - v[0]);
    }
    let normal = sum.try_normalize()?;
    let offset = v.iter().map(|p| normal.dot(*p)).sum::<f64>() / v.len() as f64;
    Some(Shape::Polygon(Polygon { vertices: v.into(), normal, offset, area: sum.length() * 0.5 }))
}

fn mesh(wanted: usize, rank: Rank) -> (Mesh, usize) {
    let mut g = MeshGeometry { ranks: vec![rank], ..MeshGeometry::default() };
    let mut known = std::collections::HashMap::new();
    room(wanted, |t| {
        let number = |p: DVec3| {
            *known.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
                g.vertices.push(p);
                g.vertices.len() as u32 - 1
            })
        };
        g.triangles.push(t.map(number));
    });
    let count = g.triangles.len();
    (Mesh::build(g).expect("the generated mesh is sound"), count)
}

/// The world: object 0 is the lamp, object 2 + k the triangle k; or all triangles are one mesh, object 1. Says to
/// standard error how large it is.
pub(crate) fn build(wanted: usize, as_mesh: bool, quads: Option<usize>, rank: Rank) -> World {
    let start = (Instant::now(), cpu());
    let mut b = WorldBuilder::new();
    let mut count = 0;
    if let Some(quads) = quads {
        furnished(quads, |q| {
            if let Some(shape) = polygon(&q) {
                b.add(count as u32 + 2, &shape, rank);
            }
            count += 1;
        });
    } else if as_mesh {
        let mesh;
        (mesh, count) = self::mesh(wanted, rank);
        eprintln!("mesh: {:.1} bytes a triangle", mesh.memory() as f64 / count as f64);
        b.add_mesh(1, ambit_base::Transform::IDENTITY, Arc::new(mesh), None);
    } else {
        room(wanted, |t| {
            if let Some(shape) = polygon(&t) {
                b.add(count as u32 + 2, &shape, rank);
            }
            count += 1;
        });
    }
    b.add(0, &polygon(&lamp()).expect("a square"), rank);
    let before = resident();
    let world = b.build().expect("the generated room is small enough");
    eprintln!(
        "{count} triangles, made and built in {:.2} s ({:.2} s of processor); {:.1} bytes a triangle held, {:.1} resident before the tree, {:.1} at the peak",
        start.0.elapsed().as_secs_f64(),
        cpu() - start.1,
        world.memory() as f64 / count as f64,
        before.1 as f64 / count as f64,
        resident().0 as f64 / count as f64,
    );
    eprintln!("nodes, blocks of triangles, of quadrilaterals, items: {:?}", world.sizes());
    world
}
