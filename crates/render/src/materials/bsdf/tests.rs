//! Files of every kind, sampling against evaluation, and texts that are no BSDF.

use super::data::Distribution;
use super::lobe::Lobe;
use ambit_base::{DVec3, Notify, Rgb, Silent, square_to_disk};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::Mutex;

const TB: &str = "Transmission Back";
const RB: &str = "Reflection Back";
const OWN_BASIS: &str = "<AngleBasis><AngleBasisName>own</AngleBasisName>\
     <AngleBasisBlock><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds>\
     </AngleBasisBlock><AngleBasisBlock><nPhis>4</nPhis><ThetaBounds><LowerTheta>30</LowerTheta>\
     <UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";

/// Keeps what is told.
#[derive(Default)]
struct Heard(Mutex<Vec<String>>);

impl Notify for Heard {
    fn warn(&self, text: &str) {
        self.0.lock().expect("no panic before").push(text.to_owned());
    }
}

fn block(wavelength: &str, direction: &str, bases: &str, numbers: &str) -> String {
    format!(
        "<WavelengthData>\n<Wavelength unit=\"Integral\">{wavelength}</Wavelength><WavelengthDataBlock>\
         <WavelengthDataDirection>{direction}</WavelengthDataDirection>{bases}<ScatteringData>{numbers}\
         </ScatteringData></WavelengthDataBlock></WavelengthData>\n"
    )
}

fn file(structure: &str, blocks: &[String]) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<WindowElement><FileType>BSDF</FileType><Optical><Layer><DataDefinition>\
         <IncidentDataStructure>{structure}</IncidentDataStructure>{OWN_BASIS}</DataDefinition>\n{}</Layer></Optical>\
         </WindowElement>\n",
        blocks.concat()
    )
}

fn matrix(structure: &str, direction: &str, basis: &str, numbers: &str) -> String {
    let bases = format!("<ColumnAngleBasis>{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis>");
    file(structure, &[block("Visible", direction, &bases, numbers)])
}

fn tree(rank: usize, direction: &str, numbers: &str) -> String {
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
    file(&format!("TensorTree{rank}"), &[block("Visible", direction, basis, numbers)])
}

fn read(text: &str) -> Distribution {
    Distribution::read(text.as_bytes(), "dir/test.xml", &Silent).expect("a good file")
}

fn error(text: &str) -> (String, u32) {
    let e = Distribution::read(text.as_bytes(), "dir/test.xml", &Silent).expect_err("a bad file");
    (e.text, e.location.line)
}

fn numbers(count: usize, f: impl Fn(usize) -> f64) -> String {
    (0..count).fold(String::new(), |mut s, i| {
        let _ = write!(s, "{} ", f(i));
        s
    })
}

/// A direction on the side of `z` whose projection is a point of the square.
fn over(x: f64, y: f64, z: f64) -> DVec3 {
    let [p, q] = square_to_disk(x, y);
    DVec3::new(p, q, (1.0 - p * p - q * q).max(0.0).sqrt().copysign(z))
}

fn value(lobe: &Lobe, incident: DVec3, exiting: DVec3) -> f64 {
    lobe.cell(incident, exiting).map_or(0.0, |c| f64::from(c.value))
}

#[test]
fn matrices_are_addressed_as_in_the_worked_example() {
    // Only exiting patch 1 (azimuth 0) and incident patch 2 (azimuth 90° of the reversed direction) scatter.
    let only = |i: usize, o: usize| numbers(25, |k| f64::from(u8::from(k == o * 5 + i)));
    let all = read(&matrix("Columns", RB, "own", &only(2, 1)));
    assert!(all.reflection[1].lobe.is_none() && all.transmission.iter().all(|t| t.lobe.is_none()));
    let lobe = all.reflection[0].lobe.as_ref().expect("a lobe");
    let (px, my) = (DVec3::new(0.8, 0.0, 0.6), DVec3::new(0.0, -0.8, 0.6));
    assert_eq!(value(lobe, my, px), 1.0);
    assert_eq!(value(lobe, px, my), 0.0);
    assert_eq!(value(lobe, my, -px), 0.0);
    let rows = read(&matrix("Rows", RB, "own", &only(1, 2)));
    assert_eq!(value(rows.reflection[0].lobe.as_ref().expect("a lobe"), my, px), 1.0);
    // Transmission from the other side by reciprocity.
    let all = read(&matrix("Columns", TB, "own", &only(2, 1)));
    let [front, back] = all.transmission.each_ref().map(|t| t.lobe.as_ref().expect("a lobe"));
    let down = |v: DVec3| DVec3::new(v.x, v.y, -v.z);
    assert_eq!(value(front, my, down(px)), 1.0);
    assert_eq!(value(back, down(px), my), 1.0);
    assert_eq!(value(back, down(my), px), 0.0);
}

