//! Patterns, textures and mixtures: what varies over a surface.

mod compiler;
mod mixture;
mod pattern;
mod site;
mod texture;

pub(crate) use compiler::Compiler;
pub(crate) use mixture::Mixture;
pub(crate) use pattern::Pattern;
pub(crate) use texture::Texture;
