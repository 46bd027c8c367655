//! oconv: scene files to an octree on standard output.

use ambit_base::{DVec3, Location, Notify, Stderr};
use ambit_file::{Header, command_line};
use ambit_octree::{Cube, Error, Find, Geometry, Limits, Objects, Tree};
use ambit_scene::{ErrorClass, Reader, Scene, Shell};
use std::fmt::Display;
use std::io::{BufWriter, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HELP: &str = "\
Usage: oconv [OPTION]... [-] [FILE]... > OCTREE

Compiles scene descriptions into an octree. A FILE may be a '!command'.

  -i OCTREE                start from this octree (or '!command') and add to it
  -b XMIN YMIN ZMIN SIZE   the cube that encloses everything; the default fits the scene
  -n N                     divide cubes with more than N surfaces (6)
  -r N                     divide no cubes smaller than 1/N of the whole (16384)
  -f                       freeze: store the scene itself instead of the names of its files
  -w                       print no warnings
  -                        read a scene from standard input at this place; freezes
  --help                   print this text
  --version                print the version

Options come before the first FILE; only their first letter counts. Library files
of instances and meshes are searched for along RAYPATH.
";

/// More scene files than this can not be listed in an octree.
const MOST_FILES: usize = 255;

/// Bytes that are written at once.
const BUFFER: usize = 1 << 20;

fn main() -> ExitCode {
    let mut words = std::env::args_os().map(|w| w.to_string_lossy().into_owned());
    let program = words.next().unwrap_or_default();
    let arguments: Vec<String> = words.collect();
    let program = program.rsplit('/').next().unwrap_or_default().to_owned();
    match run(&program, &arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let (word, status) = match failure.class {
                ErrorClass::User => ("fatal", 1),
                ErrorClass::System => ("system", 2),
                ErrorClass::Internal => ("internal", 3),
            };
            eprintln!("{program}: {word} - {}", failure.text);
            if let Some(place) = failure.place.filter(|p| p.line > 0) {
                eprintln!("{program}: at {place}");
            }
            ExitCode::from(status)
        }
    }
}

/// Why the program ends early.
struct Failure {
    class: ErrorClass,
    text: String,
    place: Option<Location>,
}

impl Failure {
    fn fatal(text: impl Display) -> Self {
        Self { class: ErrorClass::User, text: text.to_string(), place: None }
    }
}

impl From<Error> for Failure {
    fn from(e: Error) -> Self {
        let place = if let Error::Scene(e) = &e { Some(e.location().clone()) } else { None };
        Self { class: e.class(), text: e.to_string(), place }
    }
}

impl From<ambit_scene::Error> for Failure {
    fn from(e: ambit_scene::Error) -> Self {
        Error::from(e).into()
    }
}

/// What the arguments ask for.
#[derive(Default)]
struct Request {
    input: Option<String>,
    cube: Option<Cube>,
    limits: Limits,
    frozen: bool,
    quiet: bool,
    /// Names in order; `-` is standard input.
    files: Vec<String>,
}

enum Asked {
    Octree(Request),
    Text(String),
}

fn parse(arguments: &[String]) -> Result<Asked, Failure> {
    let mut request = Request::default();
    let mut words = arguments.iter();
    while let Some(word) = words.clone().next() {
        let mut letters = word.bytes();
        if letters.next() != Some(b'-') || word == "-" {
            break;
        }
        words.next();
        let mut value = || words.next().ok_or_else(|| Failure::fatal(format!("missing value for option '{word}'")));
        match word.as_str() {
            "--help" => return Ok(Asked::Text(HELP.to_owned())),
            "--version" => return Ok(Asked::Text(format!("oconv (Ambit) {}\n", env!("CARGO_PKG_VERSION")))),
            _ => {}
        }
        match letters.next() {
            Some(b'i') => {
                if request.cube.is_some() {
                    return Err(Failure::fatal("only one of '-b' or '-i'"));
                }
                request.input = Some(value()?.clone());
            }
            Some(b'b') => {
                if request.input.is_some() {
                    return Err(Failure::fatal("only one of '-b' or '-i'"));
                }
                let mut next = || number(word, value()?);
                let corner = DVec3::new(next()?, next()?, next()?);
                request.cube = Some(Cube::given(corner, next()?));
            }
            Some(b'n') => request.limits.objects = number(word, value()?)? as i64,
            Some(b'r') => request.limits.resolution = number(word, value()?)? as i64,
            Some(b'f') => request.frozen = true,
            Some(b'w') => request.quiet = true,
            _ => return Err(Failure::fatal(format!("unknown option: '{word}'"))),
        }
    }
    request.files = words.cloned().collect();
    Ok(Asked::Octree(request))
}

fn number(option: &str, word: &str) -> Result<f64, Failure> {
    let bad = || Failure::fatal(format!("bad value '{word}' for option '{option}': expected a number"));
    word.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(bad)
}

