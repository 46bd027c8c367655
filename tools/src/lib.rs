//! The command-line tools of Ambit live in `src/bin`, one program a file. What the rendering programs share, and their
//! parts, is here.

mod colour;
mod goal;
mod light;
mod quantity;
pub mod raderr;
pub mod rpict;
pub mod rtrace;
mod session;
mod spectral;
mod statistics;
mod threads;

pub use session::search_path;
