//! Where and when a measurement was made, for its report.

use ambit_file::{Zone, capture_lines};
use std::time::SystemTime;

/// The processor, how many of it may be used, and the system.
pub(super) fn describe() -> String {
    // Linux tells the processor's name here; elsewhere the kind of machine has to do.
    let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|l| l.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let system = rustix::system::uname();
    let word = |s: &std::ffi::CStr| s.to_string_lossy().into_owned();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    format!(
        "{}, {cores} cores, {} {}",
        processor.unwrap_or_else(|| word(system.machine())),
        word(system.sysname()),
        word(system.release())
    )
}

/// Universal time, to the second.
pub(super) fn date() -> String {
    let [line, _] = capture_lines(SystemTime::now(), &Zone::UTC);
    let digits = line.split_once('=').map_or("", |(_, d)| d.trim());
    match digits.split_once(' ') {
        Some((day, time)) => format!("{} {time} UTC", day.replace(':', "-")),
        None => digits.to_owned(),
    }
}
