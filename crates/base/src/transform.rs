//! Similarity transforms as scene files write them: `-t x y z`, `-rx a`, `-ry a`, `-rz a`, `-s f`, `-mx`, `-my`, `-mz`
//! and `-i n`, applied in the order written.

use glam::{DMat3, DVec3};

/// A similarity transform and its inverse, which is composed from inverted operations rather than by inverting a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    forward: Affine,
    backward: Affine,
    /// Product of all scale factors, −1 for each mirror.
    scale: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Affine {
    linear: DMat3,
    offset: DVec3,
}

impl Affine {
    const IDENTITY: Self = Self { linear: DMat3::IDENTITY, offset: DVec3::ZERO };

    /// First `self`, then `next`.
    fn then(self, next: Self) -> Self {
        Self { linear: next.linear * self.linear, offset: next.linear * self.offset + next.offset }
    }
}

/// A word that is no transform, or one with a missing or malformed number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("bad transform at '{word}'")]
pub struct TransformError {
    /// The offending word; empty if the words ended too early.
    pub word: String,
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// No change.
    pub const IDENTITY: Self = Self { forward: Affine::IDENTITY, backward: Affine::IDENTITY, scale: 1.0 };

    /// Parses the words of a transform, all of which must be consumed.
    pub fn parse<S: AsRef<str>>(words: &[S]) -> Result<Self, TransformError> {
        let mut total = Self::IDENTITY;
        let mut block = Self::IDENTITY;
        let mut count = 1i64;
        let mut w = words.iter().map(AsRef::as_ref);
        while let Some(word) = w.next() {
            let bad = || TransformError { word: word.to_owned() };
            if word == "-i" {
                total = block.repeated(count, total);
                block = Self::IDENTITY;
                count = w.next().and_then(integer).ok_or_else(bad)?;
                continue;
            }
            let mut next = || w.next().and_then(real).ok_or_else(bad);
            let step = match word {
                "-t" => Self::translation(DVec3::new(next()?, next()?, next()?)),
                "-rx" => Self::rotation(0, next()?),
                "-ry" => Self::rotation(1, next()?),
                "-rz" => Self::rotation(2, next()?),
                "-s" => {
                    let f = next()?;
                    if f == 0.0 {
                        return Err(bad());
                    }
                    Self::scaling(DVec3::splat(f), f)
                }
                "-mx" => Self::scaling(DVec3::new(-1.0, 1.0, 1.0), -1.0),
                "-my" => Self::scaling(DVec3::new(1.0, -1.0, 1.0), -1.0),
                "-mz" => Self::scaling(DVec3::new(1.0, 1.0, -1.0), -1.0),
                _ => return Err(bad()),
            };
            block = block.then(&step);
        }
        Ok(block.repeated(count, total))
    }

    /// A shift by `d` scene units.
    pub fn translation(d: DVec3) -> Self {
        Self {
            forward: Affine { linear: DMat3::IDENTITY, offset: d },
            backward: Affine { linear: DMat3::IDENTITY, offset: -d },
            scale: 1.0,
        }
    }

    /// A right-handed turn about axis 0, 1 or 2 by `degrees`.
    pub fn rotation(axis: usize, degrees: f64) -> Self {
        let turn = |a: f64| match axis {
            0 => DMat3::from_rotation_x(a),
            1 => DMat3::from_rotation_y(a),
            _ => DMat3::from_rotation_z(a),
        };
        let a = degrees.to_radians();
        Self {
            forward: Affine { linear: turn(a), offset: DVec3::ZERO },
            backward: Affine { linear: turn(-a), offset: DVec3::ZERO },
            scale: 1.0,
        }
    }

    fn scaling(f: DVec3, scale: f64) -> Self {
        Self {
            forward: Affine { linear: DMat3::from_diagonal(f), offset: DVec3::ZERO },
            backward: Affine { linear: DMat3::from_diagonal(f.recip()), offset: DVec3::ZERO },
            scale,
        }
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Self) -> Self {
        Self {
            forward: self.forward.then(next.forward),
            backward: next.backward.then(self.backward),
            scale: self.scale * next.scale,
        }
    }

