//! Radiance file formats as bytes, with no knowledge of rendering: portable numbers, information headers, resolution
//! strings, pixel codes, pictures, views, direction codes, words, the search path, record locks and export to formats
//! that other programs read.
//!
//! Nothing here reads arguments, the environment or the clock; the tool passes such values in. Lengths are scene
//! units, angles of views are degrees as users write them, radiance is W/(sr·m²) per channel.

mod command;
mod cursor;
mod direction;
mod error;
mod export;
mod header;
mod lock;
mod native;
mod picture;
mod portable;
mod printf;
mod replace;
mod resolution;
mod rgbe;
mod search;
mod stamp;
mod view;
mod words;

pub use command::{base_name, command_line};
pub use cursor::Cursor;
pub use direction::{decode_direction, encode_direction};
pub use error::{Error, os_text};
pub use export::{ExportError, Exposure, Transfer, write_exr, write_png};
pub use header::{Header, alignment, format_line, format_padding};
pub use lock::{FileLock, LockError, LockMode};
pub use native::{bytes_of, name_of, path_of, text_of, variable, word_of};
pub use picture::{Picture, PictureReader, PictureWriter, PixelSpace, decode_scanline, encode_flat, encode_scanline};
pub use portable::{FLOAT_BYTES, PortableRead, PortableWrite, SPARE};
pub use portable::{decode_float, decode_single, encode_float, encode_single};
pub use printf::{exponent, fixed, general};
pub use replace::Replacement;
pub use resolution::{Axis, Orientation, Resolution};
pub use rgbe::{decode_pixel, decode_spectrum, encode_pixel, encode_spectrum};
pub use search::{DEFAULT_PATH, Found, Library, SearchPath};
pub use stamp::{Zone, capture_lines};
pub use view::{Fit, Projection, View, ViewError, ViewOption, ViewRay, ViewType, fit_resolution, is_view_line};
pub use words::{WORD_LIMIT, boundless_real, integer, read_words, real, short_decimal, split_words};
