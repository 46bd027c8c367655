//! The result of a measurement, as it is kept in JSON and shown in tables and plots.

use crate::curve::{Curve, Point};
use crate::ladder::Rung;
use crate::parts::Part;
use crate::ratio::Comparison;
use crate::reference::Noise;
use crate::score::Score;
use serde::{Deserialize, Serialize};

/// Everything that was measured and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// What tables and plots are headed with.
    pub title: String,
    /// When, as text.
    pub date: String,
    /// Processor, cores, system.
    pub machine: String,
    /// The version of the program that measured.
    pub software: String,
    /// Scene files as they were named.
    pub scene: Vec<String>,
    /// Words of each view, or the file of sensors or rays; nothing if the view is among the options of every run.
    pub views: Vec<String>,
    /// Options of every run.
    pub common: String,
    /// The programs, in the order of `Row::sides`.
    pub programs: Vec<Program>,
    /// What results were compared with.
    pub reference: ReferenceInfo,
    /// Sizes of what was compared, after averaging over cells.
    pub parts: Vec<Part>,
    /// Side of the cells of pixels that were averaged before comparing; 1 if none were.
    pub cell: u32,
    /// One row a rung.
    pub rows: Vec<Row>,
    /// Two programs at equal error.
    pub comparison: Option<Comparison>,
}

/// A program that was measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// What tables call it.
    pub name: String,
    /// Where it is.
    pub path: String,
    /// What it says of itself.
    pub version: String,
    /// Options of its own, which the other does not get.
    pub words: String,
}

impl Program {
    /// Its path and the options of its own.
    pub fn command(&self) -> String {
        format!("{} {}", self.path, self.words).trim_end().to_owned()
    }
}

/// What is said of the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceInfo {
    /// Lines `NAME=value` that say how it was made.
    pub lines: Vec<String>,
    /// Its mean: W/(sr·m²) or W/m².
    pub mean: f64,
    /// Its noise; `None` if nothing tells it.
    pub noise: Option<Noise>,
    /// How many values were left out because it is bright there, and above how many times its mean.
    pub left_out: Option<(usize, f64)>,
}

/// One rung.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Its options.
    pub rung: Rung,
    /// Each program's cost and error.
    pub sides: Vec<SideRow>,
}

/// Cost and error of one program on one rung.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SideRow {
    /// Wall-clock seconds of all views, over the repeats.
    pub wall: Spread,
    /// Processor seconds of all threads.
    pub cpu: Spread,
    /// Greatest resident size of any run, bytes.
    pub peak: u64,
    /// Records in the ambient file after the last view of the last repeat; `None` if there is no file.
    pub records: Option<u64>,
    /// Rays of the last repeat, if the program tells.
    pub rays: Option<u64>,
    /// The error over all repeats.
    pub score: Score,
    /// Whether the error can be told from none: its lower bound is above 0, and it is above the reference's floor. Only
    /// then it stands on a curve.
    pub visible: bool,
    /// The single repeats.
    pub runs: Vec<Run>,
}

/// One repeat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Wall-clock seconds of each view.
    pub views: Vec<f64>,
    /// Processor seconds.
    pub cpu: f64,
    /// Relative RMS error, without the reference's noise.
    pub rms: f64,
    /// Relative mean error.
    pub bias: f64,
}

/// Median and extremes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median; of an even count the mean of the middle two.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub most: f64,
}

impl Spread {
    /// Of at least one number.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut all: Vec<f64> = values.into_iter().collect();
        all.sort_by(f64::total_cmp);
        let median = (all.get(all.len().checked_sub(1)? / 2)? + all[all.len() / 2]) / 2.0;
        Some(Self { median, least: all[0], most: all[all.len() - 1] })
    }
}

impl Run {
    /// Wall-clock seconds of all views.
    pub fn wall(&self) -> f64 {
        self.views.iter().sum()
    }
}

impl SideRow {
    /// Time and error.
    pub fn point(&self) -> Point {
        Point { time: self.wall.median, error: if self.visible { self.score.rms.value } else { 0.0 } }
    }
}

impl Report {
    /// The curve of a program: median times, errors over all repeats.
    pub fn curve(&self, side: usize) -> Curve {
        curve(&self.rows, side)
    }

    /// How many repeats there were.
    pub fn repeats(&self) -> usize {
        self.rows.iter().flat_map(|r| &r.sides).map(|s| s.runs.len()).max().unwrap_or(0)
    }
}

/// The curve of one program over rows.
pub(crate) fn curve(rows: &[Row], side: usize) -> Curve {
    Curve::new(rows.iter().filter_map(|r| r.sides.get(side)).map(SideRow::point))
}

/// The curve of one repeat of a program.
pub(crate) fn single_curve(rows: &[Row], side: usize, repeat: usize) -> Curve {
    let sides = rows.iter().filter_map(|r| r.sides.get(side)).filter(|s| s.visible);
    Curve::new(sides.filter_map(|s| s.runs.get(repeat)).map(|r| Point { time: r.wall(), error: r.rms }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        let spread = Spread::of([3.0, 1.0, 2.0]).unwrap();
        assert_eq!((spread.median, spread.least, spread.most), (2.0, 1.0, 3.0));
        assert_eq!(Spread::of([1.0, 2.0, 4.0, 9.0]).unwrap().median, 3.0);
        assert_eq!(Spread::of([]), None);
    }
}
