//! What commands of the form `!xform … file` and `!genbox … | xform …` print, without starting `xform` (scene.md 6.4).
//!
//! Scenes are assembled by such lines, every program that loads an octree that is not frozen runs all of them again, and
//! an array (`-a`) runs the commands within its file once for each place. Here these are run once, and no process is
//! started but for them. Only what is plain is done so; whatever is unusual, or wrong, is left to the program, which then
//! says so in its own words.

mod carry;
mod primitive;
mod request;
mod words;

use crate::command::Commands;
use crate::lexer::Lexer;
use primitive::Primitive;
use request::{Placed, Request};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

/// How deep files may name commands of files; deeper ones are left to the program.
const DEEPEST: usize = 16;

/// What a command prints, as scene text; `None` if it has to be run. Names of files, and the commands in them, are relative
/// to `folder`.
pub(crate) fn expand(command: &[u8], folder: &Path, depth: usize, commands: Commands<'_>) -> Option<Vec<u8>> {
    if depth >= DEEPEST {
        return None;
    }
    let pipe = words::split(command)?;
    let request = Request::parse(pipe.words)?;
    let mut primitives = Vec::new();
    match pipe.before {
        Some(before) if request.files.is_empty() => {
            // As in a shell, only the last program's status counts.
            let output = commands.run_in(before, folder, depth + 1).ok()?;
            read(&output.text, folder, depth, commands, &mut primitives)?;
        }
        None if !request.files.is_empty() => {
            for file in &request.files {
                let path = find(file, folder, commands)?;
                let bytes = std::fs::read(&path).ok()?;
                let within = path.parent().unwrap_or(Path::new(""));
                read(&bytes, within, depth, commands, &mut primitives)?;
            }
        }
        _ => return None,
    }
    let mut text = Vec::new();
    for placed in request.places() {
        let placed = placed?;
        for primitive in &primitives {
            print(primitive, &request, &placed, &mut text)?;
        }
    }
    Some(text)
}

/// Primitives of scene text, and of what its commands print; `None` if that is nothing, which the program warns about.
fn read(
    text: &[u8],
    folder: &Path,
    depth: usize,
    commands: Commands<'_>,
    primitives: &mut Vec<Primitive>,
) -> Option<()> {
    let before = primitives.len();
    let mut lexer = Lexer::new(text);
    while let Some(byte) = lexer.skip_white() {
        match byte {
            b'#' => lexer.skip_comment(),
            b'!' => {
                let command = lexer.command();
                let output = commands.run_in(&command[1..], folder, depth + 1).ok().filter(|o| o.success)?;
                read(&output.text, folder, depth + 1, commands, primitives)?;
            }
            _ => primitives.push(Primitive::read(&mut lexer)?),
        }
    }
    (primitives.len() > before).then_some(())
}

/// A primitive where it is put.
fn print(primitive: &Primitive, request: &Request, placed: &Placed, text: &mut Vec<u8>) -> Option<()> {
    carry::carried(primitive, request, placed)?.print(text)
}

/// A file operand, which is searched for along RAYPATH, whose folders are relative to `folder`, too.
fn find(name: &[u8], folder: &Path, commands: Commands<'_>) -> Option<PathBuf> {
    let path = Path::new(std::ffi::OsStr::from_bytes(name));
    let readable = |path: &PathBuf| path.is_file();
    match name.first()? {
        b'~' | b'-' => None,
        b'/' | b'.' => Some(folder.join(path)).filter(readable),
        _ => commands.search.directories().iter().map(|d| folder.join(d).join(path)).find(readable),
    }
}

#[cfg(test)]
mod tests;
