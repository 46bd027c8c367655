//! Which records answer which queries.

use crate::store::{ENOUGH, Store};
use crate::{
    Cache, Habits, Interpolation, Limits, Miss, Params, Query, Record, Sample, SampleRay, Sampler, StepTest, Systems,
};
use ambit_base::{DVec3, Rgb, Stream};

/// Nothing but a wall in the plane x = `.0`.
struct Wall(f64);

impl Sampler for Wall {
    type Origin = ();
    type Scratch<'a>
        = ()
    where
        Self: 'a;

    fn scratch(&self) {}

    fn sample(&self, (): &mut (), _: &Cache, _: &Query<()>, _: &SampleRay, _: &mut Vec<Miss<()>>) -> Option<Sample> {
        None
    }

    fn occluded(&self, _: &Query<()>, from: DVec3, direction: DVec3) -> bool {
        let t = (self.0 - from.x) / direction.x;
        t > 0.0 && t < 1.0
    }
}

const OPEN: Wall = Wall(f64::INFINITY);

fn limits() -> Limits {
    Limits::new(&Params { resolution: 64, ..Params::default() }, 4.0)
}

/// A record at the origin that looks up.
pub(super) fn record() -> Record {
    Record {
        position: DVec3::ZERO,
        normal: DVec3::Z,
        u: DVec3::X,
        level: 0,
        weight: 1.0,
        radii: [0.5, 0.8],
        gradient: [0.0; 2],
        rotation: [0.0; 2],
        corral: 0,
        value: Rgb::ONE,
        further: Box::default(),
        late: Box::default(),
    }
}

fn query(x: f64, y: f64, z: f64) -> Query<()> {
    Query {
        position: DVec3::new(x, y, z),
        normal: DVec3::Z,
        shading: DVec3::Z,
        weight: 1.0,
        level: 0,
        pass: 0,
        origin: (),
    }
}

fn answer(records: &[Record], wall: &Wall, query: &Query<()>) -> Option<Rgb> {
    answer_within(&limits(), records, wall, query)
}

fn answer_within(limits: &Limits, records: &[Record], wall: &Wall, query: &Query<()>) -> Option<Rgb> {
    let mut store = Store::new(DVec3::splat(-2.0), 4.0, 1, false);
    for r in records {
        assert!(store.insert(r, limits, false));
    }
    store.lookup(limits, wall, query).answer().map(|light| light.value)
}

fn accepts(record: &Record, query: &Query<()>) -> bool {
    answer(std::slice::from_ref(record), &OPEN, query).is_some()
}

fn tilted(degrees: f64) -> DVec3 {
    let (s, c) = degrees.to_radians().sin_cos();
    DVec3::new(s, 0.0, c)
}

#[test]
fn the_ellipse_bounds_the_reach() {
    let r = record();
    // Reach 0.1 along u, 0.16 along v; off the plane a tenth of the distance along it, and R₋a = 0.0125 behind it.
    for (x, y, z, expected) in [
        (0.099, 0.0, 0.0, true),
        (0.101, 0.0, 0.0, false),
        (0.0, -0.159, 0.0, true),
        (0.0, 0.161, 0.0, false),
        (0.08, 0.12, 0.0, false),
        (0.09, 0.0, 0.0089, true),
        (0.09, 0.0, 0.0091, false),
        (0.0, -0.13, -0.0124, true),
        (0.0, -0.13, -0.0126, false),
        (0.0, 0.0, 0.001, false),
    ] {
        assert_eq!(accepts(&r, &query(x, y, z)), expected, "({x}, {y}, {z})");
    }
}

