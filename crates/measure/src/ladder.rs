//! Ladders: settings from coarse to fine, one rung a line.
//!
//! A line holds options of rpict or rtrace, separated by white space; its first word may be a label that ends in a
//! colon. `#` starts a comment, empty lines are skipped.

use crate::error::Error;
use serde::{Deserialize, Serialize};

/// One setting.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rung {
    /// What tables and plots call it.
    pub label: String,
    /// Its options.
    pub options: Vec<String>,
}

/// Settings in the order in which they are run, usually from coarse to fine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ladder {
    /// At least one.
    pub rungs: Vec<Rung>,
}

/// How densely irradiance values stand: accuracy `-aa` and resolution `-ar`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// `-aa`; their number is about as 1/accuracy².
    pub accuracy: f64,
    /// `-ar`.
    pub resolution: i32,
}

const fn spacing(accuracy: f64, resolution: i32) -> Spacing {
    Spacing { accuracy, resolution }
}

/// Spacings from coarse to fine: all that settings are chosen from (`--error`), and but for the first and the last one
/// those of the standard ladder.
pub const SPACINGS: [Spacing; 8] = [
    spacing(0.6, 8),
    spacing(0.4, 16),
    spacing(0.3, 32),
    spacing(0.2, 64),
    spacing(0.15, 64),
    spacing(0.1, 128),
    spacing(0.07, 128),
    spacing(0.05, 256),
];

/// Divisions of the standard ladder's first rung.
const FIRST_DIVISIONS: i32 = 64;

/// How many super-samples (`-as`) go with so many divisions (`-ad`): a quarter as many.
pub fn super_samples(divisions: i32) -> i32 {
    divisions / 4
}

impl Ladder {
    /// The built-in ladder for the irradiance cache: accuracy .4 to .07, 64 to 2048 divisions.
    ///
    /// Each rung has about twice as many hemisphere samples as the one before, and an accuracy that falls with it, so
    /// that noise and interpolation error stay in proportion.
    pub fn standard() -> Self {
        let inner = &SPACINGS[1..SPACINGS.len() - 1];
        let rung = |(k, s): (usize, &Spacing)| {
            let divisions = FIRST_DIVISIONS << k;
            let accuracy = s.accuracy.to_string();
            let words = [
                ("-aa", accuracy.strip_prefix('0').unwrap_or(&accuracy).to_owned()),
                ("-ar", s.resolution.to_string()),
                ("-ad", divisions.to_string()),
                ("-as", super_samples(divisions).to_string()),
            ];
            let options = words.into_iter().flat_map(|(flag, value)| [flag.to_owned(), value]).collect();
            Rung { label: (k + 1).to_string(), options }
        };
        Self { rungs: inner.iter().enumerate().map(rung).collect() }
    }

    /// The first `count` rungs, at least one.
    #[must_use]
    pub fn first(mut self, count: usize) -> Self {
        self.rungs.truncate(count.max(1));
        self
    }

    /// Reads a ladder; `file` names it in errors.
    pub fn parse(text: &str, file: &str) -> Result<Self, Error> {
        let bad = |line: usize, problem: String| Error::Ladder { file: file.to_owned(), line, problem };
        let mut rungs: Vec<Rung> = Vec::new();
        for (line, text) in (1..).zip(text.lines()) {
            let text = text.split('#').next().unwrap_or_default();
            let mut words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
            let Some(first) = words.first() else { continue };
            let label = match first.strip_suffix(':') {
                Some(label) if !label.is_empty() && !first.starts_with('-') => {
                    let label = label.to_owned();
                    words.remove(0);
                    label
                }
                _ => (rungs.len() + 1).to_string(),
            };
            match words.first() {
                Some(word) if word.starts_with('-') || word.starts_with('@') => {}
                Some(word) => {
                    return Err(bad(line, format!("'{word}' is no option (expected something like -aa .2 -ad 512)")));
                }
                None => {
                    return Err(bad(
                        line,
                        "a label without options (expected something like -aa .2 -ad 512)".to_owned(),
                    ));
                }
            }
            if rungs.iter().any(|r| r.label == label) {
                return Err(bad(line, format!("a second rung is called '{label}'")));
            }
            rungs.push(Rung { label, options: words });
        }
        if rungs.is_empty() {
            return Err(bad(1, "no rung in the whole file (expected lines like -aa .2 -ad 512)".to_owned()));
        }
        Ok(Self { rungs })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_rungs() {
        let ladder = Ladder::parse("# mine\ncoarse: -aa .4 -ad 64 # quick\n\n-aa .2\n", "l").unwrap();
        let shown: Vec<_> = ladder.rungs.iter().map(|r| format!("{}={}", r.label, r.options.join(" "))).collect();
        assert_eq!(shown, ["coarse=-aa .4 -ad 64", "2=-aa .2"]);
        let standard = Ladder::standard().rungs;
        assert_eq!(standard.len(), 6);
        assert_eq!(standard[0].options.join(" "), "-aa .4 -ar 16 -ad 64 -as 16");
        assert_eq!(standard[5].options.join(" "), "-aa .07 -ar 128 -ad 2048 -as 512");
        assert_eq!(Ladder::standard().first(2).rungs.len(), 2);
    }

    #[test]
    fn what_is_no_rung_is_named_with_its_line() {
        let message = |text: &str| Ladder::parse(text, "l.txt").unwrap_err().to_string();
        assert!(message("-aa .2\naa .1\n").starts_with("l.txt, line 2: 'aa' is no option"));
        assert!(message("fine:\n").contains("a label without options"));
        assert!(message("a: -ab 1\na: -ab 2").contains("line 2: a second rung is called 'a'"));
        assert!(message("# nothing\n").contains("no rung"));
    }
}
