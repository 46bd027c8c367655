//! raderr: how long a program takes to come how near the truth, over a ladder of settings.
//!
//! What is measured and how it is judged is `ambit-measure`'s; here are the options, the processes and the files.

mod bench;
mod machine;
mod options;
mod process;
mod reference;

use ambit_cli::{StandardOutput, VERSION};
use ambit_file::{Replacement, name_of, word_of};
use ambit_measure::{
    Entry, Error, Ladder, Plan, PlotSize, Program as Named, ReferenceInfo, Report, Side, measure, page, png, svg,
    table, to_csv, to_json,
};
use bench::{Runner, Target};
use clap::{CommandFactory, Parser};
use options::{Measure, Options, Task};
use process::Program;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of every run unless the user's, which follow, say otherwise. With the default of `-lw`, samples of fine rungs
/// would weigh too little to be followed.
const COMMON: &str = "-ab 2 -lw 1e-5";

/// The whole program.
pub fn main(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let options = match Options::try_parse_from(arguments) {
        Ok(options) => options,
        Err(e) => {
            // Help and version are no errors; a closed output is no reason for another one.
            let _ = e.print();
            return ExitCode::from(u8::from(e.use_stderr()));
        }
    };
    let done = match &options.task {
        _ if options.man => {
            manual();
            Ok(())
        }
        Some(Task::Page { out, command, results }) => write_page(out, command, results),
        None => run(&options.measure),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            tell(&e.to_string());
            ExitCode::FAILURE
        }
    }
}

/// Says something on standard error.
fn tell(text: &str) {
    ambit_cli::say(format_args!("raderr: {text}"));
}

/// Prints the manual page.
fn manual() {
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = clap_mangen::Man::new(Options::command()).render(&mut text);
    ambit_cli::answer(&text);
}

/// Measures and writes the results.
fn run(options: &Measure) -> Result<(), Error> {
    let folder = tempfile::Builder::new().prefix("raderr").tempdir();
    let folder = folder.map_err(|source| Error::File { file: "scratch folder".to_owned(), source })?;
    let (target, common) = target(options);
    let ladder = match &options.ladder {
        Some(file) => Ladder::parse(&read(file)?, &name_of(file))?,
        None => Ladder::standard(),
    };
    let ladder = match options.rungs {
        Some(count) => ladder.first(count as usize),
        None => ladder,
    };
    let mut programs = programs(options, &target)?;
    let measured = programs.len();
    let maker = match options.reference_by.as_str() {
        "ours" => 0,
        "theirs" if measured == 2 => 1,
        "theirs" => return Err(Error::Program("--reference-by theirs needs --against".to_owned())),
        path => {
            programs.push(Program::new("reference", Path::new(path), options.against_raypath.as_deref(), "")?);
            measured
        }
    };
    let octree = octree(&options.scene, folder.path())?;
    let sides: Vec<Side> = programs.iter().map(|p| Side { name: p.name.clone(), seeds: p.ambit }).collect();
    let scratch = folder.path().to_owned();
    let views = target.count();
    let mut runner =
        Runner { programs, target, octree, common, threads: options.threads, scratch, quiet: options.quiet };
    // Options that a program does not know shall stop before anything long has run.
    for side in 0..measured {
        ladder.rungs.iter().try_for_each(|rung| runner.check(side, &rung.options))?;
    }
    let repeats = options.repeats as usize;
    let mut plan = Plan { sides, ladder, views, repeats, cell: options.cell, bright: options.bright };
    let found = reference::obtain(&mut runner, &plan, maker, options)?;
    reference::count_parts(&found, &runner.target)?;
    plan.sides.truncate(measured);
    let (rows, comparison) = measure(&mut runner, &plan, &found)?;
    let small = plan.compared(&found);
    let left_out = plan.bright.map(|times| (small.ignored.iter().filter(|i| **i).count(), times));
    let info = ReferenceInfo { lines: found.header.clone(), mean: small.mean(), noise: small.noise(), left_out };
    let report = Report {
        title: options.title.clone().unwrap_or_else(|| title(&options.scene)),
        date: machine::date(),
        machine: machine::describe(),
        software: format!("raderr, {VERSION}"),
        scene: options.scene.iter().map(|f| f.display().to_string()).collect(),
        views: match &runner.target {
            Target::Views(views) => views.iter().filter(|v| !v.is_empty()).map(|v| v.join(" ")).collect(),
            Target::Sensors(file) | Target::Rays(file) => vec![file.display().to_string()],
        },
        common: runner.common.join(" "),
        programs: runner.programs[..measured].iter().map(|p| named(p, options.threads)).collect(),
        reference: info,
        parts: small.parts,
        cell: plan.cell,
        rows,
        comparison,
    };
    write_results(options, &report)
}

