//! Neighbour clamping and classical spacing in a room with blocks: what is stored, whatever the number of threads.

use super::room::Room;
use crate::{Cache, Params, Record, Spacing, Systems};
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

/// The most by which a radius exceeds another one plus the distance, over the radius; radii before widening.
fn excess(records: &[Record]) -> f64 {
    let radius = |r: &Record| f64::from(r.radii[0]) * f64::from(r.weight).sqrt();
    let over = |a: &Record, b: &Record| (radius(a) - radius(b) - a.position.distance(b.position)) / radius(a);
    records.iter().flat_map(|a| records.iter().map(move |b| over(a, b))).fold(0.0, f64::max)
}

#[test]
fn no_radius_exceeds_a_neighbours_by_more_than_the_distance() {
    for spacing in [Spacing::Hessian, Spacing::Classical] {
        let free = Systems { spacing, ..Systems::default() };
        let clamped = filled(Systems { neighbour_clamping: true, ..free }, 1);
        assert!(clamped.iter().all(|r| r.is_plausible() && r.radii[1] <= 2.0 * r.radii[0] * 1.0001));
        let without = filled(free, 1);
        assert!(excess(&clamped) < 1e-5 && excess(&without) > 0.1, "{} {}", excess(&clamped), excess(&without));
        assert!(clamped.len() > without.len());
    }
}

#[test]
fn records_do_not_depend_on_threads() {
    for spacing in [Spacing::Hessian, Spacing::Classical] {
        for neighbour_clamping in [false, true] {
            let systems = Systems { neighbour_clamping, spacing, ..Systems::default() };
            let one = filled(systems, 1);
            assert!(one.len() > 100 && one == filled(systems, 3), "{systems:?}");
        }
    }
}
