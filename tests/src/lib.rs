//! Helpers of the tests that run the finished programs.
//!
//! Everything here looks at the programs from outside: it starts them, feeds them text, reads what they print and how
//! they end. Nothing links against the simulator's own crates, so that a test says what a user of the programs sees.
//!
//! * [`programs`] finds the programs (built on demand, or the folder that `AMBIT_TOOLS_DIR` names) and runs them.
//! * [`cases`] reads the table of check cases and compares answers with it.
//! * [`report`] runs a whole table of them.
//! * [`fixtures`] finds the bundled scenes and compiles them.

pub mod cases;
pub mod fixtures;
pub mod programs;
pub mod report;

pub use cases::{Case, Table};
pub use fixtures::Fixture;
pub use programs::{Answer, Program};
