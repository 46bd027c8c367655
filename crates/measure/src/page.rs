//! The published page: every scene's curve, numbers and circumstances in Markdown.

use crate::ratio::Comparison;
use crate::report::{Report, SideRow};
use crate::table::{DEFINITIONS, notes, seconds};
use std::fmt::Write;

/// One scene on the page.
#[derive(Clone, Debug)]
pub struct Entry {
    /// What was measured.
    pub report: Report,
    /// Its plot, as the page refers to it.
    pub plot: String,
}

/// The page: a summary, then each scene. `command` is what makes it anew.
pub fn page(entries: &[Entry], command: &str) -> String {
    let mut out = String::new();
    // Writing to a string can not fail.
    let _ = write_page(&mut out, entries, command);
    out
}

fn write_page(out: &mut String, entries: &[Entry], command: &str) -> std::fmt::Result {
    writeln!(out, "# Speed against error\n")?;
    writeln!(
        out,
        "How long each program takes to come how near a converged reference, from coarse settings to fine ones. \
         A number for speed says nothing without the error beside it; here both are measured on the same runs. \
         This page is written by `{command}`; `raderr` measures scenes of your own in the same way.\n"
    )?;
    writeln!(
        out,
        "| scene | programs | errors both reach | ratio of times at equal error | pairs |\n|---|---|---|---|---|"
    )?;
    for entry in entries {
        writeln!(out, "{}", summary(&entry.report))?;
    }
    writeln!(
        out,
        "\nA ratio above 1 says that the first program is faster by so much. It is the geometric mean over the \
         logarithm of error; *pairs* are the least and greatest of single pairs of runs in turns. Nothing is extrapolated.\n"
    )?;
    writeln!(out, "```text{DEFINITIONS}```\n")?;
    for entry in entries {
        write_scene(out, entry)?;
    }
    Ok(())
}

fn summary(report: &Report) -> String {
    let names: Vec<_> = report.programs.iter().map(|p| p.name.as_str()).collect();
    let (errors, ratio, pairs) = match &report.comparison {
        Some(Comparison::Overlap { low, high, mean, range, .. }) => (
            format!("{:.2} to {:.2} %", 100.0 * low, 100.0 * high),
            format!("**{mean:.2}**"),
            range.map_or_else(|| "none".to_owned(), |[a, b]| format!("{a:.2} to {b:.2}")),
        ),
        Some(Comparison::None { statement }) => ("none".to_owned(), statement.clone(), String::new()),
        None => (String::new(), "one program only".to_owned(), String::new()),
    };
    format!("| {} | {} | {errors} | {ratio} | {pairs} |", report.title, names.join(", "))
}

fn write_scene(out: &mut String, entry: &Entry) -> std::fmt::Result {
    let report = &entry.report;
    writeln!(out, "## {}\n\n![Error against time: {}]({})\n", report.title, report.title, entry.plot)?;
    writeln!(
        out,
        "| rung | program | wall s | cpu s | RMS % (95 %) | bias % | p99 % | records | rays | peak MB |\n|---|---|---|---|---|---|---|---|---|---|"
    )?;
    for row in &report.rows {
        for (program, side) in report.programs.iter().zip(&row.sides) {
            writeln!(out, "{}", line(&row.rung.options.join(" "), &program.name, side))?;
        }
    }
    if let Some(Comparison::Overlap { levels, .. }) = &report.comparison {
        let name = |i: usize| report.programs.get(i).map_or("?", |p| p.name.as_str());
        writeln!(out, "\n| at error | {} s | {} s | ratio | pairs |\n|---|---|---|---|---|", name(0), name(1))?;
        for l in levels {
            let range = l.range.map_or_else(|| "none".to_owned(), |[a, b]| format!("{a:.2} to {b:.2}"));
            let times = [l.first, l.second].map(seconds);
            writeln!(out, "| {:.2} % | {} | {} | {:.2} | {range} |", 100.0 * l.error, times[0], times[1], l.ratio)?;
        }
    } else if let Some(Comparison::None { statement }) = &report.comparison {
        writeln!(out, "\n{statement}.")?;
    }
    writeln!(out)?;
    for note in notes(report) {
        writeln!(out, "* {note}")?;
    }
    for p in &report.programs {
        writeln!(out, "* {}: `{}` ({})", p.name, p.command(), p.version)?;
    }
    writeln!(out, "* options of all runs: `{}`; {} repeats", report.common, report.repeats())?;
    for view in &report.views {
        writeln!(out, "* view: `{view}`")?;
    }
    if report.cell > 1 {
        writeln!(out, "* errors are those of means over {0} × {0} pixels", report.cell)?;
    }
    let noise = report.reference.noise.map_or_else(
        || "its noise is not known".to_owned(),
        |n| format!("its noise is {:.2} %, errors above {:.2} % stand out", 100.0 * n.rms, 100.0 * n.floor),
    );
    writeln!(out, "* reference: {}; {noise}", report.reference.lines.join(", "))?;
    writeln!(out, "* {}; {}; {}\n", report.machine, report.software, report.date)
}

fn line(options: &str, name: &str, side: &SideRow) -> String {
    let (rms, count) = (side.score.rms, |n: Option<u64>| n.map_or_else(|| "–".to_owned(), |n| n.to_string()));
    let error = if side.visible { format!("{:.2}", 100.0 * rms.value) } else { format!("<{:.2}", 100.0 * rms.high) };
    format!(
        "| `{options}` | {name} | {} | {} | {error} ({:.2} to {:.2}) | {:+.2} | {:.2} | {} | {} | {:.0} |",
        seconds(side.wall.median),
        seconds(side.cpu.median),
        100.0 * rms.low,
        100.0 * rms.high,
        100.0 * side.score.bias.value,
        100.0 * side.score.p99.value,
        count(side.records),
        count(side.rays),
        side.peak as f64 / (1 << 20) as f64
    )
}
