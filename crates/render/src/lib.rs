//! What light does: rays and their limits, sources and shadows, one material a file, patterns, and the rounds that fill
//! the irradiance cache.

mod options;
mod request;

pub use options::{Ambient, Direct, Limits, Medium, Options, Selection, Specular};
pub use request::{Aim, Answer, Request};
