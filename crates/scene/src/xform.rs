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

use crate::command::{CommandOutput, Commands, shell};
use crate::lexer::Lexer;
use ambit_file::text_of;
use primitive::Primitive;
use request::{Placed, Request};
use std::io;
use std::path::{Path, PathBuf};

/// How deep files may name commands of files; what lies deeper is left to the program.
const DEEPEST: usize = 16;

/// What became of a command.
pub(crate) enum Expansion {
    /// What it prints.
    Done(CommandOutput),
    /// It has to be run: nothing of it has been.
    Untouched,
    /// It has to be run, though commands in its files have been.
    GivenUp,
}

/// Does what a command asks `xform` for, if that is what it does. Names of files, and the commands in them, are relative to
/// `folder`.
pub(crate) fn expand(command: &[u8], folder: &Path, depth: usize, commands: Commands<'_>) -> io::Result<Expansion> {
    if depth >= DEEPEST {
        return Ok(Expansion::GivenUp);
    }
    let Some(pipe) = words::split(command) else { return Ok(Expansion::Untouched) };
    let Some(request) = Request::parse(pipe.words) else { return Ok(Expansion::Untouched) };
    let Some(first) = request.places().next().flatten() else { return Ok(Expansion::Untouched) };
    let within = (depth, commands);
    let Some(before) = pipe.before else {
        let parts = request.files.iter().map(|file| part_of_file(file, &request, &first, folder, commands));
        let Some(parts) = parts.collect::<Option<Vec<_>>>().filter(|parts| !parts.is_empty()) else {
            return Ok(Expansion::Untouched);
        };
        let text = place(parts, &request, within);
        return Ok(text.map_or(Expansion::GivenUp, Expansion::printed));
    };
    if !request.files.is_empty() {
        return Ok(Expansion::Untouched);
    }
    let Some(output) = commands.run_in(before, folder, depth + 1)? else { return Ok(Expansion::GivenUp) };
    let part = part(&output.text, &request, &first, folder.to_owned());
    match part.and_then(|part| place(vec![part], &request, within)) {
        Some(text) => Ok(Expansion::printed(text)),
        // What comes before the pipe is not run again: it may have read what this program reads.
        None => shell(pipe.last, folder, Some(&output.text)).map(Expansion::Done),
    }
}

impl Expansion {
    fn printed(text: Vec<u8>) -> Self {
        Self::Done(CommandOutput { text, success: true })
    }
}

/// A text that is to be placed, and the folder that its commands run in.
struct Part {
    items: Vec<Item>,
    folder: PathBuf,
}

/// A file operand, whose commands run in its own folder.
fn part_of_file(file: &[u8], request: &Request, first: &Placed, folder: &Path, commands: Commands<'_>) -> Option<Part> {
    let path = find(file, folder, commands)?;
    part(&std::fs::read(&path).ok()?, request, first, path.parent().unwrap_or(Path::new("")).to_owned())
}

/// Looks at a text; `None` if the program has to. No command in it has been run by then.
fn part(text: &[u8], request: &Request, first: &Placed, folder: PathBuf) -> Option<Part> {
    let items = read(text)?;
    let fits = |item: &Item| match item {
        Item::Primitive(primitive) => carry::carried(primitive, request, first).is_some(),
        Item::Command(_) => true,
    };
    (!items.is_empty() && items.iter().all(fits)).then_some(Part { items, folder })
}

/// Puts the primitives of all texts, and of what commands in them print, where they belong.
fn place(parts: Vec<Part>, request: &Request, (depth, commands): (usize, Commands<'_>)) -> Option<Vec<u8>> {
    let mut primitives = Vec::new();
    for Part { items, folder } in parts {
        gather(items, &folder, depth + 1, commands, &mut primitives)?;
    }
    let mut text = Vec::new();
    for placed in request.places() {
        let placed = placed?;
        for primitive in &primitives {
            carry::carried(primitive, request, &placed)?.print(&mut text)?;
        }
    }
    Some(text)
}

/// What scene text consists of.
enum Item {
    Primitive(Primitive),
    /// Without its `!`.
    Command(Vec<u8>),
}

/// What a text consists of; `None` if it is malformed.
fn read(text: &[u8]) -> Option<Vec<Item>> {
    let mut lexer = Lexer::new(text);
    let mut items = Vec::new();
    while let Some(byte) = lexer.skip_white() {
        match byte {
            b'#' => lexer.skip_comment(),
            b'!' => items.push(Item::Command(lexer.command().split_off(1))),
            _ => items.push(Item::Primitive(Primitive::read(&mut lexer)?)),
        }
    }
    Some(items)
}

/// The primitives of a text, and of what its commands print; `None` if that is nothing, which the program warns about.
fn gather(
    items: Vec<Item>,
    folder: &Path,
    depth: usize,
    commands: Commands<'_>,
    primitives: &mut Vec<Primitive>,
) -> Option<()> {
    let before = primitives.len();
    for item in items {
        match item {
            Item::Primitive(primitive) => primitives.push(primitive),
            Item::Command(command) => {
                let output = commands.run_in(&command, folder, depth).ok()?.filter(|o| o.success)?;
                gather(read(&output.text)?, folder, depth + 1, commands, primitives)?;
            }
        }
    }
    (primitives.len() > before).then_some(())
}

/// A file operand, which is searched for along RAYPATH; what looks like an option is none.
fn find(name: &[u8], folder: &Path, commands: Commands<'_>) -> Option<PathBuf> {
    let found = commands.search.find_from(folder, &text_of(name)).filter(|_| name.first() != Some(&b'-'));
    // The first that can be read is taken, a folder, too.
    found.filter(|path| path.is_file())
}

#[cfg(test)]
mod tests;
