//! Hard shadows of a small lamp and of the sun, against the geometry: what is known beforehand to stand in a source's light
//! must darken what it shades and nothing else.

use ambit_tests::Program;

/// Horizontal screens: low corner, high corner, height.
const SCREENS: [([f64; 2], [f64; 2], f64); 3] =
    [([-0.6, -0.5], [0.1, 0.4], 1.0), ([0.3, 0.2], [0.5, 1.5], 0.5), ([-2.0, 1.0], [-1.2, 1.1], 2.0)];
/// Points nearer than this to the border of a shadow are not looked at: the lamps have a size.
const BORDER: f64 = 0.02;
/// Points a side of the grid on the floor.
const SIDE: u32 = 60;

fn scene(lamp: &str) -> String {
    let screens = SCREENS
        .map(|([a, b], [x, y], z)| format!("grey polygon s 0 0 12 {a} {b} {z} {x} {b} {z} {x} {y} {z} {a} {y} {z}\n"));
    // The scene's bounds, which a distant source's cells divide, reach beyond the screens.
    let floor = "grey polygon floor 0 0 12 -3 -3 -.01 3 -3 -.01 3 3 -.01 -3 3 -.01\n";
    format!("void plastic grey 0 0 5 .5 .5 .5 0 0\n{lamp}{}{floor}", screens.concat())
}

/// Whether the segment from a floor point along `step` (per unit of height) meets a screen; none near its border.
fn shaded(p: [f64; 2], step: impl Fn(f64) -> [f64; 2]) -> Option<bool> {
    let mut any = false;
    for (low, high, z) in SCREENS {
        let [dx, dy] = step(z);
        let q = [p[0] + dx, p[1] + dy];
        let inside = |by: f64| (0..2).all(|k| low[k] - by < q[k] && q[k] < high[k] + by);
        if inside(BORDER) != inside(-BORDER) {
            return None;
        }
        any |= inside(0.0);
    }
    Some(any)
}

fn holds(lamp: &str, step: impl Fn([f64; 2], f64) -> [f64; 2]) {
    let scratch = tempfile::tempdir().expect("a scratch folder can be made");
    let octree = scratch.path().join("scene.oct");
    std::fs::write(&octree, Program::new("oconv").arg("-").feed(scene(lamp).as_bytes()).well("oconv").out)
        .expect("the scratch folder can be written");
    let at = |k: u32| 5.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 2.5;
    let points: Vec<[f64; 2]> = (0..SIDE * SIDE).map(|k| [at(k % SIDE), at(k / SIDE)]).collect();
    let lines: Vec<String> = points.iter().map(|[x, y]| format!("{x} {y} 0 0 0 1")).collect();
    let input = lines.join("\n") + "\n";
    let answer = Program::new("rtrace")
        .line("-h -w- -I -ab 0 -dj 0 -ds 0 -dt 0")
        .arg(&octree)
        .feed(input.as_bytes())
        .well("rtrace");
    let (mut dark, mut lit) = (0, 0);
    for (line, &p) in answer.text().lines().zip(&points) {
        let value: f64 = line.split_whitespace().next().and_then(|w| w.parse().ok()).expect("a number first");
        match shaded(p, |z| step(p, z)) {
            Some(true) => {
                assert!(value == 0.0, "{p:?} is shaded and gets {value}");
                dark += 1;
            }
            Some(false) => {
                assert!(value > 0.0, "{p:?} is in the light and gets none");
                lit += 1;
            }
            None => {}
        }
    }
    assert!(dark > 100 && lit > 1000, "{dark} points in shadow, {lit} in the light");
}

#[test]
fn a_lamp_is_hidden_by_what_stands_before_it_only() {
    // A sphere of 1 mm at height 3.
    holds("void light l 0 0 3 1e6 1e6 1e6\nl sphere lamp 0 0 4 .2 .1 3 .001\n", |[x, y], z| {
        [(0.2 - x) * z / 3.0, (0.1 - y) * z / 3.0]
    });
}

#[test]
fn the_sun_is_hidden_by_what_stands_before_it_only() {
    holds("void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 .4 -.3 1 .2\n", |_, z| [0.4 * z, -0.3 * z]);
}

