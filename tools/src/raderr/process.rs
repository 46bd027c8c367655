//! One process: what it costs, what it leaves, and why it failed.

use ambit_file::{name_of, path_of, text_of};
use ambit_measure::{Cost, Error};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use wait4::Wait4;

/// A program with the options that only it gets.
#[derive(Clone, Debug)]
pub(super) struct Program {
    /// What messages and tables call it.
    pub(super) name: String,
    pub(super) path: PathBuf,
    /// Its RAYPATH; the one of raderr if `None`.
    pub(super) raypath: Option<String>,
    /// Its own options.
    pub(super) words: Vec<String>,
    /// What it says of itself.
    pub(super) version: String,
    /// Whether it is one of Ambit's, which have `-n` and `--seed`.
    pub(super) ambit: bool,
}

/// A process that ended well.
pub(super) struct Finished {
    pub(super) cost: Cost,
    /// What it said on standard error.
    pub(super) messages: String,
}

impl Program {
    /// Asks the program who it is.
    pub(super) fn new(name: &str, path: &Path, raypath: Option<&str>, words: &str) -> Result<Self, Error> {
        let mut command = Command::new(path);
        if let Some(raypath) = raypath {
            command.env("RAYPATH", raypath);
        }
        let answer = command.arg("-version").stdin(Stdio::null()).output();
        let answer = answer.map_err(|source| Error::File { file: name_of(path).into_owned(), source })?;
        let version = text_of(&answer.stdout).lines().next().unwrap_or_default().trim().to_owned();
        if !answer.status.success() || version.is_empty() {
            let said = text_of(&answer.stderr).lines().next().unwrap_or("nothing").to_owned();
            return Err(Error::Program(format!(
                "{}: does not answer -version as rpict and rtrace do: {}, said {said}",
                name_of(path),
                answer.status
            )));
        }
        let ambit = version.contains("Ambit");
        Ok(Self { version, ambit, ..Self::unasked(name, path, raypath, words) })
    }

    /// A program that does not say who it is.
    pub(super) fn unasked(name: &str, path: &Path, raypath: Option<&str>, words: &str) -> Self {
        let words = words.split_whitespace().map(str::to_owned).collect();
        let (name, path, raypath) = (name.to_owned(), path.to_owned(), raypath.map(str::to_owned));
        Self { name, path, raypath, words, version: String::new(), ambit: false }
    }

    /// Runs it with its own words and these, standard output to a file.
    pub(super) fn run(&self, words: &[String], input: Option<&Path>, output: &Path) -> Result<Finished, Error> {
        let file = |path: &Path, source| Error::File { file: name_of(path).into_owned(), source };
        let said = output.with_extension("messages");
        let stdin = match input {
            Some(path) => Stdio::from(File::open(path).map_err(|e| file(path, e))?),
            None => Stdio::null(),
        };
        let stdout = File::create(output).map_err(|e| file(output, e))?;
        let stderr = File::create(&said).map_err(|e| file(&said, e))?;
        let mut command = Command::new(&self.path);
        command
            .args(self.words.iter().chain(words).map(|word| path_of(word)))
            .stdin(stdin)
            .stdout(stdout)
            .stderr(stderr);
        if let Some(raypath) = &self.raypath {
            command.env("RAYPATH", raypath);
        }
        let start = Instant::now();
        let mut child = command.spawn().map_err(|e| file(&self.path, e))?;
        let used = child.wait4().map_err(|e| file(&self.path, e))?;
        let wall = start.elapsed().as_secs_f64();
        let bytes = std::fs::read(&said).map_err(|e| file(&said, e))?;
        let messages = text_of(&bytes).into_owned();
        if !used.status.success() {
            let reason = messages.lines().find(|l| !l.contains("warning")).unwrap_or("nothing on standard error");
            return Err(Error::Program(format!(
                "{} ({}): {}: {reason}\n  command: {} {}",
                self.name,
                name_of(&self.path),
                used.status,
                name_of(&self.path),
                [&self.words[..], words].concat().join(" ")
            )));
        }
        let cpu = (used.rusage.utime + used.rusage.stime).as_secs_f64();
        Ok(Finished { cost: Cost { wall, cpu, peak: used.rusage.maxrss }, messages })
    }

    /// Whether it takes these options; it is asked for its defaults under them, which computes nothing.
    pub(super) fn check(&self, words: &[String], scratch: &Path) -> Result<(), Error> {
        let mut asked = words.to_vec();
        asked.push("-defaults".to_owned());
        self.run(&asked, None, scratch).map(drop)
    }
}
