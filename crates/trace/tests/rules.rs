//! Ties, instances, meshes and shadows. The expected winners of ties are what Radiance's rtrace reports for the same scenes.

mod common;

use ambit_base::{DVec3, FAR, Transform};
use ambit_scene::{ObjectId, Shape, VOID};
use ambit_trace::{Mesh, MeshGeometry, Opacity, Rank, Ray, Shadow, World, WorldBuilder};
use common::{Rng, plain, polygon};
use std::sync::Arc;

fn tile(z: f64) -> Shape {
    polygon(&[DVec3::new(0.0, 0.0, z), DVec3::new(1.0, 0.0, z), DVec3::new(1.0, 1.0, z), DVec3::new(0.0, 1.0, z)])
}

fn flipped(z: f64) -> Shape {
    polygon(&[DVec3::new(0.0, 1.0, z), DVec3::new(1.0, 1.0, z), DVec3::new(1.0, 0.0, z), DVec3::new(0.0, 0.0, z)])
}

fn rank(opacity: Opacity, modifier: ObjectId) -> Rank {
    Rank { opacity, modifier, blocks: opacity == Opacity::Opaque, bends: false }
}

const DOWN: Ray = Ray { origin: DVec3::new(0.3, 0.4, 1.0), direction: DVec3::NEG_Z, limit: FAR };

fn transform(words: &str) -> Transform {
    let words: Vec<&str> = words.split_whitespace().collect();
    Transform::parse(&words).unwrap()
}

fn winner(surfaces: &[(Shape, Rank)]) -> (ObjectId, f64) {
    let mut b = WorldBuilder::new();
    for (i, (shape, rank)) in surfaces.iter().enumerate() {
        b.add(10 + i as ObjectId, shape, *rank);
    }
    let hit = b.build().unwrap().nearest(&DOWN).unwrap();
    (hit.object - 10, hit.distance)
}

#[test]
fn coincident_surfaces_are_judged_as_radiance_does() {
    use Opacity::{Nothing, Opaque, Transparent};
    let (a, b) = (rank(Opaque, 0), rank(Opaque, 1));
    // Equal modifiers: the surface defined last, even if another is nearer by less than ε.
    assert_eq!(winner(&[(tile(0.0), a), (tile(0.0), a), (tile(0.0), a)]).0, 2);
    let (id, t) = winner(&[(tile(0.0), a), (tile(5e-7), a), (tile(2e-7), a)]);
    assert!(id == 2 && (t - (1.0 - 2e-7)).abs() < 1e-12);
    // The modifier defined later.
    assert_eq!(winner(&[(tile(0.0), b), (tile(5e-7), a)]).0, 0);
    // Beyond ε the nearer one.
    assert_eq!(winner(&[(tile(0.0), b), (tile(2e-6), a)]).0, 1);
    // Front before back, opaque before transparent before nothing, each before what follows.
    assert_eq!(winner(&[(tile(0.0), a), (flipped(0.0), b)]).0, 0);
    assert_eq!(winner(&[(flipped(0.0), a), (tile(0.0), rank(Transparent, 9))]).0, 0);
    assert_eq!(winner(&[(flipped(0.0), rank(Transparent, 0)), (tile(0.0), rank(Nothing, 9))]).0, 0);
    // More ties than are kept.
    let many: Vec<(Shape, Rank)> = (0..40).map(|i| (tile(0.0), rank(Opaque, (i * 7) % 40))).collect();
    assert_eq!(winner(&many).0, (0..40).find(|i| (i * 7) % 40 == 39).unwrap());
}

/// A world with one tile at `z`, object 100, modifier 50.
fn inner(z: f64) -> Arc<World> {
    let mut b = WorldBuilder::new();
    b.add(100, &tile(z), rank(Opacity::Opaque, 50));
    Arc::new(b.build().unwrap())
}