#[test]
fn steps_part_surfaces_and_curves_do_not_at_any_scale_and_place() {
    let far = DVec3::new(1e6, -1e6, 1e6);
    for (scale, centre) in
        [(1e-4, DVec3::ZERO), (1.0, DVec3::ZERO), (1e5, DVec3::ZERO), (1.0, far * 0.1), (1e2, far), (1e5, far)]
    {
        let limits = Limits { min_radius: scale, ..limits() };
        let r = Record { position: centre, radii: [(0.5 * scale) as f32; 2], ..record() };
        let mut store = Store::new(centre - DVec3::splat(2.0 * scale), 4.0 * scale, 1, false);
        assert!(store.insert(&r, &limits, false));
        let accepts = |place: DVec3, normal: DVec3| {
            let q = Query { position: centre + place * scale, normal, shading: normal, ..query(0.0, 0.0, 0.0) };
            store.lookup(&limits, &OPEN, &q).answer().is_some()
        };
        for step in [-0.005, 0.005] {
            for (along, expected) in [(0.0, false), (0.045, false), (0.055, true)] {
                let place = DVec3::new(0.6 * along, 0.8 * along, step);
                assert_eq!(accepts(place, DVec3::Z), expected, "{step} off at {along}, {scale} {centre}");
            }
        }
        for (radius, degrees) in [(0.2f64, 20.0f64), (0.5, 8.0), (10.0, 0.5), (1e-3, 20.0)] {
            let (s, c) = degrees.to_radians().sin_cos();
            assert!(
                accepts(DVec3::new(s, 0.0, c - 1.0) * radius, DVec3::new(s, 0.0, c)),
                "ball, {radius} {scale} {centre}"
            );
            assert!(
                accepts(DVec3::new(s, 0.0, 1.0 - c) * radius, DVec3::new(-s, 0.0, c)),
                "bowl, {radius} {scale} {centre}"
            );
        }
    }
}

#[test]
fn records_answer_over_steps_where_asked_to_and_in_files_that_radiance_began() {
    let answers = |step_test, habits: Option<Habits>| {
        let systems = Systems { step_test, ..Systems::default() };
        let mut cache = Cache::new(Params { systems, ..Params::default() }, DVec3::splat(-2.0), 4.0);
        if let Some(habits) = habits {
            cache.adopt(habits);
        }
        assert_eq!(cache.load([record()]), 0);
        // Off the plane straight above, and a little aside.
        let found = [0.0, 0.01].map(|x| cache.lookup(&OPEN, &query(x, 0.0, 0.09)).is_some());
        assert_eq!(found[0], found[1]);
        found[0]
    };
    let begun = |ours| Some(Habits { smoothing: 1.0, ours });
    assert!(!answers(StepTest::On, None) && !answers(StepTest::On, begun(true)));
    assert!(answers(StepTest::On, begun(false)) && answers(StepTest::Off, None) && answers(StepTest::Off, begun(true)));
}

#[test]
fn normals_may_differ_by_the_angle_limit() {
    for (weight, degrees, expected) in
        [(1.0, 21.3, true), (1.0, 21.7, false), (0.5, 27.3, true), (0.5, 27.8, false), (0.01, 52.0, true)]
    {
        let q = Query { normal: tilted(degrees), shading: tilted(degrees), weight, ..query(0.0, 0.0, 0.0) };
        assert_eq!(accepts(&record(), &q), expected, "{degrees}° at weight {weight}");
    }
    let back = Query { normal: DVec3::NEG_Z, shading: DVec3::NEG_Z, ..query(0.0, 0.0, 0.0) };
    assert!(!accepts(&record(), &back));
}

#[test]
fn levels_and_weights_decide() {
    let at = |level, weight| Record { level, weight, ..record() };
    let ask = |level, weight| Query { weight, level, ..query(0.0, 0.0, 0.0) };
    assert!(accepts(&at(0, 1.0), &ask(2, 0.25)), "a lower level serves");
    assert!(!accepts(&at(1, 0.5), &ask(0, 1.0)), "a deeper level does not");
    assert!(accepts(&at(1, 0.5), &ask(1, 0.55)));
    assert!(!accepts(&at(1, 0.5), &ask(1, 0.56)), "the weight must be 0.9 of the query's");
    assert!(accepts(&at(1, 0.01), &ask(2, 0.9)), "but not on lower levels");
}

