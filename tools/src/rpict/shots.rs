//! Batches of pixels as batches of rays. A picture has many of them; their memory is used again.

use crate::light::Light;
use crate::session::Stop;
use ambit_render::picture::{Pixel, PixelRequest};
use ambit_render::{Rays, Request, Seen};

/// The ray of a pixel; none outside the view.
pub(crate) type Aim<'a> = dyn Fn(PixelRequest) -> Option<Request> + Sync + 'a;

/// What has been seen of a batch of pixels.
#[derive(Default)]
pub(crate) struct Shots {
    seen: Vec<Seen>,
}

struct Batch<'a> {
    pixels: &'a [PixelRequest],
    aim: &'a Aim<'a>,
}

impl Rays for Batch<'_> {
    fn count(&self) -> usize {
        self.pixels.len()
    }

    fn ray(&self, number: usize) -> Option<Request> {
        (self.aim)(self.pixels[number])
    }
}

impl Shots {
    /// Traces pixels by the rays that `aim` gives them. Those without one, outside the view, are black and have no distance.
    pub(crate) fn trace(
        &mut self,
        pixels: &[PixelRequest],
        aim: &Aim<'_>,
        light: &mut dyn Light,
        pixel: &dyn Fn(&Seen) -> Pixel,
    ) -> Result<Vec<Pixel>, Stop> {
        light.check()?;
        light.see(&Batch { pixels, aim }, &mut self.seen)?;
        Ok(self.seen.iter().map(pixel).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::{DVec3, FAR, Rgb};
    use ambit_render::{Aim, Answer, Visit};
    use ambit_scene::ObjectId;

    /// A light whose radiance is the ray's number; it insists on being given the memory of what was seen before.
    #[derive(Default)]
    struct Plain(Option<(usize, *const Seen)>);

    impl Light for Plain {
        fn see(&mut self, rays: &dyn Rays, seen: &mut Vec<Seen>) -> Result<(), Stop> {
            if let Some(before) = self.0 {
                assert_eq!((seen.len(), seen.as_ptr()), before, "other memory than before");
            }
            seen.clear();
            seen.extend((0..rays.count()).map(|k| match rays.ray(k) {
                Some(ray) => Seen { value: Rgb::splat(ray.index as f32), length: 1.0 },
                None => Seen::default(),
            }));
            self.0 = Some((seen.len(), seen.as_ptr()));
            Ok(())
        }

        fn trace(&mut self, _: &[Request], _: &mut Vec<Answer>) -> Result<(), Stop> {
            unreachable!("pictures need no whole answers")
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
        let pixel = |s: &Seen| Pixel { colour: s.value, distance: s.length };
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