/// Share of a lamp's light that gets through screens, given as primitives that the floor at the origin sees straight above.
fn through(screens: &str, options: &str) -> [f64; 3] {
    let light = |screens: &str| {
        let scene = format!("void light l 0 0 3 1e6 1e6 1e6\nl sphere lamp 0 0 4 0 0 3 .001\n{screens}");
        let scratch = tempfile::tempdir().expect("a scratch folder can be made");
        let octree = scratch.path().join("scene.oct");
        std::fs::write(&octree, Program::new("oconv").arg("-").feed(scene.as_bytes()).well("oconv").out)
            .expect("the scratch folder can be written");
        let answer = Program::new("rtrace")
            .line(&format!("-h -w- -I -ab 0 -dj 0 -ds 0 {options}"))
            .arg(&octree)
            .feed(b"0 0 0 0 0 1\n")
            .well("rtrace");
        let numbers: Vec<f64> = answer.text().split_whitespace().map(|w| w.parse().expect("a number")).collect();
        [numbers[0], numbers[1], numbers[2]]
    };
    let (bare, screened) = (light(""), light(screens));
    std::array::from_fn(|k| screened[k] / bare[k])
}

/// A screen at a height, its front towards the lamp or (`down`) the floor.
fn screen(material: &str, z: f64, down: bool) -> String {
    let (a, b) = if down { (1, -1) } else { (-1, 1) };
    format!("{material}\nm polygon s{z} 0 0 12 -1 {a} {z} 1 {a} {z} 1 {b} {z} -1 {b} {z}\n")
}

#[test]
fn panes_pass_what_all_their_reflections_leave() {
    let one = |tau: f64, n: f64| {
        let r = ((n - 1.0) / (n + 1.0)).powi(2);
        (1.0 - r).powi(2) * tau / (1.0 - (r * tau).powi(2))
    };
    let clear = "void glass m 0 0 3 .9 .9 .9";
    let tinted = "void glass m 0 0 4 .9 .5 .1 1.7";
    for down in [false, true] {
        let panes = screen(clear, 1.0, down) + &screen(tinted, 2.0, !down);
        let got = through(&panes, "");
        for (k, tau) in [0.9, 0.5, 0.1].into_iter().enumerate() {
            let expected = one(0.9, 1.52) * one(tau, 1.7);
            assert!((got[k] / expected - 1.0).abs() < 1e-5, "channel {k}: {} instead of {expected}", got[k]);
        }
        // A pattern or a black pane behind another.
        let printed = "void brightfunc p 2 .25 . 0 0\np glass m 0 0 3 .9 .9 .9";
        let got = through(&(screen(printed, 1.0, down) + &screen(clear, 2.0, down)), "");
        let expected = 0.25 * one(0.9, 1.52).powi(2);
        assert!((got[1] / expected - 1.0).abs() < 1e-5, "{} instead of {expected}", got[1]);
        assert_eq!(through(&(screen(clear, 1.0, down) + &screen("void glass m 0 0 3 0 0 0", 2.0, down)), ""), [0.0; 3]);
    }
    // Light from above meets the back of a pane that faces down: without back faces it is not there.
    assert_eq!(through(&screen(tinted, 1.0, false), "-bv-"), [1.0; 3]);
}

#[test]
fn translucent_screens_stop_beams_unless_they_pass_some_unscattered() {
    let veil = "void trans m 0 0 7 .8 .7 .6 0 0 .5 0";
    assert_eq!(through(&screen(veil, 1.0, false), ""), [0.0; 3]);
    assert_eq!(through(&screen(&veil.replace("6 0 0 .5 0", "6 0 .1 .5 .5"), 1.0, true), ""), [0.0; 3]);
    let got = through(&screen(&veil.replace(".5 0", ".5 .4"), 1.0, false), "");
    for (k, c) in [0.8, 0.7, 0.6].into_iter().enumerate() {
        assert!((got[k] / (c * 0.5 * 0.4) - 1.0).abs() < 1e-5, "channel {k}: {}", got[k]);
    }
    // Seen from behind without back faces it is not there.
    assert_eq!(through(&screen(veil, 1.0, false), "-bv-"), [1.0; 3]);
    assert_eq!(through(&screen(veil, 1.0, true), "-bv-"), [0.0; 3]);
}
