//! The pilot of a list of rays (`--error`): some of them, spread evenly.

use super::input::RayReader;
use super::stream::Stream;
use crate::goal::{self, Goal, RAYS};
use crate::light::{Light, Scene};
use crate::session::{Session, Stop};
use ambit_base::DVec3;
use ambit_cli::RayOptions;
use ambit_render::picture::Batches;
use ambit_render::{Options, Request};

/// Chooses the settings for all rays of `input`.
pub(super) fn choose(
    session: &Session,
    options: &RayOptions,
    stream: &Stream,
    input: &[u8],
    scene: &mut Scene<'_>,
    error: f64,
) -> Result<Options, Stop> {
    let requests = selection(stream, RayReader::new(input, options.input));
    let mut pilot = |scene: &mut Scene<'_>| values(&requests, scene);
    let goal = Goal { error, options: &options.rendering.options, unit: "rays" };
    goal::choose(session, scene, &goal, &mut pilot)
}

/// Some of the rays that are answered, evenly spread over the input.
fn selection(stream: &Stream, mut rays: RayReader<&[u8]>) -> Vec<Request> {
    let all = std::iter::from_fn(|| rays.next()).take(stream.most());
    let directed: Vec<_> = all.filter(|(_, direction)| *direction != DVec3::ZERO).collect();
    let count = directed.len().min(RAYS);
    let chosen = (0..count).map(|k| directed[(2 * k + 1) * directed.len() / (2 * count)]);
    (0..).zip(chosen).map(|(index, (origin, direction))| stream.request(origin, direction, index)).collect()
}

fn values(requests: &[Request], scene: &mut Scene<'_>) -> Result<Vec<[f32; 3]>, Stop> {
    let mut batches = Batches::default();
    let mut values = Vec::with_capacity(requests.len());
    let mut answers = Vec::new();
    while values.len() < requests.len() {
        scene.check()?;
        let left = &requests[values.len()..];
        scene.trace(&left[..batches.next(left.len())], &mut answers)?;
        values.extend(answers.iter().map(|a| a.value.to_array()));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_cli::{InputFormat, OutputSpec};

    #[test]
    fn rays_are_spread_over_those_that_are_answered() {
        let chosen = |count: usize, most: i32| {
            let mut options = RayOptions::new(1);
            options.height = most;
            let stream = Stream::new(&options, &OutputSpec::parse("v").unwrap());
            // Every fifth direction is none.
            let line = |i| format!("{i} 0 0 0 0 {}\n", i32::from(i % 5 != 4));
            let text = (0..count).map(line).collect::<Vec<_>>().concat();
            let requests = selection(&stream, RayReader::new(text.as_bytes(), InputFormat::Ascii));
            requests.iter().map(|r| r.origin.x).collect::<Vec<_>>()
        };
        assert_eq!(chosen(7, 0), [0.0, 1.0, 2.0, 3.0, 5.0, 6.0]);
        assert_eq!(chosen(7, 3), [0.0, 1.0, 2.0]);
        assert_eq!(chosen(0, 0), [0.0; 0]);
        let many = chosen(5000, 0);
        assert_eq!(many.len(), RAYS);
        assert!(many.windows(2).all(|w| w[1] > w[0] && w[1] - w[0] < 22.0) && many[255] > 4980.0, "{many:?}");
    }
}
