//! What a transform does to primitives, type by type.

use super::primitive::{FEW_DECIMALS, Primitive};
use super::request::{Placed, Request, joined};
use crate::{Class, Kind};
use ambit_base::DVec3;

/// A primitive in its place; `None` if it is none that `xform` takes.
pub(super) fn carried(primitive: &Primitive, request: &Request, placed: &Placed) -> Option<Primitive> {
    let mut p = primitive.clone();
    let transform = &placed.transform;
    let scale = transform.scale().abs();
    let point = |at: &mut [f64]| at.copy_from_slice(&transform.point(DVec3::from_slice(at)).to_array());
    let vector = |at: &mut [f64]| at.copy_from_slice(&transform.vector(DVec3::from_slice(at)).to_array());
    let count = p.reals.len();
    let bare = matches!(p.kind, Kind::Glow | Kind::Spotlight | Kind::Dielectric | Kind::Interface);
    let placed_by_reals = bare
        || p.kind.class() == Class::Surface
        || matches!(p.kind, Kind::Mist | Kind::BrightText | Kind::ColorText | Kind::MixText);
    // A mist's extinction has three channels or none.
    let odd =
        placed_by_reals && !p.kind.arguments().reals.allows(count) || p.kind == Kind::Mist && matches!(count, 1 | 2);
    if odd || (bare || p.kind.class() == Class::Surface) && !p.strings.is_empty() {
        return None;
    }
    let reals = &mut p.reals[..];
    match p.kind {
        Kind::Polygon => {
            reals.chunks_exact_mut(3).for_each(point);
            if (transform.scale() < 0.0) != request.invert {
                p.reals = p.reals.chunks_exact(3).rev().flatten().copied().collect();
            }
        }
        Kind::Sphere | Kind::Bubble => {
            point(&mut reals[..3]);
            lengthen(&mut reals[3..], scale);
        }
        Kind::Cone | Kind::Cup | Kind::Cylinder | Kind::Tube => {
            reals[..6].chunks_exact_mut(3).for_each(point);
            lengthen(&mut reals[6..], scale);
        }
        Kind::Ring => {
            point(&mut reals[..3]);
            vector(&mut reals[3..6]);
            if request.invert {
                reals[3..6].iter_mut().for_each(|x| *x = -*x);
            }
            lengthen(&mut reals[6..], scale);
        }
        Kind::Source => vector(&mut reals[..3]),
        Kind::Glow => reals[3] *= scale,
        Kind::Spotlight => vector(&mut reals[4..]),
        Kind::Dielectric => {
            transmit(&mut reals[..3], scale);
            p.decimals = FEW_DECIMALS;
        }
        Kind::Interface => {
            transmit(&mut reals[..3], scale);
            transmit(&mut reals[4..7], scale);
            p.decimals = FEW_DECIMALS;
        }
        Kind::Mist => {
            reals.iter_mut().take(3).for_each(|x| *x /= scale);
            p.decimals = FEW_DECIMALS;
            if let Some(name) = &placed.name {
                p.strings.iter_mut().for_each(|path| *path = relay(name, path));
            }
        }
        Kind::BrightText | Kind::ColorText | Kind::MixText => {
            // The anchor, the vector to the right and the one downwards.
            point(&mut reals[..3]);
            reals[3..9].chunks_exact_mut(3).for_each(vector);
        }
        kind if kind.arguments().transform => append(&mut p.strings, &placed.words),
        _ => (),
    }
    if request.invert {
        p.kind = p.kind.inside_out();
    }
    if p.is_surface() {
        if let Some(name) = &placed.name {
            p.name = joined(Some(name.clone()), &p.name);
        }
        if let Some(modifier) = &request.modifier {
            p.modifier.clone_from(modifier);
        }
    }
    Some(p)
}

fn lengthen(radii: &mut [f64], scale: f64) {
    for radius in radii {
        *radius *= scale;
    }
}

/// Transmissions of a unit length that has become another.
fn transmit(values: &mut [f64], scale: f64) {
    for value in values {
        *value = value.powf(1.0 / scale);
    }
}

/// Words of a transform after those that are there, as a block of their own.
fn append(strings: &mut Vec<Vec<u8>>, words: &[Vec<u8>]) {
    if words.first().is_some_and(|w| w != b"-i") {
        strings.extend([b"-i".to_vec(), b"1".to_vec()]);
    }
    strings.extend_from_slice(words);
}

/// A mist's source, and the relays on the way to it, by their new names.
fn relay(name: &[u8], path: &[u8]) -> Vec<u8> {
    let parts: Vec<Vec<u8>> = path.split(|&b| b == b'>').map(|part| joined(Some(name.to_vec()), part)).collect();
    parts.join(&b'>')
}
