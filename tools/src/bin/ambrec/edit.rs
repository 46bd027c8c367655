//! Other records in, other records out: merging, pruning, converting.

use crate::store::{Failure, Output, contents, file, tell};
use ambit_ambient::{Components, Layout, Record, fingerprint_lines};
use ambit_base::DVec3;
use ambit_file::name_of;
use clap::Args;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Puts files into one.
pub(crate) fn merge(files: &[PathBuf], output: &Output, force: bool) -> Result<(), Failure> {
    let mut read = 0;
    let mut all = Vec::new();
    let mut known = HashSet::new();
    let mut first = None;
    for path in files {
        let one = contents(path)?;
        let main = first.get_or_insert_with(|| (one.header.clone(), one.layout, one.components.clone()));
        if one.components != main.2 {
            let (a, b) = (name_of(&files[0]), name_of(path));
            let (found, expected) = (one.components.count(), main.2.count());
            return Err(format!("\"{b}\" has NCOMP={found}, and \"{a}\" NCOMP={expected}").into());
        }
        if !force && !fingerprint_lines(&main.0).eq(fingerprint_lines(&one.header)) {
            let (a, b) = (name_of(&files[0]), name_of(path));
            // Radiance's files have none.
            let unmarked =
                [(&a, &main.0), (&b, &one.header)].into_iter().find(|(_, h)| fingerprint_lines(h).next().is_none());
            return Err(match unmarked {
                Some((name, _)) => {
                    format!("\"{name}\" does not tell the scene and parameters it is of; --force merges it")
                }
                None => format!("\"{b}\" is not of the scene and parameters of \"{a}\"; --force merges them"),
            }
            .into());
        }
        read += one.records.len();
        all.extend(one.records.into_iter().filter(|r| known.insert(Layout::CURRENT.encode(r, &one.components))));
    }
    let Some((header, layout, components)) = first else { return Ok(()) };
    tell(&format!("{} records of {read}", all.len()));
    output.write(&file(&header, layout, &components, &all))
}

/// Writes another layout.
pub(crate) fn convert(path: &Path, to: &str, output: &Output) -> Result<(), Failure> {
    let layout = to.parse().ok().and_then(Layout::of_magic).ok_or_else(|| format!("layout {to} is not known"))?;
    let all = contents(path)?;
    if layout == Layout::V559 && all.components != Components::default() {
        return Err(format!(
            "\"{}\" is of a calculation by wavelength, which layout 559 has no room for",
            name_of(path)
        )
        .into());
    }
    output.write(&file(&all.header, layout, &all.components, &all.records))
}

#[derive(Args)]
pub(crate) struct Prune {
    /// The ambient file.
    file: PathBuf,
    /// In this box: two opposite corners.
    #[arg(long = "box", num_args = 6, value_names = ["X0", "Y0", "Z0", "X1", "Y1", "Z1"], allow_negative_numbers = true)]
    region: Option<Vec<f64>>,
    /// Of this level or deeper ones (0 is seen from the eye).
    #[arg(long, value_name = "LEVEL")]
    level_from: Option<u8>,
    /// Of this level or lower ones.
    #[arg(long, value_name = "LEVEL")]
    level_to: Option<u8>,
    /// Weighing less than this.
    #[arg(long, value_name = "WEIGHT")]
    weight_below: Option<f32>,
    /// Whose larger radius is above this.
    #[arg(long, value_name = "RADIUS")]
    radius_above: Option<f32>,
    /// Whose larger radius is below this.
    #[arg(long, value_name = "RADIUS")]
    radius_below: Option<f32>,
    /// Whose relative gradient times smaller radius is above this: values that change much within their reach.
    #[arg(long, value_name = "CHANGE")]
    change_above: Option<f32>,
    /// Keep the records that meet the conditions, and remove the others.
    #[arg(long)]
    keep: bool,
    #[command(flatten)]
    output: Output,
}

impl Prune {
    /// Removes records.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let all = contents(&self.file)?;
        let left: Vec<Record> = all.records.iter().filter(|r| self.meets(r) == self.keep).cloned().collect();
        tell(&format!("{} records of {}", left.len(), all.records.len()));
        self.output.write(&file(&all.header, all.layout, &all.components, &left))
    }

    /// True if a record meets all conditions; without any, none does.
    fn meets(&self, r: &Record) -> bool {
        let inside = self.region.as_deref().map(|b| {
            let (p, q) = (DVec3::new(b[0], b[1], b[2]), DVec3::new(b[3], b[4], b[5]));
            r.position.cmpge(p.min(q)).all() && r.position.cmple(p.max(q)).all()
        });
        let [gu, gv] = r.gradient;
        let conditions = [
            inside,
            self.level_from.map(|l| r.level >= l),
            self.level_to.map(|l| r.level <= l),
            self.weight_below.map(|w| r.weight < w),
            self.radius_above.map(|x| r.radii[1] > x),
            self.radius_below.map(|x| r.radii[1] < x),
            self.change_above.map(|x| gu.hypot(gv) * r.radii[0] > x),
        ];
        conditions.iter().any(Option::is_some) && conditions.iter().flatten().all(|&c| c)
    }
}
