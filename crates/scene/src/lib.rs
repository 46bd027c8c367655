//! Radiance scene text to typed records: the lexer, the reader (primitives, commands, aliases), the table of types and
//! the surfaces' geometry.

mod kind;
mod object;
mod surface;

pub use kind::{Class, KINDS, Kind};
pub use object::{NewObject, Object, ObjectId, Scene, VOID};
pub use surface::{Cone, Polygon, Ring, Shape, Source, Sphere};
