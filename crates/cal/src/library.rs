//! The definitions a host program has read, and what compiles against them.

use std::collections::{BTreeMap, HashSet};

use crate::bind::Binder;
use crate::channel::global_channels;
use crate::embedded::embedded;
use crate::emit;
use crate::error::{CompileError, Problem};
use crate::expr::{Callee, Definition, Expr};
use crate::lex::{Parsed, Text, Trouble};
use crate::names::{Context, Names};
use crate::parse::{Grammar, Statement, Target};
use crate::program::Program;
use crate::scratch::Scratch;

/// The programs that share the language differ in what they offer it (function-files.md section 9).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Host {
    /// `rpict` and `rtrace`: variables and functions, ray channels, the renderer's library functions, folding.
    Renderer,
    /// `rcalc`: columns as channels, output channels, `PI`, `in(n)`, folding.
    Calculator,
    /// `ev`: calls of library functions only, no names for values, no folding.
    Expression,
}

impl Host {
    fn grammar(self) -> Grammar {
        Grammar {
            channels: self != Self::Expression,
            outputs: self == Self::Calculator,
            variables: self != Self::Expression,
        }
    }

    /// Whether constants are folded while reading.
    pub(crate) fn folds(self) -> bool {
        self != Self::Expression
    }
}

/// The shape of text being read, for messages.
#[derive(Clone, Copy)]
enum Source<'a> {
    File(&'a str),
    Argument(&'a str),
}

/// Definitions, and the names mentioned so far.
///
/// Lookup depends on the order in which texts are read and expressions compiled (a name binds to what is known then),
/// as in Radiance; to be independent of the order of rays, load all files before compiling.
#[derive(Clone, Debug)]
pub struct Library {
    pub(crate) host: Host,
    pub(crate) names: Names,
    pub(crate) messages: Vec<String>,
    /// Works out constants.
    pub(crate) scratch: Scratch,
    loaded: HashSet<Context>,
    outputs: BTreeMap<u32, Expr>,
}

impl Library {
    /// A library with nothing but what the host itself provides.
    pub fn new(host: Host) -> Self {
        let mut library = Self {
            host,
            names: Names::default(),
            messages: Vec::new(),
            scratch: Scratch::new(),
            loaded: HashSet::new(),
            outputs: BTreeMap::new(),
        };
        match host {
            Host::Renderer => {
                for (name, index) in global_channels() {
                    library.set(name, Definition::variable(Expr::Channel(index)));
                }
            }
            Host::Calculator => {
                let value = Expr::Number(std::f64::consts::PI);
                library.set("PI", Definition { constant: true, ..Definition::variable(value) });
            }
            Host::Expression => {}
        }
        library
    }

    /// A renderer's library with the prelude `rayinit.cal` that comes with this crate.
    pub fn renderer() -> Result<Self, CompileError> {
        let mut library = Self::new(Host::Renderer);
        let name = "rayinit.cal";
        library.load_global(name, embedded(name).unwrap_or_default().as_bytes())?;
        Ok(library)
    }

    fn set(&mut self, name: &str, definition: Definition) {
        let entry = self.names.exact(name, self.host);
        self.names.entry_mut(entry).definition = Some(definition);
    }

    /// Reads a file into the global context: the prelude, or a calculator's `-f`. `path` is for messages.
    pub fn load_global(&mut self, path: &str, text: &[u8]) -> Result<(), CompileError> {
        self.read(text, &Context::GLOBAL, Source::File(path))
    }

    /// Reads the function file that scenes call `name` into its own context; nothing happens if that context is known.
    /// `path` is where the file was found, for messages.
    pub fn load_file(&mut self, name: &str, path: &str, text: &[u8]) -> Result<(), CompileError> {
        let context = Context::of_file(name);
        if self.is_loaded(name) {
            return Ok(());
        }
        self.loaded.insert(context.clone());
        self.read(text, &context, Source::File(path))
    }

    /// Whether the function file that scenes call `name` (or one that shares its context) need not be read any more;
    /// `.` never need be.
    pub fn is_loaded(&self, name: &str) -> bool {
        let context = Context::of_file(name);
        context == Context::GLOBAL || self.loaded.contains(&context)
    }

    /// Reads definitions given on the command line (`-e`) into the global context.
    pub fn define(&mut self, text: &str) -> Result<(), CompileError> {
        self.read(text.as_bytes(), &Context::GLOBAL, Source::Argument(""))
    }

    /// Compiles an expression of a scene. `place` describes the primitive for messages: `TYPE "name"`.
    pub fn compile(&mut self, expression: &str, context: &Context, place: &str) -> Result<Program, CompileError> {
        let (text, source) = (expression.as_bytes(), Source::Argument(place));
        let raw = parsed(self.host.grammar().expression(text)).map_err(|t| report(text, source, t))?.1;
        let bound = Binder { library: self, context, parameters: &[] }.tree(&raw);
        let expr = bound.map_err(|(left, problem)| report(text, source, Trouble { left, problem }))?;
        Ok(emit::expression(self, &expr))
    }

    /// Compiles calls of the function that `name` means in `context`, with so many arguments given at run time. That
    /// there is no such function shows when the program is run, as in Radiance.
    pub fn function(&mut self, name: &str, arguments: u32, context: &Context) -> Program {
        let callee = Callee::Entry(self.names.mentioned(name, context, self.host));
        emit::expression(self, &Expr::Call(callee, (0..arguments).map(Expr::Given).collect()))
    }

    /// How many parameters the function of this name declares; `None` if there is no such function.
    pub fn parameters(&self, name: &str, context: &Context) -> Option<u32> {
        let Some(entry) = self.names.known(name, context) else {
            return crate::builtin::Builtin::named(name, self.host).map(crate::builtin::Builtin::arity);
        };
        let entry = self.names.entry(entry);
        let defined = entry.definition.as_ref().and_then(|definition| definition.parameters);
        defined.or(entry.builtin.map(crate::builtin::Builtin::arity))
    }

    /// The channels a calculator's definitions give values to, ascending, with their programs.
    pub fn outputs(&self) -> Vec<(u32, Program)> {
        self.outputs.iter().map(|(number, expr)| (*number, emit::expression(self, expr))).collect()
    }

    /// Messages of the texts read since the last call: redefinitions, constants that are none, failed arithmetic on
    /// constants. They are complete lines, without the word "warning", as Radiance prints them.
    pub fn drain_messages(&mut self) -> impl Iterator<Item = String> + '_ {
        self.messages.drain(..)
    }

    fn read(&mut self, text: Text<'_>, context: &Context, source: Source<'_>) -> Result<(), CompileError> {
        let grammar = self.host.grammar();
        let mut rest = text;
        loop {
            let (after, statement) = parsed(grammar.statement(rest)).map_err(|t| report(text, source, t))?;
            let Some(statement) = statement else { return Ok(()) };
            self.statement(&statement, context)
                .map_err(|(left, problem)| report(text, source, Trouble { left, problem }))?;
            rest = after;
        }
    }

    fn statement(&mut self, statement: &Statement, context: &Context) -> Result<(), crate::bind::Trouble> {
        let (name, parameters) = match &statement.target {
            Target::Variable(name) => (name, None),
            Target::Function(name, parameters) => (name, Some(&parameters[..])),
            Target::Output(number) => {
                let body = Binder { library: self, context, parameters: &[] }.tree(&statement.body)?;
                self.outputs.insert(*number, body);
                return Ok(());
            }
        };
        let names = parameters.unwrap_or(&[]);
        let body = Binder { library: self, context, parameters: names }.tree(&statement.body)?;
        let parameters = parameters.map(|list| list.len() as u32);
        let definition = Definition { constant: statement.constant, parameters, body, value: None };
        self.redefine(name, definition, context);
        Ok(())
    }

    /// Makes a definition the current one of its name, with the messages that go with it.
    fn redefine(&mut self, name: &str, definition: Definition, context: &Context) {
        let (before, settled) = (self.names.count(), self.is_settled(&definition.body));
        let id = self.names.defined(name, context, self.host);
        let entry = self.names.entry_mut(id);
        let name = &entry.name;
        match &entry.definition {
            Some(old) if old.constant && !old.same(&definition) => {
                self.messages.push(format!("{name}: constant redefined"));
            }
            Some(old) if self.host == Host::Renderer && !old.same(&definition) => {
                self.messages.push(format!("{name}: redefined"));
            }
            None if id < before && definition.parameters.is_some() && entry.builtin.is_some() => {
                self.messages.push(format!("{name}: definition hides library function"));
            }
            _ => {}
        }
        if definition.constant && definition.parameters.is_none() && !settled {
            self.messages.push(format!("{name}: assigned non-constant value"));
        }
        entry.definition = Some(definition);
    }
}

