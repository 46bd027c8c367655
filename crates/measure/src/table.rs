//! The result as text for a terminal.

use crate::ratio::Comparison;
use crate::report::{Report, SideRow};
use crate::score::Bounded;
use std::fmt::Write;

/// Heads of the columns.
const HEADS: [&str; 11] =
    ["rung", "program", "wall s", "(least–most)", "cpu s", "RMS %", "(95 %)", "bias %", "p99 %", "records", "rays"];

/// Below this share of the raw error, what remains of it is mostly the reference's noise.
const QUIET: f64 = 0.5;

/// The whole report as text: what was measured, a table, what follows from it, how the numbers are defined.
pub fn table(report: &Report) -> String {
    let mut out = String::new();
    // Writing to a string can not fail.
    let _ = write_head(&mut out, report);
    let _ = write_rows(&mut out, report);
    if let Some(comparison) = &report.comparison {
        out.push('\n');
        out.push_str(&comparison_text(report, comparison));
    }
    for note in notes(report) {
        let _ = writeln!(out, "note: {note}");
    }
    out.push_str(DEFINITIONS);
    out
}

/// How the columns are defined.
pub(crate) const DEFINITIONS: &str = "
RMS:  sqrt(mean of (x-a)(x-b)) / m over all channels of all pixels (or sensors) of all views, where a and b are the two
      independent halves of the reference and m is its mean: the noise of the reference is taken out
bias: (mean of x - m) / m
p99:  99th percentile over pixels of the RMS over channels of x - (a+b)/2, / m; contains the noise of the reference
95 %: bootstrap over blocks of neighbouring pixels and over repeats; wall and cpu: median over repeats, reading the
      octree included
";

fn write_head(out: &mut String, report: &Report) -> std::fmt::Result {
    writeln!(out, "{}\n{}, {}, {}", report.title, report.machine, report.software, report.date)?;
    writeln!(out, "scene: {}", report.scene.join(" "))?;
    for view in &report.views {
        writeln!(out, "view: {view}")?;
    }
    for program in &report.programs {
        writeln!(out, "{}: {} ({})", program.name, program.command(), program.version)?;
    }
    writeln!(out, "options: {}; {} repeats", report.common, report.repeats())?;
    if report.cell > 1 {
        writeln!(out, "errors of means over {0} x {0} pixels", report.cell)?;
    }
    writeln!(out, "reference: {}", report.reference.lines.join(", "))?;
    match report.reference.noise {
        Some(noise) => writeln!(
            out,
            "its noise: {:.2} % RMS; errors above {:.2} % stand out from it",
            100.0 * noise.rms,
            100.0 * noise.floor
        ),
        None => writeln!(out, "its noise: not known (one half only); it is part of every error"),
    }
}

/// The cells of one row, as `HEADS` names them.
fn cells(label: &str, name: &str, side: &SideRow) -> [String; 11] {
    let range = |b: Bounded| format!("{:.2}–{:.2}", 100.0 * b.low, 100.0 * b.high);
    let rms = side.score.rms;
    [
        label.to_owned(),
        name.to_owned(),
        seconds(side.wall.median),
        format!("{}–{}", seconds(side.wall.least), seconds(side.wall.most)),
        seconds(side.cpu.median),
        if side.visible { format!("{:.2}", 100.0 * rms.value) } else { format!("<{:.2}", 100.0 * rms.high) },
        range(rms),
        format!("{:+.2}", 100.0 * side.score.bias.value),
        format!("{:.2}", 100.0 * side.score.p99.value),
        side.records.map_or_else(|| "–".to_owned(), |r| r.to_string()),
        side.rays.map_or_else(|| "–".to_owned(), |r| r.to_string()),
    ]
}

/// Seconds with three digits.
pub(crate) fn seconds(s: f64) -> String {
    let digits = if s < 10.0 {
        3
    } else if s < 100.0 {
        2
    } else {
        1
    };
    format!("{s:.digits$}")
}

