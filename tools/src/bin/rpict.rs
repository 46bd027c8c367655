//! rpict: an octree and a view to a picture on standard output.

use std::process::ExitCode;

fn main() -> ExitCode {
    ambit_tools::rpict::main(std::env::args_os())
}
