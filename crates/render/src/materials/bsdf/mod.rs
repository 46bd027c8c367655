//! BSDF and aBSDF: scattering tabulated in files, as matrices over Klems bases or as tensor trees.
//!
//! A file ([`xml`]) holds up to four components. Each is split into a Lambertian part and a lobe, and the lobe of an
//! aBSDF's transmission may hold a peak that is seen through ([`through`]). Values are in 1/sr; they are constant over
//! the cells of the data. In evaluation the direction to the viewer is the incident one.

mod arguments;
mod basis;
mod colour;
mod data;
mod klems;
mod lobe;
mod material;
mod numbers;
mod sample;
#[cfg(test)]
mod tests;
mod through;
mod tree;
mod tree_lobe;
mod tree_text;
mod xml;

pub(crate) use arguments::Bsdf;
pub(crate) use data::Distribution;