#[test]
fn trees_are_addressed_as_in_the_worked_example() {
    // Element 8 of a flat grid, child 1 of a branch: incident quadrant (+, −) of the reversed direction, exiting (−, −).
    let flat = numbers(16, |k| f64::from(u8::from(k == 8)));
    let nested = (0..16).map(|k| ["{ 0 },", "{ 1 },"][usize::from(k == 1)]).collect::<String>();
    for text in [format!("{{ {flat} }}"), format!("{{ {nested} }}")] {
        let all = read(&tree(4, RB, &text));
        let lobe = all.reflection[0].lobe.as_ref().expect("a lobe");
        for (x, y) in [(0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)] {
            let want = f64::from(u8::from((x, y) == (0.25, 0.75)));
            assert_eq!(value(lobe, over(x, y, 1.0), over(0.25, 0.25, 1.0)), want, "{x} {y} {text}");
            assert_eq!(value(lobe, over(x, y, 1.0), over(0.75, 0.25, 1.0)), 0.0);
        }
    }
}

#[test]
fn isotropic_trees_turn_with_the_view() {
    let all = read(&tree(3, RB, &format!("{{ {} }}", numbers(8, |k| 0.01 * (k + 1) as f64))));
    let lobe = all.reflection[0].lobe.as_ref().expect("a lobe");
    // What Radiance 6.0a answers for these views and directions; the least value .01 is Lambertian.
    let ahead = DVec3::Z;
    let tilted = DVec3::new(-0.1, -0.2, 1.0).normalize();
    for (x, y, straight, oblique) in
        [(-0.3, -0.3, 0.04, 0.02), (0.3, 0.3, 0.01, 0.03), (-0.3, 0.3, 0.03, 0.04), (0.3, -0.3, 0.02, 0.01)]
    {
        let light = DVec3::new(x, y, 0.9).normalize();
        assert!((value(lobe, ahead, light) + 0.01 - straight).abs() < 1e-6);
        assert!((value(lobe, tilted, light) + 0.01 - oblique).abs() < 1e-6);
    }
}

#[test]
fn the_least_value_is_lambertian() {
    let all = read(&matrix("Columns", RB, "own", &numbers(25, |k| if k == 0 { 0.2 } else { 0.1 })));
    let side = &all.reflection[0];
    assert!((f64::from(side.diffuse.x) - 0.1 * PI).abs() < 1e-6);
    let lobe = side.lobe.as_ref().expect("a lobe");
    assert!((lobe.total(DVec3::Z) - 0.1 * PI * 0.25).abs() < 1e-6, "{}", lobe.total(DVec3::Z));
    // Too little to be worth it, and nothing but it.
    let all = read(&matrix("Columns", RB, "own", &numbers(25, |k| if k == 0 { 0.2 } else { 0.003 })));
    assert_eq!(all.reflection[0].diffuse, Rgb::ZERO);
    let all = read(&tree(3, TB, "{ 0.159155 }"));
    for side in all.transmission {
        assert!(side.lobe.is_none() && (f64::from(side.diffuse.x) - 0.5).abs() < 1e-5);
    }
}

#[test]
fn what_no_direction_reaches_tells_nothing() {
    // The first coordinate of rank 3 ends at a half. As Radiance 6.0a: .1254 is Lambertian here, not .0495, and the
    // total of what lies beyond is not told.
    let flat = "{ .1254 .1760 .2125 .2371 .9 .2490 .9 .0495 }";
    let nested = "{ {.1254} {.0495} {.2125} {.9} {.2371} {.9} {.1760} {.9} }";
    for text in [flat, nested] {
        let heard = Heard::default();
        let all = Distribution::read(tree(3, RB, text).as_bytes(), "test.xml", &heard).expect("a good file");
        assert!((f64::from(all.reflection[0].diffuse.x) - 0.1254 * PI).abs() < 1e-6, "{text}");
        assert!(heard.0.into_inner().expect("no panic before").is_empty(), "{text}");
    }
}

