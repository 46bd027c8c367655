//! Warnings, types and numbers as Radiance 6.0a's `oconv -f` gave them.

use super::*;
use crate::NewObject;
use crate::VOID;

fn one(kind: Kind, reals: &[f64]) -> Scene {
    let mut scene = Scene::new();
    let file = scene.add_file("t.rad");
    scene.push(NewObject { kind, modifier: VOID, name: b"p", strings: &[], reals, file, line: 1 });
    scene
}

fn texts(warnings: &[Warning]) -> Vec<&str> {
    warnings.iter().map(|w| w.text.as_str()).collect()
}

/// Kind, arguments, warnings, kind and arguments afterwards.
type Case<'a> = (Kind, Vec<f64>, &'a [&'a str], Kind, Vec<f64>);

#[test]
fn round_surfaces_are_put_right() {
    let axis = |rest: &[f64]| [&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], rest].concat();
    let flat = |rest: &[f64]| [&[0.0; 6], rest].concat();
    let cases: &[Case<'_>] = &[
        (Kind::Cone, axis(&[-1.0, -0.5]), &["negative radii for cone \"p\""], Kind::Cup, axis(&[1.0, 0.5])),
        (
            Kind::Cone,
            flat(&[-1.0, -0.5]),
            &["negative radii for cone \"p\"", "unknown orientation for cup \"p\""],
            Kind::Cup,
            flat(&[1.0, 0.5]),
        ),
        (Kind::Cone, axis(&[1.0, -0.5]), &["illegal radii for cone \"p\""], Kind::Cone, axis(&[1.0, -0.5])),
        (Kind::Cone, flat(&[1.0, 1.0]), &["unknown orientation for cylinder \"p\""], Kind::Cylinder, flat(&[1.0])),
        (Kind::Cone, axis(&[-1.0, -1.0]), &["negative radii for cone \"p\""], Kind::Tube, axis(&[1.0])),
        (Kind::Cone, axis(&[1e-7, 1.0]), &[], Kind::Cone, axis(&[0.0, 1.0])),
        (Kind::Cone, axis(&[1e-6, 1.5e-6]), &[], Kind::Cone, axis(&[0.0, 1.5e-6])),
        (Kind::Cone, axis(&[1.0, 1.0000009]), &[], Kind::Cylinder, axis(&[1.0])),
        (Kind::Cylinder, axis(&[-1.0]), &["negative radius for cylinder \"p\""], Kind::Tube, axis(&[1.0])),
        (
            Kind::Cylinder,
            flat(&[-1.0]),
            &["negative radius for cylinder \"p\"", "unknown orientation for tube \"p\""],
            Kind::Tube,
            flat(&[1.0]),
        ),
        (Kind::Cylinder, axis(&[-1e-7]), &["illegal radii for cylinder \"p\""], Kind::Cylinder, axis(&[-1e-7])),
        (Kind::Ring, axis(&[-1e-7, 1.0]), &[], Kind::Ring, axis(&[0.0, 1.0])),
        (Kind::Ring, axis(&[1.0, 1.0]), &["illegal radii for ring \"p\""], Kind::Ring, axis(&[1.0, 1.0])),
        (Kind::Ring, flat(&[1.0, 2.0]), &["unknown orientation for ring \"p\""], Kind::Ring, flat(&[1.0, 2.0])),
        (Kind::Ring, axis(&[2.0, -1.0]), &["illegal radii for ring \"p\""], Kind::Ring, axis(&[2.0, -1.0])),
        (
            Kind::Sphere,
            vec![0.0, 0.0, 0.0, -1.0],
            &["negative radius for sphere \"p\""],
            Kind::Bubble,
            vec![0.0, 0.0, 0.0, 1.0],
        ),
        (
            Kind::Sphere,
            vec![0.0, 0.0, 0.0, 1e-6],
            &["zero radius for sphere \"p\""],
            Kind::Sphere,
            vec![0.0, 0.0, 0.0, 1e-6],
        ),
    ];
    for (kind, reals, warnings, clean_kind, clean_reals) in cases {
        let mut scene = one(*kind, reals);
        let (shape, seen) = Shape::from_object(&scene, 0).unwrap();
        assert_eq!(texts(&seen), *warnings, "{kind:?} {reals:?}");
        let ignored = seen.iter().any(|w| w.complaint.is_degenerate());
        assert_eq!(matches!(shape, Shape::Degenerate), ignored, "{kind:?} {reals:?}");
        assert_eq!(texts(&scene.clean(0).unwrap()), *warnings);
        assert_eq!((scene.object(0).kind, scene.reals(0)), (*clean_kind, clean_reals.as_slice()));
    }
}

