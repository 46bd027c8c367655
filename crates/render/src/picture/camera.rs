//! The camera: the ray of a pixel, with jitter, depth of field and motion.

use super::sampler::PixelRequest;
use crate::request::{Aim, Request};
use ambit_base::{DVec3, EPSILON, FAR, Stream, square_to_disk};
use ambit_file::{Projection, ViewRay};
use std::f64::consts::PI;

/// Keys of the camera's random streams.
const JITTER: u64 = 0x6a69_7474_6572;
const LENS: u64 = 0x6c65_6e73;
const SHUTTER: u64 = 0x7368_7574_7465;

/// How pixels become rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// `-pj`: fraction of a pixel over which samples spread.
    pub jitter: f64,
    /// `-pd`: diameter of the aperture, scene units.
    pub aperture: f64,
    /// `-pm`: fraction of a frame during which the shutter is open.
    pub motion: f64,
}

/// A view, its picture's size, and the lens.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// The view.
    pub projection: Projection,
    /// The view of the frame before, if it moves.
    pub previous: Option<Projection>,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The lens.
    pub lens: Lens,
    /// Changes every random number.
    pub seed: u64,
}

impl Camera {
    /// The ray of a pixel, `None` outside a fisheye's disk.
    pub fn ray(&self, pixel: PixelRequest) -> Option<Request> {
        let random = Stream::new(pixel.index, self.seed);
        let [jx, jy] = random.child(JITTER).two().map(|r| self.lens.jitter * (0.5 - r));
        let x = (f64::from(pixel.x) + 0.5 + jx) / f64::from(self.width);
        let y = (f64::from(pixel.y) + 0.5 + jy) / f64::from(self.height);
        let mut ray = self.projection.ray(x, y)?;
        // What was outside of the view before stands still.
        if let Some(before) = self.previous.as_ref().and_then(|previous| previous.ray(x, y)) {
            let u = self.lens.motion * (0.5 - random.child(SHUTTER).one());
            ray = between(&ray, &before, u);
        }
        if self.lens.aperture > EPSILON {
            ray = self.through_aperture(&ray, random.child(LENS));
        }
        Some(Request {
            origin: ray.origin,
            direction: ray.direction,
            limit: ray.length,
            index: pixel.index,
            aim: Aim::Radiance,
        })
    }

    /// Moves the start of a ray over the aperture and keeps what is in focus in its place.
    fn through_aperture(&self, ray: &ViewRay, random: Stream) -> ViewRay {
        let p = &self.projection;
        let view = &p.view;
        let [u, v] = random.two();
        let [a, b] = square_to_disk(u, v);
        let radius = 0.5 * self.lens.aperture;
        let on_disk = p.right * (a * radius) + p.up * (b * radius);
        let planar = matches!(view.kind, ambit_file::ViewType::Perspective | ambit_file::ViewType::Parallel);
        // Where the ray is without its fore clipping distance: the view point, or a point of the plane of a parallel view.
        let start = ray.origin - ray.direction * self.fore_distance(ray);
        let (focus, depth) = if planar {
            (start + ray.direction * (p.focal_distance / ray.direction.dot(p.direction)), 0.0)
        } else {
            let along = (random.child(LENS).one() - 0.5) * 2.0 * PI / 8.0 * self.lens.aperture;
            (start + ray.direction * p.focal_distance, along)
        };
        let moved = start + on_disk + p.direction * depth;
        let direction = (focus - moved).try_normalize().unwrap_or(ray.direction);
        let mut bent = ViewRay { origin: moved, direction, length: ray.length };
        bent.origin += direction * self.fore_distance(&bent);
        bent
    }

    /// How far along a ray the fore clipping surface is.
    fn fore_distance(&self, ray: &ViewRay) -> f64 {
        let p = &self.projection;
        match p.view.kind {
            ambit_file::ViewType::Perspective => p.view.fore / ray.direction.dot(p.direction).max(EPSILON),
            ambit_file::ViewType::Cylinder => {
                let axial = ray.direction.dot(p.up);
                p.view.fore / (1.0 - axial * axial).sqrt().max(EPSILON)
            }
            _ => p.view.fore,
        }
    }
}

/// The ray at a fraction of the way from `a` to `b`.
fn between(a: &ViewRay, b: &ViewRay, at: f64) -> ViewRay {
    let mix = |a: DVec3, b: DVec3| a + (b - a) * at;
    let direction = mix(a.direction, b.direction).try_normalize().unwrap_or(a.direction);
    let length =
        if a.length >= FAR || b.length >= FAR { a.length.min(b.length) } else { a.length + (b.length - a.length) * at };
    ViewRay { origin: mix(a.origin, b.origin), direction, length }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_file::{View, ViewType};

    #[test]
    fn what_comes_into_a_hemispherical_view_stands_still() {
        // As in Radiance 6.0a: the corner was outside of the disk in the frame before.
        let view = |wide: f64| View { kind: ViewType::Hemisphere, horizontal: wide, vertical: wide, ..View::default() };
        let [now, before] = [60.0, 180.0].map(|wide| view(wide).set_up().expect("a view"));
        let lens = Lens { jitter: 0.0, aperture: 0.0, motion: 1.0 };
        let camera = Camera { projection: now, previous: Some(before), width: 9, height: 9, lens, seed: 0 };
        assert_eq!(before.ray(0.5 / 9.0, 0.5 / 9.0), None);
        let corner = camera.ray(PixelRequest { x: 0, y: 0, index: 5 }).expect("a ray");
        let still = now.ray(0.5 / 9.0, 0.5 / 9.0).expect("a ray");
        assert_eq!((corner.origin, corner.direction), (still.origin, still.direction));
        let inner = camera.ray(PixelRequest { x: 3, y: 3, index: 5 }).expect("a ray");
        assert_ne!(inner.direction, now.ray(3.5 / 9.0, 3.5 / 9.0).expect("a ray").direction);
    }
}
