//! The options of raderr.

use clap::{Args, Parser, Subcommand};
use std::ffi::OsString;
use std::path::PathBuf;

/// What is said after the options.
const NOTES: &str = "\
Examples:
  raderr scene.oct -- -vf view.vf
  raderr room.rad sky.rad --against /opt/radiance/bin/rpict --reference room.ref --svg room.svg -- -vf view.vf -ab 3
  raderr scene.oct --sensors grid.pts --ladder my-settings.txt --json grid.json -- -ab 4
  raderr page --out speed.md room.json grid.json

A ladder is a file of one setting a line, from coarse to fine, such as '-aa .2 -ar 64 -ad 256 -as 64'; a first word
that ends in a colon is its label, # starts a comment.

Every run is one process; its time includes reading the octree. Pictures are computed with -ps 1 -pj 0, every repeat
starts with an empty ambient file, and all views of a repeat share it. Programs run in turns, and who goes first changes
from repeat to repeat. Nothing else should run meanwhile.";

/// The command line.
#[derive(Debug, Parser)]
#[command(
    name = "raderr",
    version,
    about = "Measure the error of rpict or rtrace against a converged reference, and its time, over a ladder of settings",
    after_help = NOTES,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true
)]
pub(super) struct Options {
    #[command(subcommand)]
    pub(super) task: Option<Task>,
    #[command(flatten)]
    pub(super) measure: Measure,
    /// Print the manual page and stop
    #[arg(long, exclusive = true)]
    pub(super) man: bool,
}

/// Tasks that measure nothing.
#[derive(Debug, Subcommand)]
pub(super) enum Task {
    /// Write a page with the curves and numbers of results that were kept with --json
    Page {
        /// The page (Markdown); plots are written beside it, in a folder of its name
        #[arg(long, value_name = "FILE.md")]
        out: PathBuf,
        /// What the page says it was made by
        #[arg(long, value_name = "TEXT", default_value = "raderr page")]
        command: String,
        /// Results
        #[arg(required = true, value_name = "FILE.json")]
        results: Vec<PathBuf>,
    },
}

/// What to measure.
#[derive(Args, Debug)]
pub(super) struct Measure {
    /// An octree, or scene files, which oconv makes one of
    #[arg(required_unless_present = "man", value_name = "SCENE")]
    pub(super) scene: Vec<PathBuf>,
    /// Options of every run of every program, such as a view: -vf FILE -ab 3
    #[arg(last = true, value_name = "OPTIONS")]
    pub(super) common: Vec<OsString>,

    /// A view as rpict's options; several are rendered one after the other
    #[arg(long, value_name = "WORDS", allow_hyphen_values = true, help_heading = "What is computed")]
    pub(super) view: Vec<String>,
    /// Irradiance at sensors (rtrace -I): a file of positions and normals
    #[arg(long, value_name = "FILE", conflicts_with_all = ["view", "rays"], help_heading = "What is computed")]
    pub(super) sensors: Option<PathBuf>,
    /// Radiance along rays (rtrace): a file of origins and directions
    #[arg(long, value_name = "FILE", conflicts_with = "view", help_heading = "What is computed")]
    pub(super) rays: Option<PathBuf>,
    /// Greatest width and height of pictures, pixels
    #[arg(long, value_name = "N", default_value_t = 128, help_heading = "What is computed")]
    pub(super) size: u32,
    /// Compare means over cells of N x N pixels
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), help_heading = "What is computed")]
    pub(super) cell: u32,

    /// Leave out pixels where the reference is above N times its mean: lamps seen directly, which can outweigh all else
    #[arg(long, value_name = "N", help_heading = "What is computed")]
    pub(super) bright: Option<f64>,

    /// Settings, one a line; a built-in ladder for the irradiance cache unless given
    #[arg(long, value_name = "FILE", help_heading = "Runs")]
    pub(super) ladder: Option<PathBuf>,
    /// The first N settings only
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = "Runs")]
    pub(super) rungs: Option<u32>,
    /// How often every setting is run
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Runs")]
    pub(super) repeats: u32,
    /// Threads of programs that have -n as Ambit's have
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), help_heading = "Runs")]
    pub(super) threads: u32,

    /// The program that is measured; the rpict (rtrace) beside raderr unless given
    #[arg(long, value_name = "PATH", help_heading = "Programs")]
    pub(super) program: Option<PathBuf>,
    /// RAYPATH of that program; as it is unless given
    #[arg(long, value_name = "PATHS", help_heading = "Programs")]
    pub(super) raypath: Option<String>,
    /// Options for that program alone
    #[arg(
        long,
        value_name = "WORDS",
        default_value = "",
        allow_hyphen_values = true,
        hide_default_value = true,
        help_heading = "Programs"
    )]
    pub(super) options: String,
    /// What tables call it
    #[arg(long, value_name = "NAME", default_value = "ours", help_heading = "Programs")]
    pub(super) name: String,
    /// Another program that takes rpict's (rtrace's) options, which runs in turns with the first
    #[arg(long, value_name = "PATH", help_heading = "Programs")]
    pub(super) against: Option<PathBuf>,
    /// RAYPATH of the other program
    #[arg(long, value_name = "PATHS", requires = "against", help_heading = "Programs")]
    pub(super) against_raypath: Option<String>,
    /// Options for the other program alone
    #[arg(
        long,
        value_name = "WORDS",
        default_value = "",
        allow_hyphen_values = true,
        hide_default_value = true,
        help_heading = "Programs"
    )]
    pub(super) against_options: String,
    /// What tables call it
    #[arg(long, value_name = "NAME", default_value = "theirs", help_heading = "Programs")]
    pub(super) against_name: String,

    /// The reference: read if the file is there, made and kept there if not; a picture does, too (one for each view)
    #[arg(long, value_name = "FILE", help_heading = "Reference")]
    pub(super) reference: Vec<PathBuf>,
    /// Which program makes it: ours (the measured one), theirs, or a path
    #[arg(long, value_name = "PROGRAM", default_value = "ours", help_heading = "Reference")]
    pub(super) reference_by: String,
    /// Options of its passes, after those of every run. With -aa 0 the samples of hemispheres see lamps undivided whatever
    /// -ds says; -aa 1e-4 -ar 0 divides them as a cache does, for four times the time and 4 KB a pixel and more
    #[arg(
        long,
        value_name = "WORDS",
        default_value = "-aa 0 -as 0 -ad 64 -dt 0 -lw 1e-5",
        allow_hyphen_values = true,
        help_heading = "Reference"
    )]
    pub(super) reference_options: String,
    /// Passes at most; half of them make either half of it
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..), help_heading = "Reference")]
    pub(super) passes: u32,
    /// Enough when its noise is below this, per cent of the mean
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, help_heading = "Reference")]
    pub(super) noise: f64,
    /// Take a reference that was made for another scene, view or options
    #[arg(long, help_heading = "Reference")]
    pub(super) any_reference: bool,

    /// Heading of tables and plots; the scene's name unless given
    #[arg(long, value_name = "TEXT", help_heading = "Results")]
    pub(super) title: Option<String>,
    /// Everything that was measured, for `raderr page` and other programs
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub(super) json: Option<PathBuf>,
    /// The table for other programs
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub(super) csv: Option<PathBuf>,
    /// Plot of error against time
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub(super) svg: Option<PathBuf>,
    /// The same as PNG
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub(super) png: Option<PathBuf>,
    /// Do not tell how far things are
    #[arg(short, long, help_heading = "Results")]
    pub(super) quiet: bool,
}
