//! A room of 1 × 1 × 1 with two blocks and a small lamp, by brute force over its rectangles; everything is diffuse.

use crate::{Answer, Cache, Miss, Query, Sample, SampleRay, Sampler};
use ambit_base::{DVec3, FAR, Rgb, Stream, Vec3};
use std::f64::consts::PI;

/// Hits nearer than this are the surface the ray starts on.
const SELF: f64 = 1e-7;

struct Rectangle {
    corner: DVec3,
    /// Edges over their squared lengths.
    across: [DVec3; 2],
    normal: DVec3,
    reflectance: Vec3,
}

/// The room, and how dense the pixels of its picture are.
pub(crate) struct Room {
    rectangles: Vec<Rectangle>,
    lamp: [DVec3; 3],
    /// Weight of camera rays.
    pub(crate) weight: f32,
}

pub(crate) struct Hit {
    pub(crate) distance: f64,
    pub(crate) position: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) reflectance: Vec3,
    lamp: bool,
}

impl Room {
    /// With two blocks.
    pub(crate) fn new() -> Self {
        let mut room = Self::empty();
        room.block(0.33, 0.65, [0.15, 0.15, 0.6], 17.0);
        room.block(0.68, 0.38, [0.14, 0.15, 0.3], -18.0);
        room
    }

    /// With a wall from side to side that leaves a door.
    pub(crate) fn divided() -> Self {
        let mut room = Self::empty();
        let white = Vec3::splat(0.7);
        room.add(DVec3::new(0.0, 0.7, 0.0), DVec3::X * 0.7, DVec3::Z, white);
        room.add(DVec3::new(0.7, 0.7, 0.6), DVec3::X * 0.3, DVec3::Z * 0.4, white);
        room
    }

    /// With thin blades on the floor.
    pub(crate) fn hairy(blades: u32) -> Self {
        let mut room = Self::empty();
        for k in 0..blades {
            let at = |a: f64| (f64::from(k) * a).fract();
            let (s, c) = (6.3 * at(0.754_877_67)).sin_cos();
            let foot = DVec3::new(0.1 + 0.8 * at(0.618_033_99), 0.3 + 0.6 * at(0.414_213_56), 0.0);
            let lean = DVec3::new(-s, c, 0.0) * (0.2 * at(0.569_840_29) - 0.1);
            room.add(foot, DVec3::new(c, s, 0.0) * 0.01, lean + DVec3::Z * 0.3, Vec3::new(0.5, 0.6, 0.3));
        }
        room
    }

    /// With nothing in it.
    pub(crate) fn empty() -> Self {
        let white = Vec3::splat(0.7);
        let (o, x, y, z) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
        let lamp = [DVec3::new(0.4, 0.45, 0.995), y * 0.2, x * 0.2];
        let mut room = Self { rectangles: Vec::new(), lamp, weight: 1.0 };
        room.add(lamp[0], lamp[1], lamp[2], Vec3::ZERO);
        room.add(o, x, y, white);
        room.add(z, y, x, white);
        room.add(o, y, z, Vec3::new(0.6, 0.08, 0.06));
        room.add(x, z, y, Vec3::new(0.12, 0.45, 0.1));
        room.add(o, z, x, white * 0.7);
        room.add(y, x, z, white);
        room
    }

    fn add(&mut self, corner: DVec3, u: DVec3, v: DVec3, reflectance: Vec3) {
        let across = [u / u.length_squared(), v / v.length_squared()];
        self.rectangles.push(Rectangle { corner, across, normal: u.cross(v).normalize(), reflectance });
    }

    fn block(&mut self, x: f64, y: f64, [a, b, height]: [f64; 3], degrees: f64) {
        let (s, c) = degrees.to_radians().sin_cos();
        let (u, v, z) = (DVec3::new(c, s, 0.0) * a, DVec3::new(-s, c, 0.0) * b, DVec3::Z * height);
        let (m, white) = (DVec3::new(x, y, 0.0), Vec3::splat(0.7));
        self.add(m - u - v + z, 2.0 * u, 2.0 * v, white);
        self.add(m - u - v, 2.0 * u, z, white);
        self.add(m + u - v, 2.0 * v, z, white);
        self.add(m + u + v, -2.0 * u, z, white);
        self.add(m - u + v, -2.0 * v, z, white);
    }

