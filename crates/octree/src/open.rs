//! An octree's bytes by its name on a command line: a file, or a command whose output is the octree.

use crate::Error;
use ambit_base::Notify;
use ambit_file::{bytes_of, path_of};
use ambit_scene::Runner;

/// The bytes of a file, or of what a command prints if the name begins with `!`. A command that fails costs a warning.
/// A directory is an empty file.
pub fn open(name: &str, runner: &mut dyn Runner, notify: &dyn Notify) -> Result<Vec<u8>, Error> {
    let failed = |action| move |source| Error::Open { action, name: name.to_owned(), source };
    let Some(command) = name.strip_prefix('!') else {
        return match std::fs::read(path_of(name)) {
            Err(e) if e.kind() == std::io::ErrorKind::IsADirectory => Ok(Vec::new()),
            result => result.map_err(failed("cannot open octree file")),
        };
    };
    let output = runner.run(&bytes_of(command)).map_err(failed("cannot execute"))?;
    if !output.success {
        notify.warn(&format!("bad status from \"{name}\""));
    }
    Ok(output.text)
}
