//! What is said at the end of a run about interreflection (`--stats`).

use ambit_ambient::{CORES, Parallelism};
use ambit_render::Report;
use rustix::time::{ClockId, clock_gettime};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Time since the first call.
pub(crate) fn clock() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// Processor time of this thread.
pub(crate) fn own() -> Duration {
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}

/// The lines of a report on a run of so many seconds.
pub(crate) fn lines(report: &Report, seconds: f64) -> Vec<String> {
    let o = &report.observed;
    let share = |part: u64, all: u64| 100.0 * part as f64 / all.max(1) as f64;
    let (asked, answered): (u64, u64) = (o.asked.iter().sum(), o.answered.iter().sum());
    let deepest = o.asked.iter().rposition(|&n| n > 0).map_or(0, |k| k + 1);
    let hits: Vec<String> = (0..deepest).map(|k| format!("{:.2}", share(o.answered[k], o.asked[k]))).collect();
    let mut lines = vec![
        format!("{} made, {} from the ambient file", counted("records", &report.made), counted("", &report.loaded)),
        format!(
            "{asked} look-ups, {:.3} a ray; {:.2} % answered by records (by level: {})",
            asked as f64 / report.rays.max(1) as f64,
            share(answered, asked),
            hits.join(" ")
        ),
        format!(
            "{} in {} rounds, {:.1} % of the time",
            counted("hemisphere samples", &report.samples),
            report.rounds,
            100.0 * report.filling.as_secs_f64() / seconds.max(1e-9)
        ),
        if let Some(deepest) = o.compared.iter().rposition(|&n| n > 0) {
            let told = |(x, &n): (&f64, &u64)| if n > 0 { format!("{:.2}", 100.0 * x) } else { "-".to_owned() };
            let percent = |all: &[f64]| all.iter().zip(&o.compared).map(told).collect::<Vec<_>>().join(" ");
            let (error, difference) = (percent(&o.error[..=deepest]), percent(&o.difference[..=deepest]));
            let of = counted("look-ups", &o.compared[..=deepest]);
            format!(
                "estimated interpolation error by level {error} % (RMS of {of}; records that answer together differ by \
                 {difference} %)"
            )
        } else {
            "interpolation error not estimated: too few look-ups that several records answer".to_owned()
        },
    ];
    lines.extend(report.parallelism.as_ref().map(cores));
    lines
}

/// What the run would take on other numbers of cores.
fn cores(p: &Parallelism) -> String {
    let seconds = |k: usize| p.time(k).as_secs_f64();
    let others: Vec<String> = (1..CORES.len()).map(|k| format!("{:.3} on {}", seconds(k), CORES[k])).collect();
    format!(
        "{} parallel steps of {} tasks, {:.2} % of the work outside of them; by model {:.3} s on one core, {} ({:.1} us a \
         step)",
        p.steps,
        p.pieces,
        100.0 * p.serial.as_secs_f64() / seconds(0).max(1e-9),
        seconds(0),
        others.join(", "),
        1e6 * p.step.as_secs_f64(),
    )
}

/// A sum, what it is of, and its parts by level.
fn counted(what: &str, levels: &[u64]) -> String {
    let total: u64 = levels.iter().sum();
    let name = if what.is_empty() { String::new() } else { format!(" {what}") };
    if total == 0 {
        return format!("{total}{name}");
    }
    let parts: Vec<String> = levels.iter().map(u64::to_string).collect();
    format!("{total}{name} (by level: {})", parts.join(" "))
}