#[test]
fn instances_tie_by_the_order_of_definition() {
    // (surface's number, instance's number, height of the inner tile, winner)
    for (surface, instance, z, expected) in
        [(0, 1, 0.0, 100), (1, 0, 0.0, 1), (0, 1, 5e-7, 100), (1, 0, 5e-7, 100), (0, 1, -5e-7, 100), (1, 0, -5e-7, 1)]
    {
        let mut b = WorldBuilder::new();
        b.add(surface, &tile(0.0), plain(40));
        b.add_instance(instance, Transform::IDENTITY, inner(z), None);
        let hit = b.build().unwrap().nearest(&DOWN).unwrap();
        assert_eq!(hit.object, expected, "{surface} {instance} {z}");
    }
    // The instance is tested first, but the surface has the later modifier; a surface without material has not.
    for (first, expected) in [(plain(60), 0), (rank(Opacity::Nothing, VOID), 1)] {
        let mut b = WorldBuilder::new();
        b.add(0, &tile(0.0), first);
        b.add_instance(1, Transform::IDENTITY, inner(-3e-7), Some(plain(55)));
        assert_eq!(b.build().unwrap().nearest(&DOWN).unwrap().object, expected);
    }
}

#[test]
fn instances_transform_hits_and_their_modifiers() {
    let words = "-rx 90 -s 2 -t 5 0 1";
    let mut b = WorldBuilder::new();
    b.add_instance(7, transform(words), inner(0.0), None);
    b.add_instance(8, transform("-t 0 0 -3"), inner(0.0), Some(plain(60)));
    let world = b.build().unwrap();
    // z up becomes −y; the tile spans x 5…7, z 1…3 at y = 0.
    let ray = Ray::new(DVec3::new(6.0, -4.0, 2.0), DVec3::Y);
    let hit = world.nearest(&ray).unwrap();
    assert!((hit.distance - 4.0).abs() < 1e-12 && (hit.normal - DVec3::NEG_Y).length() < 1e-12);
    assert!((hit.cosine - 1.0).abs() < 1e-12);
    assert_eq!((hit.object, hit.modifier), (100, 50));
    assert_eq!(world.placement(hit.placement.unwrap()), transform(words));
    let hit = world.nearest(&DOWN).unwrap();
    assert_eq!((hit.object, hit.modifier, hit.placement, hit.distance), (8, 60, None, 4.0));

    // One level more.
    let mut outer = WorldBuilder::new();
    outer.add_instance(3, transform("-t 100 0 0"), Arc::new(WorldBuilder::new().build().unwrap()), None);
    outer.add_instance(4, transform("-t 0 10 0 -mx"), Arc::new(world), None);
    let outer = outer.build().unwrap();
    let hit = outer.nearest(&Ray::new(DVec3::new(-6.0, 6.0, 2.0), DVec3::Y)).unwrap();
    assert_eq!((hit.object, hit.modifier), (100, 50));
    let t = outer.placement(hit.placement.unwrap());
    let expected = transform(&format!("{words} -t 0 10 0 -mx"));
    for p in [DVec3::ZERO, DVec3::X, DVec3::new(0.2, -3.0, 1.0)] {
        assert!((t.point(p) - expected.point(p)).length() < 1e-12);
    }
    // Overridden inside: coordinates are those of the world in between.
    let hit = outer.nearest(&Ray::new(DVec3::new(-0.5, 10.5, 0.0), DVec3::NEG_Z)).unwrap();
    assert_eq!((hit.object, hit.modifier), (8, 60));
    assert_eq!(outer.placement(hit.placement.unwrap()), transform("-t 0 10 0 -mx"));
}

/// A bumpy sheet over the unit square; triangles in both orders of vertices.
fn sheet(n: u32, normals: bool) -> MeshGeometry {
    let mut g = MeshGeometry { ranks: vec![plain(3), plain(4)], ..MeshGeometry::default() };
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            g.vertices.push(DVec3::new(x, y, 0.05 * (9.0 * x).sin() * (7.0 * y).cos()));
            if normals {
                g.normals.push(DVec3::new(-0.45 * (9.0 * x).cos() * (7.0 * y).cos(), 0.2, 1.0).normalize());
                g.uvs.push(Some([x, 2.0 * y]));
            }
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
            g.triangles.extend(if (i + j) % 2 == 0 { [[a, b, d], [d, c, a]] } else { [[b, c, a], [d, c, b]] });
            g.materials.extend([(i + j) % 2, 0]);
        }
    }
    g
}

