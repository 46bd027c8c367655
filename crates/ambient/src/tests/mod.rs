//! Filling the cache of a small room: the same bits for any number of threads, and the work of the serial lazy cache.

mod clamping;
mod filling;
mod interpolation;
mod observing;
mod room;
mod serial;
