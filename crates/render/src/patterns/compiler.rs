//! Compiles the expressions and functions of modifiers. All function files of the scene are loaded first, so that no
//! result depends on the order of rays; equal expressions of one file are compiled once.

use super::auxiliary::Auxiliary;
use super::function_file::function_file;
use crate::Error;
use crate::prepare::{Definition, Environment};
use crate::spectral::Spectrum;
use ambit_base::Transform;
use ambit_cal::{ChannelSet, Context, Host, Library, Program};
use ambit_file::{name_of, os_text};
use ambit_scene::{ObjectId, Scene};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Defines what every function file may use.
const PRELUDE: &str = "rayinit.cal";

/// Library of function files, with the programs made so far and the other files that modifiers name.
pub(crate) struct Compiler<'e> {
    library: Library,
    environment: &'e Environment<'e>,
    /// Contexts whose file is loaded, or why it is not.
    loaded: HashMap<String, Result<(), Error>>,
    expressions: HashMap<(String, String), Arc<Program>>,
    functions: HashMap<(String, String, u32), Arc<Program>>,
    pub(crate) files: Auxiliary<'e>,
    /// What spectral patterns are folded to.
    pub(crate) spectrum: Spectrum,
}

/// Programs of one modifier with what they are evaluated in.
#[derive(Debug)]
pub(crate) struct Functions {
    /// The primitive they belong to.
    pub(crate) owner: ObjectId,
    pub(crate) programs: Box<[Arc<Program>]>,
    /// Inputs that any of them reads.
    pub(crate) channels: ChannelSet,
    /// Carries the function's coordinates into the scene.
    pub(crate) placement: Transform,
    /// Real arguments.
    pub(crate) reals: Box<[f64]>,
}

/// Which strings of a primitive become programs, in this order.
#[derive(Clone, Debug)]
pub(crate) struct Recipe<'r> {
    /// Strings that are expressions.
    pub(crate) expressions: &'r [usize],
    /// Strings that name functions, and how many arguments these are called with.
    pub(crate) functions: &'r [(usize, u32)],
    /// The string that names the function file.
    pub(crate) file: usize,
    /// The first string that may belong to a transform.
    pub(crate) transform: usize,
}

impl Functions {
    /// Refuses programs that read what only materials provide: in patterns, textures and mixtures these names have no
    /// value.
    pub(crate) fn without_material(self) -> Result<Self, Error> {
        let wrong = ChannelSet::MATERIAL.without(ChannelSet::MATERIAL.without(self.channels));
        match wrong.first_name() {
            Some(name) => Err(Error::user(format!("{name}: undefined variable"))),
            None => Ok(self),
        }
    }
}

impl<'e> Compiler<'e> {
    /// A compiler that knows the prelude, the command line's definitions and the function files of `scene`. A
    /// `rayinit.cal` on the search path takes the place of the built-in prelude.
    pub(crate) fn new(scene: &Scene, environment: &'e Environment<'e>, spectrum: Spectrum) -> Result<Self, Error> {
        let bad = |e: ambit_cal::CompileError| Error::user(e.to_string());
        let library = match (environment.find)(PRELUDE) {
            Some(path) => {
                let mut library = Library::new(Host::Renderer);
                let text = read(&path, PRELUDE)?;
                library.load_global(&name_of(&path), &text).map_err(bad)?;
                library
            }
            None => Library::renderer().map_err(bad)?,
        };
        let mut compiler = Self {
            library,
            environment,
            loaded: HashMap::new(),
            expressions: HashMap::new(),
            functions: HashMap::new(),
            files: Auxiliary::new(environment),
            spectrum,
        };
        for definition in environment.definitions {
            match definition {
                Definition::Text(text) => compiler.library.define(text).map_err(bad)?,
                Definition::File(name) => {
                    let path = (environment.find)(name).ok_or_else(|| {
                        Error::system(format!("cannot find function file \"{name}\": No such file or directory"))
                    })?;
                    let text = read(&path, name)?;
                    compiler.library.load_global(&name_of(&path), &text).map_err(bad)?;
                }
            }
        }
        for id in scene.ids() {
            if let Some(name) = function_file(scene.object(id).kind).and_then(|i| scene.string(id, i)) {
                // A file that cannot be loaded is an error where a ray needs it, which `context` reports.
                let _ = compiler.context(scene, id, &name);
            }
        }
        compiler.pass_on_messages();
        Ok(compiler)
    }

    pub(crate) fn warn(&self, text: &str) {
        self.environment.notify.warn(text);
    }

    /// Tells what the library has to say about the texts read so far.
    fn pass_on_messages(&mut self) {
        for message in self.library.drain_messages() {
            self.environment.notify.warn(&message);
        }
    }

