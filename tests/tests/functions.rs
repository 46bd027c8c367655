//! The check cases of `tests/cases/functions.tsv`: the function language and data files in the finished programs oconv
//! and rtrace. (What calculators do with the language is tested beside the crate `cal`.)
//!
//! Numbers as arguments run these cases only; [`ambit_tests::report`] says what passes.

use std::process::ExitCode;

fn main() -> ExitCode {
    ambit_tests::report::run("functions")
}
