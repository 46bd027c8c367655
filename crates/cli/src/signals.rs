//! Signals: most end the program with status 3, after a message and with its files whole; SIGCONT asks for a report.

use crate::standard::starts_ignoring;
use signal_hook::consts::{SIGALRM, SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
use signal_hook::iterator::Signals as Stream;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// How long a program may take to close its files after a signal; then it ends all the same.
const PATIENCE: Duration = Duration::from_secs(15);

/// How often it is looked whether the program has come to its end.
const GLANCE: Duration = Duration::from_millis(20);

/// A signal that ends the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Caught(i32);

impl Caught {
    /// The name in the message `signal - NAME`.
    pub fn name(self) -> &'static str {
        match self.0 {
            SIGINT => "Interrupt",
            SIGHUP => "Hangup",
            SIGTERM => "Terminate",
            SIGALRM => "Alarm clock",
            SIGXCPU => "CPU limit exceeded",
            SIGXFSZ => "File size exceeded",
            _ => "Unknown",
        }
    }
}

/// The signals of this process.
#[derive(Clone, Debug)]
pub struct Signals {
    ended: Arc<AtomicBool>,
    working: Arc<AtomicBool>,
}

impl Signals {
    /// Starts to watch. `on_end` is called from another thread for the first signal that ends the program: it prints
    /// the message and asks the work to stop; if work has begun, the program then has 15 seconds to close its files
    /// and exit, before it is ended with status 3. A second signal ends it at once with the signal's number.
    /// `on_report` is called for SIGCONT.
    ///
    /// Signals that the parent had ignored stay ignored.
    ///
    /// # Errors
    /// If the system refuses to hand out signals.
    pub fn watch(on_end: impl Fn(Caught) + Send + 'static, on_report: impl Fn() + Send + 'static) -> io::Result<Self> {
        let wanted = [SIGINT, SIGHUP, SIGTERM, SIGALRM, SIGXCPU, SIGXFSZ, SIGCONT];
        let mut stream = Stream::new(wanted.into_iter().filter(|&s| !starts_ignoring(s)))?;
        let ended = Arc::new(AtomicBool::new(false));
        let working = Arc::new(AtomicBool::new(false));
        let (done, busy) = (Arc::clone(&ended), Arc::clone(&working));
        thread::Builder::new().name("signals".into()).spawn(move || {
            for signal in stream.forever() {
                if signal == SIGCONT {
                    on_report();
                } else {
                    on_end(Caught(signal));
                    let end = Instant::now() + PATIENCE;
                    while busy.load(Ordering::Acquire) && Instant::now() < end && !done.load(Ordering::Acquire) {
                        if let Some(second) = stream.pending().find(|&s| s != SIGCONT) {
                            std::process::exit(second);
                        }
                        thread::sleep(GLANCE);
                    }
                    if !done.load(Ordering::Acquire) {
                        std::process::exit(3);
                    }
                    return;
                }
            }
        })?;
        Ok(Self { ended, working })
    }

    /// Tells the watcher that there are files to close from now on.
    pub fn begin_work(&self) {
        self.working.store(true, Ordering::Release);
    }

    /// Tells the watcher that the program ends by itself now.
    pub fn finish(&self) {
        self.ended.store(true, Ordering::Release);
    }
}
