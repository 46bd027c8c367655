//! The table of check cases: reading it, running a case, comparing the answer.
//!
//! The layout is described at the head of the tables themselves, `tests/cases/shading.tsv` and `functions.tsv`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::programs::{Answer, Program};

/// Relative tolerance where the table names no other: five digits.
const FIVE_DIGITS: f64 = 1e-5;

/// Where the table says 0: what may be left of 32-bit sums that cancel.
const ZERO: f64 = 1e-9;

/// One check case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Number in the table.
    pub number: u32,
    /// What it checks, in a few words.
    pub checks: String,
    /// Scene text, its fragments filled in.
    pub scene: String,
    /// Options after the common ones, one word each.
    pub extra: Vec<String>,
    /// Text for the standard input of rtrace: one ray a line.
    pub rays: String,
    /// Fields of every answered line.
    pub values: Vec<Vec<String>>,
    /// Relative tolerance of the numbers among them.
    pub tolerance: f64,
    /// What rtrace says when it ends, instead of an answer.
    pub fatal: Option<String>,
}

/// The whole table.
#[derive(Debug, Default)]
pub struct Table {
    /// Options common to all cases.
    pub options: String,
    /// The cases, by number.
    pub cases: Vec<Case>,
    /// Numbers whose feature the programs refuse so far.
    pub unsupported: BTreeSet<u32>,
    /// Numbers where the programs differ on purpose.
    pub different: BTreeSet<u32>,
}

/// How the answer to a case compares with the table.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// All fields agree.
    Agrees,
    /// The programs said that a feature is not supported (their message).
    Refused(String),
    /// Anything else: what was expected and what came.
    Fails(String),
}

impl Table {
    /// Reads a table.
    ///
    /// # Panics
    /// If a line of it is not as its head describes.
    pub fn read(text: &str) -> Self {
        let mut table = Self::default();
        let mut fragments: BTreeMap<&str, &str> = BTreeMap::new();
        let mut tolerances: BTreeMap<u32, f64> = BTreeMap::new();
        for line in text.lines().filter(|l| !l.is_empty() && !l.starts_with('#')) {
            let cells: Vec<&str> = line.split('\t').collect();
            match cells[..] {
                ["!options", options] => options.clone_into(&mut table.options),
                ["!fragment", name, scene] => drop(fragments.insert(name, scene)),
                ["!tolerance", value, list] => {
                    let value: f64 = value.parse().expect("a tolerance is a number");
                    tolerances.extend(numbers(list).map(|n| (n, value)));
                }
                ["!unsupported", list] => table.unsupported.extend(numbers(list)),
                ["!different", list] => table.different.extend(numbers(list)),
                [number, checks, scene, extra, rays, values] => {
                    let number = number.parse().unwrap_or_else(|_| panic!("not a case's number: {number}"));
                    table.cases.push(Case {
                        number,
                        checks: checks.to_owned(),
                        scene: fill_in(scene, &fragments),
                        extra: extra.split_whitespace().filter(|w| *w != "-").map(str::to_owned).collect(),
                        rays: rays.replace(';', "\n") + "\n",
                        values: values.split(';').map(fields).collect(),
                        fatal: values.strip_prefix("fatal ").map(str::to_owned),
                        tolerance: tolerances.get(&number).copied().unwrap_or(FIVE_DIGITS),
                    });
                }
                _ => panic!("not a line of a case table: {line}"),
            }
        }
        table
    }
}

/// The fields of one answered line.
fn fields(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
}

/// `109-111 114` → 109, 110, 111, 114.
fn numbers(list: &str) -> impl Iterator<Item = u32> {
    list.split_whitespace().flat_map(|item| {
        let (first, last) = item.split_once('-').unwrap_or((item, item));
        let number = |word: &str| word.parse::<u32>().unwrap_or_else(|_| panic!("not a case's number: {word}"));
        number(first)..=number(last)
    })
}

/// Scene text with every `@NAME` replaced by the fragment of that name (which may name others).
fn fill_in(scene: &str, fragments: &BTreeMap<&str, &str>) -> String {
    let word = |word: &str| match word.strip_prefix('@') {
        Some(name) => {
            let text = fragments.get(name).unwrap_or_else(|| panic!("no fragment of this name: {name}"));
            fill_in(text, fragments)
        }
        None => word.to_owned(),
    };
    scene.split_whitespace().map(word).collect::<Vec<_>>().join(" ")
}

