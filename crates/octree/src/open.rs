//! An octree's bytes by its name on a command line: a file, or a command whose output is the octree.

use crate::Error;
use crate::error::{Instead, Problem};
use ambit_base::Notify;
use ambit_file::{bytes_of, path_of};
use ambit_scene::Runner;
use std::io::ErrorKind;

/// What may be an octree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// What messages call it.
    pub name: String,
    /// What is to be read.
    pub bytes: Vec<u8>,
    /// True if a command printed them that failed.
    pub failed: bool,
}

impl Source {
    /// The bytes of a file, or of what a command prints if the name begins with `!`.
    pub fn open(name: &str, runner: &mut dyn Runner) -> Result<Self, Error> {
        let failed = |action| move |source| Error::Open { action, name: name.to_owned(), source };
        let shown = name.to_owned();
        let Some(command) = name.strip_prefix('!') else {
            let bytes = match std::fs::read(path_of(name)) {
                Err(e) if e.kind() == ErrorKind::IsADirectory => {
                    return Err(Problem::NotAnOctree(Instead::Directory).of(name));
                }
                result => result.map_err(failed("cannot open octree file"))?,
            };
            return Ok(Self { name: shown, bytes, failed: false });
        };
        let output = runner.run(&bytes_of(command)).map_err(failed("cannot execute"))?;
        Ok(Self { name: shown, bytes: output.text, failed: !output.success })
    }

    /// Warns if the command failed. It is called once the octree has been read: whoever gets none needs not know.
    pub fn complain(&self, notify: &dyn Notify) {
        if self.failed {
            notify.warn(&format!("bad status from \"{}\"", self.name));
        }
    }
}
