//! Rounds against the serial reference, and against themselves on other numbers of threads.

use super::room::Room;
use super::serial;
use crate::{Answer, Cache, Params};
use ambit_base::{DVec3, Rgb, hash_bits};

fn params(bounces: i32) -> Params {
    Params { bounces, divisions: 64, super_samples: 0, ..Params::default() }
}

/// What a run came to.
#[derive(Debug, PartialEq)]
struct Run {
    values: Vec<Rgb>,
    cache_hash: u64,
    records: usize,
    samples: u64,
}

impl Run {
    fn mean(&self) -> f32 {
        self.values.iter().map(|v| v.element_sum()).sum::<f32>() / (3 * self.values.len()) as f32
    }
}

fn hash(cache: &Cache) -> u64 {
    let mut words = Vec::new();
    for r in cache.records() {
        words.extend(r.position.to_array().map(f64::to_bits));
        words.extend(r.u.to_array().map(f64::to_bits));
        words.extend(r.value.to_array().map(|x| u64::from(x.to_bits())));
        for pair in [r.radii, r.gradient, r.rotation] {
            words.extend(pair.map(|x| u64::from(x.to_bits())));
        }
        words.extend([u64::from(r.corral), u64::from(r.level), u64::from(r.weight.to_bits())]);
    }
    hash_bits(&words)
}

fn rounds(params: Params, room: &Room, side: u32, threads: usize) -> Run {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
    let mut cache = Cache::new(params, DVec3::splat(-0.01), 1.02);
    let values = pool.install(|| cache.resolve(room, &room.pixels(side)));
    Run {
        values,
        cache_hash: hash(&cache),
        records: cache.records().len(),
        samples: cache.statistics().samples.iter().sum(),
    }
}

fn reference(params: Params, room: &Room, side: u32) -> Run {
    let mut cache = Cache::new(params, DVec3::splat(-0.01), 1.02);
    let mut samples = [0; 16];
    let pixels = room.pixels(side);
    cache.worth.expect(pixels.len());
    let values = pixels.iter().map(|m| serial::ask(&mut cache, room, &m.query, &mut samples).value).collect();
    Run { values, cache_hash: hash(&cache), records: cache.records().len(), samples: samples.iter().sum() }
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let room = Room::new();
    let mut glass = Room::new();
    glass.weight = 0.04;
    let coarse = |bounces| Params { accuracy: 0.4, ..params(bounces) };
    let extra = Params { divisions: 128, super_samples: 64, ..coarse(2) };
    let cases = [
        (params(1), &room, 20),
        (coarse(3), &room, 12),
        (coarse(5), &room, 1),
        (coarse(5), &room, 6),
        (extra, &room, 8),
        (coarse(2), &glass, 12),
    ];
    for (params, room, side) in cases {
        let alone = rounds(params, room, side, 1);
        assert!(alone.records > 1 && alone.mean() > 0.0);
        for threads in [2, 3, 8] {
            assert_eq!(alone, rounds(params, room, side, threads), "{params:?}, {side}², {threads} threads");
        }
    }
}

