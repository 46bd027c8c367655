//! Reading arguments left to right: options up to the first word without a dash, which names the octree and must be
//! the last.

use crate::failure::Failure;
use crate::outside::Outside;
use crate::table::{Place, Row};
use ambit_file::{WORD_LIMIT, bytes_of, integer, real, split_words, text_of};
use std::collections::VecDeque;

/// More expansions of `@FILE` and `$VARIABLE` than any command line needs: what goes beyond names itself.
const EXPANSION_LIMIT: usize = 10_000;

/// The words of a command line that have not been read yet, and those that have.
pub struct Arguments<'a> {
    rest: VecDeque<String>,
    /// Words read, after expansion: what a header records.
    read: Vec<String>,
    /// Flags of the rows that were read.
    flags: Vec<&'static str>,
    /// Words that were expanded.
    expansions: usize,
    outside: &'a dyn Outside,
}

/// What a command line asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Scan {
    /// A run.
    Run {
        /// The octree argument.
        octree: Option<String>,
        /// The options after expansion.
        words: Vec<String>,
        /// Flags of the rows that were read, in order.
        flags: Vec<&'static str>,
        /// What comes after the octree, where nothing may. It is refused once the error file is open, as Radiance does.
        excess: Vec<String>,
    },
    /// `-version`, `--version`.
    Version,
    /// `-defaults`, `-help`: the parameters as set so far.
    Defaults,
    /// `--help`.
    Help,
    /// `--man`.
    Man,
    /// `--completions SHELL`.
    Completions(String),
}

/// Reads a command line into `settings`, by the rows of a table.
///
/// # Errors
/// `command line error at 'WORD'` for an option that is unknown, incomplete or malformed, and whatever the options
/// themselves object to.
pub fn scan<S>(
    arguments: impl IntoIterator<Item = String>,
    table: &[Row<S>],
    settings: &mut S,
    outside: &dyn Outside,
) -> Result<Scan, Failure> {
    let rest = arguments.into_iter().collect();
    let mut words = Arguments { rest, read: Vec::new(), flags: Vec::new(), expansions: 0, outside };
    while let Some(word) = words.expanded()? {
        match word.as_str() {
            "-version" | "--version" => return Ok(Scan::Version),
            "-defaults" | "-help" => return Ok(Scan::Defaults),
            "--help" => return Ok(Scan::Help),
            "--man" => return Ok(Scan::Man),
            "--completions" => return words.text(&word).map(Scan::Completions),
            option if option.starts_with('-') => words.option(option, table, settings)?,
            _ => {
                words.read.pop();
                return Ok(words.run(Some(word)));
            }
        }
    }
    Ok(words.run(None))
}

