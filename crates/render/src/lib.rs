//! What light does: rays and their limits, sources and shadows, one material a file, patterns, and the rounds that fill
//! the irradiance cache.

mod antimatter;
mod braid;
mod corner;
mod error;
mod fingerprint;
mod indirect;
mod materials;
mod observer;
mod options;
mod patterns;
pub mod picture;
mod prepare;
mod ray;
mod renderer;
mod reply;
mod request;
mod shade;
mod sharing;
mod sources;
mod spectral;
mod statistics;
mod tracer;
mod tree;
mod unbounded;
mod walk;
mod work;

pub use ambit_ambient::{Bounces, Clamping, Interpolation, MOST_OVERLAP, Spacing, StepTest, Systems};
pub use ambit_ambient::{Fingerprint, Reuse};
pub use error::Error;
pub use fingerprint::SceneFingerprint;
pub use options::{Ambient, Direct, Limits, Medium, Options, Selection, Specular};
pub use prepare::{Definition, Environment, Loaded, load};
pub use renderer::Renderer;
pub use reply::{Rays, Seen};
pub use request::{Aim, Answer, Request};
pub use sharing::Store;
pub use spectral::{Bins, Efficiency, Spectra, Spectrum};
pub use statistics::Report;
pub use tree::{Names, TreeRay, Visit};
