//! Small types that every crate of Ambit shares: constants of the simulation, colours, transforms, coordinate frames,
//! random sequences, warps of the unit square, places in text files and the channel for warnings.
//!
//! Conventions: lengths are scene units, radiance is W/(sr·m²) per channel, angles are radians unless a name says degrees,
//! positions and directions are `f64`, colours and weights are `f32`.

mod colour;
mod frame;
mod hash;
mod notify;
mod sequence;
mod transform;
mod warp;

pub use colour::{Colour, LUMINOUS_EFFICACY, Rgb, TO_XYZ, desaturated};
pub use frame::Frame;
pub use hash::{hash_bits, hash_point, mix};
pub use notify::{Location, Notify, Silent};
pub use sequence::Stream;
pub use transform::{Transform, TransformError};
pub use warp::{disk_to_square, square_to_disk};

pub use glam::{DMat3, DVec3, Vec3};

/// The absolute "tiny" of the simulation, in scene units or radians: hits no farther than this are refused, and
/// quantities no larger than this count as zero. Radiance fixes it, so results near it agree.
pub const EPSILON: f64 = 1e-6;

/// The absolute "infinite" distance, in scene units: what a ray that leaves the scene has travelled.
pub const FAR: f64 = 1e10;
