//! Scene text to primitives: modifiers by latest definition, aliases, commands in place (scene.md 2 to 4).

use crate::command::Runner;
use crate::lexer::Lexer;
use crate::{Error, ErrorKind, Kind, NewObject, ObjectId, Scene, VOID};
use ambit_base::{Location, Notify};
use ambit_file::{bytes_of, name_of, os_text, path_of, text_of};
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// How deep commands may print commands. Radiance stops at the limit of open files, usually 1024; each level here costs
/// a few hundred bytes of stack.
const MAX_DEPTH: usize = 500;

/// Reads scene text into a scene, file after file, in one name space.
pub struct Reader<'a> {
    scene: &'a mut Scene,
    notify: &'a dyn Notify,
    runner: &'a mut dyn Runner,
    /// Real arguments of the primitive being read.
    reals: Vec<f64>,
    /// The modifier looked up last; files of geometry repeat it.
    recent: Option<(Vec<u8>, ObjectId)>,
    depth: usize,
}

/// What scene text comes from.
struct Input<'n> {
    /// As diagnostics call it.
    name: &'n str,
    /// Its index in the scene.
    file: u32,
}

impl Input<'_> {
    fn error(&self, lexer: &Lexer<'_>, kind: ErrorKind) -> Error {
        let (line, column) = lexer.place();
        Error::new(kind, Location { file: self.name.to_owned(), line, column })
    }
}

fn whole(name: &str) -> Location {
    Location { file: name.to_owned(), line: 0, column: 0 }
}

impl<'a> Reader<'a> {
    /// A reader that appends to `scene`, whose modifiers it knows; warnings go to `notify`, commands to `runner`.
    pub fn new(scene: &'a mut Scene, notify: &'a dyn Notify, runner: &'a mut dyn Runner) -> Self {
        Self { scene, notify, runner, reals: Vec::new(), recent: None, depth: 0 }
    }

    /// Reads what a program was given as the name of a scene file: a command if it begins with `!`, else a file.
    pub fn read(&mut self, name: &str) -> Result<(), Error> {
        if name.starts_with('!') { self.read_command(&bytes_of(name)) } else { self.read_file(path_of(name)) }
    }