/// The four rooms that work is measured in.
fn rooms() -> [(&'static str, Room); 4] {
    [("empty", Room::empty()), ("blocks", Room::new()), ("divided", Room::divided()), ("blades", Room::hairy(150))]
}

/// Records and samples of the rounds over those of the serial cache, and means; says so.
fn compared(what: &str, params: Params, room: &Room, side: u32) -> [f64; 3] {
    let (ours, serial) = (rounds(params, room, side, 2), reference(params, room, side));
    let ratio = |a: u64, b: u64| a as f64 / b as f64;
    let ratios = [
        ratio(ours.records as u64, serial.records as u64),
        ratio(ours.samples, serial.samples),
        f64::from(ours.mean() / serial.mean()),
    ];
    println!(
        "| {what} | {side}² | {} | {} | {} | {:.3} | {} | {} | {:.3} | {:.3} |",
        params.bounces, params.overlap, serial.records, ratios[0], serial.samples, ours.samples, ratios[1], ratios[2]
    );
    ratios
}

#[test]
fn rounds_take_the_work_of_the_serial_cache() {
    let overlap = crate::OVERLAP;
    for (params, side) in [
        (params(1), 40),
        (params(3), 20),
        (Params { accuracy: 0.35, ..params(5) }, 16),
        (Params { overlap, ..params(2) }, 24),
    ] {
        let [records, samples, mean] = compared("blocks", params, &Room::new(), side);
        assert!((records - 1.0).abs() <= 0.05, "-ab {}: {records} of the records", params.bounces);
        assert!((samples - 1.0).abs() <= 0.05, "-ab {}: {samples} of the samples", params.bounces);
        assert!((mean - 1.0).abs() <= 0.03, "-ab {}: {mean} of the mean", params.bounces);
    }
}

/// The table of docs/irradiance-cache.md: `cargo test --profile tested -p ambit-ambient work_in_four_rooms -- --ignored
/// --nocapture`.
#[test]
#[ignore = "takes minutes; makes a table"]
fn work_in_four_rooms() {
    println!("| room | pixels | -ab | overlap | records, serial | ratio | samples, serial | rounds | ratio | mean |");
    for (name, room) in rooms() {
        for (bounces, side) in [(1, 64), (2, 32), (3, 32)] {
            for overlap in [0.0, crate::OVERLAP] {
                compared(name, Params { overlap, ..params(bounces) }, &room, side);
            }
        }
    }
}

#[test]
fn levels_and_weights_halve() {
    let room = Room::new();
    let mut cache = Cache::new(params(3), DVec3::splat(-0.01), 1.02);
    cache.resolve(&room, &room.pixels(8));
    for level in 0..3u8 {
        let of = cache.records().iter().filter(|r| r.level == level);
        assert!(of.clone().count() > 0);
        assert!(of.clone().all(|r| r.weight == 0.5f32.powi(i32::from(level))));
    }
    assert!(cache.records().iter().all(|r| r.level < 3));
}

#[test]
fn the_more_records_share_a_value_the_fewer_samples_each_has() {
    let room = Room::new();
    let samples = |accuracy: f64, side: u32| {
        let mut cache = Cache::new(Params { divisions: 1024, accuracy, ..params(2) }, DVec3::splat(-0.01), 1.02);
        cache.resolve(&room, &room.pixels(side));
        let deeper = cache.records().iter().filter(|r| r.level == 1).count();
        (deeper, cache.statistics().samples[1] as f64 / deeper as f64)
    };
    // Below one point the first ones have 256, the k-th 2048 k⁻·⁶, the last ones of many a quarter of 256; grids are square.
    let expected = |records: usize| {
        let sum: f64 = (1..=records).map(|k| (2048.0 * (k as f64).powf(-0.6)).clamp(64.0, 256.0)).sum();
        sum / records as f64
    };
    let (many, few) = (samples(0.1, 1), samples(0.6, 1));
    assert!(many.0 > 5 * few.0, "{many:?}, {few:?}");
    for (records, mean) in [many, few] {
        assert!((mean / expected(records) - 1.0).abs() < 0.03, "{mean} for {} of {records}", expected(records));
    }
    // More points that they serve are worth more.
    let (one, all) = (samples(0.3, 1), samples(0.3, 12));
    assert!(all.0 > 3 * one.0 && all.1 > 1.4 * one.1, "{all:?}, of one point {one:?}");
}

#[test]
fn asking_again_makes_no_records() {
    let room = Room::new();
    let mut cache = Cache::new(params(2), DVec3::splat(-0.01), 1.02);
    let pixels = room.pixels(16);
    cache.resolve(&room, &pixels);
    let made = cache.records().len();
    let missed = |cache: &Cache| pixels.iter().filter(|m| cache.ask(&room, &m.query) == Answer::Miss).count();
    assert_eq!(missed(&cache), 0, "the same points");
    // Another run that starts with the records of the first.
    let mut second = Cache::new(params(2), DVec3::splat(-0.01), 1.02);
    assert_eq!(second.load(cache.records().to_vec()), 0);
    assert_eq!(missed(&second), 0, "a second run");
    assert_eq!(second.load(cache.records().to_vec()), made, "duplicates are dropped");
}

#[test]
fn places_of_records_are_smoothed_like_others() {
    // Who asks again gets what it got, also where records were made; unless values are those of hemispheres alone.
    let room = Room::new();
    let pixels = room.pixels(16);
    let changed = |smoothing: f32| {
        let params = Params { overlap: crate::OVERLAP, smoothing, ..params(1) };
        let mut cache = Cache::new(params, DVec3::splat(-0.01), 1.02);
        let values = cache.resolve(&room, &pixels);
        let again = pixels.iter().map(|m| cache.ask(&room, &m.query));
        let same = |(value, again): (&Rgb, Answer)| matches!(again, Answer::Value(light) if light.value == *value);
        values.iter().zip(again).filter(|pair| !same((pair.0, pair.1))).count()
    };
    let (smooth, plain) = (changed(1.25), changed(1.0));
    assert!(smooth == 0 && plain > 0, "{smooth} and {plain} of {} differ", pixels.len());
}

#[test]
fn a_point_beside_a_wall_is_answered_by_its_own_record() {
    let room = Room::new();
    let mut cache = Cache::new(params(2), DVec3::splat(-0.01), 1.02);
    let mut miss = room.pixels(1)[0];
    let eye = |cache: &Cache| cache.records().iter().filter(|r| r.level == 0).count();
    for distance in [0.05, 1e-3, 1e-5] {
        miss.query.position = DVec3::new(distance, 0.5, 0.0);
        miss.query.normal = DVec3::Z;
        miss.query.shading = DVec3::Z;
        let before = eye(&cache);
        cache.resolve(&room, &[miss; 10]);
        let made = eye(&cache);
        assert_eq!(made, before + 1, "{distance} from the wall");
        assert!(matches!(cache.ask(&room, &miss.query), Answer::Value(_)), "{distance} from the wall");
    }
}

#[test]
fn what_a_file_brought_is_not_thickened_between_its_places() {
    let room = Room::new();
    let params = Params { overlap: crate::OVERLAP, ..params(2) };
    let empty = || Cache::new(params, DVec3::splat(-0.01), 1.02);
    let added = |cache: &mut Cache, side: u32| {
        let before = cache.records().len();
        let missed: Vec<_> =
            room.pixels(side).into_iter().filter(|m| cache.ask(&room, &m.query) == Answer::Miss).collect();
        cache.resolve(&room, &missed);
        cache.records().len() - before
    };
    let mut own = empty();
    added(&mut own, 24);
    let mut read = empty();
    assert_eq!(read.load(own.records().iter().cloned()), 0);
    assert_eq!(added(&mut read, 24), 0, "the same places need nothing");
    let (thickened, added) = (added(&mut own, 37), added(&mut read, 37));
    assert!(3 * added < 2 * thickened, "{added} records are added to those of a file, {thickened} to one's own");
}