#[test]
fn weights_are_products_of_hats() {
    // Two records at the ends: at 0.03 from one and 0.06 from the other along u the weights are 0.7 and 0.4.
    let a = Record { value: Rgb::new(1.0, 0.0, 2.0), ..record() };
    let b = Record { position: DVec3::new(0.09, 0.0, 0.0), value: Rgb::new(0.0, 1.0, 4.0), ..record() };
    let v = answer(&[a.clone(), b], &OPEN, &query(0.03, 0.0, 0.0)).unwrap();
    let expected = Rgb::new(0.7, 0.4, 3.0) / 1.1;
    assert!((v - expected).abs().max_element() < 1e-5, "{v}");
    // Angle: half of the limit gives half the weight.
    let half = 0.5 * limits().max_angle;
    let n = tilted(2.0 * (half / 2.0).asin().to_degrees());
    let tilted = Record { normal: n, u: DVec3::Y, value: Rgb::new(0.0, 1.0, 0.0), ..record() };
    let v = answer(&[a, tilted], &OPEN, &query(0.0, 0.0, 0.0)).unwrap();
    assert!((v.x / v.y - 2.0).abs() < 1e-4, "{v}");
}

#[test]
fn extrapolation_follows_gradients_and_is_limited() {
    let value = |r: Record, q: &Query<()>| answer(&[r], &OPEN, q).map(|v| v.x);
    let near = |got: Option<f32>, expected: f32| {
        assert!(got.is_some_and(|v| (v - expected).abs() < 1e-5), "{got:?} instead of {expected}");
    };
    near(value(Record { gradient: [2.0, -1.0], ..record() }, &query(0.05, 0.1, 0.0)), 1.0);
    near(value(Record { gradient: [2.0, 1.0], ..record() }, &query(0.05, 0.1, 0.0)), 1.2);
    near(value(Record { gradient: [1000.0, 0.0], ..record() }, &query(0.05, 0.0, 0.0)), 20.0);
    assert_eq!(value(Record { gradient: [-1000.0, 0.0], ..record() }, &query(0.05, 0.0, 0.0)), None);
    // At the record's own place even the steepest extrapolation is better than another record.
    near(value(Record { gradient: [-1e6, 0.0], ..record() }, &query(0.001, 0.0, 0.0)), 0.05);
    // Turning towards +x means turning about +y = v.
    let bump = tilted(10.0);
    let q = Query { shading: bump, ..query(0.0, 0.0, 0.0) };
    near(value(Record { rotation: [0.0, 1.0], ..record() }, &q), 1.0 + 10f32.to_radians().sin());
}

#[test]
fn the_corral_is_probed_in_its_azimuths_only() {
    let fenced = Record { corral: 0b11 | 1 << 31, ..record() };
    let ask = |x: f64, y: f64, wall| answer(std::slice::from_ref(&fenced), &Wall(wall), &query(x, y, 0.0)).is_some();
    assert!(ask(0.09, 0.0, 5.0), "a flagged azimuth without an occluder");
    assert!(!ask(0.09, 0.0, 0.05), "a flagged azimuth with a wall between");
    assert!(ask(-0.09, 0.0, -0.05), "an azimuth without flag");
    assert!(ask(0.0, 0.0, 0.05) && ask(1e-6, 0.0, 5e-7), "the record's own place");
}

#[test]
fn records_smooth_a_little_beyond_their_reach() {
    // The reach along u is 0.1; at 0.11 from one and 0.03 from the other. Hats over 1.25 times the reach weigh 0.12 and 0.76.
    let smooth = Limits { smoothing: 1.25, ..limits() };
    let a = Record { value: Rgb::new(1.0, 0.0, 2.0), ..record() };
    let b = Record { position: DVec3::new(0.14, 0.0, 0.0), value: Rgb::new(0.0, 1.0, 4.0), ..record() };
    let q = query(0.11, 0.0, 0.0);
    let of = |share: f32| a.value * share + b.value * (1.0 - share);
    let near = |found: Option<Rgb>, v: Rgb| found.is_some_and(|f| (f - v).abs().max_element() < 1e-5);
    let ask = |records: &[Record], limits: &Limits, q: &Query<()>| answer_within(limits, records, &OPEN, q);
    assert!(near(ask(&[a.clone(), b.clone()], &smooth, &q), of(0.12 / 0.88)));
    assert!(near(ask(&[a.clone(), b.clone()], &limits(), &q), b.value), "as in Radiance");
    assert!(ask(std::slice::from_ref(&a), &smooth, &q).is_none(), "it alone is no answer");
    let deep = |r: &Record| Record { level: 1, ..r.clone() };
    let deeper = Query { level: 1, ..q };
    assert!(near(ask(&[deep(&a), deep(&b)], &smooth, &deeper), b.value), "deeper questions are not smoothed");
}

