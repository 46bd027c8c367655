//! Progress reports: how many rays, how much of the picture, and the time it took.

use std::fs;
use std::time::{Duration, Instant};

/// Seconds in an hour: reports count time in hours.
const HOUR: f64 = 3600.0;

/// Time that a process has used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// In the program, seconds.
    pub user: f64,
    /// In the system for it, seconds.
    pub system: f64,
    /// By the clock, seconds.
    pub elapsed: f64,
}

/// What reports need to know of the process.
#[derive(Clone, Debug)]
pub struct Progress {
    program: String,
    host: String,
    pid: u32,
    start: Instant,
}

impl Progress {
    /// Reports of this process, which starts now.
    pub fn start(program: &str) -> Self {
        let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
        Self { program: program.to_owned(), host, pid: std::process::id(), start: Instant::now() }
    }

    /// The report, without newline, after so many rays and this percentage of the picture.
    pub fn line(&self, rays: u64, percent: f64) -> String {
        self.line_at(rays, percent, self.times())
    }

    fn line_at(&self, rays: u64, percent: f64, t: Times) -> String {
        let Self { program, host, pid, .. } = self;
        let (user, system, elapsed) = (t.user / HOUR, t.system / HOUR, t.elapsed / HOUR);
        format!(
            "{program}: {rays} rays, {percent:4.2}% after {user:.3}u {system:.3}s {elapsed:.3}r hours on {host} (PID {pid})"
        )
    }

    /// How long the process has been running.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// The time used so far.
    pub fn times(&self) -> Times {
        let elapsed = self.start.elapsed().as_secs_f64();
        let (user, system) = ticks().unwrap_or_else(|| (processor_time(), 0.0));
        Times { user, system, elapsed }
    }
}

/// User and system time of the process from `/proc`, where there is one.
fn ticks() -> Option<(f64, f64)> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The second field, a name in parentheses, may have blanks; user and system time are the 14th and 15th.
    let mut fields = stat[stat.rfind(')')? + 1..].split_ascii_whitespace().skip(11);
    let second = rustix::param::clock_ticks_per_second() as f64;
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some((next()? / second, next()? / second))
}

/// Processor time of all kinds.
fn processor_time() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_have_the_form_that_scripts_read() {
        let progress = Progress { program: "rpict".into(), host: "h".into(), pid: 7, start: Instant::now() };
        let times = Times { user: 1.8, system: 0.0, elapsed: 3.6 };
        assert_eq!(
            progress.line_at(1039783, 84.7777, times),
            "rpict: 1039783 rays, 84.78% after 0.001u 0.000s 0.001r hours on h (PID 7)"
        );
        assert!(progress.line(0, 0.0).starts_with("rpict: 0 rays, 0.00% after 0.000u "));
    }

    #[test]
    fn time_passes() {
        let (user, system) = ticks().unwrap_or_default();
        assert!(user >= 0.0 && system >= 0.0 && processor_time() > 0.0);
    }
}
