//! How fast and how exact renderings are: error against a converged reference, curves of error against time, ratios of
//! times at equal error, and tables, files and plots of them.
//!
//! What programs are run and what they cost is the business of a [`Bench`], which the tool implements: nothing here
//! starts a process, reads a clock or prints. Errors are relative to the mean of the reference (no unit), times are
//! seconds; see [`Score`] for the exact definitions.

mod campaign;
mod curve;
mod error;
mod export;
mod ladder;
mod page;
mod parts;
mod plot;
mod ratio;
mod reference;
mod report;
mod score;
mod search;
mod table;

pub use campaign::{Bench, Cost, Job, Output, Plan, Side, make_reference, measure};
pub use curve::{Curve, Point};
pub use error::Error;
pub use export::{to_csv, to_json};
pub use ladder::{Ladder, Rung, SPACINGS, Spacing, super_samples};
pub use page::{Entry, page};
pub use parts::{Part, cells};
pub use plot::{PlotSize, png, svg};
pub use ratio::{Comparison, Level, compare};
pub use reference::{Noise, Reference, radiance};
pub use report::{Program, ReferenceInfo, Report, Row, Run, SideRow, Spread};
pub use score::{Block, Bounded, Score, blocks, score};
pub use search::{Found, Model, SAFETY, Search, Setting, TYPICAL, difference, mean};
pub use table::table;