/// Mean and RMS error of answers around the origin to records on a lattice of the given spacing, each jittered by up to
/// a quarter of it, of the value and gradient that `field` has there.
fn errors(interpolation: Interpolation, spacing: f64, field: impl Fn(f64, f64) -> (f64, [f64; 2])) -> (f64, f64) {
    let limits = Limits { interpolation, ..limits() };
    let record_at = |i: i32, j: i32| {
        let [x, y] = Stream::new((i + 20) as u32, (j + 20) as u64).two().map(|r| 0.5 * spacing * (r - 0.5));
        let (x, y) = (f64::from(i) * spacing + x, f64::from(j) * spacing + y);
        let (value, gradient) = field(x, y);
        let position = DVec3::new(x, y, 0.0);
        let gradient = gradient.map(|g| (g / value) as f32);
        Record { position, value: Rgb::splat(value as f32), gradient, radii: [0.8; 2], ..record() }
    };
    let records: Vec<_> = (-9..=9).flat_map(|i| (-9..=9).map(move |j| record_at(i, j))).collect();
    let errors: Vec<f64> = (0..400)
        .map(|k| {
            let [x, y] = Stream::new(k, 1).two().map(|r| 4.0 * spacing * (r - 0.5));
            let found = answer_within(&limits, &records, &OPEN, &query(x, y, 0.0)).expect("the lattice covers it");
            f64::from(found.x) - field(x, y).0
        })
        .collect();
    let mean = |f: fn(f64) -> f64| errors.iter().copied().map(f).sum::<f64>() / errors.len() as f64;
    (mean(|e| e), mean(|e| e * e).sqrt())
}

#[test]
fn linear_functions_are_met_and_quadratic_ones_by_the_second_order() {
    for interpolation in [Interpolation::First, Interpolation::Second] {
        let (mean, rms) = errors(interpolation, 0.1, |x, y| (2.0 + 0.5 * x - 0.8 * y, [0.5, -0.8]));
        assert!(mean.abs() < 1e-6 && rms < 1e-6, "{interpolation:?}: {mean} {rms}");
    }
    let dome = |x: f64, y: f64| (2.0 - 2.0 * x * x - y * y, [-4.0 * x, -2.0 * y]);
    // Tangents lie above a dome, at a mean by 3 squares of the distance along an axis.
    let (above, first) = errors(Interpolation::First, 0.06, dome);
    assert!(above > 0.9 * first && (0.003..0.02).contains(&first), "{above} {first}");
    let (mean, second) = errors(Interpolation::Second, 0.06, dome);
    assert!(second < 0.1 * first && mean.abs() < 0.05 * above, "{mean} {second} of {first}");
    // As the lattice is thinned to few records in reach, what is left grows towards the first order's.
    let (_, first) = errors(Interpolation::First, 0.12, dome);
    let (_, second) = errors(Interpolation::Second, 0.12, dome);
    assert!(second < 0.4 * first, "{second} of {first}");
}

#[test]
fn where_one_record_answers_both_orders_are_the_same() {
    let mut met = 0;
    // Turned normals by themselves may leave next to nothing of the light, or many times of it.
    for (rotation, gradient) in [([0.3, 0.4], 3.0), ([9.0, 0.0], 9.0), ([-9.0, 0.0], 9.0), ([-150.0, 0.0], 3.0)] {
        for (x, y) in [(0.05, 0.02), (-0.06, 0.05), (0.01, -0.03)] {
            let steep = Record { gradient: [gradient, -2.0], rotation, ..record() };
            let q = Query { shading: DVec3::new(0.1, 0.2, 1.0).normalize(), ..query(x, y, 0.0) };
            let [first, second] = [Interpolation::First, Interpolation::Second].map(|interpolation| {
                answer_within(&Limits { interpolation, ..limits() }, std::slice::from_ref(&steep), &OPEN, &q)
                    .map(|v| v.x)
            });
            let (first, second) = (first.unwrap_or(0.0), second.unwrap_or(0.0));
            assert!((first - second).abs() <= 3e-6 * first, "{rotation:?} {gradient} at {x} {y}: {first} {second}");
            met += usize::from(first > 0.0);
        }
    }
    assert!(met >= 8, "{met}");
}

