//! Parallel steps whose results do not depend on the number of threads: collected by index, never reduced; and what they
//! would take on other numbers of cores.
//!
//! A run is a row of parallel steps with serial work between them. A step is a list of chains, which do not wait for each
//! other: work of one thread, pieces that several may do, work of one thread again. Who asks for it has all of it timed,
//! by the processor time of the thread that does it, which neither other programs nor waiting disturb. The pieces are then
//! dealt out anew, in order, each to the first of P cores that is free: with the serial work, and what a step costs beside
//! its pieces, that is the time the run would take on P cores. A run that is not timed has nothing of this but one question
//! a step. Either has its threads stay awake between steps.

use crate::awake::Awake;
use crate::observe::Clock;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Numbers of cores that a timed run is modelled on.
pub const CORES: [usize; 4] = [1, 2, 8, 64];

/// `f(0), f(1), … f(count − 1)` in parallel, in tasks of `piece`.
fn in_order<R: Send>(count: usize, piece: usize, f: impl Fn(usize) -> R + Sync + Send) -> Vec<R> {
    (0..count).into_par_iter().with_min_len(piece).with_max_len(piece).map(f).collect()
}

/// Readings of a clock that tell what one takes.
const READINGS: u32 = 256;

/// Does parallel steps, and times them if it is told to.
#[derive(Debug, Default)]
pub struct Steps {
    timed: Option<Timed>,
    awake: Awake,
}

#[derive(Debug)]
struct Timed {
    /// Time by the wall.
    wall: Clock,
    /// Processor time of the thread that asks.
    own: Clock,
    /// What reading that takes.
    reading: Duration,
    times: Mutex<Times>,
}

#[derive(Debug, Default)]
struct Times {
    /// Of the calling thread, when the last step had been dealt with.
    since: Duration,
    serial: Duration,
    /// The steps' pieces on each number of [`CORES`].
    steps: [Duration; CORES.len()],
    count: u64,
    pieces: u64,
    /// By the wall, what each step took beyond its pieces on as many cores as there are threads.
    beyond: Vec<Duration>,
}

/// What a run takes, and would take on other numbers of cores.
#[derive(Clone, Debug, PartialEq)]
pub struct Parallelism {
    /// Parallel steps; one whose chains have several stages counts as so many.
    pub steps: u64,
    /// Their pieces.
    pub pieces: u64,
    /// Processor time outside of steps.
    pub serial: Duration,
    /// Time of the pieces on each number of [`CORES`], those of the first one after the other.
    pub parallel: [Duration; CORES.len()],
    /// By the wall, what a step takes beside its pieces: the median, which other programs hardly disturb.
    pub step: Duration,
}

/// The chain that a thread is at.
#[derive(Debug)]
pub(crate) struct Chain {
    /// Processor time of the thread that asks, if it is wanted.
    own: Option<Clock>,
    /// Of this thread, when its present work began.
    since: Duration,
    stages: Vec<Stage>,
}

/// Work of one thread, and the pieces that come after it.
#[derive(Clone, Debug, Default)]
struct Stage {
    alone: Duration,
    pieces: Vec<Duration>,
}

impl Chain {
    fn new(own: Option<Clock>) -> Self {
        Self { own, since: own.map_or(Duration::ZERO, |own| own()), stages: Vec::new() }
    }

    /// `f(0), f(1), … f(count − 1)` in parallel, in tasks of `piece`.
    pub(crate) fn in_order<R: Send>(
        &mut self,
        count: usize,
        piece: usize,
        f: impl Fn(usize) -> R + Sync + Send,
    ) -> Vec<R> {
        let Some(own) = self.own else { return in_order(count, piece, f) };
        let alone = own().saturating_sub(self.since);
        let parts = in_order(count.div_ceil(piece), 1, |k| {
            let start = own();
            let part: Vec<R> = (k * piece..count.min((k + 1) * piece)).map(&f).collect();
            (part, own().saturating_sub(start))
        });
        let pieces = parts.iter().map(|p| p.1).collect();
        self.stages.push(Stage { alone, pieces });
        // While this thread waited it did pieces of others.
        self.since = own();
        parts.into_iter().flat_map(|p| p.0).collect()
    }

    fn end(mut self) -> Vec<Stage> {
        let alone = self.own.map_or(Duration::ZERO, |own| own().saturating_sub(self.since));
        self.stages.push(Stage { alone, pieces: Vec::new() });
        self.stages
    }
}

