//! `BRTDfunc`: ideal reflection and transmission by expressions, diffuse parts of their own for either side, and three
//! functions, one a channel, of the direction to the light.

use super::{Facing, Finish};
use crate::Error;
use crate::observer::Observer;
use crate::patterns::{Compiler, Functions, Recipe};
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{Colour, EPSILON, Rgb};
use ambit_scene::{ObjectId, Scene};
use std::f64::consts::PI;

/// Arguments of `BRTDfunc`.
#[derive(Debug)]
pub(crate) struct Brtd {
    front: Rgb,
    back: Rgb,
    transmitted: Rgb,
    /// Mirror and through coefficients (six expressions), then the distributions that there are.
    functions: Functions,
    /// For each channel, the index of its distribution.
    distributions: [Option<usize>; 3],
    /// Light passes unscattered.
    pub(crate) transmits: bool,
    /// Direct light counts.
    lit: bool,
}

const FILE: usize = 9;

impl Brtd {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        scene.check_arguments(id)?;
        let is_zero = |i: usize| scene.string_bytes(id, i) == Some(b"0");
        let mut distributions = [None; 3];
        let mut called = Vec::new();
        for (channel, i) in (6..9).enumerate() {
            if !is_zero(i) {
                distributions[channel] = Some(6 + called.len());
                called.push((i, 4));
            }
        }
        let expressions = &[0, 1, 2, 3, 4, 5];
        let recipe = Recipe { expressions, functions: &called, file: FILE, transform: FILE + 1 };
        let functions = compiler.assemble(scene, id, &recipe)?;
        let r = scene.reals(id);
        let rgb = |i: usize| Rgb::new(r[i] as f32, r[i + 1] as f32, r[i + 2] as f32);
        let dark = r[..9].iter().all(|&v| v <= EPSILON);
        let silent = scene.string_bytes(id, 6).is_some_and(|name| name.starts_with(b"0"));
        Ok(Self {
            front: rgb(0),
            back: rgb(3),
            transmitted: rgb(6),
            functions,
            distributions,
            transmits: !(3..6).all(is_zero),
            lit: !(dark && silent),
        })
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn brtd(&mut self, ray: &mut Ray<'_>, m: &Brtd, finish: Finish) -> bool {
        if ray.is_shadow() && !m.transmits {
            return true;
        }
        let facing = Facing::of(ray, finish.tilt, true);
        // Told from behind: the normal as it is, tilted the other way.
        ray.normal = if ray.cosine() > 0.0 { facing.normal } else { Facing::of(ray, -finish.tilt, false).normal };
        let functions = &m.functions;
        let channels = self.material_channels(ray, functions, &facing, finish.pattern);
        let ideal = self.expressions::<6>(&channels, functions, 0).unwrap_or_default().map(|v| v as f32);
        let mirror = Rgb::new(ideal[0], ideal[1], ideal[2]);
        let through = Rgb::new(ideal[3], ideal[4], ideal[5]);
        let straight = !facing.textured || ray.is_shadow() || ray.is_ambient();
        if m.transmits && through.max_element() > EPSILON as f32 {
            // Neither this nor the reflection asks which side the tilted ray ends on.
            let d = ray.direction;
            let bent = if straight || self.is_phong(ray) { d } else { (d - facing.tilt).normalize_or(d) };
            self.pass(ray, bent, through, straight);
        }
        if ray.is_shadow() {
            return true;
        }
        if mirror.max_element() > EPSILON as f32 {
            self.reflect(ray, facing.mirrored(ray.direction), mirror, straight);
        }
        let near = if ray.cosine() > 0.0 { m.front } else { m.back } * finish.pattern;
        let far = m.transmitted * finish.pattern;
        self.positive_ambient(ray, near, facing.normal);
        self.positive_ambient(ray, far, -facing.normal);
        if !m.lit {
            return true;
        }
        let frame = self.function_frame(ray, &functions.placement);
        let scattered = m.distributions.iter().any(Option::is_some);
        self.direct_with(ray, None, |walk, l, omega| {
            let lambda = facing.normal.dot(l);
            if lambda.abs() <= EPSILON {
                return Rgb::ZERO;
            }
            let reach = lambda.abs() * omega;
            let mut sum = if lambda > 0.0 { near } else { far } * (reach / PI) as f32;
            if scattered {
                let at = frame.direction_back(l);
                let values = walk.run(&channels, functions, |pass| {
                    let mut values = [0.0; 3];
                    for (value, distribution) in values.iter_mut().zip(m.distributions) {
                        if let Some(i) = distribution {
                            *value = pass.call(&functions.programs[i], &[at.x, at.y, at.z, omega])?;
                        }
                    }
                    Ok(values)
                });
                if let Some([r, g, b]) = values {
                    let value = Rgb::new(r as f32, g as f32, b as f32);
                    if value.brightness() > EPSILON as f32 {
                        sum += value * reach as f32;
                    }
                }
            }
            sum
        });
        true
    }
}
