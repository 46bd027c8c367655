//! The serial lazy cache: each question is answered before the next is asked, as Radiance does.

use super::room::Room;
use crate::fill::key;
use crate::finish::{Cell, Outcome, finish, mean};
use crate::hemisphere::Hemisphere;
use crate::params::Params;
use crate::supersample::allocate;
use crate::{Cache, Light, Query};
use ambit_base::{Colour, Stream};

/// Answers a question, computing records on the way; counts the samples of each level.
pub(crate) fn ask(cache: &mut Cache, room: &Room, query: &Query<()>, samples: &mut [u64]) -> Light {
    if cache.ends_at(query.level) {
        return cache.fallback().into();
    }
    if let Some(value) = cache.lookup(room, query) {
        return value;
    }
    let params = *cache.params();
    let share = cache.worth.share(query.level, Params::record_weight(query.level, query.weight), 0);
    let stream = Stream::new(0, key(query, params.seed));
    let plan = Hemisphere::new(&params, share, 1.0, query.normal, stream, true).expect("there are divisions");
    let mut look = |cache: &mut Cache, direction, number| {
        let (mut sample, question) = room.look(query, direction, plan.child_weight(), plan.stream(number));
        samples[usize::from(query.level)] += 1;
        if let Some(miss) = question {
            sample.light += ask(cache, room, &miss.query, samples).times(miss.coefficient);
        }
        sample
    };
    let mut cells: Vec<Cell> = (0..plan.len())
        .map(|k| {
            let s = look(cache, plan.direction(k), k);
            Cell { light: s.light, distance: s.distance, nearness: 1.0 / s.distance, normal: s.normal }
        })
        .collect();
    let brightness: Vec<f32> = cells.iter().map(|c| c.light.value.brightness()).collect();
    let counts = allocate([plan.grid().rows(), plan.grid().columns()], &brightness, plan.extra(), |c| plan.share(c));
    let mut number = plan.len();
    for (cell, &count) in counts.iter().enumerate() {
        let mut sum = cells[cell].light;
        for k in 0..count {
            let s = look(cache, plan.frame().to_world(plan.extra_local(cell, k)), number);
            number += 1;
            sum += s.light;
            cells[cell].nearness = cells[cell].nearness.max(1.0 / s.distance);
        }
        cells[cell].light = sum * (1.0 / (count + 1) as f32);
    }
    let light = cache.ending(query.level, mean(cells.iter()));
    match finish(&cache.limits, query, &plan, &cells, &[light]) {
        Outcome::Record(record, value, survey) => {
            cache.insert(record, survey, false);
            value
        }
        Outcome::Once(value) => value,
        Outcome::Nothing => cache.fallback().into(),
    }
}