#[test]
fn meshes_have_no_cracks() {
    let n = 32;
    let mesh = Arc::new(Mesh::build(sheet(n, false)).unwrap());
    let scalar = Arc::new(Mesh::build(sheet(n, false)).unwrap().without_vectors());
    let place = |mesh| {
        let mut b = WorldBuilder::new();
        b.add_mesh(5, Transform::IDENTITY, mesh, None);
        b.build().unwrap()
    };
    let (world, twin) = (place(mesh), place(scalar).without_vectors());
    let g = sheet(n, false);
    let mut rng = Rng::new(8);
    let inside = |v: DVec3| v.x > 0.01 && v.x < 0.99 && v.y > 0.01 && v.y < 0.99;
    let mut count = 0;
    while count < 20_000 {
        // Through vertices and points of edges, straight down and slanted.
        let t = g.triangles[rng.below(g.triangles.len() as u64) as usize];
        let (a, b) = (g.vertices[t[0] as usize], g.vertices[t[1] as usize]);
        let p = if count % 3 == 0 { a } else { a + (b - a) * rng.unit() };
        if !inside(p) {
            continue;
        }
        count += 1;
        let d = if count % 2 == 0 { DVec3::NEG_Z } else { (DVec3::NEG_Z + rng.direction() * 0.3).normalize() };
        let ray = Ray::new(p - d, d);
        let hit = world.nearest(&ray).expect("a crack");
        assert!((hit.distance - 1.0).abs() < 1e-3 && hit.object == 5 && hit.mesh_triangle && hit.cosine > 0.0);
        assert_eq!(Some(hit), twin.nearest(&ray));
    }
}

#[test]
fn mesh_hits_carry_normals_coordinates_and_materials() {
    let n = 4;
    let mesh = Arc::new(Mesh::build(sheet(n, true)).unwrap());
    let mut b = WorldBuilder::new();
    b.add_mesh(5, transform("-s 3 -rz 90"), mesh.clone(), None);
    b.add_mesh(6, transform("-t 10 0 0"), mesh, Some(plain(77)));
    let world = b.build().unwrap();
    // (0.3, 0.4) of the sheet lies at (−1.2, 0.9).
    let hit = world.nearest(&Ray::new(DVec3::new(-1.2, 0.9, 5.0), DVec3::NEG_Z)).unwrap();
    assert!((hit.uv[0] - 0.3).abs() < 1e-12 && (hit.uv[1] - 0.8).abs() < 1e-12);
    let smooth = hit.normal + hit.tilt;
    assert!((smooth.length() - 1.0).abs() < 1e-12 && hit.tilt.length() > 1e-3);
    // y of every vertex normal is positive; turned by 90° it is −x.
    assert!(smooth.x < 0.0);
    assert_eq!((hit.object, hit.placement), (5, Some(0)));
    assert!(hit.modifier == 3 || hit.modifier == 4);
    let hit = world.nearest(&Ray::new(DVec3::new(10.3, 0.4, 5.0), DVec3::NEG_Z)).unwrap();
    assert_eq!((hit.object, hit.modifier, hit.placement), (6, 77, None));
    let bad = MeshGeometry { triangles: vec![[0, 1, 99]], ..sheet(1, false) };
    assert!(Mesh::build(MeshGeometry { materials: vec![], ..bad }).is_err());
}

/// What a shadow query has to answer, from nearest hits alone.
fn by_nearest(world: &World, ranks: &[Rank], ray: &Ray, target: Option<ObjectId>) -> Shadow {
    match world.nearest(ray) {
        None => Shadow::Reaches,
        Some(h) if Some(h.object) == target => Shadow::Reaches,
        Some(h) if ranks[h.object as usize].blocks => Shadow::Blocked(h.object),
        Some(h) => Shadow::Other(h),
    }
}

