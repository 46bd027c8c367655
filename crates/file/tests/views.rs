//! Views against rays and lines that Radiance gave.

use ambit_base::{DVec3, FAR};
use ambit_file::{Projection, View, ViewError, ViewOption, ViewType, is_view_line};

/// Rays agree to this in every component: the published equivalence of the formulas, with room for the order of
/// operations.
const ROUNDING: f64 = 1e-12;

fn view(options: &str) -> View {
    let mut v = View::default();
    assert!(v.apply_line(options.as_bytes()) > 0, "{options}");
    v
}

fn recorded() -> Vec<(Projection, Vec<[f64; 6]>)> {
    let mut all: Vec<(Projection, Vec<[f64; 6]>)> = Vec::new();
    for line in include_str!("data/vwrays.txt").lines().filter(|l| !l.starts_with('#')) {
        if line.starts_with("-v") {
            all.push((view(line).set_up().unwrap(), Vec::new()));
        } else {
            let numbers: Vec<f64> = line.split(' ').map(|w| w.parse().unwrap()).collect();
            all.last_mut().unwrap().1.push(numbers.try_into().unwrap());
        }
    }
    all
}

fn location(pixel: usize) -> (f64, f64) {
    ((f64::from(pixel as u32 % 4) + 0.5) / 4.0, 1.0 - (f64::from(pixel as u32 / 4) + 0.5) / 3.0)
}

#[test]
fn rays_are_those_of_vwrays() {
    let (mut rays, mut gaps, mut types) = (0, 0, Vec::new());
    for (p, expected) in recorded() {
        assert_eq!(expected.len(), 12);
        types.push(p.view.kind.letter());
        for (i, e) in expected.iter().enumerate() {
            let (x, y) = location(i);
            if *e == [0.0; 6] {
                assert_eq!(p.ray(x, y), None, "{} pixel {i}", p.view);
                gaps += 1;
                continue;
            }
            let ray = p.ray(x, y).unwrap();
            let scale = if p.view.aft > 0.0 { ray.length } else { 1.0 };
            let off = (ray.origin - DVec3::new(e[0], e[1], e[2])).abs().max_element();
            let turned = (ray.direction * scale - DVec3::new(e[3], e[4], e[5])).abs().max_element();
            assert!(off < ROUNDING && turned < ROUNDING, "{} pixel {i}: {off:e} {turned:e}", p.view);
            assert_eq!(ray.length == FAR, p.view.aft == 0.0);
            rays += 1;
        }
    }
    types.dedup();
    assert_eq!(types, ['v', 'l', 'c', 'h', 'a', 's', 'a', 'h', 'v']);
    assert!(rays > 140 && gaps > 10, "{rays} {gaps}");
}

#[test]
fn points_on_rays_are_located_where_the_rays_were() {
    for (p, _) in recorded() {
        for i in 0..12 {
            let (x, y) = location(i);
            let Some(ray) = p.ray(x, y) else { continue };
            // Straight back is the whole rim of a full fisheye.
            if ray.direction.dot(p.direction) < -1.0 + 1e-9 {
                continue;
            }
            let found = p.locate(ray.origin + ray.direction * 2.5);
            let [a, b] = found.unwrap_or_else(|| panic!("{} {x} {y} {ray:?}", p.view));
            assert!((a - x).abs() < 1e-9 && (b - y).abs() < 1e-9, "{}: {x} {y} at {a} {b}", p.view);
        }
    }
}

#[test]
fn points_without_a_place_have_none() {
    let at = |options: &str, point: [f64; 3]| view(options).set_up().unwrap().locate(DVec3::from(point));
    for (options, point) in [
        ("-vtv", [0.0, -1.0, 0.5]),
        ("-vtv", [0.0, 0.0, 0.0]),
        ("-vtc", [0.0, 0.0, 1.0]),
        ("-vth", [0.0, -1.0, 0.0]),
        ("-vth", [0.0, 0.0, 0.0]),
        ("-vta", [0.0, 0.0, 0.0]),
        ("-vta", [0.0, -1.0, 0.0]),
        ("-vts", [0.0, -1.0, 0.0]),
    ] {
        assert_eq!(at(options, point), None, "{options} {point:?}");
    }
    assert_eq!(at("-vta", [0.0, 3.0, 0.0]), Some([0.5, 0.5]));
}