fn run(program: &str, arguments: &[String]) -> Result<(), Failure> {
    let request = match parse(arguments)? {
        Asked::Octree(request) => request,
        Asked::Text(text) => {
            print!("{text}");
            return Ok(());
        }
    };
    let notify = Stderr { program: program.to_owned(), warnings: !request.quiet };
    let search = std::env::var("RAYPATH").ok();
    let home = std::env::var("HOME").ok();
    let find = |name: &str| find_library_file(name, search.as_deref(), home.as_deref());
    let mut header = Header::empty();
    let octree = convert(&request, &mut header, &find, &notify)?;
    header.push(command_line(program.as_bytes(), arguments));
    let frozen = octree.frozen;
    let objects = if frozen {
        Objects::Frozen(&octree.scene)
    } else {
        Objects::InFiles { names: &octree.names, count: octree.scene.len() }
    };
    let mut out = BufWriter::with_capacity(BUFFER, stdout().lock());
    Ok(ambit_octree::write(&mut out, &header, &octree.cube, objects, &octree.tree)?)
}

/// Everything that goes into the file but its header.
struct Octree {
    scene: Scene,
    names: Vec<String>,
    frozen: bool,
    cube: Cube,
    tree: Tree,
}

fn convert(request: &Request, header: &mut Header, find: &Find<'_>, notify: &dyn Notify) -> Result<Octree, Failure> {
    let mut scene = Scene::new();
    let mut names = Vec::new();
    let mut frozen = request.frozen;
    let mut start = None;
    if let Some(name) = &request.input {
        let bytes = ambit_octree::open(name, &mut Shell, notify)?;
        let (loaded, tree) = ambit_octree::read_octree(&bytes, name, &mut scene, &mut Shell, notify)?;
        header.extend(loaded.header.lines_without_format());
        if loaded.frozen && !frozen && !request.files.iter().any(|f| f == "-") {
            notify.warn("frozen octree");
        }
        frozen |= loaded.frozen;
        names.extend(loaded.scene_files);
        start = Some((loaded.cube, tree));
    } else {
        header.push("#?RADIANCE");
    }
    let first = scene.ids().end;
    let mut shell = Shell;
    let mut reader = Reader::new(&mut scene, notify, &mut shell);
    for name in &request.files {
        if name == "-" {
            frozen = true;
            reader.read_stream("standard input", std::io::stdin().lock())?;
            continue;
        }
        if names.len() >= MOST_FILES && !frozen {
            return Err(Failure { class: ErrorClass::Internal, text: "too many scene files".to_owned(), place: None });
        }
        names.push(name.clone());
        reader.read(name)?;
    }
    let objects = first..scene.ids().end;
    let geometry = ambit_octree::prepare(&mut scene, objects, find, notify)?;
    let (cube, tree) = plant(request, &scene, &geometry, start, find)?;
    Ok(Octree { scene, names, frozen, cube, tree })
}

/// The cube and its tree.
fn plant(
    request: &Request,
    scene: &Scene,
    geometry: &Geometry,
    start: Option<(Cube, Tree)>,
    find: &Find<'_>,
) -> Result<(Cube, Tree), Error> {
    let cube = match (start.as_ref().map(|s| s.0), request.cube) {
        (Some(cube), _) | (None, Some(cube)) => {
            if geometry.bounds().is_some_and(|b| !cube.encloses(&b)) {
                return Err(Error::Outside);
            }
            cube
        }
        (None, None) => Cube::around(geometry.bounds()),
    };
    let tree = match start {
        Some((_, tree)) => {
            let present = ambit_octree::prepare_present(scene, 0..geometry.first(), find)?;
            ambit_octree::extend(scene, geometry, cube, request.limits, &tree, &present)?
        }
        None => ambit_octree::build(scene, geometry, cube, request.limits)?,
    };
    Ok((cube, tree))
}

/// A library file by its name: absolute, relative to the working directory (leading `.`), to a home directory (leading
/// `~`), or in the first folder of the search path that has it.
fn find_library_file(name: &str, search: Option<&str>, home: Option<&str>) -> Option<PathBuf> {
    let readable = |path: PathBuf| std::fs::File::open(&path).is_ok().then_some(path);
    if name.starts_with(['/', '.']) {
        return readable(PathBuf::from(name));
    }
    if let Some(rest) = name.strip_prefix("~/") {
        return readable(Path::new(home?).join(rest));
    }
    let search = search.unwrap_or(":");
    let folders = search.strip_suffix(':').unwrap_or(search);
    folders.split(':').find_map(|folder| {
        let path = if folder.is_empty() { PathBuf::from(name) } else { PathBuf::from(format!("{folder}/{name}")) };
        readable(path)
    })
}
