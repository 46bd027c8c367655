//! Photometric functions of luminaires: near-field corrections and angles. Answers function-files.md 7.2.

use crate::channel::Channel::{Dx, Dy, Dz, Px, Py, Pz, Rdot, Ts};
use crate::channel::{CHANNELS, Channel};
use crate::error::Fault;

type Ray = [f64; CHANNELS];

fn get(ray: &Ray, channel: Channel) -> f64 {
    ray[channel as usize]
}

/// `source_theta`: angle between the direction from the lit point and +z, in degrees.
pub(crate) fn theta(ray: &Ray) -> f64 {
    get(ray, Dz).clamp(-1.0, 1.0).acos().to_degrees()
}

/// `source_phi`: azimuth of the emission, in degrees, folded as the luminaire's symmetry (360, 180 or 90) has it.
pub(crate) fn phi(ray: &Ray, symmetry: f64) -> Result<f64, Fault> {
    // Subtracting from 0 leaves no negative zero, so that straight up and down have the azimuth 0.
    let angle = (0.0 - get(ray, Dy)).atan2(0.0 - get(ray, Dx)).to_degrees();
    let angle = if angle < 0.0 { angle + 360.0 } else { angle };
    let half = if angle < 180.0 { angle } else { 360.0 - angle };
    match (symmetry + 0.5).floor() as i64 {
        360 => Ok(angle),
        180 => Ok(half),
        90 => Ok(if half < 90.0 { half } else { 180.0 - half }),
        value => Err(Fault::IllegalMode { function: "source_phi", what: "symmetry", value }),
    }
}

/// `source_corr`: turns a candela value into radiance for the shape of luminaire that `mode` names, whose dimensions
/// are the real arguments 2 to 4.
pub(crate) fn correction(ray: &Ray, reals: &[f64], value: f64, mode: f64) -> Result<f64, Fault> {
    let v = if reals.len() > 1 { value * reals[0] } else { value };
    if v <= 0.0 {
        return Ok(0.0);
    }
    let d = [get(ray, Dx), get(ray, Dy), get(ray, Dz)];
    let size = |needed: usize| match reals {
        [_, sizes @ ..] if sizes.len() >= needed => Ok(sizes),
        _ => Err(Fault::MissingReals),
    };
    match (mode + 0.5).floor() as i64 {
        0 => Ok(v),
        1 => Ok(v / get(ray, Rdot)),
        2 => {
            let a = size(3)?;
            Ok(v / (d[0].abs() * a[1] * a[2] + d[1].abs() * a[0] * a[2] + d[2].abs() * a[0] * a[1]))
        }
        3 => {
            let a = size(3)?;
            let (p, t) = ([get(ray, Px), get(ray, Py), get(ray, Pz)], get(ray, Ts));
            let mut area = 0.0;
            for axis in 0..3 {
                let beyond = (p[axis] - d[axis] * t).abs() - a[axis] / 2.0;
                if beyond > 0.0 {
                    area += beyond * a[(axis + 1) % 3] * a[(axis + 2) % 3];
                }
            }
            Ok(v * t / area)
        }
        4 => {
            let a = size(2)?;
            let side = a[0] * a[1] * (1.0 - d[2] * d[2]).max(0.0).sqrt();
            Ok(v / (side + std::f64::consts::FRAC_PI_4 * a[0] * a[0] * d[2].abs()))
        }
        value => Err(Fault::IllegalMode { function: "source_corr", what: "mode", value }),
    }
}