    /// `first`, then this transform `count` times over; nothing for counts below 1. Counts that scenes use are composed one
    /// by one, so that rounding is Radiance's; absurd ones by squaring, so that they end.
    fn repeated(&self, count: i64, first: Self) -> Self {
        const ONE_BY_ONE: i64 = 4096;
        if count <= ONE_BY_ONE {
            return (0..count).fold(first, |t, _| t.then(self));
        }
        let (mut total, mut power, mut left) = (first, *self, count);
        while left > 0 {
            if left & 1 != 0 {
                total = total.then(&power);
            }
            left >>= 1;
            if left > 0 {
                power = power.then(&power);
            }
        }
        total
    }

    /// The transform the other way.
    pub fn inverse(&self) -> Self {
        Self { forward: self.backward, backward: self.forward, scale: 1.0 / self.scale }
    }

    /// Signed scale: negative for an odd number of mirrors.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Carries a point.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.forward.linear * p + self.forward.offset
    }

    /// Carries a vector, scale included.
    #[inline]
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.forward.linear * v
    }

    /// Carries a direction: turned and mirrored, its length kept.
    #[inline]
    pub fn direction(&self, v: DVec3) -> DVec3 {
        self.forward.linear * v / self.scale.abs()
    }

    /// Carries a point back.
    #[inline]
    pub fn point_back(&self, p: DVec3) -> DVec3 {
        self.backward.linear * p + self.backward.offset
    }

    /// Carries a direction back, its length kept.
    #[inline]
    pub fn direction_back(&self, v: DVec3) -> DVec3 {
        self.backward.linear * v * self.scale.abs()
    }
}

/// A real number in the syntax of scene files: digits with at most one point and an optional exponent, nothing else
/// (`nan`, `inf` and `0x10` are refused; `1.`, `.5` and `+.5e1` are fine).
pub(crate) fn real(word: &str) -> Option<f64> {
    let plain = word.bytes().all(|c| c.is_ascii_digit() || matches!(c, b'+' | b'-' | b'.' | b'e' | b'E'));
    if plain { word.parse().ok() } else { None }
}

fn integer(word: &str) -> Option<i64> {
    word.strip_prefix('+').unwrap_or(word).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(text: &str) -> DVec3 {
        let words: Vec<&str> = text.split_whitespace().collect();
        Transform::parse(&words).unwrap().point(DVec3::X)
    }

    #[test]
    fn operations_apply_in_the_order_written() {
        for (text, expected) in [
            ("-t 1 2 3 -s 2", [4.0, 4.0, 6.0]),
            ("-s 2 -t 1 2 3", [3.0, 2.0, 3.0]),
            ("-t 5 0 0 -rz 90", [0.0, 6.0, 0.0]),
            ("-i 3 -t 1 0 0", [4.0, 0.0, 0.0]),
            ("-i 2 -t 1 0 0 -i 3 -t 0 1 0", [3.0, 3.0, 0.0]),
            ("-i 0 -t 1 0 0", [1.0, 0.0, 0.0]),
            ("-i 1000000000 -t 1 0 0", [1_000_000_001.0, 0.0, 0.0]),
        ] {
            let p = apply(text);
            assert!((p - DVec3::from(expected)).length() < 1e-12, "{text}: {p}");
        }
    }

    #[test]
    fn repeated_blocks_are_rounded_as_radiance_rounds_them() {
        // What its xform prints: three turns by 30° after a scaling leave this of a zero.
        let t = Transform::parse(&["-s", ".0254", "-i", "3", "-ry", "30"]).unwrap();
        assert_eq!(format!("{:.11e}", t.point(DVec3::X).x), "6.93889390391e-18");
    }

    #[test]
    fn the_inverse_undoes_points_and_directions() {
        let t = Transform::parse(&["-rx", "31", "-s", "-2.5", "-t", "1", "-4", "7", "-mz", "-ry", "12"]).unwrap();
        let p = DVec3::new(0.3, -2.0, 5.0);
        assert!((t.point_back(t.point(p)) - p).length() < 1e-12);
        assert!((t.direction(p).length() - p.length()).abs() < 1e-12);
        assert!((t.scale() - 2.5).abs() < 1e-12);
    }

    #[test]
    fn malformed_words_are_named() {
        for text in ["-s 0", "-t 1 2", "-q", "-rx nan", "-i 1.5", "-a 3"] {
            let words: Vec<&str> = text.split_whitespace().collect();
            assert!(Transform::parse(&words).is_err(), "{text}");
        }
    }
}