#[test]
fn errors_come_in_the_order_of_the_programs() {
    use ViewError::{Clipping, Direction, Horizontal, Type, Up, UpParallel, Vertical};
    for (options, expected) in [
        ("-vd 1e-7 0 0", None),
        ("-vd 1e-170 0 0", Some(Direction)),
        ("-vd 0 0 0 -vu 0 0 0 -va -1", Some(Clipping)),
        ("-vd 0 0 0 -vu 0 0 0 -vh 0", Some(Direction)),
        ("-vu 1e-170 0 0", Some(Up)),
        ("-vu 0 1 1e-10", None),
        ("-vu 0 1 0 -vh 0", Some(UpParallel)),
        ("-vo -1e-7", None),
        ("-vo -2e-6", Some(Clipping)),
        ("-va 1 -vo 1", Some(Clipping)),
        ("-va 1e-6 -vo 1", None),
        ("-vh 0 -vv 0", Some(Horizontal)),
        ("-vv 0", Some(Vertical)),
        ("-vh 1e-6", Some(Horizontal)),
        ("-vh 179.99999", None),
        ("-vh 179.9999995", Some(Horizontal)),
        ("-vtc -vh 360.000001", None),
        ("-vtc -vh 360.000002", Some(Horizontal)),
        ("-vtc -vv 180", Some(Vertical)),
        ("-vta -vh 360", None),
        ("-vta -vv 361", Some(Vertical)),
        ("-vth -vh 180 -vv 180", None),
        ("-vth -vh 181", Some(Horizontal)),
        ("-vts -vh 360", Some(Horizontal)),
        ("-vts -vv 359", None),
        ("-vtq -vh 0", Some(Horizontal)),
        ("-vtq -vh 400", Some(Type('q'))),
        ("-vtl -vh 400", None),
        ("-vtl -vv -3", Some(Vertical)),
    ] {
        assert_eq!(view(options).set_up().err(), expected, "{options}");
    }
    assert_eq!(Clipping.to_string(), "illegal fore/aft clipping plane");
    assert_eq!(UpParallel.to_string(), "view up parallel to view direction");
}

#[test]
fn the_canonical_line_is_that_of_rpict() {
    let v = view("-vp 2 .1 1.5 -vh 90 -vv 75");
    let line = "VIEW= -vtv -vp 2 0.1 1.5 -vd 0 1 0 -vu 0 0 1 -vh 90 -vv 75 -vo 0 -va 0 -vs 0 -vl 0";
    assert_eq!(v.header_line(), line);
    assert_eq!(view(line), v);
    let v = view("-vts -vp 1e-9 123456789 -.33333333333 -vd 3 4 0 -vu 1 1 1 -vs .123456789 -vl -1e-5 -va 1e6 -vo 1e5");
    assert_eq!(
        v.to_string(),
        "-vts -vp 1e-09 1.234568e+08 -0.3333333 -vd 3 4 0 -vu 0.57735 0.57735 0.57735 -vh 45 -vv 45 -vo 1e+05 -va 1e+06 \
         -vs 0.12346 -vl -1e-05"
    );
}

#[test]
fn options_are_spelled_in_full() {
    assert_eq!(ViewOption::parse("-vtc"), Some(ViewOption::Type(ViewType::Cylinder)));
    assert_eq!(ViewOption::parse("-vp").map(ViewOption::numbers), Some(3));
    for word in ["-vt", "-vtvv", "-v", "-vf", "-vpx", "vp", "--vp", "-vx", "-vé"] {
        assert_eq!(ViewOption::parse(word), None, "{word}");
    }
    let mut v = View::default();
    assert!(!v.apply(ViewOption::Point, &[1.0]));
    assert!(!v.apply(ViewOption::Lift, &[f64::NAN]));
    assert_eq!(v, View::default());
}

#[test]
fn view_lines_are_told_by_their_first_word() {
    for line in ["VIEW= x", "VIEW=-vp", "rpict", "/a/b/rpict99 -vp", "rview", "rxpiece.exe", "a/rpict=x", "vwrays\t-vp"]
    {
        assert!(is_view_line(line.as_bytes(), "vwrays"), "{line}");
    }
    for line in ["VIEW -vp", " rpict", "\tVIEW= -vp", "#?rpict", "-vp 1 2 3", "rpic", "foo rpict", ""] {
        assert!(!is_view_line(line.as_bytes(), "vwrays"), "{line}");
    }
}

#[test]
fn view_files_read_as_programs_read_them() {
    let read = |text: &str| {
        let mut v = View::default();
        v.read(&mut text.as_bytes(), "f.vf", "vwrays").map(|()| v)
    };
    let moved = View { point: DVec3::new(1.0, 2.0, 3.0), ..View::default() };
    for text in [
        "VIEW= -vp 1 2 3\n",
        "VIEW=-vp -vp 1 2 3\n",
        "rpict -x 3 -vp 1 2 3 -vd 1 x 0 -vh 45\n",
        "vwrays -vp 1 2 3",
        "rpict -vp 1 2 -vp 1 2 3",
        "x\tVIEW= -vp 0 0 0\nrpict\t-vp\t1\t2\t3\r\n",
        "#?rpict\nrpict -vp 9 9 9\nFORMAT=x\nVIEW= -vp 1 2 3\n\nVIEW= -vp 7 7 7\n",
    ] {
        assert_eq!(read(text).unwrap(), moved, "{text}");
    }
    for text in [
        "",
        "VIEW=-vp 1 2 3\n",
        " rpict -vp 1 2 3\n",
        "\nrpict -vp 1 2 3\n",
        "x\n\nrpict -vp 1 2 3\n",
        "rpict -vp 1 2\n",
        "rpict \"-vp\" 1 2 3\n",
        "rpict -vp 1 2 inf\n",
        "VIEW= -vp 1,2,3\n",
    ] {
        assert_eq!(read(text).unwrap_err().to_string(), "bad view file \"f.vf\"", "{text}");
    }
    let missing = View::default().read_file("/no/such.vf", "rpict").unwrap_err().to_string();
    assert_eq!(missing, "cannot open view file \"/no/such.vf\": No such file or directory");
}
