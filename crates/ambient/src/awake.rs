//! Threads that stay awake between parallel steps.
//!
//! What one thread does between two steps takes some ten microseconds, and so does waking those that have gone to sleep
//! meanwhile. After a step they therefore go on looking for work until none has come for [`PATIENCE`]. This changes when
//! work begins, never what comes out. (A thread may come to look while it waits within a step for what another does for it: rarely,
//! and it goes on at the latest when its patience ends.)

use rayon::Yield;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// How long a thread looks for work: longer than most of what lies between two steps.
const PATIENCE: Duration = Duration::from_micros(100);
/// From when on it lets other programs run in between.
const EAGERNESS: Duration = Duration::from_micros(20);
/// Pauses of the processor between two looks: looking disturbs those who work.
const PAUSES: u32 = 16;

/// Keeps the threads of the pool awake in which it is first asked to.
#[derive(Debug, Default)]
pub(crate) struct Awake(OnceLock<Arc<Kept>>);

/// Which threads are awake.
#[derive(Debug)]
struct Kept {
    count: AtomicUsize,
    /// By index in the pool.
    threads: Vec<AtomicBool>,
}

impl Awake {
    /// Has the other threads look for work for a while. To be called between steps, by the thread that asks for them.
    pub(crate) fn keep(&self) {
        // Steps that are asked for from outside of the pool have nobody to be quick for.
        let Some(caller) = rayon::current_thread_index() else { return };
        let threads = rayon::current_num_threads();
        let kept = self.0.get_or_init(|| Kept::new(threads).into());
        if kept.count.load(Ordering::Relaxed) + 1 >= threads || kept.threads.len() != threads {
            return;
        }
        let kept = Arc::clone(kept);
        rayon::spawn_broadcast(move |thread| {
            if thread.index() != caller {
                kept.look(thread.index());
            }
        });
    }
}

impl Kept {
    fn new(threads: usize) -> Self {
        Self { count: AtomicUsize::new(0), threads: (0..threads).map(|_| AtomicBool::new(false)).collect() }
    }

    /// Does what work there is until none has come for a while.
    fn look(&self, thread: usize) {
        if self.threads[thread].swap(true, Ordering::Relaxed) {
            return;
        }
        self.count.fetch_add(1, Ordering::Relaxed);
        let mut idle: Option<Instant> = None;
        loop {
            match rayon::yield_now() {
                Some(Yield::Executed) => idle = None,
                Some(Yield::Idle) => match idle.get_or_insert_with(Instant::now).elapsed() {
                    waited if waited > PATIENCE => break,
                    waited if waited > EAGERNESS => std::thread::yield_now(),
                    _ => (0..PAUSES).for_each(|_| std::hint::spin_loop()),
                },
                None => break,
            }
        }
        self.threads[thread].store(false, Ordering::Relaxed);
        self.count.fetch_sub(1, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn those_who_are_kept_awake_do_the_work_and_then_give_up() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads can be had");
        let awake = Awake::default();
        let end = Instant::now() + Duration::from_secs(20);
        let in_time = || assert!(Instant::now() < end, "not within twenty seconds");
        pool.install(|| {
            // Until both others look at once, and one of them does a piece while it does.
            let (mut both, mut worked) = (false, false);
            while !(both && worked) {
                in_time();
                awake.keep();
                let kept = awake.0.get().expect("the pool was asked");
                both |= kept.count.load(Ordering::Relaxed) == 2;
                let looking = |_| {
                    let thread = rayon::current_thread_index().expect("a thread of the pool");
                    u32::from(kept.threads[thread].load(Ordering::Relaxed))
                };
                worked |= (0..1000u32).into_par_iter().with_max_len(1).map(looking).sum::<u32>() > 0;
            }
        });
        let kept = awake.0.get().expect("the pool was asked");
        while kept.count.load(Ordering::Acquire) > 0 {
            in_time();
            std::thread::sleep(PATIENCE);
        }
        assert!(kept.threads.iter().all(|t| !t.load(Ordering::Relaxed)));
    }

    #[test]
    fn nobody_is_kept_awake_for_those_outside_of_the_pool() {
        let awake = Awake::default();
        awake.keep();
        assert!(awake.0.get().is_none());
    }
}