impl Steps {
    /// Steps that are timed from now on: by the wall, and by the processor time of the thread that asks. The calling thread
    /// is the one whose work between the steps counts.
    pub fn timed(wall: Clock, own: Clock) -> Self {
        let start = wall();
        for _ in 0..READINGS {
            own();
        }
        let reading = wall().saturating_sub(start) / READINGS;
        let times = Times { since: own(), ..Times::default() };
        Self { timed: Some(Timed { wall, own, reading, times: Mutex::new(times) }), awake: Awake::default() }
    }

    /// `f(0), f(1), … f(count − 1)`, from `least` on in parallel, in tasks of `piece`. Steps must not lie within steps.
    pub fn in_order<R: Send>(
        &self,
        count: usize,
        least: usize,
        piece: usize,
        f: impl Fn(usize) -> R + Sync + Send,
    ) -> Vec<R> {
        if count < least {
            return (0..count).map(f).collect();
        }
        let all = match &self.timed {
            None => in_order(count, piece, f),
            Some(timed) => timed.step(|own| {
                let mut chain = Chain::new(Some(own));
                let all = chain.in_order(count, piece, f);
                (all, vec![chain.end()])
            }),
        };
        self.awake.keep();
        all
    }

    /// `f` of each piece of work, in parallel, each of which may use others for a part of its work.
    pub(crate) fn chains<W: Send, R: Send>(
        &self,
        work: Vec<W>,
        f: impl Fn(W, &mut Chain) -> R + Sync + Send,
    ) -> Vec<R> {
        let work = work.into_par_iter().with_max_len(1);
        let all = match &self.timed {
            None => work.map(|piece| f(piece, &mut Chain::new(None))).collect(),
            Some(timed) => timed.step(|own| {
                let each = work.map(|piece| {
                    let mut chain = Chain::new(Some(own));
                    let result = f(piece, &mut chain);
                    (result, chain.end())
                });
                each.unzip()
            }),
        };
        self.awake.keep();
        all
    }

    /// What has been timed so far, if it was; the thread that began asks.
    pub fn parallelism(&self) -> Option<Parallelism> {
        let timed = self.timed.as_ref()?;
        let now = (timed.own)();
        let times = timed.times.lock().unwrap_or_else(PoisonError::into_inner);
        let mut beyond = times.beyond.clone();
        let middle = beyond.len() / 2;
        let step = if beyond.is_empty() { Duration::ZERO } else { *beyond.select_nth_unstable(middle).1 };
        Some(Parallelism {
            steps: times.count,
            pieces: times.pieces,
            serial: times.serial + now.saturating_sub(times.since),
            parallel: times.steps,
            step,
        })
    }
}

impl Timed {
    /// Does a step, which returns its chains beside what it is done for.
    fn step<R>(&self, step: impl FnOnce(Clock) -> (R, Vec<Vec<Stage>>)) -> R {
        let serial_until = (self.own)();
        let start = (self.wall)();
        let (result, chains) = step(self.own);
        let took = (self.wall)().saturating_sub(start);
        let mut times = self.times.lock().unwrap_or_else(PoisonError::into_inner);
        let since = times.since;
        times.serial += serial_until.saturating_sub(since);
        for (total, cores) in times.steps.iter_mut().zip(CORES) {
            *total += dealt(&chains, cores);
        }
        let stages = chains.iter().map(|c| c.iter().filter(|s| !s.pieces.is_empty()).count()).max().unwrap_or(0).max(1);
        times.count += stages as u64;
        let pieces: usize = chains.iter().flatten().map(|s| s.pieces.len()).sum();
        times.pieces += pieces as u64;
        // A piece reads the clock twice, and one of the readings counts as its own.
        let threads = rayon::current_num_threads();
        let readings = self.reading * pieces as u32 / threads as u32;
        let beyond = took.saturating_sub(dealt(&chains, threads) + readings);
        times.beyond.push(beyond / stages as u32);
        times.since = (self.own)();
        result
    }
}

impl Parallelism {
    /// The time on the number of [`CORES`] with this index. A step's work is handed on from thread to thread, each time to twice
    /// as many: it costs what was measured once for each doubling of the cores.
    pub fn time(&self, index: usize) -> Duration {
        let doublings = CORES[index].max(2).ilog2();
        self.serial + self.parallel[index] + self.step * (doublings * self.steps as u32)
    }
}