    /// Compiles the strings `expressions` of `id` in the context of the function file named by string `file`;
    /// a transform may follow from string `file + 1` on.
    pub(crate) fn functions(
        &mut self,
        scene: &Scene,
        id: ObjectId,
        expressions: &[usize],
        file: usize,
    ) -> Result<Functions, Error> {
        self.assemble(scene, id, &Recipe { expressions, functions: &[], file, transform: file + 1 })
    }

    /// Compiles the programs of a recipe: its expressions, then its functions.
    pub(crate) fn assemble(&mut self, scene: &Scene, id: ObjectId, recipe: &Recipe<'_>) -> Result<Functions, Error> {
        let string = |i: usize| {
            scene.string(id, i).map(Cow::into_owned).ok_or_else(|| Error::primitive(scene, id, "bad # arguments"))
        };
        let context = self.context(scene, id, &string(recipe.file)?)?;
        let mut programs = Vec::with_capacity(recipe.expressions.len() + recipe.functions.len());
        for &i in recipe.expressions {
            programs.push(self.expression(scene, id, string(i)?, &context)?);
        }
        for &(i, arguments) in recipe.functions {
            programs.push(self.function(string(i)?, arguments, &context));
        }
        Ok(Functions {
            owner: id,
            channels: programs.iter().fold(ChannelSet::EMPTY, |set, p| set.union(p.channels())),
            programs: programs.into(),
            placement: trailing_transform(scene, id, recipe.transform)?,
            reals: scene.reals(id).into(),
        })
    }

    fn expression(
        &mut self,
        scene: &Scene,
        id: ObjectId,
        text: String,
        context: &Context,
    ) -> Result<Arc<Program>, Error> {
        let key = (context.as_str().to_owned(), text);
        if let Some(program) = self.expressions.get(&key) {
            return Ok(program.clone());
        }
        let compiled = self.library.compile(&key.1, context, &scene.describe(id));
        self.pass_on_messages();
        let program = Arc::new(compiled.map_err(|e| Error::at(scene, id, e.to_string()))?);
        self.expressions.insert(key, program.clone());
        Ok(program)
    }

    fn function(&mut self, name: String, arguments: u32, context: &Context) -> Arc<Program> {
        let key = (context.as_str().to_owned(), name, arguments);
        if let Some(program) = self.functions.get(&key) {
            return program.clone();
        }
        let program = Arc::new(self.library.function(&key.1, arguments, context));
        self.functions.insert(key, program.clone());
        program
    }

    /// How many parameters the function that string `function` names declares, in the file named by string `file`.
    pub(crate) fn parameters(
        &mut self,
        scene: &Scene,
        id: ObjectId,
        function: usize,
        file: usize,
    ) -> Result<Option<u32>, Error> {
        let (Some(function), Some(file)) = (scene.string(id, function), scene.string(id, file)) else {
            return Err(Error::primitive(scene, id, "bad # arguments"));
        };
        let context = self.context(scene, id, &file)?;
        Ok(self.library.parameters(&function, &context))
    }

    /// The context of a function file, which is loaded unless that has happened; `.` is none.
    pub(crate) fn context(&mut self, scene: &Scene, id: ObjectId, file: &str) -> Result<Context, Error> {
        if file == "." {
            return Ok(Context::GLOBAL);
        }
        let context = Context::of_file(file);
        if let Some(outcome) = self.loaded.get(context.as_str()) {
            return outcome.clone().map(|()| context);
        }
        let outcome = self.load(scene, id, file);
        self.loaded.insert(context.as_str().to_owned(), outcome.clone());
        outcome.map(|()| context)
    }

    fn load(&mut self, scene: &Scene, id: ObjectId, file: &str) -> Result<(), Error> {
        let (shown, text): (String, Cow<'static, [u8]>) = match (self.environment.find)(file) {
            Some(path) => (name_of(&path).into_owned(), read(&path, file)?.into()),
            None => match ambit_cal::embedded(file) {
                Some(text) => (file.to_owned(), text.as_bytes().into()),
                None => return Err(Error::missing_file(scene, id, "function file", file)),
            },
        };
        self.library.load_file(file, &shown, &text).map_err(|e| Error::user(e.to_string()))
    }
}

fn read(path: &Path, name: &str) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|e| Error::system(format!("cannot open function file \"{name}\": {}", os_text(&e))))
}

/// The transform in a modifier's trailing strings: what comes before the first transform option is ignored, from
/// there on everything must parse.
pub(crate) fn trailing_transform(scene: &Scene, id: ObjectId, first: usize) -> Result<Transform, Error> {
    Ok(scene.trailing_transform(id, first)?)
}
