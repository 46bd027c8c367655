//! The command line of the rendering programs in Radiance's exact forms: options, their values, `@file` and `$VAR`,
//! `-defaults`, messages, exit codes, signals and progress reports.
//!
//! One table of options a program ([`Row`]) is the source of everything: how arguments are read, what `-defaults`
//! prints, `--help`, man pages and completions. Reading fills a complete struct of parameters; what to do with it is
//! the program's business. Nothing here reads the environment, the clock or standard input: a program hands these in
//! ([`Outside`]).

mod common;
mod console;
mod defaults;
mod failure;
mod features;
mod goal;
mod help;
mod outside;
mod picture;
mod progress;
mod rays;
mod rendering;
mod scan;
mod signals;
mod spec;
mod spectrum;
mod standard;
mod systems;
mod table;
mod viewing;

pub use common::{Carries, Common, Output, SCOTOPIC_EFFICACY};
pub use console::{ConsoleMessages, attach_error_file, say};
pub use defaults::defaults;
pub use failure::{Class, Failure};
pub use features::{COMMON_FEATURES, Features, PICTURE_FEATURES, RAY_FEATURES};
pub use help::{About, command, completions, long_help, man_page};
pub use outside::{Outside, Process};
pub use picture::{PictureOptions, picture_table};
pub use progress::{Progress, Times};
pub use rays::{InputFormat, OutputFormat, RayOptions, ray_table};
pub use rendering::{Function, PhotonMap, Rendering};
pub use scan::{Arguments, Scan, scan};
pub use signals::{Caught, Signals};
pub use spec::{Field, OutputSpec, TreeSpec};
pub use spectrum::Spectrum;
pub use standard::{StandardOutput, answer, broken_pipes_end};
pub use table::{Label, Place, Row};

/// What `-version` prints and what headers record as the software: the version of Radiance whose files and options
/// these are, then our own.
pub const VERSION: &str = concat!("RADIANCE 6.0a (Ambit ", env!("CARGO_PKG_VERSION"), ")");