#[test]
fn positions_outside_the_cube_are_found() {
    let outside = DVec3::new(2.5, -7.0, 0.3);
    let r = Record { position: outside, ..record() };
    let q = Query { position: outside + DVec3::new(0.02, 0.05, 0.0), ..query(0.0, 0.0, 0.0) };
    assert!(accepts(&r, &q));
}

#[test]
fn every_record_in_reach_is_found_if_need_be() {
    // Records of many radii, compared with a search through all of them. Without early-out: tolerance × cell > R₋ fails
    // for the smallest cells only, so the limits are widened until it never holds.
    let wide = Limits { min_radius: 4.0, ..limits() };
    let mut store = Store::new(DVec3::splat(-2.0), 4.0, 1, false);
    let number = |k: u32, tag| Stream::new(k, tag).one();
    // Uneven floors, between which steps part what they part.
    let floor = |z: f64| ((8.0 * z).floor() + 0.01 * (8.0 * z).fract()) / 8.0;
    let records: Vec<Record> = (0..3000)
        .map(|k| {
            let p = DVec3::new(number(k, 1), number(k, 2), floor(number(k, 3))) * 4.0 - 2.0;
            let radius = 0.02f32 * 100f32.powf(number(k, 4) as f32);
            let level = (number(k, 5) * 3.0) as u8;
            Record {
                position: p,
                radii: [radius, radius],
                level,
                weight: 0.5f32.powi(i32::from(level)),
                value: Rgb::splat(k as f32),
                ..record()
            }
        })
        .collect();
    for r in &records {
        assert!(store.insert(r, &limits(), false));
    }
    let (mut answered, mut some) = (0, 0);
    for k in 0..2000 {
        let p = DVec3::new(number(k, 11), number(k, 12), floor(number(k, 13))) * 4.0 - 2.0;
        let q =
            Query { position: p, level: (k % 3) as u8, weight: 0.5f32.powi((k % 3) as i32), ..query(0.0, 0.0, 0.0) };
        let (mut weight, mut sum, mut least, mut most) = (0.0, 0.0, f64::INFINITY, 0.0f64);
        for r in records.iter().filter(|r| r.level <= q.level) {
            let d = q.position - r.position;
            let distance = d.length() / f64::from(r.radii[0]);
            if distance < 0.2 && d.z.abs() < 0.1 * d.x.hypot(d.y) {
                weight += 1.0 - distance / 0.2;
                let value = f64::from(r.value.x);
                sum += (1.0 - distance / 0.2) * value;
                (least, most) = (least.min(value), most.max(value));
            }
        }
        let found = store.lookup(&wide, &OPEN, &q);
        answered += usize::from(found.answer().is_some());
        match found.answer() {
            Some(light) => {
                let (v, own) = (f64::from(light.value.x), f64::from(found.weight));
                let (expected, near) = (sum / weight, |a: f64, b: f64| (a - b).abs() < 1e-2 * (1.0 + b));
                // Some of them are enough for hemisphere samples.
                let all = q.level == 0 || weight < f64::from(ENOUGH);
                assert!(
                    if all { near(v, expected) } else { (v > least || near(v, least)) && (v < most || near(v, most)) },
                    "{v}, not {expected}"
                );
                assert!(
                    own < weight + 1e-3 && (!all || own > weight - 1e-3) && own > f64::from(ENOUGH).min(weight) - 1e-3
                );
                some += usize::from(own < weight - 1e-3);
            }
            None => assert!(weight < 1e-5, "{weight}"),
        }
    }
    assert!(answered > 500 && some > 100, "{answered}, {some}");
}
