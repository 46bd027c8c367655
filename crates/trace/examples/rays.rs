//! Rays per second on a generated room of a million triangles, and memory.
//!
//! `cargo run --release -p ambit-trace --example rays [scalar] [mesh] [quads]`: coherent rays are those of a camera in tiles of
//! 8 × 8, diffuse ones leave where those hit, cosine-distributed, in order of pixels and shuffled; shadow rays go from
//! there to a point of a small lamp. Times are of this process's own time on the processor where the system tells.

use ambit_base::DVec3;
use ambit_scene::{Polygon, Shape};
use ambit_trace::{Mesh, MeshGeometry, Opacity, Rank, Ray, Shadow, World, WorldBuilder};
use std::sync::Arc;
use std::time::Instant;

struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (s, c) = (self.unit() * std::f64::consts::TAU).sin_cos();
        DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
    }
}

/// Seconds spent on the processor.
fn cpu() -> f64 {
    let own = std::fs::read_to_string("/proc/self/schedstat").ok();
    own.and_then(|s| s.split(' ').next()?.parse::<f64>().ok()).map_or_else(
        || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0.0, |d| d.as_secs_f64()),
        |ns| ns * 1e-9,
    )
}

/// Peak and present resident memory in bytes, where the system tells.
fn resident() -> (usize, usize) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let field = |name: &str| {
        let line = status.lines().find(|l| l.starts_with(name))?;
        line.split_whitespace().nth(1)?.parse::<usize>().ok()
    };
    (field("VmHWM:").unwrap_or(0) * 1024, field("VmRSS:").unwrap_or(0) * 1024)
}

