//! Two ambient files side by side.

use crate::stats::Grid;
use crate::store::{Failure, contents, print as write};
use ambit_ambient::{Contents, Layout, Record, fingerprint_lines};
use ambit_base::Colour;
use ambit_file::{bytes_of, name_of, text_of};
use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

/// Records nearer to each other than this fraction of their smaller radius are compared.
const NEAR: f64 = 0.2;
/// Least cosine between the normals of records that are compared.
const ALIKE: f64 = 0.95;

/// Prints how two files differ; false if they do.
pub(crate) fn print(left: &Path, right: &Path) -> Result<bool, Failure> {
    let (a, b) = (contents(left)?, contents(right)?);
    let mut text = String::new();
    let mut say = |line: String| {
        // Writing to memory does not fail.
        let _ = writeln!(text, "{line}");
    };
    let marks = |c: &ambit_ambient::Contents| fingerprint_lines(&c.header).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let (ours, theirs) = (marks(&a), marks(&b));
    let same_marks = ours == theirs;
    for (name, line) in ours
        .iter()
        .filter(|l| !theirs.contains(l))
        .map(|l| ('<', l))
        .chain(theirs.iter().filter(|l| !ours.contains(l)).map(|l| ('>', l)))
    {
        say(format!("{name} {}", text_of(line)));
    }
    let set = |c: &Contents| -> HashSet<Vec<u8>> {
        c.records.iter().map(|r| Layout::CURRENT.encode(r, &c.components)).collect()
    };
    let (one, other) = (set(&a), set(&b));
    let common = one.intersection(&other).count();
    let only = |c: &Contents, rest: &HashSet<Vec<u8>>| -> Vec<Record> {
        c.records.iter().filter(|r| !rest.contains(&Layout::CURRENT.encode(r, &c.components))).cloned().collect()
    };
    let (left_only, right_only) = (only(&a, &other), only(&b, &one));
    say(format!("{common} records in both"));
    say(format!("{} only in {}", left_only.len(), name_of(left)));
    say(format!("{} only in {}", right_only.len(), name_of(right)));
    let mut differences = near(&left_only, &right_only);
    if !differences.is_empty() {
        let n = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / n;
        let rms = (differences.iter().map(|d| d * d).sum::<f64>() / n).sqrt();
        differences.sort_by(|x, y| x.abs().total_cmp(&y.abs()));
        let median = differences[differences.len() / 2].abs();
        say(format!(
            "{} records of the first stand near one of the second: the second is {:+.2} % brighter on average, \
             {:.2} % apart (RMS), {:.2} % (median)",
            differences.len(),
            100.0 * mean,
            100.0 * rms,
            100.0 * median
        ));
    }
    write(&bytes_of(&text))?;
    Ok(same_marks && left_only.is_empty() && right_only.is_empty())
}

/// Relative differences of values between records of equal level that stand near each other.
fn near(left: &[Record], right: &[Record]) -> Vec<f64> {
    let reach = |r: &Record| NEAR * f64::from(r.radii[0]);
    let largest = left.iter().map(reach).fold(0.0, f64::max);
    let grid = Grid::new(right, largest.max(f64::MIN_POSITIVE));
    let difference = |r: &Record| {
        let alike = |o: &Record| o.level == r.level && o.normal.dot(r.normal) > ALIKE;
        let (nearest, distance) = grid.nearest(r, alike)?;
        let (was, is) = (f64::from(r.value.mean()), f64::from(nearest.value.mean()));
        (distance < reach(r) && was + is > 0.0).then(|| 2.0 * (is - was) / (is + was))
    };
    left.iter().filter_map(difference).collect()
}
