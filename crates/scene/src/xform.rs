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
use ambit_file::text_of;
use primitive::Primitive;
use request::{Placed, Request};
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
    let mut texts = Vec::new();
    match pipe.before {
        Some(before) if request.files.is_empty() => {
            // As in a shell, only the last program's status counts.
            let output = commands.run_in(before, folder, depth + 1).ok()?;
            texts.push((output.text, folder.to_owned()));
        }
        None if !request.files.is_empty() => {
            for file in &request.files {
                let path = find(file, folder, commands)?;
                texts.push((std::fs::read(&path).ok()?, path.parent().unwrap_or(Path::new("")).to_owned()));
            }
        }
        _ => return None,
    }
    // All is looked at before any command in it is run, since the program runs them, too, if it has to be called.
    let first = request.places().next()??;
    let mut items = Vec::new();
    for (text, within) in &texts {
        items.push((read(text)?, within));
    }
    for primitive in items.iter().flat_map(|(items, _)| items) {
        if let Item::Primitive(primitive) = primitive {
            carry::carried(primitive, &request, &first)?;
        }
    }
    let mut primitives = Vec::new();
    for (items, within) in items {
        gather(items, within, depth + 1, commands, &mut primitives)?;
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
                let output = commands.run_in(&command, folder, depth).ok().filter(|o| o.success)?;
                gather(read(&output.text)?, folder, depth + 1, commands, primitives)?;
            }
        }
    }
    (primitives.len() > before).then_some(())
}

/// A primitive where it is put.
fn print(primitive: &Primitive, request: &Request, placed: &Placed, text: &mut Vec<u8>) -> Option<()> {
    carry::carried(primitive, request, placed)?.print(text)
}

/// A file operand, which is searched for along RAYPATH; what looks like an option is none.
fn find(name: &[u8], folder: &Path, commands: Commands<'_>) -> Option<PathBuf> {
    let found = commands.search.find_from(folder, &text_of(name)).filter(|_| name.first() != Some(&b'-'));
    // The first that can be read is taken, a folder, too.
    found.filter(|path| path.is_file())
}

#[cfg(test)]
mod tests;