/// The outlines of a room 12 × 9 × 4 with a rough shell, thin slats and lumpy balls.
fn room(mut emit: impl FnMut(&[DVec3])) {
    let mut rng = Rng(42);
    let size = DVec3::new(12.0, 9.0, 4.0);
    let n = 120usize;
    for face in 0..6 {
        let (axis, far) = (face / 2, face % 2 == 1);
        let mut grid = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let edge = i == 0 || j == 0 || i == n || j == n;
                let depth = if edge { 0.0 } else { 0.02 * rng.unit() };
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
                emit(&[at(0, 0), at(1, 0), at(1, 1)]);
                emit(&[at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    for _ in 0..2000 {
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
            emit(&[v[f[0]], v[f[1]], v[f[2]]]);
            emit(&[v[f[0]], v[f[2]], v[f[3]]]);
        }
    }
    for _ in 0..100 {
        let c = DVec3::new(0.8 + 10.4 * rng.unit(), 0.8 + 7.4 * rng.unit(), 0.6 + 2.8 * rng.unit());
        let r = 0.1 + 0.45 * rng.unit();
        let m = 64usize;
        let mut grid = Vec::new();
        for t in 0..=m {
            for p in 0..m {
                let theta = std::f64::consts::PI * t as f64 / m as f64;
                let phi = std::f64::consts::TAU * p as f64 / m as f64;
                let lump = if t == 0 || t == m { 1.0 } else { 1.0 + 0.08 * (rng.unit() - 0.5) };
                let (s, u) = theta.sin_cos();
                grid.push(c + DVec3::new(s * phi.cos(), s * phi.sin(), u) * (r * lump));
            }
        }
        for t in 0..m {
            for p in 0..m {
                let at = |a: usize, b: usize| grid[(t + b) * m + (p + a) % m];
                if t != 0 {
                    emit(&[at(0, 0), at(1, 0), at(1, 1)]);
                }
                if t != m - 1 {
                    emit(&[at(0, 0), at(1, 1), at(0, 1)]);
                }
            }
        }
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

fn build(mesh: bool, rank: Rank) -> World {
    let mut b = WorldBuilder::new();
    let mut count = 0;
    if mesh {
        let mut g = MeshGeometry { ranks: vec![rank], ..MeshGeometry::default() };
        let mut known = std::collections::HashMap::new();
        room(|v| {
            let t: Vec<u32> = v
                .iter()
                .map(|p| {
                    *known.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
                        g.vertices.push(*p);
                        g.vertices.len() as u32 - 1
                    })
                })
                .collect();
            g.triangles.push([t[0], t[1], t[2]]);
            count += 1;
        });
        drop(known);
        let mesh = Mesh::build(g).expect("the generated mesh is sound");
        println!("mesh: {:.1} bytes a triangle", mesh.memory() as f64 / f64::from(count));
        b.add_mesh(1, ambit_base::Transform::IDENTITY, Arc::new(mesh), None);
    } else {
        room(|v| {
            if let Some(shape) = polygon(v) {
                b.add(count + 2, &shape, rank);
                count += 1;
            }
        });
    }
    let lamp = [(5.8, 4.3), (6.2, 4.3), (6.2, 4.7), (5.8, 4.7)].map(|(x, y)| DVec3::new(x, y, 3.9));
    b.add(0, &polygon(&lamp).expect("a square"), rank);
    let before = resident();
    let start = Instant::now();
    let c = cpu();
    let world = b.build().expect("the generated room is small enough");
    println!(
        "{count} triangles, built in {:.2} s ({:.2} s of processor); {:.1} bytes a triangle resident, {:.1} waiting, {:.1} at the peak",
        start.elapsed().as_secs_f64(),
        cpu() - c,
        world.memory() as f64 / f64::from(count),
        before.1 as f64 / f64::from(count),
        resident().0 as f64 / f64::from(count),
    );
    println!("nodes, blocks of triangles, of quadrilaterals, items: {:?}", world.sizes());
    world
}

fn time(name: &str, rays: &[Ray], mut f: impl FnMut(&Ray) -> bool) {
    let mut best = f64::INFINITY;
    let mut yes = 0;
    for _ in 0..5 {
        yes = 0;
        let start = cpu();
        for r in rays {
            yes += usize::from(f(r));
        }
        best = best.min(cpu() - start);
    }
    println!("{name:28} {:7.3} Mrays/s   ({yes} of {})", rays.len() as f64 / best / 1e6, rays.len());
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |w: &str| words.iter().any(|x| x == w);
    let rank = Rank { opacity: Opacity::Opaque, modifier: 0, blocks: true, bends: false };
    let mut world = build(has("mesh"), rank);
    if has("scalar") {
        world = world.without_vectors();
    }
    let n = 512;
    let eye = DVec3::new(0.4, 0.4, 1.7);
    let forward = (DVec3::new(12.0, 9.0, 1.2) - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let mut camera = Vec::new();
    for k in 0..n * n {
        let (tile, inside) = (k / 64, k % 64);
        let x = tile % (n / 8) * 8 + inside % 8;
        let y = tile / (n / 8) * 8 + inside / 8;
        let at = |i: usize| (i as f64 + 0.5) / n as f64 - 0.5;
        camera.push(Ray::new(eye, (forward + right * (1.6 * at(x)) + up * (1.6 * at(y))).normalize()));
    }
    let mut rng = Rng(7);
    let (mut diffuse, mut shadow) = (Vec::new(), Vec::new());
    for r in &camera {
        let Some(hit) = world.nearest(r) else { continue };
        let normal = if hit.cosine < 0.0 { -hit.normal } else { hit.normal };
        let p = r.origin + r.direction * hit.distance;
        diffuse.push(Ray::new(p, (normal + rng.direction() * 0.9999).normalize()));
        let q = DVec3::new(5.8 + 0.4 * rng.unit(), 4.3 + 0.4 * rng.unit(), 3.9);
        shadow.push(Ray::new(p, (q - p).normalize()));
    }
    let mut shuffled = diffuse.clone();
    let mut shuffled_shadow = shadow.clone();
    for i in (1..shuffled.len()).rev() {
        let j = (rng.next() % (i as u64 + 1)) as usize;
        shuffled.swap(i, j);
        shuffled_shadow.swap(i, j);
    }
    let nearest = |r: &Ray| world.nearest(r).is_some();
    let reaches = |r: &Ray| world.shadow(r, Some(0)) == Shadow::Reaches;
    time("camera", &camera, nearest);
    time("diffuse, by pixels", &diffuse, nearest);
    time("diffuse, shuffled", &shuffled, nearest);
    time("shadow, by pixels", &shadow, reaches);
    time("shadow, shuffled", &shuffled_shadow, reaches);
    time("shadow by nearest, pixels", &shadow, |r| world.nearest(r).is_some_and(|h| h.object == 0));
}
