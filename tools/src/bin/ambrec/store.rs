//! Ambient files in and out.

use ambit_ambient::{Components, Contents, FORMAT, Layout, Record, missing, scan, segments};
use ambit_file::{FileLock, Header, LockMode, Replacement, name_of, os_text};
use clap::Args;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// How long the lock of a file is waited for.
pub(crate) const PATIENCE: Duration = Duration::from_secs(10);

/// Why the work ends early: what to tell the user.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) String);

impl From<String> for Failure {
    fn from(text: String) -> Self {
        Self(text)
    }
}

/// Where the result goes.
#[derive(Args)]
pub(crate) struct Output {
    /// The file to write; it appears when it is complete. Standard output unless given.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

impl Output {
    /// Writes all at once.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        let Some(path) = &self.output else { return print(bytes) };
        let failed = |e: io::Error| Failure(format!("cannot write \"{}\": {}", name_of(path), os_text(&e)));
        let mut out = Replacement::create(path).map_err(failed)?;
        out.write_all(bytes).map_err(failed)?;
        out.commit().map_err(failed)
    }
}

/// Prints on standard output.
pub(crate) fn print(bytes: &[u8]) -> Result<(), Failure> {
    let written = ambit_cli::StandardOutput::ending().write_all(bytes);
    written.map_err(|e| Failure(format!("cannot write output: {}", os_text(&e))))
}

/// The bytes of a file, read under its lock if that can be had.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let failed = |e: io::Error| Failure(format!("cannot read \"{}\": {}", name_of(path), os_text(&e)));
    let file = Arc::new(File::open(path).map_err(failed)?);
    if !file.metadata().map_err(failed)?.is_file() {
        return Err(Failure(format!("\"{}\" is not a regular file", name_of(path))));
    }
    let _lock = FileLock::acquire_within(&file, LockMode::Shared, PATIENCE);
    let mut bytes = Vec::new();
    (&*file).read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

/// The contents of a file, with the records that wait in segments beside it.
pub(crate) fn contents(path: &Path) -> Result<Contents, Failure> {
    let name = name_of(path).into_owned();
    let mut contents = scan(&bytes(path)?, &name)
        .map_err(|problem| Failure(format!("bad/incompatible ambient file \"{name}\": {problem}")))?;
    let (more, _) = missing(&contents, &segments(path, &contents, &Told));
    contents.records.extend(more);
    Ok(contents)
}

/// An ambient file of these records, with the lines of `header` that still hold.
pub(crate) fn file(header: &Header, layout: Layout, components: &Components, records: &[Record]) -> Vec<u8> {
    let mut lines = Header::empty();
    let dropped = [&b"NCOMP="[..], b"WAVELENGTH_SPLITS="];
    lines.extend(header.lines_without_format().filter(|l| !dropped.iter().any(|d| l.starts_with(d))));
    if layout == Layout::V561 {
        lines.extend(header.lines().filter(|l| l.starts_with(b"WAVELENGTH_SPLITS=")));
        lines.push(format!("NCOMP={}", components.count()));
    }
    lines.push(format!("FORMAT={FORMAT}"));
    let mut bytes = Vec::with_capacity(1024 + records.len() * layout.record_bytes(components));
    // Writing to memory does not fail.
    let _ = lines.write(&mut bytes);
    bytes.extend(layout.magic().to_be_bytes());
    for record in records {
        bytes.extend(layout.encode(record, components));
    }
    bytes
}

/// Tells something on standard error.
pub(crate) fn tell(text: &str) {
    ambit_cli::say(format_args!("ambrec: {text}"));
}

/// Warnings of the library.
pub(crate) struct Told;

impl ambit_base::Notify for Told {
    fn warn(&self, text: &str) {
        tell(&format!("warning - {text}"));
    }
}
