//! The tree against brute force: no hit may be lost or gained, whatever the scale, the offset and the direction.

mod common;

use ambit_base::DVec3;
use ambit_scene::Shape;
use ambit_trace::{Ray, World};
use common::{Rng, brute_force, plain, polygon, world_of};

/// Boxes on a grid of a tenth, so that faces, edges and corners coincide; triangles, quadrilaterals and L-shapes.
fn grid_scene(rng: &mut Rng, boxes: usize, scale: f64, offset: DVec3) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for i in 0..boxes {
        let cell = |r: &mut Rng, n: u64| r.below(n) as f64 * 0.1;
        let p = DVec3::new(cell(rng, 60), cell(rng, 60), cell(rng, 60));
        let s = DVec3::new(0.1 + cell(rng, 6), 0.1 + cell(rng, 6), 0.1 + cell(rng, 6));
        for axis in 0..3 {
            let mut u = DVec3::ZERO;
            let mut v = DVec3::ZERO;
            let mut w = DVec3::ZERO;
            u[(axis + 1) % 3] = s[(axis + 1) % 3];
            v[(axis + 2) % 3] = s[(axis + 2) % 3];
            w[axis] = s[axis];
            for base in [p, p + w] {
                let at = |a: f64, b: f64| (base + u * a + v * b) * scale + offset;
                let outline: Vec<Vec<DVec3>> = match (i + axis) % 3 {
                    0 => vec![
                        vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)],
                        vec![at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
                    ],
                    1 => vec![vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]],
                    _ => vec![vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 0.5), at(0.5, 0.5), at(0.5, 1.0), at(0.0, 1.0)]],
                };
                shapes.extend(outline.iter().map(|o| polygon(o)));
            }
        }
    }
    shapes
}

fn vertices(shape: &Shape) -> &[DVec3] {
    match shape {
        Shape::Polygon(p) => &p.vertices,
        _ => &[],
    }
}

/// Rays that start on vertices, edges and faces, or near them, mostly along axes.
fn awkward_ray(rng: &mut Rng, shapes: &[Shape], scale: f64, k: usize) -> Ray {
    let v = vertices(&shapes[rng.below(shapes.len() as u64) as usize]);
    let (a, b) = match k % 4 {
        0 => (0.0, 0.0),
        1 => (rng.unit(), 0.0),
        _ => {
            let (a, b) = (rng.unit(), rng.unit());
            if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) }
        }
    };
    let p = v[0] + (v[1] - v[0]) * a + (v[2] - v[0]) * b;
    let axis = rng.below(3) as usize;
    let mut d = DVec3::ZERO;
    d[axis] = if rng.below(2) == 0 { 1.0 } else { -1.0 };
    if k.is_multiple_of(5) {
        d = rng.direction();
    }
    if k.is_multiple_of(7) {
        d[(axis + 1) % 3] += 1e-8;
        d = d.normalize();
    }
    let back = match k % 6 {
        0 | 3 => 0.0,
        1 | 4 => 3e-6 * scale * (1.0 + 50.0 * rng.unit()),
        2 => rng.unit() * 3.0 * scale,
        _ => rng.unit() * 1e4 * scale,
    };
    Ray::new(p - d * back, d)
}

fn compare(world: &World, shapes: &[Shape], rays: impl Iterator<Item = Ray>) -> (usize, usize) {
    let (mut hits, mut total) = (0, 0);
    for ray in rays {
        let expected = brute_force(world, shapes, &ray);
        let got = world.nearest(&ray).map(|h| (h.object, h.distance.to_bits()));
        assert_eq!(got, expected.map(|(id, t)| (id, t.to_bits())), "{ray:?}");
        hits += usize::from(got.is_some());
        total += 1;
    }
    (hits, total)
}

#[test]
fn awkward_rays_on_grids_find_what_brute_force_finds() {
    let cases = [
        (1.0, DVec3::ZERO),
        (1e-3, DVec3::ZERO),
        (1e5, DVec3::ZERO),
        (1.0, DVec3::new(500_000.3, 4_000_000.7, 20.1)),
        (30.0, DVec3::new(-1e6, 1e6, 0.0)),
    ];
    for (scale, offset) in cases {
        let mut rng = Rng::new(3);
        let shapes = grid_scene(&mut rng, 40, scale, offset);
        let world = world_of(&shapes);
        let rays: Vec<Ray> = (0..12_000).map(|k| awkward_ray(&mut rng, &shapes, scale, k)).collect();
        let (hits, total) = compare(&world, &shapes, rays.iter().copied());
        assert!(hits > total / 4, "{hits} of {total} hit");
        let scalar = world_of(&shapes).without_vectors();
        for ray in &rays {
            assert_eq!(world.nearest(ray), scalar.nearest(ray), "{ray:?}");
        }
    }
}

#[test]
fn curved_surfaces_and_soup_find_what_brute_force_finds() {
    let mut rng = Rng::new(11);
    let shapes = common::soup(&mut rng, 400);
    let world = world_of(&shapes);
    let scalar = world_of(&shapes).without_vectors();
    let mut hits = 0;
    for k in 0..40_000 {
        let from = rng.direction() * (if k % 3 == 0 { 1e5 } else { 12.0 }) * rng.unit();
        let to = rng.direction() * 5.0 * rng.unit();
        let ray = Ray::new(from, (to - from).normalize());
        let expected = brute_force(&world, &shapes, &ray);
        let got = world.nearest(&ray);
        assert_eq!(got.map(|h| (h.object, h.distance)), expected, "{ray:?}");
        assert_eq!(got, scalar.nearest(&ray));
        hits += usize::from(got.is_some());
    }
    assert!(hits > 10_000);
}