    /// Reads a file, by the name as given (no search path). A directory counts as an empty file.
    pub fn read_file(&mut self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let name = name_of(path);
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::IsADirectory => Vec::new(),
            Err(e) => {
                let kind = ErrorKind::CannotOpen { file: name.clone().into_owned(), reason: os_text(&e) };
                return Err(Error::new(kind, whole(&name)));
            }
        };
        self.read_bytes(&name, &bytes)
    }

    /// Reads a stream to its end; `name` is what diagnostics call it, such as `standard input`.
    pub fn read_stream(&mut self, name: &str, mut stream: impl Read) -> Result<(), Error> {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).map_err(|e| {
            Error::new(ErrorKind::ReadFailed { file: name.to_owned(), reason: os_text(&e) }, whole(name))
        })?;
        self.read_bytes(name, &bytes)
    }

    /// Reads text from memory; `name` is what diagnostics call it.
    pub fn read_bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let before = self.scene.len();
        self.parse(name, bytes)?;
        self.warn_if_empty(name, before);
        Ok(())
    }

    /// Runs a command, which begins with `!`, and reads what it prints. If it fails there is only a warning.
    pub fn read_command(&mut self, command: &[u8]) -> Result<(), Error> {
        let name = text_of(command).into_owned();
        let before = self.scene.len();
        let refuse = |reason| Err(Error::new(ErrorKind::CannotExecute { command: name.clone(), reason }, whole(&name)));
        if self.depth >= MAX_DEPTH {
            return refuse(format!("commands are nested more than {MAX_DEPTH} deep"));
        }
        let output = match self.runner.run(command.strip_prefix(b"!").unwrap_or(command)) {
            Ok(output) => output,
            Err(e) => return refuse(os_text(&e)),
        };
        self.depth += 1;
        let parsed = self.parse(&name, &output.text);
        self.depth -= 1;
        parsed?;
        if !output.success {
            self.notify.warn(&format!("bad status from \"{name}\""));
        }
        self.warn_if_empty(&name, before);
        Ok(())
    }

    fn warn_if_empty(&self, name: &str, before: usize) {
        if self.scene.len() == before {
            self.notify.warn(&format!("({name}): empty file"));
        }
    }

    fn parse(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let input = Input { name, file: self.scene.add_file(name) };
        let mut lexer = Lexer::new(bytes);
        while let Some(byte) = lexer.skip_white() {
            match byte {
                b'#' => lexer.skip_comment(),
                b'!' => {
                    let command = lexer.command();
                    self.read_command(&command)?;
                }
                _ => self.primitive(&mut lexer, &input)?,
            }
        }
        Ok(())
    }

    /// `modifier type identifier`, then arguments or an alias's reference.
    fn primitive(&mut self, lexer: &mut Lexer<'_>, input: &Input<'_>) -> Result<(), Error> {
        let line = lexer.line();
        let file = || input.name.to_owned();
        let text = |word: &[u8]| text_of(word).into_owned();

        let Some(word) = lexer.word() else { return Ok(()) };
        if word.contains(&b'\t') {
            let kind = ErrorKind::IllegalTab { file: file(), part: "modifier", word: text(&word) };
            return Err(input.error(lexer, kind));
        }
        let inherit = *word == *b"inherit";
        let modifier = match &*word {
            b"void" | b"inherit" => VOID,
            name => self
                .find(name)
                .ok_or_else(|| input.error(lexer, ErrorKind::UndefinedModifier { file: file(), word: text(name) }))?,
        };

        let word = lexer.word();
        let word = word.as_ref().map_or(&[][..], |w| &**w);
        let Some(kind) = Kind::from_name(word) else {
            return Err(input.error(lexer, ErrorKind::UnknownType { file: file(), word: text(word) }));
        };

        let word = lexer.word();
        let name = word.as_ref().map_or(&[][..], |w| &**w);
        if name.contains(&b'\t') {
            let kind = ErrorKind::IllegalTab { file: file(), part: "identifier", word: text(name) };
            return Err(input.error(lexer, kind));
        }
        if kind.is_modifier() && matches!(name, b"void" | b"inherit") {
            return Err(input.error(lexer, ErrorKind::IllegalModifierName { file: file(), word: text(name) }));
        }

        let mut new = NewObject { kind, modifier, name, strings: &[], reals: &[], file: input.file, line };
        if kind == Kind::Alias {
            let reference = lexer.word();
            let reference = reference.as_ref().map_or(&[][..], |w| &**w);
            let Some(target) = self.alias_target(reference) else {
                let primitive = format!("alias \"{}\"", text(name));
                let kind = ErrorKind::BadReference { file: file(), word: text(reference), primitive };
                return Err(input.error(lexer, kind));
            };
            // Another name for the same thing, or the target's arguments under another modifier.
            let passes = inherit || modifier == self.scene.object(target).modifier;
            let strings = [reference];
            if passes {
                new.modifier = target;
            } else {
                new.strings = &strings;
            }
            return self.define(&new, lexer, input);
        }

        let mut reals = std::mem::take(&mut self.reals);
        let strings = arguments(lexer, &mut reals).ok_or_else(|| {
            let primitive = format!("{} \"{}\"", kind.name(), text(name));
            input.error(lexer, ErrorKind::MalformedArguments { file: file(), primitive })
        })?;
        if inherit {
            let primitive = format!("{} \"{}\"", kind.name(), text(name));
            return Err(input.error(lexer, ErrorKind::InappropriateInherit { file: file(), primitive }));
        }
        let strings: Vec<&[u8]> = strings.iter().map(|s| &**s).collect();
        new.strings = &strings;
        new.reals = &reals;
        self.define(&new, lexer, input)?;
        self.reals = reals;
        Ok(())
    }

    fn define(&mut self, new: &NewObject<'_>, lexer: &Lexer<'_>, input: &Input<'_>) -> Result<(), Error> {
        if let Some(what) = self.scene.full(new) {
            return Err(input.error(lexer, ErrorKind::TooLarge { file: input.name.to_owned(), what }));
        }
        self.scene.push(*new);
        if new.kind.is_modifier() {
            self.recent = None;
        }
        Ok(())
    }

    /// A modifier by its latest definition.
    fn find(&mut self, name: &[u8]) -> Option<ObjectId> {
        if let Some((recent, id)) = &self.recent
            && recent == name
        {
            return Some(*id);
        }
        let id = self.scene.modifier(name)?;
        self.recent = Some((name.to_owned(), id));
        Some(id)
    }

    /// What a reference denotes once aliases that are mere names are looked through.
    fn alias_target(&self, reference: &[u8]) -> Option<ObjectId> {
        let mut target = self.scene.modifier(reference)?;
        loop {
            let object = self.scene.object(target);
            let is_name = object.kind == Kind::Alias && self.scene.string_count(target) == 0;
            // Modifiers point backwards; the comparison only guards against tables made otherwise.
            if !is_name || object.modifier >= target {
                return Some(target);
            }
            target = object.modifier;
        }
    }
}

/// The strings, no integers, and the reals.
pub(crate) fn arguments<'a>(lexer: &mut Lexer<'a>, reals: &mut Vec<f64>) -> Option<Vec<Cow<'a, [u8]>>> {
    let mut strings = Vec::new();
    for _ in 0..lexer.count()? {
        strings.push(lexer.word()?);
    }
    if lexer.count()? != 0 {
        return None;
    }
    reals.clear();
    for _ in 0..lexer.count()? {
        reals.push(lexer.real()?);
    }
    Some(strings)
}

#[cfg(test)]
mod tests;
