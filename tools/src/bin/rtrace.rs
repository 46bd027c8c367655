//! rtrace: rays on standard input to radiance, irradiance or geometry on standard output.

use std::process::ExitCode;

fn main() -> ExitCode {
    ambit_tools::rtrace::main(std::env::args_os())
}
