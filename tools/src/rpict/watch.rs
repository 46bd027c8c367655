//! Progress while a picture is made: reports every so many seconds, or a bar on a terminal.

use crate::session::Session;
use std::io::{self, IsTerminal, Write};

/// Seconds between two states of the bar.
const BAR_INTERVAL: f64 = 0.2;
/// Characters of the bar.
const BAR_WIDTH: usize = 30;

/// Watches one picture.
pub(crate) struct Watch<'a> {
    session: &'a Session,
    /// Seconds between reports; 0 for none.
    interval: f64,
    bar: bool,
    last: f64,
    start: f64,
}

impl<'a> Watch<'a> {
    /// Starts with a report if there are to be some.
    pub(crate) fn start(session: &'a Session, interval: i32, percent: f64) -> Self {
        session.meter.set_percent(percent);
        let interval = f64::from(interval.max(0));
        if interval > 0.0 {
            session.meter.report();
        }
        let now = session.meter.seconds();
        let bar = interval == 0.0 && session.messages.warnings && io::stderr().is_terminal();
        Self { session, interval, bar, last: now, start: now }
    }

    /// Notes how far the picture is.
    pub(crate) fn step(&mut self, percent: f64) {
        self.session.meter.set_percent(percent);
        let now = self.session.meter.seconds();
        if self.interval > 0.0 && now - self.last >= self.interval {
            self.last = now;
            self.session.meter.report();
        }
        if self.bar && now - self.last >= BAR_INTERVAL {
            self.last = now;
            let full = (percent / 100.0 * BAR_WIDTH as f64) as usize;
            let spent = now - self.start;
            let left = if percent > 0.0 { spent * (100.0 - percent) / percent } else { 0.0 };
            let bar: String = (0..BAR_WIDTH).map(|i| if i < full { '█' } else { '░' }).collect();
            let _ = write!(io::stderr(), "\r{bar} {percent:5.1} %  {}  {} left\x1b[K", clock(spent), clock(left));
        }
    }

    /// Ends with a report.
    pub(crate) fn finish(&mut self) {
        self.session.meter.set_percent(100.0);
        if self.interval > 0.0 {
            self.session.meter.report();
        }
    }
}

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        if self.bar {
            let _ = write!(io::stderr(), "\r\x1b[K");
        }
    }
}

/// Seconds as minutes and seconds, with hours if there are any.
fn clock(seconds: f64) -> String {
    let s = seconds as u64;
    if s >= 3600 {
        format!("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
    } else {
        format!("{}:{:02}", s / 60, s % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::clock;

    #[test]
    fn clocks_count_minutes() {
        assert_eq!([clock(5.9), clock(65.0), clock(3725.0)], ["0:05", "1:05", "1:02:05"]);
    }
}
