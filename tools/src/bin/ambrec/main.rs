//! ambrec: looks into ambient files, and puts them right: statistics, merging, pruning, comparison, repair, conversion
//! between the layouts of Radiance 5 and 6, and export of the records as geometry.

mod check;
mod compare;
mod edit;
mod export;
mod stats;
mod store;

use clap::{CommandFactory, Parser, Subcommand};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Looks into ambient files of irradiance records and puts them right.
#[derive(Parser)]
#[command(name = "ambrec", version, subcommand_required = true, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Counts records by level and tells their spacing, radii, weights and extent.
    Stats {
        /// The ambient file.
        file: PathBuf,
        /// Print JSON instead of text.
        #[arg(long)]
        json: bool,
    },
    /// Puts the records of several files, and of their segments, into one; equal records count once.
    Merge {
        /// The ambient files; the first one's header is kept.
        #[arg(required = true)]
        files: Vec<PathBuf>,
        #[command(flatten)]
        output: store::Output,
        /// Merge files whose fingerprints tell that they are of other scenes or parameters.
        #[arg(long)]
        force: bool,
    },
    /// Removes the records that meet all the conditions given.
    Prune(edit::Prune),
    /// Compares two files: headers, records that only one has, and values where both have records.
    Diff {
        /// One ambient file.
        left: PathBuf,
        /// The other.
        right: PathBuf,
    },
    /// Looks for damage; the exit status is 1 if there is any.
    Check {
        /// The ambient files.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Keeps every record that makes sense, also those that lie between record boundaries, and takes in segments.
    Repair {
        /// The ambient file, which is repaired in its place, under its lock, unless there is another output.
        file: PathBuf,
        #[command(flatten)]
        output: store::Output,
    },
    /// Writes the file in the layout of Radiance 5 (559) or 6 (561).
    Convert {
        /// The ambient file.
        file: PathBuf,
        /// The magic number of the layout.
        #[arg(long, value_parser = ["559", "561"], default_value = "561")]
        to: String,
        #[command(flatten)]
        output: store::Output,
    },
    /// Writes the records as a scene of spheres and ellipses, or as points in PLY.
    Export(export::Export),
    /// Prints the manual page.
    #[command(hide = true)]
    Man,
}

fn main() -> ExitCode {
    match run(Arguments::parse().task) {
        Ok(fine) => ExitCode::from(u8::from(!fine)),
        Err(store::Failure(text)) => {
            store::tell(&text);
            ExitCode::from(2)
        }
    }
}

/// Does what is asked; false where the answer to a question is no.
fn run(task: Task) -> Result<bool, store::Failure> {
    match task {
        Task::Stats { file, json } => stats::print(&file, json).map(|()| true),
        Task::Merge { files, output, force } => edit::merge(&files, &output, force).map(|()| true),
        Task::Prune(prune) => prune.run().map(|()| true),
        Task::Diff { left, right } => compare::print(&left, &right),
        Task::Check { files } => check::print(&files),
        Task::Repair { file, output } => check::repair(&file, &output).map(|()| true),
        Task::Convert { file, to, output } => edit::convert(&file, &to, &output).map(|()| true),
        Task::Export(export) => export.run().map(|()| true),
        Task::Man => {
            manual();
            Ok(true)
        }
    }
}

/// The manual page: the program's, and a section for every command.
fn manual() {
    let command = Arguments::command();
    let mut page = Vec::new();
    let man = clap_mangen::Man::new(command.clone());
    // Writing to memory does not fail. The list of commands is left out: each has a section.
    let _ = man.render_title(&mut page);
    let _ = man.render_name_section(&mut page);
    let _ = man.render_synopsis_section(&mut page);
    let _ = man.render_description_section(&mut page);
    let _ = man.render_options_section(&mut page);
    for sub in command.get_subcommands().filter(|c| !c.is_hide_set()) {
        let name = sub.get_name().to_owned();
        let sub = sub.clone().bin_name(format!("ambrec {name}")).disable_help_flag(true);
        let _ = writeln!(page, ".SH \"AMBREC {}\"", name.to_uppercase());
        let man = clap_mangen::Man::new(sub);
        let _ = man.render_description_section(&mut page);
        let _ = man.render_synopsis_section(&mut page);
        let _ = man.render_options_section(&mut page);
    }
    ambit_cli::answer(&page);
}
