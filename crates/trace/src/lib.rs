//! The nearest hit of a ray, exactly, over millions of surfaces.
//!
//! A [`World`] holds what an octree holds: polygons, spheres, cones, rings, and instances of other worlds and of meshes.
//! obvhs clusters their boxes; the tree becomes eight-wide nodes in f32, wide enough that nothing is lost by rounding;
//! leaves decide in f64 by Radiance's rules (refused distances, tolerances, ties).
//!
//! | module | what it does |
//! |---|---|
//! | `ray` | questions and answers |
//! | `block` | which of eight surfaces may be hit |
//! | `polygon`, `facet`, `quadric`, `trio`, `mesh` | exact hit tests |
//! | `best` | which of several hits counts |
//! | `bounds`, `frame`, `split`, `tree`, `collapse`, `node`, `pages` | building |
//! | `walk`, `simd`, `search` | walking |
//! | `builder`, `world`, `item` | what is built and asked |

// What the walk calls for each leaf must become part of it: as calls they took a tenth of the time of a ray.
#![allow(clippy::inline_always)]

mod best;
mod block;
mod bounds;
mod builder;
mod collapse;
mod facet;
mod frame;
mod item;
mod mesh;
mod node;
mod pages;
mod polygon;
mod quadric;
mod ray;
mod search;
mod simd;
mod split;
mod tree;
mod trio;
mod walk;
mod world;

pub use builder::{BuildError, WorldBuilder};
pub use mesh::{Mesh, MeshGeometry};
pub use ray::{Hit, Opacity, Rank, Ray, Shadow};
pub use world::World;