/// How a report names a program.
fn named(program: &Program, threads: u32) -> Named {
    let mut words = program.words.clone();
    if program.ambit {
        words.push(format!("-n {threads} --seed REPEAT"));
    }
    let words = words.join(" ");
    let (name, version) = (program.name.clone(), program.version.clone());
    Named { name, path: program.path.display().to_string(), version, words }
}

/// What is computed, and the options of every run.
fn target(options: &Measure) -> (Target, Vec<String>) {
    let size = options.size;
    let (target, own) = match (&options.sensors, &options.rays) {
        (Some(file), _) => (Target::Sensors(file.clone()), "-h -I+".to_owned()),
        (None, Some(file)) => (Target::Rays(file.clone()), "-h".to_owned()),
        (None, None) => {
            let words = |v: &String| v.split_whitespace().map(str::to_owned).collect();
            let mut views: Vec<Vec<String>> = options.view.iter().map(words).collect();
            if views.is_empty() {
                // The view is among the options of every run.
                views.push(Vec::new());
            }
            // The interval of progress reports only makes rpict tell its rays at the end.
            (Target::Views(views), format!("-t 36000 -ps 1 -pj 0 -x {size} -y {size}"))
        }
    };
    let mut common: Vec<String> = own.split(' ').chain(COMMON.split(' ')).map(str::to_owned).collect();
    common.extend(options.common.iter().map(|word| word_of(word)));
    (target, common)
}

/// The one or two programs that are measured.
fn programs(options: &Measure, target: &Target) -> Result<Vec<Program>, Error> {
    let ours = options.program.clone().map_or_else(|| beside(target.program()), Ok)?;
    let mut all = vec![Program::new(&options.name, &ours, options.raypath.as_deref(), &options.options)?];
    if let Some(path) = &options.against {
        let raypath = options.against_raypath.as_deref();
        all.push(Program::new(&options.against_name, path, raypath, &options.against_options)?);
    }
    Ok(all)
}

/// A program in the folder of this one.
fn beside(name: &str) -> Result<PathBuf, Error> {
    let own = std::env::current_exe().map_err(|source| Error::File { file: "raderr".to_owned(), source })?;
    Ok(own.with_file_name(name))
}

/// The octree itself, or one that oconv makes of scene files, frozen: then its bytes tell the scene.
fn octree(scene: &[PathBuf], folder: &Path) -> Result<PathBuf, Error> {
    if let [file] = scene {
        let bytes = std::fs::read(file).map_err(|source| Error::File { file: name_of(file).into_owned(), source })?;
        let header = ambit_file::Header::parse(&bytes, &name_of(file));
        if header.is_ok_and(|(h, _)| h.format() == Some("Radiance_octree")) {
            return Ok(file.clone());
        }
    }
    let out = folder.join("scene.oct");
    let oconv = Program::unasked("oconv", &beside("oconv")?, None, "-f -w");
    let words: Vec<String> = scene.iter().map(|f| name_of(f).into_owned()).collect();
    oconv.run(&words, None, &out)?;
    Ok(out)
}

/// The scene's name: that of its last file.
fn title(scene: &[PathBuf]) -> String {
    scene.last().and_then(|f| f.file_stem()).map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

fn read(file: &Path) -> Result<String, Error> {
    std::fs::read_to_string(file).map_err(|source| Error::File { file: name_of(file).into_owned(), source })
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), Error> {
    let written = Replacement::create(file).and_then(|mut out| out.write_all(bytes).and_then(|()| out.commit()));
    written.map_err(|source| Error::File { file: name_of(file).into_owned(), source })
}

/// Files first, so that a closed output loses none of them.
fn write_results(options: &Measure, report: &Report) -> Result<(), Error> {
    if let Some(file) = &options.json {
        write(file, to_json(report)?.as_bytes())?;
    }
    if let Some(file) = &options.csv {
        write(file, to_csv(report)?.as_bytes())?;
    }
    if let Some(file) = &options.svg {
        write(file, svg(report, PlotSize::default())?.as_bytes())?;
    }
    if let Some(file) = &options.png {
        write(file, &png(report, PlotSize::default())?)?;
    }
    let written = StandardOutput::ending().write_all(table(report).as_bytes());
    written.map_err(|source| Error::File { file: "standard output".to_owned(), source })
}

/// The page of kept results; plots go into a folder of the page's name.
fn write_page(out: &Path, command: &str, results: &[PathBuf]) -> Result<(), Error> {
    let plots = out.with_extension("");
    std::fs::create_dir_all(&plots).map_err(|source| Error::File { file: name_of(&plots).into_owned(), source })?;
    let mut entries = Vec::new();
    for file in results {
        let report = Report::from_json(&read(file)?, &name_of(file))?;
        let name = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default() + ".svg";
        write(&plots.join(&name), svg(&report, PlotSize::default())?.as_bytes())?;
        let folder = plots.file_name().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        entries.push(Entry { report, plot: format!("{folder}/{name}") });
    }
    write(out, page(&entries, command).as_bytes())
}
