//! Batches of pixels as batches of rays. A picture has many of them; their memory is used again.

use crate::light::Light;
use crate::session::Stop;
use ambit_render::picture::{Pixel, PixelRequest};
use ambit_render::{Answer, Request};

/// The rays of a batch of pixels.
#[derive(Default)]
pub(crate) struct Shots {
    requests: Vec<Request>,
    /// Places in the batch of those pixels that have a ray.
    places: Vec<usize>,
    answers: Vec<Answer>,
}

impl Shots {
    /// Traces pixels by the rays that `aim` gives them. Those without one, outside the view, are black and have no distance.
    pub(crate) fn trace(
        &mut self,
        pixels: &[PixelRequest],
        aim: &dyn Fn(PixelRequest) -> Option<Request>,
        light: &mut dyn Light,
        pixel: &dyn Fn(&Answer) -> Pixel,
    ) -> Result<Vec<Pixel>, Stop> {
        self.requests.clear();
        self.places.clear();
        for (place, request) in pixels.iter().enumerate().filter_map(|(place, &p)| Some((place, aim(p)?))) {
            self.requests.push(request);
            self.places.push(place);
        }
        light.check()?;
        light.trace(&self.requests, &mut self.answers)?;
        let mut all = vec![Pixel::default(); pixels.len()];
        for (&place, answer) in self.places.iter().zip(&self.answers) {
            all[place] = pixel(answer);
        }
        Ok(all)
    }
}
