//! For which smoothing the records of an ambient file were made: their corrals tell what lies within as much of their
//! reach, and must not be asked for more.

use super::fingerprint::fingerprint_lines;
use super::reuse::{Opening, Verdict};
use super::share::AmbientFile;
use ambit_file::{Header, name_of};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The smoothing of the run that began a file; that of Radiance, and of older versions, is none.
pub(super) fn smoothing(header: &Header) -> f32 {
    let words = fingerprint_lines(header).flat_map(|line| line.split(u8::is_ascii_whitespace));
    let told = words.filter_map(|word| std::str::from_utf8(word.strip_prefix(b"smoothing=")?).ok()?.parse().ok());
    told.last().unwrap_or(1.0)
}

impl AmbientFile {
    /// The [`super::Opened::smoothing`] that opening would come to, for estimates that are made before. No file is locked or
    /// changed, and what is wrong with one is left for the opening to tell.
    pub fn smoothing(path: &Path, opening: &Opening<'_>) -> Option<f32> {
        // What is used of a file: itself, or the one beside it.
        let judged = |path: &Path| {
            std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
            let name = name_of(path);
            let header = Header::read(&mut BufReader::new(File::open(path).ok()?), &name).ok()?;
            let verdict = opening.judge(&opening.compare(&header), &name).ok()?;
            Some((smoothing(&header), matches!(verdict, Verdict::Use(_))))
        };
        let (found, used) = judged(path)?;
        if used { Some(found) } else { judged(&opening.beside(path)?).filter(|beside| beside.1).map(|beside| beside.0) }
    }
}
