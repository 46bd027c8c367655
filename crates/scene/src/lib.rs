//! Radiance scene text to typed records: the lexer, the reader (primitives, commands, aliases), the table of types and
//! the surfaces' geometry.

mod error;
mod kind;
mod object;
mod surface;

pub use error::{AuxiliaryProblem, Error, ErrorClass, ErrorKind, Problem};
pub use kind::{Class, KINDS, Kind};
pub use object::{NewObject, Object, ObjectId, Scene, VOID};
pub use surface::{Bounds, Complaint, Cone, Facet, Polygon, Ring, Shape, Source, Sphere, Warning};
