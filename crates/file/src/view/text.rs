//! Views as text: the canonical line, and the lines of headers and view files that carry options.

use super::{View, ViewOption};
use crate::command::base_name;
use crate::error::Error;
use crate::header::Header;
use crate::native::path_of;
use crate::printf::general;
use crate::words::real;
use ambit_base::DVec3;
use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader};

/// First words that mark a view line, whoever reads it.
const PREFIXES: [&str; 7] = ["VIEW=", "rpict", "rvu", "rview", "rpiece", "rxpiece", "pinterp"];

/// The canonical options, all ten, without a blank before them: up has unit length, the direction its own.
impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "-vt{}", self.kind.letter())?;
        let up = self.up.try_normalize().unwrap_or(self.up);
        for (name, v, digits) in [('p', self.point, 7), ('d', self.direction, 7), ('u', up, 5)] {
            let DVec3 { x, y, z } = v;
            write!(f, " -v{name} {} {} {}", general(x, digits), general(y, digits), general(z, digits))?;
        }
        for (name, v) in [
            ('h', self.horizontal),
            ('v', self.vertical),
            ('o', self.fore),
            ('a', self.aft),
            ('s', self.shift),
            ('l', self.lift),
        ] {
            write!(f, " -v{name} {}", general(v, 5))?;
        }
        Ok(())
    }
}

/// True for a header or file line that carries view options: its first word, without directories, starts with
/// `VIEW=`, with the name of a program that has views, or with `program`, the name of the running one.
pub fn is_view_line(line: &[u8], program: &str) -> bool {
    let first = line.split(|b| is_space(*b)).next().unwrap_or_default();
    let name = base_name(first);
    let own = !program.is_empty() && name.starts_with(program.as_bytes());
    own || PREFIXES.iter().any(|p| name.starts_with(p.as_bytes()))
}

fn is_space(b: u8) -> bool {
    b.is_ascii_whitespace() || b == 0x0b
}

impl View {
    /// The header line, without newline.
    pub fn header_line(&self) -> String {
        format!("VIEW= {self}")
    }

    /// Applies the options of a line whose first words do not matter; words that are no option, or an option with bad
    /// numbers, are passed over one by one. Returns how many options were applied.
    pub fn apply_line(&mut self, line: &[u8]) -> usize {
        let words: Vec<&str> = line
            .split(|&b| is_space(b))
            .filter(|w| !w.is_empty())
            .map(|w| std::str::from_utf8(w).unwrap_or_default())
            .collect();
        let (mut at, mut applied) = (0, 0);
        while let Some(word) = words.get(at) {
            at += 1;
            let Some(option) = ViewOption::parse(word) else { continue };
            let Some(numbers) = words.get(at..at + option.numbers()) else { continue };
            let Some(numbers) = numbers.iter().map(|w| real(w)).collect::<Option<Vec<f64>>>() else { continue };
            if self.apply(option, &numbers) {
                at += numbers.len();
                applied += 1;
            }
        }
        applied
    }

    /// Applies all view lines of a header in order, as the running `program` sees them. Returns how many options were
    /// applied.
    pub fn apply_header(&mut self, header: &Header, program: &str) -> usize {
        header.pieces().filter(|line| is_view_line(line, program)).map(|line| self.apply_line(line)).sum()
    }

    /// Applies a view file, or a picture's header, to this view; `file` names the stream in errors.
    pub fn read(&mut self, input: &mut (impl BufRead + ?Sized), file: &str, program: &str) -> Result<(), Error> {
        let bad = || Error::NoView { file: file.to_owned() };
        let header = match Header::read_text(input, file) {
            Err(Error::Header { .. }) => return Err(bad()),
            other => other?,
        };
        if self.apply_header(&header, program) > 0 { Ok(()) } else { Err(bad()) }
    }

    /// Applies the view file (or picture) of that name.
    pub fn read_file(&mut self, file: &str, program: &str) -> Result<(), Error> {
        let open = File::open(path_of(file)).map_err(|e| Error::io("cannot open view file", file, e))?;
        self.read(&mut BufReader::new(open), file, program)
    }
}