impl Case {
    /// Compiles the scene, traces the rays and compares; `scratch` is an empty folder, `files` holds auxiliary files.
    ///
    /// # Panics
    /// If the scratch folder cannot be written.
    pub fn run(&self, options: &str, files: &Path, scratch: &Path) -> Verdict {
        let (scene, octree) = (scratch.join("scene.rad"), scratch.join("scene.oct"));
        std::fs::write(&scene, format!("{}\n", self.scene)).expect("the scratch folder can be written");
        let compiled = Program::new("oconv").arg(&scene).within(files).run();
        if compiled.status != Some(0) {
            return failed("oconv", &compiled);
        }
        std::fs::write(&octree, &compiled.out).expect("the scratch folder can be written");
        let mut rtrace = Program::new("rtrace").line(options).within(files);
        if self.extra.iter().all(|word| !word.starts_with("-o")) {
            rtrace = rtrace.arg("-ov");
        }
        for word in &self.extra {
            rtrace = rtrace.arg(word);
        }
        let answer = rtrace.arg(&octree).feed(self.rays.as_bytes());
        if let Some(message) = &self.fatal {
            return refused(message, &answer);
        }
        if answer.status != Some(0) {
            return failed("rtrace", &answer);
        }
        let text = answer.text();
        let answered: Vec<Vec<String>> = text.lines().map(fields).filter(|f| !f.is_empty()).collect();
        match compare(&self.values, &answered, self.tolerance) {
            None => Verdict::Agrees,
            Some(worst) => {
                let show = |lines: &[Vec<String>]| lines.iter().map(|f| f.join(" ")).collect::<Vec<_>>().join("; ");
                Verdict::Fails(format!(
                    "{worst}\n    expected {}\n    got      {}",
                    show(&self.values),
                    show(&answered)
                ))
            }
        }
    }
}

/// A case that must end with a message: whether it did.
fn refused(message: &str, answer: &Answer) -> Verdict {
    if answer.status.is_some_and(|s| s != 0) && answer.err.contains(message) {
        return Verdict::Agrees;
    }
    Verdict::Fails(format!("`{message}` expected, ended with {:?}: {}", answer.status, answer.err.trim()))
}

/// A program ended badly: either it names what it does not support, or it simply fails.
fn failed(program: &str, answer: &Answer) -> Verdict {
    let message = answer.err.trim();
    if answer.status.is_some() && (message.contains("not supported") || message.contains("unsupported")) {
        Verdict::Refused(message.to_owned())
    } else {
        Verdict::Fails(format!("{program} ended with {:?}: {message}", answer.status))
    }
}

/// What differs most, or nothing.
fn compare(expected: &[Vec<String>], answered: &[Vec<String>], tolerance: f64) -> Option<String> {
    if expected.len() != answered.len() {
        return Some(format!("{} lines expected, {} answered", expected.len(), answered.len()));
    }
    let mut worst = (1.0, None);
    for (line, (want, got)) in expected.iter().zip(answered).enumerate() {
        if want.len() != got.len() {
            return Some(format!("line {}: {} fields expected, {} answered", line + 1, want.len(), got.len()));
        }
        for (field, (want, got)) in want.iter().zip(got).enumerate() {
            let excess = match (want.parse::<f64>(), got.parse::<f64>()) {
                (Ok(want), Ok(got)) if got.is_finite() => (want - got).abs() / (tolerance * want.abs()).max(ZERO),
                (Err(_), Err(_)) if want == got => 0.0,
                _ => f64::INFINITY,
            };
            if excess > worst.0 {
                worst =
                    (excess, Some(format!("line {} field {}: {want} expected, {got} answered", line + 1, field + 1)));
            }
        }
    }
    worst.1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<Vec<String>> {
        text.split(';').map(fields).collect()
    }

    #[test]
    fn table_lines_are_read_as_described() {
        let text = "# head\n!options\t-h\n!fragment\tA\tvoid x\n!tolerance\t1e-3\t7-8\n!unsupported\t8\n\
                    7\tword\t@A y\t-i -e f(x)=x\t0 0 1 0 0 -1; 1 0 1 0 0 -1\t1 2; 3 b\n";
        let table = Table::read(text);
        let case = &table.cases[0];
        assert_eq!((case.number, case.scene.as_str(), case.tolerance), (7, "void x y", 1e-3));
        assert_eq!(case.extra, ["-i", "-e", "f(x)=x"]);
        assert_eq!(case.rays.lines().count(), 2);
        assert_eq!(case.values, lines("1 2;3 b"));
        assert_eq!(table.unsupported, BTreeSet::from([8]));
    }

    #[test]
    fn comparison_sees_the_sixth_digit_not_the_seventh() {
        let expected = lines("1.234567 0 b");
        assert_eq!(compare(&expected, &lines("1.2345671e0 -0.0 b"), 1e-5), None);
        assert!(compare(&expected, &lines("1.23460 0 b"), 1e-5).is_some());
        assert!(compare(&expected, &lines("1.234567 1e-8 b"), 1e-5).is_some());
        assert!(compare(&expected, &lines("1.234567 0 a"), 1e-5).is_some());
        assert!(compare(&expected, &lines("nan 0 b"), 1e-5).is_some());
        assert!(compare(&expected, &lines("1.234567 0"), 1e-5).is_some());
        assert!(compare(&expected, &[], 1e-5).is_some());
    }
}