#[test]
fn wrong_counts_are_worded_by_type() {
    for (kind, count, text) in [
        (Kind::Ring, 7, "bad # arguments for ring \"p\""),
        (Kind::Sphere, 3, "bad arguments for sphere \"p\""),
        (Kind::Polygon, 3, "bad # arguments for polygon \"p\""),
        (Kind::Polygon, 10, "bad # arguments for polygon \"p\""),
        (Kind::Cylinder, 8, "bad # arguments for cylinder \"p\""),
        (Kind::Source, 3, "bad arguments for source \"p\""),
    ] {
        let error = Shape::from_object(&one(kind, &vec![1.0; count]), 0).unwrap_err();
        assert_eq!(error.to_string(), text);
        assert_eq!(error.location().to_string(), "t.rad:1");
    }
}

#[test]
fn sources_have_direction_and_size() {
    let source = |reals: &[f64]| Shape::from_object(&one(Kind::Source, reals), 0);
    for (reals, text) in [
        ([0.0, 0.0, 0.0, 1.0], "zero direction for source \"p\""),
        ([0.0, 0.0, 1.0, 0.0], "zero size for source \"p\""),
        ([0.0, 0.0, 1.0, 1e-4], "zero size for source \"p\""),
        ([0.0, 0.0, 1.0, -10.0], "zero size for source \"p\""),
    ] {
        assert_eq!(source(&reals).unwrap_err().to_string(), text);
    }
    let Shape::Source(s) = source(&[0.0, 0.0, 2.0, 10.0]).unwrap().0 else { panic!("a source") };
    let at = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
    assert!(s.contains(at(4.99)) && !s.contains(at(5.16)));
    let Shape::Source(all) = source(&[0.0, 0.0, 2.0, 360.0]).unwrap().0 else { panic!("a source") };
    assert!(all.contains(DVec3::NEG_Z));
}

fn polygon(reals: &[f64]) -> (Shape, Vec<Warning>) {
    Shape::from_object(&one(Kind::Polygon, reals), 0).unwrap()
}

const SQUARE: [f64; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];

#[test]
fn polygons_have_plane_and_area() {
    let (Shape::Polygon(p), warnings) = polygon(&[&SQUARE[..], &[0., 5e-7, 0.]].concat()) else { panic!("a polygon") };
    assert!(warnings.is_empty());
    assert_eq!((p.vertices.len(), p.normal, p.offset, p.area), (4, DVec3::Z, 0.0, 1.0));
    // A corner raised by a tenth: warned about, and flattened to the mean plane.
    let mut raised = SQUARE;
    raised[8] = 0.1;
    let (Shape::Polygon(p), warnings) = polygon(&raised) else { panic!("a polygon") };
    assert_eq!(texts(&warnings), ["non-planar vertex for polygon \"p\""]);
    let z = |x: f64, y: f64| (p.offset - p.normal.x * x - p.normal.y * y) / p.normal.z;
    assert!((z(0.9, 0.9) - 0.065).abs() < 1e-12, "{}", z(0.9, 0.9));
    assert!((z(0.1, 0.1) + 0.015).abs() < 1e-12, "{}", z(0.1, 0.1));
    // Three corners are always planar; the relative limit counts away from the origin.
    let mut far = SQUARE;
    for z in far.chunks_exact_mut(3) {
        z[2] = 5.0;
    }
    far[11] = 5.0001;
    assert!(polygon(&far).1.is_empty());
    far[11] = 5.001;
    assert_eq!(polygon(&far).1.len(), 1);
}

#[test]
fn polygons_without_area_vanish_but_count() {
    let bow_tie = [0., 0., 0., 2., 0., 0., 0., 1., 0., 2., 2., 0.];
    let mut overflow = SQUARE;
    overflow[3] = f64::INFINITY;
    for reals in [&bow_tie[..], &[0., 0., 0., 1., 0., 0., 2., 0., 0.], &overflow] {
        let (shape, warnings) = polygon(reals);
        assert!(matches!(shape, Shape::Degenerate), "{reals:?}");
        assert_eq!(texts(&warnings), ["zero area for polygon \"p\""]);
    }
    let scene = one(Kind::Polygon, &bow_tie);
    let box_ = scene.surface_bounds(0, &Shape::Degenerate).unwrap();
    assert_eq!((box_.min, box_.max), (DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0)));
    assert!(one(Kind::Polygon, &overflow).surface_bounds(0, &Shape::Degenerate).is_none());
}

