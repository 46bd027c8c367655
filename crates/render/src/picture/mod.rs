//! From pixels to rays and back: which pixels of a picture are traced and which interpolated, the camera, and the
//! sources too small for the pixels.

mod camera;
mod lattice;
mod order;
mod outline;
mod sampler;
mod slab;
mod small;
#[cfg(test)]
mod tests;

pub use camera::{Camera, Lens};
pub use order::{Batches, hilbert_index};
pub(crate) use outline::outlines;
pub use sampler::{Band, Order, Pixel, PixelRequest, Sampler, Trace};
pub use small::{Aimed, SmallSources, SourceOutline};