impl Arguments<'_> {
    fn run(self, octree: Option<String>) -> Scan {
        Scan::Run { octree, words: self.read, flags: self.flags, excess: self.rest.into() }
    }

    /// The next word where `@FILE` and `$VARIABLE` stand for words.
    fn expanded(&mut self) -> Result<Option<String>, Failure> {
        while let Some(word) = self.rest.pop_front() {
            if word.starts_with(['@', '$']) {
                self.expansions += 1;
                if self.expansions > EXPANSION_LIMIT {
                    return Err(Failure::user(format!(
                        "'{word}' stands for itself, or expands more than {EXPANSION_LIMIT} times"
                    )));
                }
            }
            let found = if let Some(file) = word.strip_prefix('@') {
                self.outside.words(file)?
            } else if let Some(name) = word.strip_prefix('$') {
                // What Radiance says of an unset variable, stale error text and all.
                let unset = || Failure::system(format!("cannot expand '{word}'"), &missing());
                let value = self.outside.variable(name).ok_or_else(unset)?;
                split_words(&bytes_of(&value)).map(|w| text_of(w).into_owned()).collect()
            } else {
                self.read.push(word.clone());
                return Ok(Some(word));
            };
            for word in found.into_iter().take(WORD_LIMIT).rev() {
                self.rest.push_front(word);
            }
        }
        Ok(None)
    }

    /// The next word as it stands; an error at `option` if there is none.
    fn text(&mut self, option: &str) -> Result<String, Failure> {
        let word = self.rest.pop_front().ok_or_else(|| Failure::at(option).hint("a value is missing"))?;
        if !is_text(&word) {
            return Err(expected(option, &word, "printable ASCII characters"));
        }
        self.read.push(word.clone());
        Ok(word)
    }

    fn real(&mut self, option: &str) -> Result<f64, Failure> {
        // Scripts that put their words together leave blanks around numbers, which Radiance passes over.
        let word = self.text(option)?;
        real(word.trim()).ok_or_else(|| expected(option, &word, "a number"))
    }

    fn integer(&mut self, option: &str) -> Result<i32, Failure> {
        let word = self.text(option)?;
        integer(word.trim()).ok_or_else(|| expected(option, &word, "an integer"))
    }

    /// Reads one option with its values.
    fn option<S>(&mut self, word: &str, table: &[Row<S>], settings: &mut S) -> Result<(), Failure> {
        let name = &word[1..];
        for row in table {
            let Some(tail) = name.strip_prefix(row.flag) else { continue };
            match (&row.place, tail.chars().next()) {
                (Place::Switch(at), Some('+' | '1')) => *at(settings) = true,
                (Place::Switch(at), Some('-' | '0')) => *at(settings) = false,
                (Place::Switch(at), None) => *at(settings) = !*at(settings),
                (Place::Toggle(_, set), Some('+' | '1')) => set(settings, true),
                (Place::Toggle(_, set), Some('-' | '0')) => set(settings, false),
                (Place::Toggle(stands, set), None) => set(settings, !stands(settings)),
                (Place::Glued(fits, act), _) if fits(tail) => act(settings, tail)?,
                (Place::Switch(_) | Place::Toggle(..) | Place::Glued(..), _) | (_, Some(_)) => continue,
                (Place::Bare(act), None) => act(settings),
                (Place::Integer(at), None) => *at(settings) = self.integer(word)?,
                (Place::Whole(act), None) => act(settings, self.integer(word)?)?,
                (Place::Seed(at), None) => *at(settings) = self.text(word)?.parse().map_err(|_| Failure::at(word))?,
                (Place::Real(at), None) => *at(settings) = self.real(word)?,
                (Place::Vector(at), None) => {
                    let (x, y, z) = (self.real(word)?, self.real(word)?, self.real(word)?);
                    *at(settings) = ambit_base::DVec3::new(x, y, z);
                }
                (Place::Colour(at), None) => {
                    let (r, g, b) = (self.real(word)?, self.real(word)?, self.real(word)?);
                    *at(settings) = ambit_base::DVec3::new(r, g, b).as_vec3();
                }
                (Place::Reals(count, act), None) => {
                    let numbers = (0..*count).map(|_| self.real(word)).collect::<Result<Vec<f64>, Failure>>()?;
                    act(settings, &numbers)?;
                }
                (Place::Text(at), None) => *at(settings) = Some(self.text(word)?),
                (Place::Word(act), None) => {
                    let value = self.text(word)?;
                    act(settings, value, self.outside)?;
                }
                (Place::WordAndIntegers(most, act), None) => {
                    let value = self.text(word)?;
                    let mut numbers = Vec::new();
                    while numbers.len() < *most
                        && let Some(n) = self.rest.front().and_then(|w| integer(w))
                    {
                        numbers.push(n);
                        self.read.extend(self.rest.pop_front());
                    }
                    act(settings, value, &numbers)?;
                }
            }
            self.flags.push(row.flag);
            return Ok(());
        }
        Err(unknown(word, table))
    }
}

/// A value that an option can not take.
fn expected(option: &str, word: &str, what: &str) -> Failure {
    Failure::at(option).hint(format!("'{word}' (expected {what})"))
}

/// An option that is none, with the one that may have been meant: dashes are easily mistaken.
fn unknown<S>(word: &str, table: &[Row<S>]) -> Failure {
    let name = word.trim_start_matches('-');
    let meant = table.iter().find(|row| row.flag.trim_start_matches('-') == name && row.flag != &word[1..]);
    Failure::at(word).hint(if let Some(row) = meant {
        format!("expected '-{}'", row.flag)
    } else if let Some((flag, tail)) = glued(name, table) {
        format!("'-{flag}' does not take '{tail}'")
    } else {
        "there is no such option; --help lists them".to_owned()
    })
}

/// The option that a word without its dashes begins with, the longest one, and what is glued to it without need: one
/// character, or a value. More letters are rather another word, but for options that want letters.
fn glued<'a, S>(name: &'a str, table: &[Row<S>]) -> Option<(&'static str, &'a str)> {
    let parts = table.iter().filter_map(|row| {
        let tail = name.strip_prefix(row.flag.trim_start_matches('-'))?;
        let letters = tail.starts_with(|c: char| c.is_alphabetic()) && tail.chars().nth(1).is_some();
        let is_tail = !tail.is_empty() && (!letters || matches!(row.place, Place::Glued(..)));
        is_tail.then_some((row.flag, tail))
    });
    parts.min_by_key(|(_, tail)| tail.len())
}

/// Values are printable ASCII and not empty.
fn is_text(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|b| (b' '..=b'~').contains(&b))
}

fn missing() -> std::io::Error {
    std::io::Error::from(rustix::io::Errno::NOENT)
}
