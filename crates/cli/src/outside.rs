//! What a command line may ask of the world while it is read: variables, files, lists on the search path.

use crate::failure::Failure;
use ambit_file::{View, read_words, split_words, text_of};
use std::io;

/// The world as the reader of options sees it.
pub trait Outside {
    /// The value of an environment variable.
    fn variable(&self, name: &str) -> Option<String>;
    /// The words of an argument file (`@file`).
    fn words(&self, file: &str) -> Result<Vec<String>, Failure>;
    /// The words of a list (`-aE`, `-tI` …), which is looked for on the search path; `what` names its purpose.
    fn list(&self, file: &str, what: &str) -> Result<Vec<String>, Failure>;
    /// Applies a view file, `-` being standard input, to a view.
    fn view(&self, view: &mut View, file: &str) -> Result<(), Failure>;
}

/// The process's own environment.
pub struct Process<'a> {
    /// Base name of the program, for view lines of its own.
    pub program: &'a str,
    /// Reads a file that is looked for along the search path.
    pub read: &'a dyn Fn(&str) -> io::Result<Vec<u8>>,
}

impl Outside for Process<'_> {
    fn variable(&self, name: &str) -> Option<String> {
        ambit_file::variable(name)
    }

    fn words(&self, file: &str) -> Result<Vec<String>, Failure> {
        let words = read_words(file)?;
        Ok(words.into_iter().map(|w| text_of(&w).into_owned()).collect())
    }

    fn list(&self, file: &str, what: &str) -> Result<Vec<String>, Failure> {
        let bytes =
            (self.read)(file).map_err(|e| Failure::system(format!("cannot open {what} file \"{file}\""), &e))?;
        Ok(split_words(&bytes).map(|w| text_of(w).into_owned()).collect())
    }

    fn view(&self, view: &mut View, file: &str) -> Result<(), Failure> {
        if file == "-" {
            view.read(&mut io::stdin().lock(), file, self.program)?;
        } else {
            view.read_file(file, self.program)?;
        }
        Ok(())
    }
}
