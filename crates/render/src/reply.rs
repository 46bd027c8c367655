//! What is asked of a batch of rays, and what is kept of the answers: all that is known, or as little as a picture needs.

use crate::request::{Answer, Request};
use ambit_base::{DVec3, Rgb};

/// Rays by number: each is made by the thread that follows it.
pub trait Rays: Sync {
    /// How many there are.
    fn count(&self) -> usize;
    /// The ray of a number, if there is one.
    fn ray(&self, number: usize) -> Option<Request>;
}

impl Rays for [Request] {
    fn count(&self) -> usize {
        self.len()
    }

    #[inline]
    fn ray(&self, number: usize) -> Option<Request> {
        Some(self[number])
    }
}

/// What a picture needs of an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Radiance.
    pub value: Rgb,
    /// Effective length through transparent and mirroring surfaces.
    pub length: f32,
}

impl From<&Answer> for Seen {
    #[inline]
    fn from(answer: &Answer) -> Self {
        Self { value: answer.value, length: answer.length as f32 }
    }
}

/// What is kept of an answer.
pub(crate) trait Reply: Clone + Send {
    /// What stands for a ray that there is none of.
    fn none() -> Self;

    fn of(answer: Answer) -> Self;

    /// Adds light that came later.
    fn add(&mut self, light: Rgb);

    /// Keeps what is not a number, or infinite, out of pictures and tables.
    fn make_finite(&mut self);
}

fn make_finite(colour: &mut Rgb) {
    if !colour.is_finite() {
        *colour = Rgb::ZERO;
    }
}

impl Reply for Answer {
    fn none() -> Self {
        Self::nothing(DVec3::ZERO, DVec3::ZERO)
    }

    #[inline]
    fn of(answer: Answer) -> Self {
        answer
    }

    fn add(&mut self, light: Rgb) {
        self.value += light;
    }

    fn make_finite(&mut self) {
        make_finite(&mut self.value);
        make_finite(&mut self.mirrored);
    }
}

impl Reply for Seen {
    fn none() -> Self {
        Self::default()
    }

    #[inline]
    fn of(answer: Answer) -> Self {
        Self::from(&answer)
    }

    fn add(&mut self, light: Rgb) {
        self.value += light;
    }

    fn make_finite(&mut self) {
        make_finite(&mut self.value);
    }
}