#[test]
fn a_side_without_lobe_has_the_other_ones() {
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
    let wavy = format!("{{ {} }}", numbers(16, |k| 0.1 + 0.01 * k as f64));
    let incident = DVec3::new(-0.1, -0.2, 1.0).normalize();
    for own in [0.0, 0.05] {
        let lambertian = format!("{{ {own} }}");
        let blocks = [block("Visible", TB, basis, &lambertian), block("Visible", "Transmission Front", basis, &wavy)];
        let [front, back] = read(&file("TensorTree4", &blocks)).transmission;
        assert!((f64::from(front.diffuse.x) - own * PI).abs() < 1e-6);
        assert!((f64::from(back.diffuse.x) - 0.1 * PI).abs() < 1e-6);
        // Radiance 6.0a's answer.
        let total = front.lobe.expect("a lobe").total(incident);
        assert!((total - 0.1884956).abs() < 1e-5, "{total}");
    }
}

#[test]
fn colour_comes_from_tristimulus_values_or_chromaticities() {
    let bases = "<ColumnAngleBasis>own</ColumnAngleBasis><RowAngleBasis>own</RowAngleBasis>";
    let xyz = [("Visible", 0.5), ("CIE-X", 0.6), ("CIE-Z", 0.25)];
    let blocks = xyz.map(|(w, v)| block(w, RB, bases, &numbers(25, |_| v / PI)));
    let side = &read(&file("Columns", &blocks)).reflection[0];
    assert!(side.diffuse.abs_diff_eq(Rgb::new(0.8545, 0.3867, 0.2209), 0.01), "{}", side.diffuse);
    let sum = 0.6 + 15.0 * 0.5 + 3.0 * 0.25;
    let yuv = [("Visible", 0.5 / PI), ("CIE-u", 4.0 * 0.6 / sum), ("CIE-v", 9.0 * 0.5 / sum)];
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
    let blocks = yuv.map(|(w, v)| block(w, RB, basis, &format!("{{ {v} }}")));
    let side = &read(&file("TensorTree4", &blocks)).reflection[0];
    assert!(side.diffuse.abs_diff_eq(Rgb::new(0.8562, 0.3868, 0.2131), 2e-4), "{}", side.diffuse);
    // A Lambertian part has the colour of the darkest cell, what remains that of the difference.
    let two = |low: f64, high: f64| format!("{{ {} }}", numbers(16, |k| if k < 8 { low } else { high }));
    let blocks = [("Visible", two(0.1, 0.3)), ("CIE-u", two(0.25, 0.2)), ("CIE-v", two(0.45, 0.5))]
        .map(|(w, n)| block(w, RB, basis, &n));
    let side = &read(&file("TensorTree4", &blocks)).reflection[0];
    assert!(side.diffuse.abs_diff_eq(Rgb::new(0.48437, 0.23732, 0.41247), 2e-4), "{}", side.diffuse);
}

/// Files whose lobes are steep, partly empty and of uneven cells, from both sides.
fn lobes() -> Vec<(String, Lobe, bool)> {
    let mut all = Vec::new();
    let wavy = |k: usize| if k % 7 == 3 { 0.0 } else { (1.3 + (k as f64 * 0.77).sin()).powi(3) * 0.05 };
    let zero = |n: usize| numbers(n, |_| 0.0);
    let deep = |rank: usize| {
        let cells = 1 << rank;
        let children: String = (0..cells)
            .map(|c| match c % 3 {
                0 => format!("{{ {} }}", wavy(c)),
                1 => format!("{{ {} }}", numbers(cells * cells, |k| wavy(k + c))),
                _ => format!("{{ {{{}}} }}", numbers(cells, |d| wavy(c * d)).trim().replace(' ', "} {")),
            })
            .collect();
        format!("{{ {children} }}")
    };
    for (name, text) in [
        ("full", matrix("Columns", TB, "LBNL/Klems Full", &numbers(145 * 145, wavy))),
        ("quarter", matrix("Rows", TB, "LBNL/Klems Quarter", &numbers(41 * 41, wavy))),
        ("own", matrix("Columns", TB, "own", &format!("1 {}", zero(24)))),
        ("flat 4", tree(4, TB, &format!("{{ {} }}", numbers(256, wavy)))),
        ("deep 4", tree(4, TB, &deep(4))),
        ("deep 3", tree(3, TB, &deep(3))),
    ] {
        let [front, back] = read(&text).transmission;
        all.push((format!("{name} front"), front.lobe.expect("a lobe"), true));
        all.push((format!("{name} back"), back.lobe.expect("a lobe"), !name.ends_with('3')));
    }
    all
}