/// A nom result without the outcome "more bytes needed", which complete texts do not have.
fn parsed<T>(result: Parsed<'_, T>) -> Result<(Text<'_>, T), Trouble> {
    result.map_err(|error| match error {
        nom::Err::Error(trouble) | nom::Err::Failure(trouble) => trouble,
        nom::Err::Incomplete(_) => Trouble { left: 0, problem: Problem::UnexpectedCharacter },
    })
}

/// Puts a trouble in its place. The offending character is the one at which reading stopped; at the end of the text it
/// is the last there was.
fn report(text: Text<'_>, source: Source<'_>, trouble: Trouble) -> CompileError {
    let at = (text.len() - trouble.left).min(text.len().saturating_sub(1));
    let words = |bytes: Text<'_>| String::from_utf8_lossy(bytes).into_owned();
    let (place, line, column, source_line) = match source {
        Source::Argument(place) => (place, 0, at, words(text)),
        Source::File(path) => {
            let start = text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |newline| newline + 1);
            let line = text[..start].split(|byte| *byte == b'\n').count();
            let source_line = text[start..].split(|byte| *byte == b'\n').next().unwrap_or_default();
            (path, line, at - start, words(source_line.strip_suffix(b"\r").unwrap_or(source_line)))
        }
    };
    CompileError {
        place: place.to_owned(),
        line: line as u32,
        column: column as u32 + 1,
        source_line,
        problem: trouble.problem,
    }
}