#[test]
fn borders_belong_to_polygons() {
    let Shape::Polygon(p) = polygon(&SQUARE).0 else { panic!("a polygon") };
    for (x, y, inside) in [
        (0.5, 0.5, true),
        (0.0, 0.0, true),
        (1.0, 1.0, false),
        (1.0, 0.5, true),
        (0.5, 1.0, true),
        (1.0000005, 0.5, true),
        (1.000002, 0.5, false),
        (-0.1, 0.5, false),
    ] {
        assert_eq!(p.contains(DVec3::new(x, y, 0.0)), inside, "{x} {y}");
    }
    // A hole joined by a seam: the hole is out, the seam in.
    let holed = [
        0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0., 0., 0., 0.3, 0.3, 0., 0.3, 0.6, 0., 0.6, 0.6, 0., 0.6, 0.3,
        0., 0.3, 0.3, 0.,
    ];
    let Shape::Polygon(p) = polygon(&holed).0 else { panic!("a polygon") };
    assert!(!p.contains(DVec3::new(0.45, 0.5, 0.0)));
    assert!(p.contains(DVec3::new(0.2, 0.2, 0.0)));
    assert!((p.area - 0.91).abs() < 1e-12);
}

#[test]
fn boxes_are_tight() {
    let bounds = |kind, reals: &[f64]| Shape::from_object(&one(kind, reals), 0).unwrap().0.bounds().unwrap();
    let b = bounds(Kind::Sphere, &[1.0, 2.0, 3.0, -2.0]);
    assert_eq!((b.min, b.max), (DVec3::new(-1.0, 0.0, 1.0), DVec3::new(3.0, 4.0, 5.0)));
    let b = bounds(Kind::Cylinder, &[0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.5]);
    assert_eq!((b.min, b.max), (DVec3::new(-0.5, -0.5, 0.0), DVec3::new(0.5, 0.5, 4.0)));
    let b = bounds(Kind::Ring, &[0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 2.0, 0.5]);
    assert_eq!((b.min, b.max), (DVec3::new(-2.0, 0.0, -1.0), DVec3::new(2.0, 0.0, 3.0)));
    let b = bounds(Kind::Cone, &[0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 3.0, 0.0]);
    assert_eq!((b.min, b.max), (DVec3::new(-3.0, -3.0, 0.0), DVec3::new(3.0, 3.0, 4.0)));
}

#[test]
fn axes_of_nearly_unit_length_are_unit_vectors_to_first_order() {
    let bounds = |kind, reals: &[f64]| Shape::from_object(&one(kind, reals), 0).unwrap().0.bounds().unwrap();
    // Lengths of 1 + 3e-7: oconv of Radiance prints a lower limit of -1.1724e-13 with a margin of 1e-5 where an exact axis
    // would give 0.
    let longer = 1.0 + 3e-7;
    let squared: f64 = 0.36 + 0.49 + 0.16;
    let [x, y, z] = [0.6, 0.7, 0.4].map(|c| c / squared.sqrt() * longer);
    let reach = 5.0 * (1.0 - 0.16 / squared).sqrt();
    let b = bounds(Kind::Cylinder, &[0.0, 0.0, reach, x, y, z + reach, 5.0]);
    assert!((b.min.z + 1.172e-13).abs() < 2e-15, "{}", b.min.z);
    // 1.627 times its reciprocal is a little less than 1: what a cylinder along an axis reaches beyond its ends.
    let b = bounds(Kind::Cylinder, &[-0.536, 0.9037, 0.5495, -0.536, 0.9037, 2.1765, 0.24405]);
    assert!((0.5495 - b.min.z - 3.64e-9).abs() < 1e-11, "{}", b.min.z);
}

#[test]
fn cones_run_from_the_smaller_end() {
    let (shape, _) = Shape::from_object(&one(Kind::Cup, &[0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 3.0, 1.0]), 0).unwrap();
    let Shape::Cone(c) = shape else { panic!("a cone") };
    assert_eq!((c.r0, c.r1, c.p0, c.axis, c.length, c.inward), (1.0, 3.0, 4.0 * DVec3::Z, DVec3::NEG_Z, 4.0, true));
}
