//! Neighbour clamping and classical spacing in a room with blocks: what is stored, whatever the number of threads.

use super::interpolation::record;
use super::room::Room;
use crate::file::Habits;
use crate::{Cache, Clamping, Params, Record, Spacing, Systems};
use ambit_base::DVec3;

fn filled(systems: Systems, threads: usize) -> Vec<Record> {
    let params = Params { bounces: 2, divisions: 64, super_samples: 0, accuracy: 0.4, systems, ..Params::default() };
    let mut cache = Cache::new(params, DVec3::splat(-0.01), 1.02);
    let room = Room::new();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    let values = pool.install(|| cache.resolve(&room, &room.pixels(24)));
    assert!(values.iter().all(|v| v.is_finite()));
    cache.records().to_vec()
}

/// The most by which a radius exceeds another one plus so many times the distance, over the radius; radii before widening, of
/// records from a level on.
fn excess(records: &[Record], level: u8, slope: f64) -> f64 {
    let radius = |r: &Record| f64::from(r.radii[0]) * f64::from(r.weight).sqrt();
    let over = |a: &Record, b: &Record| (radius(a) - radius(b) - slope * a.position.distance(b.position)) / radius(a);
    let held: Vec<&Record> = records.iter().filter(|r| r.level >= level).collect();
    held.iter().flat_map(|a| held.iter().map(|b| over(a, b))).fold(0.0, f64::max)
}

#[test]
fn no_radius_exceeds_a_neighbours_by_more_than_the_distance() {
    for spacing in [Spacing::Hessian, Spacing::Classical] {
        let free = Systems { spacing, ..Systems::default() };
        let clamped = filled(Systems { clamping: Clamping::All, ..free }, 1);
        assert!(clamped.iter().all(|r| r.is_plausible() && r.radii[1] <= 2.0 * r.radii[0] * 1.0001));
        let without = filled(free, 1);
        let [with, free] = [&clamped, &without].map(|records| excess(records, 0, 1.0));
        assert!(with < 1e-5 && free > 0.1, "{with} {free}");
        assert!(clamped.len() > without.len());
        // By themselves those of the second bounce differ by twice the distance at most, and there are some that do.
        let [most, once] = [2.0, 1.0].map(|slope| excess(&without, 1, slope));
        assert!(most < 1e-5 && once > 0.1, "{most} {once}");
    }
}

#[test]
fn records_do_not_depend_on_threads() {
    for spacing in [Spacing::Hessian, Spacing::Classical] {
        for clamping in [Clamping::Nobody, Clamping::Deeper, Clamping::All] {
            let systems = Systems { clamping, spacing, ..Systems::default() };
            let one = filled(systems, 1);
            assert!(one.len() > 100 && one == filled(systems, 3), "{systems:?}");
        }
    }
}

fn wide_and_narrow() -> [Record; 2] {
    let wide = Record { level: 1, weight: 0.5, radii: [4.0, 4.0], ..record() };
    [wide.clone(), Record { position: DVec3::new(0.1, 0.0, 0.0), radii: [0.05, 0.05], ..wide }]
}

fn empty() -> Cache {
    Cache::new(Params { bounces: 2, accuracy: 0.2, ..Params::default() }, DVec3::splat(-2.0), 4.0)
}

#[test]
fn a_record_that_was_reined_in_is_known_again() {
    let [wide, narrow] = wide_and_narrow();
    let mut cache = empty();
    assert_eq!(cache.load([wide.clone(), narrow.clone(), wide, narrow]), 2, "either is there already");
}

#[test]
fn records_of_others_files_are_left_free() {
    let radii = |habits: Option<Habits>| {
        let mut cache = empty();
        if let Some(habits) = habits {
            cache.adopt(habits);
        }
        assert_eq!(cache.load(wide_and_narrow()), 0);
        cache.records()[0].radii[0]
    };
    let held = radii(None);
    // What 0.05 was before it was widened for its weight, and twice the distance.
    assert!((f64::from(held) * 0.5f64.sqrt() - (0.05 * 0.5f64.sqrt() + 0.2)).abs() < 1e-6, "{held}");
    assert_eq!(radii(Some(Habits { smoothing: 1.0, ours: true })), held);
    assert_eq!(radii(Some(Habits { smoothing: 1.0, ours: false })), 4.0);
}