#[test]
fn samples_follow_the_values_and_keep_the_energy() {
    for (name, lobe, sampled) in lobes() {
        for (x, y) in [(0.31, 0.42), (0.52, 0.95), (0.08, 0.2)] {
            let incident = over(x, y, 1.0);
            let total = lobe.total(incident);
            if !sampled {
                assert_eq!((total, lobe.sample(incident, [0.4, 0.6])), (0.0, None), "{name}");
                continue;
            }
            // The total is the integral of what evaluation gives.
            let n = 480;
            let at = |i: i32, n: i32| (f64::from(i) + 0.5) / f64::from(n);
            let mut bins = [[0.0; 4]; 4];
            let mut integral = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let v = value(&lobe, incident, over(at(i, n), at(j, n), 1.0)) * PI / f64::from(n * n);
                    integral += v;
                    bins[(4 * i / n) as usize][(4 * j / n) as usize] += v;
                }
            }
            assert!((integral - total).abs() < 0.01 * total.max(0.02), "{name}: {integral} {total}");
            if total <= 0.0 {
                continue;
            }
            // Stratified samples reach each part of the hemisphere as often as its share says: the density, which is
            // value/total, integrates to 1 there and everywhere.
            let m = 128;
            let mut seen = [[0.0; 4]; 4];
            for i in 0..m {
                for j in 0..m {
                    let d = lobe.sample(incident, [at(i, m), at(j, m)]).expect("a sample");
                    assert!((d.length() - 1.0).abs() < 1e-9 && d.z >= 0.0);
                    assert!(value(&lobe, incident, d) > 0.0, "{name}: a sample where nothing scatters");
                    let [u, v] = ambit_base::disk_to_square(d.x, d.y);
                    let bin = |u: f64| ((4.0 * u) as usize).min(3);
                    seen[bin(u)][bin(v)] += 1.0 / f64::from(m * m);
                }
            }
            for (a, b) in bins.iter().flatten().zip(seen.iter().flatten()) {
                assert!((a / integral - b).abs() < 0.012, "{name} at {x} {y}: {bins:?} / {integral} against {seen:?}");
            }
        }
    }
}

#[test]
fn more_light_than_there_is_gets_a_warning() {
    let heard = Heard(Mutex::new(Vec::new()));
    let text = tree(4, RB, "{ 0.6 }");
    Distribution::read(text.as_bytes(), "dir/big.xml", &heard).expect("a good file");
    assert_eq!(heard.0.into_inner().expect("no panic before"), ["BSDF \"big\" has 188.5% front reflection"]);
}