fn write_rows(out: &mut String, report: &Report) -> std::fmt::Result {
    let mut rows = vec![HEADS.map(str::to_owned)];
    for row in &report.rows {
        for (program, side) in report.programs.iter().zip(&row.sides) {
            rows.push(cells(&row.rung.label, &program.name, side));
        }
    }
    let widths: Vec<usize> =
        (0..HEADS.len()).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
    out.push('\n');
    for row in rows {
        let line: Vec<String> = row
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(c, (cell, w))| if c < 2 { format!("{cell:<w$}") } else { format!("{cell:>w$}") })
            .collect();
        writeln!(out, "{}", line.join("  ").trim_end())?;
    }
    Ok(())
}

/// Times at equal error, or why there are none.
pub(crate) fn comparison_text(report: &Report, comparison: &Comparison) -> String {
    let name = |i: usize| report.programs.get(i).map_or("?", |p| p.name.as_str());
    let (first, second) = (name(0), name(1));
    let range = |r: Option<[f64; 2]>| r.map_or_else(|| "none".to_owned(), |[a, b]| format!("{a:.2}–{b:.2}"));
    match comparison {
        Comparison::None { statement } => format!("{statement}\n"),
        Comparison::Overlap { low, high, mean, range: all, levels } => {
            let mut out = format!(
                "at equal RMS error, {:.2} to {:.2} %: {second} takes {mean:.2} times as long as {first} (geometric mean over the logarithm of error; pairs: {})\n",
                100.0 * low,
                100.0 * high,
                range(*all),
            );
            for l in levels {
                let _ = writeln!(
                    out,
                    "  error {:>6.2} %: {first} {} s, {second} {} s, ratio {:.2} (pairs that reach it: {}, {})",
                    100.0 * l.error,
                    seconds(l.first),
                    seconds(l.second),
                    l.ratio,
                    l.pairs,
                    range(l.range),
                );
            }
            out
        }
    }
}

/// What a reader should know of single rows and of further views.
pub(crate) fn notes(report: &Report) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some((count, times)) = report.reference.left_out {
        let all: usize = report.parts.iter().map(|p| p.len()).sum();
        notes.push(format!(
            "{count} of {all} values are left out everywhere: the reference is above {times} times its mean there"
        ));
    }
    for (i, program) in report.programs.iter().enumerate() {
        let sides: Vec<_> = report.rows.iter().filter_map(|r| Some((&r.rung.label, r.sides.get(i)?))).collect();
        let rungs = |which: &dyn Fn(&SideRow) -> bool| {
            let labels: Vec<_> = sides.iter().filter(|(_, s)| which(s)).map(|(l, _)| l.as_str()).collect();
            (!labels.is_empty()).then(|| labels.join(", "))
        };
        let name = &program.name;
        if let Some(labels) = rungs(&|s| !s.visible) {
            notes.push(format!(
                "{name}, rungs {labels}: the error is too small for this reference; they are on no curve"
            ));
        }
        if let Some(labels) = rungs(&|s| s.visible && s.score.rms.value < QUIET * s.score.raw) {
            notes.push(format!("{name}, rungs {labels}: less than the reference's noise, which has been taken out"));
        }
        let curve = report.curve(i);
        if let Some(labels) = rungs(&|s| s.visible && !curve.points().contains(&s.point())) {
            notes.push(format!("{name}, rungs {labels}: slower than a rung that errs no more; they are on no curve"));
        }
        let runs: Vec<_> = sides.iter().flat_map(|(_, s)| &s.runs).collect();
        for view in 1..runs.first().map_or(0, |r| r.views.len()) {
            let [first, later] = [0, view].map(|v| runs.iter().map(|r| r.views[v]).sum::<f64>());
            notes.push(format!(
                "{name}: view {} with the ambient file of those before took {:.0} % of the first view's time",
                view + 1,
                100.0 * later / first
            ));
        }
    }
    notes
}
