//! The check cases of `tests/cases/shading.tsv` over the finished programs oconv and rtrace.
//!
//! Numbers as arguments run these cases only; [`ambit_tests::report`] says what passes.

use std::process::ExitCode;

fn main() -> ExitCode {
    ambit_tests::report::run("shading")
}