/// The time that chains take whose pieces are dealt out in order, each to the first core that is free.
fn dealt(chains: &[Vec<Stage>], cores: usize) -> Duration {
    if cores <= 1 {
        return chains.iter().flatten().map(|s| s.alone + s.pieces.iter().sum::<Duration>()).sum();
    }
    // Twice a stage: what is done alone, then the pieces.
    let phase = |chain: usize, k: usize| -> Option<&[Duration]> {
        let stage = chains[chain].get(k / 2)?;
        Some(if k.is_multiple_of(2) { std::slice::from_ref(&stage.alone) } else { &stage.pieces })
    };
    // Of each chain, its phase and how many pieces of that are not done.
    let mut at: Vec<(usize, usize)> = vec![(0, 1); chains.len()];
    let mut ready: BinaryHeap<Reverse<(usize, usize, Duration)>> =
        (0..chains.len()).filter_map(|c| Some(Reverse((c, 0, *phase(c, 0)?.first()?)))).collect();
    let mut running: BinaryHeap<Reverse<(Duration, usize)>> = BinaryHeap::new();
    let mut now = Duration::ZERO;
    loop {
        while running.len() < cores
            && let Some(Reverse((chain, _, piece))) = ready.pop()
        {
            running.push(Reverse((now + piece, chain)));
        }
        let Some(Reverse((end, chain))) = running.pop() else { return now };
        now = end;
        let (k, left) = &mut at[chain];
        *left -= 1;
        while *left == 0 {
            *k += 1;
            let Some(pieces) = phase(chain, *k) else { break };
            *left = pieces.len();
            ready.extend(pieces.iter().enumerate().map(|(i, &piece)| Reverse((chain, i, piece))));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    fn stage(alone: u64, pieces: &[u64]) -> Stage {
        let pieces = pieces.iter().map(|&t| Duration::from_millis(t)).collect();
        Stage { alone: Duration::from_millis(alone), pieces }
    }

    fn milliseconds(chains: &[Vec<Stage>], cores: usize) -> u128 {
        dealt(chains, cores).as_millis()
    }

    #[test]
    fn pieces_go_to_the_first_core_that_is_free() {
        let chains = [vec![stage(0, &[4, 1, 1, 1, 5])]];
        // On two: 4 and 1 + 1 + 1, then 5 after the three. On three: 4, 1 + 1, 1 + 5.
        assert_eq!([1, 2, 3, 5, 64].map(|cores| milliseconds(&chains, cores)), [12, 8, 6, 5, 5]);
        assert_eq!([1, 8].map(|cores| milliseconds(&[], cores)), [0, 0]);
    }

    #[test]
    fn chains_wait_for_their_own_pieces_only() {
        let chain = || vec![stage(1, &[2, 2]), stage(3, &[]), stage(1, &[4])];
        // 1, then 2 and 2 on two cores, then 3, 1 and 4.
        assert_eq!([1, 2, 64].map(|cores| milliseconds(&[chain()], cores)), [13, 11, 11]);
        // The second's first pieces fill the gap beside the first's 3: 1, 1; 2, 2; then 3 beside 2 and 2.
        let two = [chain(), chain()];
        assert_eq!(milliseconds(&two, 1), 26);
        assert!((13..=15).contains(&milliseconds(&two, 2)), "{}", milliseconds(&two, 2));
        assert_eq!(milliseconds(&two, 4), 11);
    }

    /// A clock that goes on by a millisecond whenever it is read.
    fn tick() -> Duration {
        static READ: AtomicU64 = AtomicU64::new(0);
        Duration::from_millis(READ.fetch_add(1, Ordering::Relaxed))
    }

    #[test]
    fn timing_returns_the_same_and_counts_all() {
        let f = |k: usize| k * k;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be had");
        pool.install(|| {
            let (plain, timed) = (Steps::default(), Steps::timed(tick, tick));
            assert_eq!(plain.parallelism(), None);
            for count in [0, 1, 7, 8, 9, 100] {
                assert_eq!(plain.in_order(count, 8, 3, f), timed.in_order(count, 8, 3, f));
            }
            // Of 8, 9 and 100 at 3 a piece; each piece lasts from one reading of the clock to the next, and so does what
            // comes before and after the pieces.
            let p = timed.parallelism().expect("it was timed");
            assert_eq!((p.steps, p.pieces), (3, 3 + 3 + 34));
            assert_eq!(p.parallel.map(|d| d.as_millis()), [40 + 6, 2 + 2 + 17 + 6, 1 + 1 + 5 + 6, 3 + 6]);
            assert!(p.serial > Duration::ZERO, "{p:?}");
            assert!(p.time(1) < p.time(0), "{p:?}");
        });
    }
}
