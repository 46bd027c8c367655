//! Light sources: the list, how each is sampled, and the direct calculation with its shadow rays.

mod choice;
mod direct;
mod distant;
mod emitter;
mod few;
mod lamp;
mod list;
mod obstacles;
mod partition;
mod scatter;
mod tally;
mod virtual_sources;

pub(crate) use choice::{Choice, Chosen};
pub(crate) use direct::Candidate;
pub(crate) use distant::sensor;
pub(crate) use emitter::{Emitter, Source, Spot};
pub(crate) use lamp::Lamp;
pub(crate) use list::find_sources;
pub(crate) use obstacles::Obstacles;
pub(crate) use partition::Part;
pub(crate) use scatter::name_scatterers;
pub(crate) use tally::{Count, Tally};
pub(crate) use virtual_sources::{Relay, add_virtual_sources};

/// Index in the list of sources.
pub(crate) type SourceId = u32;
