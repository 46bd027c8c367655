//! Counting changes nothing, and counts the same on any number of threads.

use super::room::Room;
use crate::{Answer, Cache, Interpolation, Light, Observed, Params, Systems};
use ambit_base::{Colour, DVec3, Rgb};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// A clock that goes on by a second whenever it is read.
fn tick() -> Duration {
    static SECONDS: AtomicU64 = AtomicU64::new(0);
    Duration::from_secs(SECONDS.fetch_add(1, Ordering::Relaxed))
}

fn observed(observe: bool, threads: usize) -> (Vec<Answer>, Option<Observed>, f64) {
    // Records taken one by one extrapolate, each by itself.
    let systems = Systems { interpolation: Interpolation::First, ..Systems::default() };
    let params = Params { bounces: 2, divisions: 64, super_samples: 0, systems, ..Params::default() };
    let room = Room::new();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
    pool.install(|| {
        let mut cache = Cache::new(params, DVec3::splat(-0.01), 1.02);
        if observe {
            cache.observe(tick);
        }
        let pixels = room.pixels(40);
        cache.resolve(&room, &pixels);
        // Hemispheres within hemispheres are not measured again.
        let seconds = cache.filling().as_secs();
        assert!(if observe { (1..10).contains(&seconds) } else { seconds == 0 }, "{seconds}");
        let answers: Vec<Answer> = pixels.iter().map(|m| cache.ask(&room, &m.query)).collect();
        // The records taken one by one make up what the look-up sums at once.
        for (m, answer) in pixels.iter().zip(&answers) {
            let parts = cache.store.contributions(cache.limits(), &room, &m.query);
            let weight: f32 = parts.iter().map(|p| p.0).sum();
            let mean = parts.iter().map(|p| p.1 * p.0).sum::<Rgb>() / weight;
            if let (Answer::Value(Light { value, .. }), true) = (answer, weight > 1e-5) {
                assert!((mean - *value).abs().max_element() <= 1e-4 * value.max_element(), "{mean} {value}");
            }
        }
        // How far bright records outweigh others where errors are told relative to the mean.
        let deeper = cache.records().iter().filter(|r| r.level == 1);
        let brightness: Vec<f64> = deeper.map(|r| f64::from(r.value.brightness())).collect();
        let mean = brightness.iter().sum::<f64>() / brightness.len() as f64;
        let square = brightness.iter().map(|b| b * b).sum::<f64>() / brightness.len() as f64;
        (answers, cache.observed(), square.sqrt() / mean)
    })
}

#[test]
fn counting_changes_nothing_and_does_not_depend_on_threads() {
    let (plain, none, _) = observed(false, 1);
    assert_eq!(none, None);
    let (one, counts, spread) = observed(true, 1);
    assert_eq!(plain, one);
    assert_eq!(observed(true, 3), (one.clone(), counts, spread));
    let counts = counts.expect("it was asked for");
    let answered = one.iter().filter(|a| matches!(a, Answer::Value(_))).count() as u64;
    // At level 0 only the questions above were asked; the hemispheres asked at level 1.
    assert_eq!((counts.asked[0], counts.answered[0]), (one.len() as u64, answered));
    assert!(counts.asked[1] > 1000 && counts.answered[1] > 0 && counts.asked[2] == 0, "{counts:?}");
    let (compared, difference, error) = (counts.compared[1], counts.difference[1], counts.error[1]);
    assert!(compared > 20 && error > 0.0 && error < difference, "{counts:?}");
    assert!(counts.compared[0] > 0 && counts.compared[2..] == [0; 6], "{counts:?}");
    // A record of the fewest samples, 25 at level 1, errs by some 1/√25, and that is what those that answer together differ by:
    // extrapolation and the levels that they are of add little.
    assert!(difference < 1.1 / 5.0 * spread, "{counts:?} {spread}");
}
