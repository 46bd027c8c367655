//! Radiance scene text to typed records: the lexer, the reader (primitives, commands, aliases), the table of types and
//! the surfaces' geometry.

mod arguments;
mod command;
mod data;
mod error;
mod font;
mod grammar;
mod kind;
mod lexer;
mod names;
mod object;
mod print;
mod reader;
mod surface;
mod text;
mod tokens;
mod xform;

pub use arguments::{Arguments, RealCount};
pub use command::{CommandOutput, Commands, NoCommands, Runner};
pub use data::{Axis, DataTable, MAX_DIMENSIONS};
pub use error::{AuxiliaryProblem, Error, ErrorClass, ErrorKind, FontProblem, Problem};
pub use font::{Font, GLYPH_SIZE, Glyph};
pub use grammar::real as parse_real;
pub use kind::{Class, KINDS, Kind};
pub use object::{NewObject, Object, ObjectId, Scene, VOID};
pub use reader::Reader;
pub use surface::{Bounds, Complaint, Cone, Facet, Polygon, Ring, Shape, Source, Sphere, Warning};
pub use text::TextBlock;
