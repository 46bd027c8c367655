//! The result as CSV and JSON, for other programs.

use crate::error::Error;
use crate::report::Report;
use serde::Serialize;

/// One line of the CSV: a program on a rung. Errors are relative (0.01 is one per cent), times seconds, sizes bytes.
#[derive(Serialize)]
struct Line<'a> {
    title: &'a str,
    rung: &'a str,
    options: String,
    program: &'a str,
    wall: f64,
    wall_least: f64,
    wall_most: f64,
    cpu: f64,
    rms: f64,
    rms_low: f64,
    rms_high: f64,
    rms_with_reference_noise: f64,
    bias: f64,
    bias_low: f64,
    bias_high: f64,
    p99: f64,
    p99_low: f64,
    p99_high: f64,
    records: Option<u64>,
    rays: Option<u64>,
    peak: u64,
    repeats: usize,
}

/// A table with a line of heads; one line for each program on each rung.
pub fn to_csv(report: &Report) -> Result<String, Error> {
    let failed = |problem: String| Error::Write { what: "CSV", problem };
    let mut out = csv::Writer::from_writer(Vec::new());
    for row in &report.rows {
        for (program, side) in report.programs.iter().zip(&row.sides) {
            let score = &side.score;
            let line = Line {
                title: &report.title,
                rung: &row.rung.label,
                options: row.rung.options.join(" "),
                program: &program.name,
                wall: side.wall.median,
                wall_least: side.wall.least,
                wall_most: side.wall.most,
                cpu: side.cpu.median,
                rms: score.rms.value,
                rms_low: score.rms.low,
                rms_high: score.rms.high,
                rms_with_reference_noise: score.raw,
                bias: score.bias.value,
                bias_low: score.bias.low,
                bias_high: score.bias.high,
                p99: score.p99.value,
                p99_low: score.p99.low,
                p99_high: score.p99.high,
                records: side.records,
                rays: side.rays,
                peak: side.peak,
                repeats: side.runs.len(),
            };
            out.serialize(line).map_err(|e| failed(e.to_string()))?;
        }
    }
    let bytes = out.into_inner().map_err(|e| failed(e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| failed(e.to_string()))
}

/// The whole report; [`Report`] says what each field means.
pub fn to_json(report: &Report) -> Result<String, Error> {
    let text = serde_json::to_string_pretty(report);
    text.map(|t| t + "\n").map_err(|e| Error::Write { what: "JSON", problem: e.to_string() })
}

impl Report {
    /// Reads what [`to_json`] wrote; `file` names it in errors.
    pub fn from_json(text: &str, file: &str) -> Result<Self, Error> {
        serde_json::from_str(text)
            .map_err(|e| Error::Program(format!("{file}: {e} (expected what raderr --json writes)")))
    }
}

#[cfg(test)]
#[path = "tests/export.rs"]
mod tests;
