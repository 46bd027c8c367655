//! Runs rpict or rtrace for the measurement, and reads what they give.

use super::process::Program;
use ambit_ambient::{Components, scan_header};
use ambit_file::{Picture, name_of};
use ambit_measure::{Bench, Error, Job, Output, Part};
use std::path::{Path, PathBuf};

/// What is computed.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// Pictures of these views (words of rpict).
    Views(Vec<Vec<String>>),
    /// Irradiance at sensors.
    Sensors(PathBuf),
    /// Radiance along rays.
    Rays(PathBuf),
}

impl Target {
    /// How many runs make one repeat.
    pub(super) fn count(&self) -> usize {
        if let Self::Views(views) = self { views.len() } else { 1 }
    }

    /// The program that computes it.
    pub(super) fn program(&self) -> &'static str {
        if let Self::Views(_) = self { "rpict" } else { "rtrace" }
    }
}

/// The programs and all that their runs have in common.
pub(super) struct Runner {
    pub(super) programs: Vec<Program>,
    pub(super) target: Target,
    pub(super) octree: PathBuf,
    /// Options of every run, those of size included.
    pub(super) common: Vec<String>,
    pub(super) threads: u32,
    /// A folder for what runs leave.
    pub(super) scratch: PathBuf,
    pub(super) quiet: bool,
}

impl Runner {
    /// The words of a run, the octree and files that are written apart.
    fn words(&self, side: usize, view: usize, options: &[String], seed: u64, timed: bool) -> Vec<String> {
        let mut words = Vec::new();
        if self.programs[side].ambit {
            // The reference may have all cores: it is not timed, and the answer does not depend on threads.
            if timed {
                words.extend(["-n".to_owned(), self.threads.to_string()]);
            }
            words.extend(["--seed".to_owned(), seed.to_string()]);
        }
        words.extend_from_slice(&self.common);
        if let Target::Views(views) = &self.target {
            words.extend_from_slice(&views[view]);
        }
        words.extend_from_slice(options);
        words
    }

    /// Whether a program takes these options in all views.
    pub(super) fn check(&self, side: usize, options: &[String]) -> Result<(), Error> {
        let scratch = self.scratch.join("defaults");
        (0..self.target.count())
            .try_for_each(|view| self.programs[side].check(&self.words(side, view, options, 0, true), &scratch))
    }
}

impl Bench for Runner {
    fn run(&mut self, job: &Job) -> Result<Output, Error> {
        let mut words = self.words(job.side, job.view, job.options, job.seed, job.timed);
        let records = self.scratch.join("records.amb");
        if job.fresh && records.exists() {
            std::fs::remove_file(&records)
                .map_err(|source| Error::File { file: name_of(&records).into_owned(), source })?;
        }
        if job.timed {
            words.extend(["-af".to_owned(), name_of(&records).into_owned()]);
        }
        words.push(name_of(&self.octree).into_owned());
        let input = match &self.target {
            Target::Views(_) => None,
            Target::Sensors(file) | Target::Rays(file) => Some(file.as_path()),
        };
        let out = self.scratch.join("output");
        let done = self.programs[job.side].run(&words, input, &out)?;
        let (part, values) = if let Target::Views(_) = &self.target { picture(&out)? } else { numbers(&out)? };
        let records = if job.timed { count_records(&records)? } else { None };
        Ok(Output { part, values, cost: done.cost, rays: rays(&done.messages), records })
    }

    fn say(&mut self, line: &str) {
        if !self.quiet {
            super::tell(line);
        }
    }
}

/// The pixels of a picture, exposure undone.
fn picture(file: &Path) -> Result<(Part, Vec<[f32; 3]>), Error> {
    let name = name_of(file).into_owned();
    let picture = Picture::open(&name).map_err(|e| Error::Program(format!("what rpict wrote is no picture: {e}")))?;
    ambit_measure::radiance(&picture, &name)
}

/// The numbers that rtrace printed, three a line.
fn numbers(file: &Path) -> Result<(Part, Vec<[f32; 3]>), Error> {
    let name = name_of(file).into_owned();
    let text = std::fs::read_to_string(file).map_err(|source| Error::File { file: name, source })?;
    let rows: Result<Vec<[f32; 3]>, Error> = (1..)
        .zip(text.lines().filter(|l| !l.trim().is_empty()))
        .map(|(line, text)| {
            let values: Option<Vec<f32>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
            values.and_then(|v| <[f32; 3]>::try_from(v).ok()).ok_or_else(|| {
                Error::Program(format!("rtrace, line {line} of its output: '{text}' (expected three numbers)"))
            })
        })
        .collect();
    let rows = rows?;
    Ok((Part { width: rows.len() as u32, height: 1 }, rows))
}

/// How many records an ambient file holds; `None` without a file.
fn count_records(file: &Path) -> Result<Option<u64>, Error> {
    let name = name_of(file).into_owned();
    let bytes = match std::fs::read(file) {
        Ok(bytes) => bytes,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(Error::File { file: name, source }),
    };
    let (header, layout, start) =
        scan_header(&bytes, &name).map_err(|e| Error::Program(format!("ambient file: {e}")))?;
    let components = Components::in_order(header.components() as usize);
    Ok(Some(((bytes.len() - start) / layout.record_bytes(&components)) as u64))
}

/// The last count of rays in reports of progress.
fn rays(messages: &str) -> Option<u64> {
    messages.lines().rev().find_map(|l| l.split_once(" rays,")?.0.rsplit(' ').next()?.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_those_of_the_last_report() {
        let said = "rpict: warning - x\nrpict: 12 rays, 5.00% after 1u\nrpict: 182256 rays, 100.00% after 0.000u\n";
        assert_eq!(rays(said), Some(182256));
        assert_eq!(rays("nothing"), None);
    }

    #[test]
    fn numbers_that_are_none_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("out");
        std::fs::write(&file, "1 2 3\n\n4e-1\tnan 6\n").unwrap();
        let (part, values) = numbers(&file).unwrap();
        assert_eq!((part, values[0]), (Part { width: 2, height: 1 }, [1.0, 2.0, 3.0]));
        // Not finite is for the measurement to refuse, which knows the rung.
        assert!(values[1][1].is_nan());
        std::fs::write(&file, "1 2 3\n1 2\n").unwrap();
        assert!(numbers(&file).unwrap_err().to_string().contains("line 2 of its output: '1 2'"));
    }
}
