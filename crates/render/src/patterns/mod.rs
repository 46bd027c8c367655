//! Patterns, textures and mixtures: what varies over a surface.

mod auxiliary;
mod builtin_font;
mod compiler;
mod complaints;
mod evaluate;
mod folding;
mod function_file;
mod image;
mod lettering;
mod lookup;
mod mixture;
mod pattern;
mod site;
mod spectral;
mod spectral_image;
mod texture;

pub(crate) use compiler::{Compiler, Functions, Recipe};
pub(crate) use complaints::Complaints;
pub(crate) use mixture::Mixture;
pub(crate) use pattern::Pattern;
pub(crate) use site::fill;
pub(crate) use texture::Texture;
