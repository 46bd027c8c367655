//! How the run that began an ambient file treats its records, which those that go on with it must know.

use super::fingerprint::fingerprint_lines;
use super::reuse::{Opening, Verdict};
use super::share::AmbientFile;
use ambit_file::{Header, name_of};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// How records of a file are to be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Habits {
    /// How far they may count, as a multiple of their reach: their corrals tell what lies within as much, and must not be
    /// asked for more. 1 of Radiance, and of older versions.
    pub smoothing: f32,
    /// Whether Ambit began the file, and not Radiance: then those of deeper bounces rein each other in, and steps part
    /// surfaces.
    pub ours: bool,
}

impl Habits {
    pub(super) fn of(header: &Header) -> Self {
        let words = fingerprint_lines(header).flat_map(|line| line.split(u8::is_ascii_whitespace));
        let told = words.filter_map(|word| std::str::from_utf8(word.strip_prefix(b"smoothing=")?).ok()?.parse().ok());
        let smoothing = told.last().unwrap_or(1.0);
        Self { smoothing, ours: fingerprint_lines(header).next().is_some() }
    }
}

impl AmbientFile {
    /// The [`super::Opened::habits`] that opening would come to, for estimates that are made before. No file is locked or
    /// changed, and what is wrong with one is left for the opening to tell.
    pub fn habits(path: &Path, opening: &Opening<'_>) -> Option<Habits> {
        // What is used of a file: itself, or the one beside it.
        let judged = |path: &Path| {
            std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
            let name = name_of(path);
            let header = Header::read(&mut BufReader::new(File::open(path).ok()?), &name).ok()?;
            let verdict = opening.judge(&opening.compare(&header), &name).ok()?;
            Some((Habits::of(&header), matches!(verdict, Verdict::Use(_))))
        };
        let (found, used) = judged(path)?;
        if used { Some(found) } else { judged(&opening.beside(path)?).filter(|beside| beside.1).map(|beside| beside.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_tell_who_began_them() {
        let habits = |lines: &str| {
            let text = format!("#?RADIANCE\n{lines}FORMAT=Radiance_ambval\n\n");
            Habits::of(&Header::parse(text.as_bytes(), "a.amb").expect("a header").0)
        };
        assert_eq!(habits("rpict -ab 1\n"), Habits { smoothing: 1.0, ours: false });
        assert_eq!(habits("AMBIT_OPTIONS= ab=1\n"), Habits { smoothing: 1.0, ours: true });
        assert_eq!(habits("AMBIT_OPTIONS= ab=1 smoothing=1\n"), Habits { smoothing: 1.0, ours: true });
        assert_eq!(habits("AMBIT_OPTIONS= ab=1 smoothing=1.5\n"), Habits { smoothing: 1.5, ours: true });
    }
}
