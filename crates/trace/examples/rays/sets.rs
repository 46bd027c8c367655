//! The rays: of a camera, diffuse ones from where those hit, and shadow rays.

use crate::scene::Rng;
use ambit_base::{DVec3, FAR};
use ambit_trace::{Ray, Shadow, World};

/// Pixels along a side of the picture.
const SIDE: usize = 512;

/// How far from the surface rays start: where an f32 tracer does not meet the surface they leave.
const OFF: f64 = 1e-4;

/// How far the rays look that ask whether something is near.
const NEAR: f64 = 1.0;

/// Rays of a hemisphere.
const HEMISPHERE: usize = 64;

/// What is asked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Question {
    /// The nearest hit.
    Nearest,
    /// Is the lamp seen?
    Lamp,
    /// Is there nothing up to the ray's limit?
    Open,
}

/// Rays that are timed together.
pub(crate) struct Set {
    pub(crate) name: &'static str,
    pub(crate) question: Question,
    pub(crate) rays: Vec<Ray>,
}

impl Set {
    /// Asks once more for every ray: how many hit something, or reach what they look for.
    pub(crate) fn run(&self, world: &World) -> usize {
        match self.question {
            Question::Nearest => self.rays.iter().filter(|r| world.nearest(r).is_some()).count(),
            Question::Lamp => self.rays.iter().filter(|r| world.shadow(r, Some(0)) == Shadow::Reaches).count(),
            Question::Open => self.rays.iter().filter(|r| world.shadow(r, None) == Shadow::Reaches).count(),
        }
    }

    /// Object and distance of each hit; for the other questions 0 where the ray reaches, 1 where it does not.
    pub(crate) fn answers(&self, world: &World) -> Vec<(u32, f64)> {
        let dark = |shadow: Shadow| (u32::from(shadow != Shadow::Reaches), 0.0);
        let answer = |r: &Ray| match self.question {
            Question::Nearest => world.nearest(r).map_or((u32::MAX, 0.0), |h| (h.object, h.distance)),
            Question::Lamp => dark(world.shadow(r, Some(0))),
            Question::Open => dark(world.shadow(r, None)),
        };
        self.rays.iter().map(answer).collect()
    }
}

/// A camera's rays in tiles of 8 × 8.
fn camera() -> Vec<Ray> {
    let eye = DVec3::new(0.4, 0.4, 1.7);
    let forward = (DVec3::new(12.0, 9.0, 1.2) - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let at = |i: usize| (i as f64 + 0.5) / SIDE as f64 - 0.5;
    let ray = |k: usize| {
        let (tile, inside) = (k / 64, k % 64);
        let x = tile % (SIDE / 8) * 8 + inside % 8;
        let y = tile / (SIDE / 8) * 8 + inside / 8;
        Ray::new(eye, (forward + right * (1.6 * at(x)) + up * (1.6 * at(y))).normalize())
    };
    (0..SIDE * SIDE).map(ray).collect()
}

fn shuffled(rays: &[Ray]) -> Vec<Ray> {
    let (mut rng, mut rays) = (Rng(11), rays.to_vec());
    for i in (1..rays.len()).rev() {
        rays.swap(i, (rng.next() % (i as u64 + 1)) as usize);
    }
    rays
}

/// All sets. The world decides where the later ones start.
pub(crate) fn all(world: &World) -> Vec<Set> {
    let camera = camera();
    let mut rng = Rng(7);
    let (mut diffuse, mut lamp, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for r in &camera {
        let Some(hit) = world.nearest(r) else { continue };
        let normal = if hit.cosine < 0.0 { -hit.normal } else { hit.normal };
        let p = r.origin + r.direction * hit.distance + normal * OFF;
        places.push((p, normal));
        // Cosine-distributed: a point of the sphere that touches the surface.
        diffuse.push(Ray::new(p, (normal + rng.direction() * 0.9999).normalize()));
        let q = DVec3::new(5.8 + 0.4 * rng.unit(), 4.3 + 0.4 * rng.unit(), 3.9);
        lamp.push(Ray::new(p, (q - p).normalize()));
    }
    let hemispheres = places.iter().step_by(HEMISPHERE).flat_map(|&(p, normal)| {
        let mut rng = Rng(p.x.to_bits());
        (0..HEMISPHERE).map(move |_| Ray::new(p, (normal + rng.direction() * 0.9999).normalize())).collect::<Vec<_>>()
    });
    let hemispheres = hemispheres.collect();
    let open = diffuse.iter().map(|r| Ray { limit: NEAR, ..*r }).collect();
    let set = |name, question, rays| Set { name, question, rays };
    vec![
        set("camera", Question::Nearest, camera),
        set("hemispheres", Question::Nearest, hemispheres),
        set("diffuse-shuffled", Question::Nearest, shuffled(&diffuse)),
        set("diffuse", Question::Nearest, diffuse),
        set("lamp-shuffled", Question::Lamp, shuffled(&lamp)),
        set("lamp", Question::Lamp, lamp),
        set("open", Question::Open, open),
    ]
}

/// Where a tracer that only knows limits has to stop looking: just before the lamp.
pub(crate) fn limit(world: &World, question: Question, ray: &Ray) -> f64 {
    match question {
        Question::Nearest => FAR,
        Question::Lamp => world.distance(0, ray).map_or(FAR, |t| t - OFF),
        Question::Open => ray.limit,
    }
}
