//! raderr: speed against error of rpict or rtrace, ours or another's.

use std::process::ExitCode;

fn main() -> ExitCode {
    ambit_tools::raderr::main(std::env::args_os())
}
