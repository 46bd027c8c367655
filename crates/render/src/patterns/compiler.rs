//! Compiles the expressions of function-type modifiers, loading each function file once.

use crate::Error;
use crate::prepare::{Definition, Environment};
use ambit_base::Transform;
use ambit_cal::{ChannelSet, Context, Host, Library, Program};
use ambit_scene::{ObjectId, Scene};
use std::borrow::Cow;
use std::collections::HashSet;
use std::path::Path;

/// Defines what every function file may use.
const PRELUDE: &str = "rayinit.cal";

/// Library of function files, and the way to further ones.
pub(crate) struct Compiler<'e> {
    library: Library,
    environment: &'e Environment<'e>,
    loaded: HashSet<String>,
}

/// Expressions of one modifier with what they are evaluated in.
#[derive(Debug)]
pub(crate) struct Functions {
    pub(crate) programs: Box<[Program]>,
    /// Inputs that any of them reads.
    pub(crate) channels: ChannelSet,
    /// Carries the function's coordinates into the scene.
    pub(crate) placement: Transform,
    /// Real arguments.
    pub(crate) reals: Box<[f64]>,
}

impl<'e> Compiler<'e> {
    /// A compiler that knows the prelude and the command line's definitions. A `rayinit.cal` on the search path takes
    /// the place of the built-in prelude.
    pub(crate) fn new(environment: &'e Environment<'e>) -> Result<Self, Error> {
        let bad = |e: ambit_cal::CompileError| Error::user(e.to_string());
        let library = match (environment.find)(PRELUDE) {
            Some(path) => {
                let mut library = Library::new(Host::Renderer);
                let text = read(&path, PRELUDE)?;
                library.load_global(&path.to_string_lossy(), &text).map_err(bad)?;
                library
            }
            None => Library::renderer().map_err(bad)?,
        };
        let mut compiler = Self { library, environment, loaded: HashSet::new() };
        for definition in environment.definitions {
            match definition {
                Definition::Text(text) => compiler.library.define(text).map_err(bad)?,
                Definition::File(name) => {
                    let path = (environment.find)(name).ok_or_else(|| {
                        Error::system(format!("cannot find function file \"{name}\": No such file or directory"))
                    })?;
                    let text = read(&path, name)?;
                    compiler.library.load_global(&path.to_string_lossy(), &text).map_err(bad)?;
                }
            }
        }
        Ok(compiler)
    }

    pub(crate) fn warn(&self, text: &str) {
        self.environment.notify.warn(text);
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
        let string = |i: usize| {
            scene.string(id, i).map(Cow::into_owned).ok_or_else(|| Error::primitive(scene, id, "bad # arguments"))
        };
        let context = self.context(scene, id, &string(file)?)?;
        let owner = scene.describe(id);
        let mut programs = Vec::with_capacity(expressions.len());
        let mut channels = ChannelSet::default();
        for &i in expressions {
            let program = self
                .library
                .compile(&string(i)?, &context, &owner)
                .map_err(|e| Error::primitive(scene, id, &e.to_string()))?;
            channels = channels.union(program.channels());
            programs.push(program);
        }
        Ok(Functions {
            programs: programs.into(),
            channels,
            placement: trailing_transform(scene, id, file + 1)?,
            reals: scene.reals(id).into(),
        })
    }

    /// The context of a function file, which is loaded unless that has happened; `.` is none.
    pub(crate) fn context(&mut self, scene: &Scene, id: ObjectId, file: &str) -> Result<Context, Error> {
        if file == "." {
            return Ok(Context::GLOBAL);
        }
        let context = Context::of_file(file);
        if self.loaded.insert(context.as_str().to_owned()) {
            let (shown, text): (String, Cow<'static, [u8]>) = match (self.environment.find)(file) {
                Some(path) => {
                    let shown = path.to_string_lossy().into_owned();
                    let text = read(&path, file)?;
                    (shown, text.into())
                }
                None => match ambit_cal::embedded(file) {
                    Some(text) => (file.to_owned(), text.as_bytes().into()),
                    None => return Err(Error::missing_file(scene, id, "function file", file)),
                },
            };
            self.library.load_file(file, &shown, &text).map_err(|e| Error::primitive(scene, id, &e.to_string()))?;
        }
        Ok(context)
    }
}

fn read(path: &Path, name: &str) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|e| Error::system(format!("cannot open function file \"{name}\": {e}")))
}

/// The transform in a modifier's trailing strings: what comes before the first transform option is ignored, from
/// there on everything must parse.
pub(crate) fn trailing_transform(scene: &Scene, id: ObjectId, first: usize) -> Result<Transform, Error> {
    const OPTIONS: [&str; 9] = ["-t", "-s", "-i", "-rx", "-ry", "-rz", "-mx", "-my", "-mz"];
    let words: Vec<Cow<'_, str>> = scene.strings(id).skip(first).skip_while(|w| !OPTIONS.contains(&&**w)).collect();
    Transform::parse(&words).map_err(|_| Error::primitive(scene, id, "bad transform"))
}