#[test]
fn shadows_say_what_nearest_hits_say() {
    let mut rng = Rng::new(31);
    let shapes = common::soup(&mut rng, 60);
    let ranks: Vec<Rank> =
        (0..60).map(|i| rank(if i % 3 == 0 { Opacity::Transparent } else { Opacity::Opaque }, i as ObjectId)).collect();
    let (mut seen, mut early) = ([0; 3], 0);
    for bends in [true, false] {
        let mut b = WorldBuilder::new();
        for (i, s) in shapes.iter().enumerate() {
            b.add(i as ObjectId, s, Rank { bends, ..ranks[i] });
        }
        let world = b.build().unwrap();
        for k in 0..30_000 {
            let from = rng.direction() * 9.0 * rng.unit();
            let ray = Ray::new(from, (rng.direction() * 3.0 - from).normalize());
            let target = (k % 5 != 0).then(|| rng.below(60) as ObjectId);
            let got = world.shadow(&ray, target);
            let expected = by_nearest(&world, &ranks, &ray, target);
            match (got, expected) {
                (Shadow::Blocked(blocker), Shadow::Other(first)) => {
                    // Ended early: the blocker must be behind the first hit and before the target.
                    // A ray that meets a bender first sees it, whatever stops it behind.
                    assert!(!bends);
                    let t = world.distance(blocker, &ray).unwrap();
                    assert!(ranks[blocker as usize].blocks && t >= first.distance);
                    assert!(target.and_then(|o| world.distance(o, &ray)).is_none_or(|own| t < own));
                    early += 1;
                }
                (Shadow::Blocked(a), Shadow::Blocked(b)) => {
                    assert!(ranks[a as usize].blocks && (a == b || !bends));
                    seen[0] += 1;
                }
                (a, b) => {
                    assert_eq!(a, b);
                    seen[if a == Shadow::Reaches { 1 } else { 2 }] += 1;
                }
            }
        }
    }
    assert!(seen.iter().all(|&n| n > 500) && early > 100, "{seen:?} {early}");
}

#[test]
fn shadows_look_into_instances() {
    let mut b = WorldBuilder::new();
    b.add(0, &tile(-1.0), rank(Opacity::Transparent, 0));
    b.add_instance(1, transform("-t 0 0 .5"), inner(0.0), None);
    let world = b.build().unwrap();
    assert_eq!(world.shadow(&DOWN, Some(0)), Shadow::Blocked(100));
    let mut b = WorldBuilder::new();
    b.add(0, &tile(-1.0), rank(Opacity::Transparent, 0));
    b.add_instance(1, transform("-t 0 0 .5"), inner(0.0), Some(rank(Opacity::Transparent, 2)));
    let world = b.build().unwrap();
    assert!(matches!(world.shadow(&DOWN, Some(0)), Shadow::Other(h) if h.object == 1 && h.modifier == 2));
    assert_eq!(world.shadow(&Ray { direction: DVec3::Z, ..DOWN }, None), Shadow::Reaches);
}

#[test]
fn every_surface_keeps_its_modifier_however_many_there_are() {
    // More than a byte can number; triangles, quadrilaterals and pentagons in turns.
    let mut b = WorldBuilder::new();
    for i in 0..600u32 {
        let (x, y) = (f64::from(i % 25), f64::from(i / 25));
        let outline = [(0.1, 0.1), (0.9, 0.1), (0.9, 0.8), (0.5, 0.9), (0.1, 0.8)];
        let corners: Vec<DVec3> =
            outline[..3 + i as usize % 3].iter().map(|(u, v)| DVec3::new(x + u, y + v, 0.0)).collect();
        let opacity = if i % 2 == 0 { Opacity::Opaque } else { Opacity::Transparent };
        b.add(i, &polygon(&corners), rank(opacity, 1000 + i));
    }
    let world = b.build().unwrap();
    for i in 0..600u32 {
        let origin = DVec3::new(f64::from(i % 25) + 0.6, f64::from(i / 25) + 0.3, 1.0);
        let ray = Ray::new(origin, DVec3::NEG_Z);
        let hit = world.nearest(&ray).unwrap();
        assert_eq!((hit.object, hit.modifier), (i, 1000 + i));
        assert_eq!(matches!(world.shadow(&ray, None), Shadow::Blocked(_)), i % 2 == 0, "{i}");
    }
}
