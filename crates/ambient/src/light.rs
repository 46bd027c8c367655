//! Light that remembers how much of it came by the last bounces.
//!
//! A record nearer the eye holds more bounces than a deeper question is to be answered with. Radiance answers with all of
//! them, so that `-ab 2` brings some of the light of the third bounce, the more the more records the eye has made. Here
//! hemispheres add up, beside the light that their samples bring, what of it the last bounce and the last two brought, at
//! no ray more; a question one level deeper than the record is answered without the former, two levels deeper without the
//! latter. Ambient files tell it in bits that other programs do not read (`shares`); records that others write answer as in
//! Radiance, with all their bounces.

use ambit_base::Rgb;
use std::ops::{AddAssign, Mul};

/// How many of the last bounces are told apart; questions still deeper are answered as the deepest that is.
pub const APART: usize = 2;

/// Light by bounces: radiance, or irradiance/π, W/(sr·m²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Light {
    /// All of it.
    pub value: Rgb,
    /// What the last bounce, and the last two, brought.
    pub late: [Rgb; APART],
}

impl Light {
    pub(crate) const NONE: Self = Self { value: Rgb::ZERO, late: [Rgb::ZERO; APART] };

    /// The light for a question `levels` deeper than it was computed for.
    pub(crate) fn deeper(self, levels: u8) -> Self {
        let Some(first) = usize::from(levels).checked_sub(1) else { return self };
        let without = self.late[first.min(APART - 1)];
        // No later bounce brings more than an earlier one.
        let step = self.late[1] - self.late[0];
        Self { value: (self.value - without).max(Rgb::ZERO), late: [step, 2.0 * step] }
    }

    /// What a calculation of `bounces` (1 at least) comes to, in place of whose last hemispheres stands `end`.
    pub(crate) fn ending(mut self, bounces: usize, end: Rgb) -> Self {
        for late in self.late.iter_mut().skip(bounces - 1) {
            *late = self.value - end;
        }
        self
    }

    /// Every part multiplied by a colour.
    pub fn times(self, colour: Rgb) -> Self {
        Self { value: self.value * colour, late: self.late.map(|l| l * colour) }
    }
}

impl From<Rgb> for Light {
    /// Light that is the same for every number of bounces, or of which no more is known.
    fn from(value: Rgb) -> Self {
        Self { value, late: [Rgb::ZERO; APART] }
    }
}

impl AddAssign for Light {
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        self.late.iter_mut().zip(other.late).for_each(|(a, b)| *a += b);
    }
}

impl Mul<f32> for Light {
    type Output = Self;

    fn mul(self, factor: f32) -> Self {
        Self { value: self.value * factor, late: self.late.map(|l| l * factor) }
    }
}

impl std::iter::Sum for Light {
    fn sum<I: Iterator<Item = Self>>(lights: I) -> Self {
        lights.fold(Self::default(), |mut sum, light| {
            sum += light;
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(value: f32, late: [f32; APART]) -> Light {
        Light { value: Rgb::splat(value), late: late.map(Rgb::splat) }
    }

    #[test]
    fn deeper_questions_get_fewer_bounces() {
        // Bounces of 8, 4, 2 and 1.
        let whole = light(15.0, [1.0, 3.0]);
        assert_eq!(whole.deeper(0), whole);
        assert_eq!(whole.deeper(1), light(14.0, [2.0, 4.0]), "2 and 6 in truth");
        assert_eq!(whole.deeper(2), light(12.0, [2.0, 4.0]), "4 and 12 in truth");
        assert_eq!(whole.deeper(3), light(12.0, [2.0, 4.0]));
        assert_eq!(light(1.0, [2.0, 2.0]).deeper(1).value, Rgb::ZERO, "no light is negative");
    }

    #[test]
    fn what_has_no_bounces_left_is_the_constant() {
        assert_eq!(light(8.0, [0.0, 0.0]).ending(1, Rgb::splat(0.5)), light(8.0, [7.5, 7.5]));
        assert_eq!(light(12.0, [4.0, 4.0]).ending(2, Rgb::splat(0.5)), light(12.0, [4.0, 11.5]));
        assert_eq!(light(14.0, [2.0, 6.0]).ending(3, Rgb::splat(0.5)), light(14.0, [2.0, 6.0]));
    }
}