#[test]
fn rows_of_equal_and_coincident_tiles_build_and_answer() {
    let tile = |x: f64, y: f64| {
        let p = DVec3::new(x, y, 0.0);
        polygon(&[p, p + DVec3::X, p + DVec3::X + DVec3::Y, p + DVec3::Y])
    };
    let row: Vec<Shape> = (0..10_000).map(|i| tile(f64::from(i), 0.0)).collect();
    let floor: Vec<Shape> = (0..10_000).map(|i| tile(f64::from(i % 100), f64::from(i / 100))).collect();
    let stack: Vec<Shape> = (0..3000).map(|_| tile(0.0, 0.0)).collect();
    for (name, shapes) in [("row", row), ("floor", floor), ("stack", stack)] {
        let world = world_of(&shapes);
        let bounds = world.bounds();
        let mut rng = Rng::new(5);
        for k in 0..300 {
            let size = bounds.max - bounds.min;
            let p = bounds.min + size * DVec3::new(rng.unit(), rng.unit(), 0.0);
            let o = DVec3::new(p.x, p.y, 3.0);
            let d = if k % 2 == 0 { DVec3::NEG_Z } else { (DVec3::NEG_Z + rng.direction() * 0.9).normalize() };
            let ray = Ray::new(o, d);
            let got = world.nearest(&ray).map(|h| (h.object, h.distance));
            assert_eq!(got, brute_force(&world, &shapes, &ray), "{name}");
        }
    }
}

#[test]
fn worlds_of_none_and_one_surface_work() {
    let ray = Ray::new(DVec3::new(0.2, 0.1, 5.0), DVec3::NEG_Z);
    let empty = world_of(&[]);
    assert!(empty.nearest(&ray).is_none() && empty.bounds().is_empty());
    let tri = polygon(&[DVec3::ZERO, DVec3::X, DVec3::Y]);
    let one = world_of(std::slice::from_ref(&tri));
    let hit = one.nearest(&ray).unwrap();
    assert_eq!((hit.distance, hit.normal, hit.cosine), (5.0, DVec3::Z, 1.0));
    assert!(one.nearest(&Ray { limit: 5.0, ..ray }).is_none());
    assert!(one.nearest(&Ray { limit: 5.0 + 1e-9, ..ray }).is_some());
    assert!(one.nearest(&Ray::new(ray.origin, DVec3::Z)).is_none());
    assert!(one.nearest(&Ray::new(DVec3::NAN, DVec3::Z)).is_none());
    assert!(one.nearest(&Ray::new(ray.origin, DVec3::ZERO)).is_none());
}

#[test]
fn a_giant_ground_does_not_hide_small_things() {
    let mut shapes = vec![polygon(&[
        DVec3::new(-1e5, -2e4, 0.0),
        DVec3::new(1e6, -2e4, 0.0),
        DVec3::new(1e6, 1e6, 0.0),
        DVec3::new(-1e5, 1e6, 0.0),
    ])];
    let mut rng = Rng::new(9);
    for _ in 0..500 {
        let p = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        shapes.push(polygon(&[p, p + rng.direction() * 0.01, p + rng.direction() * 0.01]));
    }
    let world = world_of(&shapes);
    let rays = (0..20_000).map(|k| {
        let o = DVec3::new(rng.unit(), rng.unit(), rng.unit()) * if k % 2 == 0 { 1.0 } else { 1e4 };
        let p = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        Ray::new(o, (p - o).normalize())
    });
    let rays: Vec<Ray> = rays.collect();
    compare(&world, &shapes, rays.into_iter());
    assert_eq!(plain(0).modifier, 0);
}

#[test]
fn facets_agree_with_the_general_test() {
    let mut rng = Rng::new(21);
    for round in 0..3000 {
        let size = [1e-3, 0.02, 1.0, 50.0][round % 4];
        let p = rng.direction() * 3.0;
        let (u, v) = (rng.direction() * size, rng.direction() * size * rng.unit());
        let shape = if round % 3 == 0 { polygon(&[p, p + u, p + u + v, p + v]) } else { polygon(&[p, p + u, p + v]) };
        let Shape::Polygon(poly) = &shape else { continue };
        let world = world_of(std::slice::from_ref(&shape));
        for k in 0..60 {
            // Near the border, far outside it, and inside.
            let (a, b) = match k % 4 {
                0 => (rng.unit(), 2e-6 * (rng.unit() - 0.5) / size.min(1.0)),
                1 => (2e-6 * (rng.unit() - 0.5) / size.min(1.0), rng.unit()),
                2 => (rng.unit(), rng.unit()),
                _ => (4.0 * rng.unit() - 1.5, 4.0 * rng.unit() - 1.5),
            };
            let d = rng.direction();
            let ray = Ray::new(p + u * a + v * b - d, d);
            let t = (poly.offset - poly.normal.dot(ray.origin)) / poly.normal.dot(d);
            if poly.normal.dot(d).abs() <= 1e-6 || t <= 1e-6 {
                continue;
            }
            let expected = poly.contains(ray.origin + d * t);
            assert_eq!(world.nearest(&ray).is_some(), expected, "{poly:?} {ray:?}");
        }
    }
}
