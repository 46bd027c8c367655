//! What an ambient file was computed for: a fingerprint of the scene and of the parameters, in header lines of our own.
//!
//! Radiance passes over header lines it does not know, and leaves the header as it is when it appends records, so the
//! file stays an ambient file for its programs. What the lines say is compared with what a run would write; what the
//! words mean is the business of whoever computes them.
//!
//! ```text
//! AMBIT_SCENE= version=1 geometry=03b2… materials=9c4e… …
//! AMBIT_OPTIONS= ab=2 ad=1024 …
//! ```

use ambit_base::mix;
use ambit_file::Header;
use std::fmt::Write;

/// How much depends on a trait.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gravity {
    /// Fine print: a difference is told only to those who are strict.
    Slight,
    /// Records are finer or coarser, but of the same light.
    Accuracy,
    /// Records are of another light.
    Decisive,
}

/// The header line that a trait stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkLine {
    /// `AMBIT_SCENE=`
    Scene,
    /// `AMBIT_OPTIONS=`
    Options,
}

impl MarkLine {
    fn name(self) -> &'static str {
        match self {
            Self::Scene => "AMBIT_SCENE",
            Self::Options => "AMBIT_OPTIONS",
        }
    }
}

/// One thing that records depend on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Where it is written.
    pub line: MarkLine,
    /// Its name in the file, without `=` and blanks.
    pub key: &'static str,
    /// Its name in messages. One that begins with `-` is an option, whose values are told, too.
    pub label: &'static str,
    /// Its value, without blanks.
    pub value: String,
    /// What a difference means.
    pub gravity: Gravity,
}

/// All that the records of a run depend on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fingerprint {
    /// The marks, in the order in which differences are told.
    pub marks: Vec<Mark>,
}

/// How a file's fingerprint compares with a run's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// False if the file has none: written by Radiance, or by an older version.
    pub marked: bool,
    /// What differs, and how grave that is.
    pub differences: Vec<(Gravity, String)>,
}

impl Fingerprint {
    /// The header lines.
    pub fn lines(&self) -> Vec<String> {
        let line = |line: MarkLine| {
            let mut text = format!("{}=", line.name());
            for mark in self.marks.iter().filter(|m| m.line == line) {
                // Writing to memory does not fail.
                let _ = write!(text, " {}={}", mark.key, mark.value);
            }
            text
        };
        vec![line(MarkLine::Scene), line(MarkLine::Options)]
    }

    /// Compares with what stands in a header. What the header does not mention does not differ.
    pub fn compare(&self, header: &Header) -> Comparison {
        let mut comparison = Comparison::default();
        for mark in &self.marks {
            for line in header.values(mark.line.name()) {
                comparison.marked = true;
                let there =
                    line.split_ascii_whitespace().find_map(|word| word.strip_prefix(mark.key)?.strip_prefix('='));
                if let Some(there) = there
                    && there != mark.value
                {
                    let Mark { label, value, gravity, .. } = mark;
                    let option = label.starts_with('-');
                    let text =
                        if option { format!("{label} ({there} there, {value} here)") } else { (*label).to_owned() };
                    comparison.differences.push((*gravity, text));
                }
            }
        }
        comparison
    }

    /// A name for the light that records are of: eight digits from all decisive marks.
    pub fn short_name(&self) -> String {
        let decisive = self.marks.iter().filter(|m| m.gravity == Gravity::Decisive);
        let hash =
            decisive.flat_map(|m| m.key.bytes().chain(m.value.bytes()).chain([b' '])).fold(0, |h, b| mix(h, b.into()));
        format!("{:08x}", hash >> 32)
    }
}

impl Comparison {
    /// What differs at least so gravely, as a list for a message; `None` if nothing does.
    pub fn list(&self, least: Gravity) -> Option<String> {
        let texts: Vec<&str> = self.differences.iter().filter(|d| d.0 >= least).map(|d| d.1.as_str()).collect();
        (!texts.is_empty()).then(|| texts.join(", "))
    }
}

/// The lines of a header that belong to a fingerprint.
pub fn fingerprint_lines(header: &Header) -> impl Iterator<Item = &[u8]> {
    header.lines().filter(|line| line.starts_with(b"AMBIT_SCENE=") || line.starts_with(b"AMBIT_OPTIONS="))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(geometry: &str, bounces: &str, divisions: &str) -> Fingerprint {
        let mark = |line, key, label, value: &str, gravity| Mark { line, key, label, value: value.to_owned(), gravity };
        Fingerprint {
            marks: vec![
                mark(MarkLine::Scene, "geometry", "geometry", geometry, Gravity::Decisive),
                mark(MarkLine::Options, "ab", "-ab", bounces, Gravity::Decisive),
                mark(MarkLine::Options, "ad", "-ad", divisions, Gravity::Accuracy),
            ],
        }
    }

    fn header(print: &Fingerprint) -> Header {
        let mut header = Header::new();
        header.extend(print.lines());
        header
    }

    #[test]
    fn what_was_written_compares_equal() {
        let p = print("12", "1", "64");
        assert_eq!(p.lines(), ["AMBIT_SCENE= geometry=12", "AMBIT_OPTIONS= ab=1 ad=64"]);
        let same = p.compare(&header(&p));
        assert!(same.marked && same.differences.is_empty());
        assert!(!p.compare(&Header::new()).marked);
    }

    #[test]
    fn differences_are_named_by_gravity() {
        let there = header(&print("12", "1", "64"));
        let c = print("13", "1", "128").compare(&there);
        assert_eq!(c.list(Gravity::Decisive).unwrap(), "geometry");
        assert_eq!(c.list(Gravity::Accuracy).unwrap(), "geometry, -ad (64 there, 128 here)");
        assert_eq!(print("12", "1", "64").compare(&there).list(Gravity::Slight), None);
    }

    #[test]
    fn the_short_name_is_of_what_decides() {
        let name = |g: &str, b: &str, d: &str| print(g, b, d).short_name();
        assert_eq!(name("1", "1", "64"), name("1", "1", "128"));
        assert_ne!(name("1", "1", "64"), name("1", "2", "64"));
        assert_ne!(name("1", "1", "64"), name("11", "", "64"));
        assert_eq!(name("1", "1", "64").len(), 8);
    }
}
