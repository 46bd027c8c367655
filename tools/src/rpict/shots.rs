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

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::{DVec3, FAR, Rgb};
    use ambit_render::{Aim, Visit};
    use ambit_scene::ObjectId;

    /// A light whose radiance is the ray's number; it insists on being given the memory of the answers before.
    #[derive(Default)]
    struct Plain(Option<(usize, *const Answer)>);

    impl Light for Plain {
        fn trace(&mut self, requests: &[Request], answers: &mut Vec<Answer>) -> Result<(), Stop> {
            if let Some(before) = self.0 {
                assert_eq!((answers.len(), answers.as_ptr()), before, "other memory than before");
            }
            answers.clear();
            answers.extend(
                requests
                    .iter()
                    .map(|r| Answer { value: Rgb::splat(r.index as f32), ..Answer::nothing(r.origin, r.direction) }),
            );
            self.0 = Some((answers.len(), answers.as_ptr()));
            Ok(())
        }

        fn trace_tree(&mut self, _: &Request, _: Visit<'_>) -> Result<Answer, Stop> {
            unreachable!("pictures ask for no trees")
        }

        fn name(&self, _: ObjectId, _: ObjectId) -> &[u8] {
            b"it"
        }
    }

    #[test]
    fn batches_use_the_memory_of_those_before() {
        let (mut shots, mut light) = (Shots::default(), Plain::default());
        // Every third pixel lies outside the view.
        let aim = |p: PixelRequest| {
            let (origin, direction, limit) = (DVec3::ZERO, DVec3::Z, FAR);
            (p.x % 3 != 2).then_some(Request { origin, direction, limit, index: p.index, aim: Aim::Radiance })
        };
        let pixel = |a: &Answer| Pixel { colour: a.value, distance: 1.0 };
        for count in [90u32, 9, 60, 0, 90] {
            let pixels: Vec<_> = (0..count).map(|k| PixelRequest { x: k, y: 0, index: 7 * k }).collect();
            let made = shots.trace(&pixels, &aim, &mut light, &pixel).unwrap();
            assert_eq!(made.len(), pixels.len());
            for (k, pixel) in made.iter().enumerate() {
                let wanted = if k % 3 == 2 { (0.0, 0.0) } else { (7.0 * k as f32, 1.0) };
                assert_eq!((pixel.colour.x, pixel.distance), wanted);
            }
        }
    }
}
