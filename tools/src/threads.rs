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
/// threads.
pub(crate) fn start_threads(wanted: usize) -> Result<(), Failure> {
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    rayon::ThreadPoolBuilder::new()
        .stack_size(STACK)
        .num_threads(sensible(wanted, processors, getrlimit(Resource::As).current))
        .use_current_thread()
        .build_global()
        .map_err(|e| Failure::system("cannot start threads", &std::io::Error::other(e)))
}

/// How many threads to start of those wanted. Where address space is limited (`ulimit -v`, batch systems) there are no more
/// than half of it holds: results are the same.
fn sensible(wanted: usize, processors: usize, space: Option<u64>) -> usize {
    let room = space.map_or(usize::MAX, |space| usize::try_from(space / 2 / SPACE).unwrap_or(usize::MAX));
    wanted.min(processors.max(MOST)).min(room).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_beyond_all_use_or_room_are_not_started() {
        for (wanted, processors, threads) in
            [(1, 2, 1), (16, 2, 16), (512, 2, 512), (1_000_000_000, 2, 512), (600, 1000, 600), (usize::MAX, 1000, 1000)]
        {
            assert_eq!(sensible(wanted, processors, None), threads, "{wanted} {processors}");
            assert_eq!(sensible(wanted, processors, Some(u64::MAX)), threads, "{wanted} {processors}");
        }
        for (threads_of_space, threads) in [(0, 1), (1, 1), (2, 1), (3, 1), (4, 2), (9, 4), (64, 16)] {
            assert_eq!(sensible(16, 2, Some(threads_of_space * SPACE)), threads, "{threads_of_space}");
        }
    }
}