    pub(crate) fn hit(&self, from: DVec3, direction: DVec3) -> Option<Hit> {
        let mut best: Option<(f64, usize)> = None;
        for (k, r) in self.rectangles.iter().enumerate() {
            let slope = direction.dot(r.normal);
            let t = (r.corner - from).dot(r.normal) / slope;
            if slope == 0.0 || t <= SELF || best.is_some_and(|(nearest, _)| t >= nearest) {
                continue;
            }
            let p = from + direction * t - r.corner;
            if r.across.iter().all(|a| (0.0..=1.0).contains(&p.dot(*a))) {
                best = Some((t, k));
            }
        }
        best.map(|(distance, k)| {
            let r = &self.rectangles[k];
            let normal = if r.normal.dot(direction) > 0.0 { -r.normal } else { r.normal };
            let position = from + direction * distance;
            Hit { distance, position, normal, reflectance: r.reflectance, lamp: k == 0 }
        })
    }

    /// Direct irradiance over π from one point of the lamp.
    fn direct(&self, position: DVec3, normal: DVec3, stream: Stream) -> f32 {
        let [s, t] = stream.two();
        let [corner, u, v] = self.lamp;
        let to = corner + u * s + v * t - position;
        let (here, there) = (normal.dot(to), to.z);
        let squared = to.length_squared();
        let seen = self.hit(position, to).is_none_or(|h| h.distance > 1.0 - SELF);
        if here <= 0.0 || there <= 0.0 || !seen {
            return 0.0;
        }
        (15.0 * u.length() * v.length() * here * there / (squared * squared) / PI) as f32
    }

    /// What a hemisphere ray finds: radiance without indirect light, distance, and the diffuse question with its
    /// coefficient.
    pub(crate) fn look(
        &self,
        query: &Query<()>,
        direction: DVec3,
        weight: f32,
        stream: Stream,
    ) -> (Sample, Option<Miss<()>>) {
        match self.hit(query.position, direction) {
            None => (Sample { light: Rgb::ZERO.into(), distance: FAR, normal: Vec3::ZERO }, None),
            Some(h) if h.lamp => {
                (Sample { light: Rgb::ZERO.into(), distance: h.distance, normal: h.normal.as_vec3() }, None)
            }
            Some(h) => {
                let radiance = h.reflectance * self.direct(h.position, h.normal, stream);
                let next = Query {
                    position: h.position,
                    normal: h.normal,
                    shading: h.normal,
                    weight: query.weight * weight,
                    level: query.level + 1,
                    pass: query.pass,
                    origin: (),
                };
                let sample = Sample { light: radiance.into(), distance: h.distance, normal: h.normal.as_vec3() };
                (sample, Some(Miss { coefficient: h.reflectance, query: next }))
            }
        }
    }

    /// Questions of the pixels of a side × side picture, coarse to fine.
    pub(crate) fn pixels(&self, side: u32) -> Vec<Miss<()>> {
        let eye = DVec3::new(0.5, 0.01, 0.5);
        let spread = |mut k: u32| {
            // Every second bit of the pixel's number, from the last on.
            let mut out = 0;
            for bit in 0..16 {
                out |= (k & 1) << (15 - bit);
                k >>= 2;
            }
            out
        };
        let mut misses = Vec::new();
        for number in 0..1u32 << 16 {
            let (x, y) = (spread(number) >> 8, spread(number >> 1) >> 8);
            if x >= side || y >= side {
                continue;
            }
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
            let direction = DVec3::new(at(x) * 1.4, 0.8, at(y) * 1.4).normalize();
            if let Some(h) = self.hit(eye, direction)
                && !h.lamp
            {
                let query = Query {
                    position: h.position,
                    normal: h.normal,
                    shading: h.normal,
                    weight: self.weight,
                    level: 0,
                    pass: 0,
                    origin: (),
                };
                misses.push(Miss { coefficient: h.reflectance, query });
            }
        }
        misses
    }
}

impl Sampler for Room {
    type Origin = ();
    type Scratch<'a>
        = ()
    where
        Self: 'a;

    fn scratch(&self) {}

    fn sample(
        &self,
        (): &mut (),
        cache: &Cache,
        query: &Query<()>,
        &SampleRay { direction, weight, stream, .. }: &SampleRay,
        misses: &mut Vec<Miss<()>>,
    ) -> Option<Sample> {
        let (mut sample, question) = self.look(query, direction, weight, stream);
        if let Some(miss) = question {
            match cache.ask(self, &miss.query) {
                Answer::Value(light) => sample.light += light.times(miss.coefficient),
                Answer::Fallback(v) => sample.light.value += miss.coefficient * v,
                Answer::Miss => misses.push(miss),
                Answer::Uncached => unreachable!("these tests cache"),
            }
        }
        Some(sample)
    }

    fn occluded(&self, _: &Query<()>, from: DVec3, direction: DVec3) -> bool {
        self.hit(from, direction).is_some_and(|h| h.distance < 1.0)
    }
}
