//! The octree file: the cube that holds a scene, the tests of surfaces against cubes, the tree built of them, and the
//! file read and written; and the compiled triangle mesh, which is made of the same parts.

mod build;
mod cube;
mod error;
mod format;
mod frozen;
mod geometry;
mod mesh;
mod open;
mod overlap;
mod prepare;
mod read;
mod tree;
mod write;

pub use build::{BuildError, Extended, Limits, build, extend};
pub use cube::{Cube, MARGIN};
pub use error::{Error, Instead, ObjProblem, Problem};
pub use geometry::Geometry;
pub use mesh::{CompiledMesh, MESH_LIMITS, Mesh, compile_mesh, read_mesh};
pub use open::Source;
pub use overlap::{Relation, Volume};
pub use prepare::{Find, Prepared, prepare, prepare_present};
pub use read::{Loaded, read_cube, read_octree, read_scene};
pub use tree::{MOST_IN_SET, MOST_OBJECTS, Node, Tree};
pub use write::{Objects, write};