#[test]
fn faults_are_named_with_their_line() {
    let good = matrix("Columns", RB, "own", &numbers(25, |_| 0.1));
    let bad = |from: &str, to: &str| error(&good.replace(from, to));
    assert_eq!(
        bad("WindowElement>", "Window>").0,
        "File format error: BSDF \"test\": top level node not 'WindowElement'"
    );
    let wrong = ("File format error: XML \"test\": wrong FileType (must be 'BSDF')".to_owned(), 2);
    assert_eq!(bad(">BSDF<", ">XX<"), wrong);
    assert_eq!(bad("Layer", "Pane").0, "File format error: BSDF \"test\": no optical layers");
    let unsupported = "Unsupported feature: BSDF \"test\": unsupported IncidentDataStructure";
    assert_eq!(bad("Columns<", " Columns<").0, unsupported);
    assert_eq!(
        bad("IncidentDataStructure", "Structure").0,
        "File format error: BSDF \"test\": missing IncidentDataStructure"
    );
    assert_eq!(bad("<RowAngleBasis>own", "<RowAngleBasis>none").0, "File format error: Undefined RowAngleBasis 'none'");
    assert_eq!(bad("ColumnAngleBasis", "Other").0, "File format error: Missing column basis for BSDF 'test'");
    assert_eq!(bad("0.1 0.1", "").0, "File format error: Bad/missing BSDF ScatteringData in 'test'");
    assert_eq!(bad("0.1 0.1", "0.1\n\n nan").1, 6);
    assert_eq!(bad("<nPhis>4", "<nPhis>1"), ("Invalid data: Illegal phi count in 'own'".to_owned(), 2));
    assert_eq!(bad("<LowerTheta>30", "<LowerTheta>31").0, "Invalid data: Theta values disagree in 'own'");
    let (text, line) = bad("</Layer>", "");
    assert!(text.starts_with("File format error: BSDF \"dir/test.xml\" [error near line 5]: "), "{text}");
    assert_eq!(line, 5);
    let cut = |until: &str| error(good.split_once(until).expect("it is there").0).1;
    assert_eq!((cut("<Optical"), cut("</DataDefinition"), cut("</ScatteringData")), (2, 2, 4), "where a cut file ends");
    for (numbers, problem) in [
        ("0.1", "Missing '{' in tensor tree"),
        ("{ 0.1", "Missing '}' in tensor tree"),
        ("{ 0.1 0.2 }", "Illegal value count in tensor tree"),
        ("{ { 0.1 } { 0.2 } }", "Missing '{' in tensor tree"),
        ("{ 0.1 } 3", "Extra characters at end of ScatteringData"),
        ("{ inf }", "Bad number in tensor tree"),
        ("{}", "Illegal value count in tensor tree"),
    ] {
        assert_eq!(error(&tree(4, RB, numbers)).0, format!("File format error: {problem} in 'test'"));
    }
    let deep = "{".repeat(100_000);
    assert_eq!(error(&tree(3, RB, &deep)).0, "File format error: Tensor tree is nested too deeply in 'test'");
}

#[test]
fn other_wavelengths_and_directions_are_skipped() {
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
    let blocks = [
        block("Solar", RB, basis, "nonsense"),
        block("Visible", "Sideways", basis, "nonsense"),
        block("visible", "reflection BACK", basis, "<!-- first --> { <!-- second --> .2 }"),
    ];
    let all = read(&file("tensortree4", &blocks));
    assert!((f64::from(all.reflection[0].diffuse.x) - 0.2 * PI).abs() < 1e-6);
}

proptest! {
    #[test]
    fn any_bytes_are_refused_or_read(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = Distribution::read(&bytes, "x.xml", &Silent);
    }

    #[test]
    fn damaged_files_are_refused_or_read(
        which in 0usize..3,
        at in 0.0f64..1.0,
        length in 0usize..12,
        inserted in "[{}0-9.,eE+<>/ a-z\\-]{0,12}",
    ) {
        let text = match which {
            0 => matrix("Columns", RB, "own", &numbers(25, |k| 0.01 * k as f64)),
            1 => tree(3, TB, "{ {.1} {.2 .3 .4 .5 .6 .7 .8 .9} {0} {1} {2} {3} {4} {5} }"),
            _ => tree(4, RB, &format!("{{ {} }}", numbers(16, |k| k as f64))),
        };
        let start = (at * text.len() as f64) as usize;
        let end = (start + length).min(text.len());
        let damaged = format!("{}{inserted}{}", &text[..start], &text[end..]);
        if let Ok(all) = Distribution::read(damaged.as_bytes(), "x.xml", &Silent) {
            for side in all.reflection.iter().chain(&all.transmission) {
                prop_assert!(side.diffuse.is_finite());
                let Some(lobe) = &side.lobe else { continue };
                for (x, y) in [(0.1, 0.2), (0.5, 0.5), (0.999, 0.7)] {
                    let d = over(x, y, 1.0);
                    prop_assert!(lobe.total(d).is_finite() && value(lobe, d, d).is_finite());
                    if let Some(s) = lobe.sample(d, [0.3, 0.9]) {
                        prop_assert!(s.is_finite());
                    }
                }
            }
        }
    }
}
