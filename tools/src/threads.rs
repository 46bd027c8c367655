//! How many threads a rendering program has, and their stacks.

use ambit_cli::{Failure, say};
use ambit_file::variable;
use rustix::process::{Resource, getrlimit};
use std::process::ExitCode;

/// The variable that [`processors`] asks.
const THREADS: &str = "AMBIT_THREADS";

/// How many threads to use unless `-n` says so: one a processor, or what the environment says. Packages that start a
/// program on each processor give none of them `-n`, and would have as many threads as the square of their number.
pub(crate) fn processors() -> Result<usize, Failure> {
    let Some(value) = variable(THREADS).filter(|value| !value.is_empty()) else {
        return Ok(std::thread::available_parallelism().map_or(1, std::num::NonZero::get));
    };
    match value.parse() {
        Ok(threads) if threads > 0 => Ok(threads),
        _ => Err(Failure::user(format!("bad {THREADS} '{value}' (expected a whole number above 0)"))),
    }
}

/// Bytes of stack of every thread that follows rays: enough for as many reflections as a ray may have, one waiting for the
/// next. Only what is used takes memory.
const STACK: usize = 128 << 20;

/// Address space that a thread takes: its stack, and what the C library sets apart for its memory.
const SPACE: u64 = 2 * STACK as u64;

/// More threads than this, and than there are processors, bring nothing: a slip of the finger should not take minutes to
/// start them.
const MOST: usize = 512;

/// Runs a program of this name on a thread with that much stack.
pub(crate) fn on_deep_stack(name: &str, program: impl FnOnce() -> ExitCode + Send + 'static) -> ExitCode {
    let thread = std::thread::Builder::new().name("main".into()).stack_size(STACK).spawn(program);
    match thread.map(std::thread::JoinHandle::join) {
        Ok(Ok(status)) => status,
        // The thread has said why it panicked.
        Ok(Err(_)) => ExitCode::from(3),
        Err(e) => {
            say(format_args!("{name}: system - cannot start a thread: {e}"));
            ExitCode::from(2)
        }
    }
}

/// Starts the threads that share the work; the one that calls is one of them: a step that runs alone costs no change of
/// threads. Where address space is limited (`ulimit -v`, batch systems) there are no more than half of it holds, whatever
/// is wanted: results are the same.
pub(crate) fn start_threads(wanted: usize) -> Result<(), Failure> {
    let limit = getrlimit(Resource::As).current;
    let room = limit.map_or(usize::MAX, |space| (space / 2 / SPACE) as usize);
    let useful = std::thread::available_parallelism().map_or(MOST, |n| n.get().max(MOST));
    rayon::ThreadPoolBuilder::new()
        .stack_size(STACK)
        .num_threads(wanted.min(useful).min(room).max(1))
        .use_current_thread()
        .build_global()
        .map_err(|e| Failure::system("cannot start threads", &std::io::Error::other(e)))
}
