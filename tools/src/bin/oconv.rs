//! oconv: scene files to an octree on standard output.

use ambit_base::{DVec3, Location, Notify};
use ambit_cli::{Class, ConsoleMessages, Failure, StandardOutput, VERSION, answer};
use ambit_file::{Header, bytes_of, command_line, path_of, word_of};
use ambit_octree::{Cube, Error, Find, Limits, Objects, Prepared, Source, Tree};
use ambit_scene::{Commands, ErrorClass, Reader, Scene};
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter};
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
    let mut words = std::env::args_os().map(|w| word_of(&w));
    let program = words.next().unwrap_or_default();
    let arguments: Vec<String> = words.collect();
    let program = program.rsplit('/').next().unwrap_or_default();
    match run(program, &arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(stop) => {
            let messages = ConsoleMessages { program: program.to_owned(), warnings: true };
            messages.fail(&stop.failure);
            if let Some(place) = stop.place.filter(|p| p.line > 0) {
                messages.print(format_args!("at {place}"));
                if let Some(format) = format_of(&place.file) {
                    messages.print(format_args!("this is a file of FORMAT={format}, not a scene{}", remedy(&format)));
                }
            }
            ExitCode::from(stop.failure.class.status())
        }
    }
}

/// What the header of a file says that it is; none for scenes, which have no header.
fn format_of(file: &str) -> Option<String> {
    let path = path_of(file);
    // A pipe has been read already.
    if !path.is_file() {
        return None;
    }
    let mut input = BufReader::new(File::open(path).ok()?);
    if !input.fill_buf().ok()?.starts_with(b"#?") {
        return None;
    }
    Header::read(&mut input, file).ok()?.format().map(str::to_owned)
}

/// How a scene takes a file of this format in.
fn remedy(format: &str) -> &'static str {
    match format {
        "Radiance_octree" => "; -i adds to an octree, and the primitive instance places one",
        "Radiance_tmesh" => "; the primitive mesh places one",
        _ => "",
    }
}

/// Why the program ends early.
struct Stop {
    failure: Failure,
    /// Where in the scene files the reason is.
    place: Option<Location>,
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self { failure, place: None }
    }
}

impl From<Error> for Stop {
    fn from(e: Error) -> Self {
        let place = if let Error::Scene(e) = &e { Some(e.location().clone()) } else { None };
        let class = match e.class() {
            ErrorClass::User => Class::User,
            ErrorClass::System => Class::System,
            ErrorClass::Internal => Class::Internal,
        };
        Self { failure: Failure::new(class, e.to_string()), place }
    }
}

impl From<ambit_scene::Error> for Stop {
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
        let mut value = || words.next().ok_or_else(|| Failure::user(format!("missing value for option '{word}'")));
        match word.as_str() {
            "--help" => return Ok(Asked::Text(HELP.to_owned())),
            "--version" => return Ok(Asked::Text(format!("{VERSION}\n"))),
            _ => {}
        }
        match letters.next() {
            Some(b'i') => {
                if request.cube.is_some() {
                    return Err(Failure::user("only one of '-b' or '-i'"));
                }
                request.input = Some(value()?.clone());
            }
            Some(b'b') => {
                if request.input.is_some() {
                    return Err(Failure::user("only one of '-b' or '-i'"));
                }
                let mut next = || number(word, value()?);
                let corner = DVec3::new(next()?, next()?, next()?);
                request.cube = Some(Cube::given(corner, next()?));
            }
            Some(b'n') => request.limits.objects = number(word, value()?)? as i64,
            Some(b'r') => request.limits.resolution = number(word, value()?)? as i64,
            Some(b'f') => request.frozen = true,
            Some(b'w') => request.quiet = true,
            _ => {
                return Err(Failure::user(format!("unknown option: '{word}'")).hint("--help lists the options"));
            }
        }
    }
    request.files = words.cloned().collect();
    Ok(Asked::Octree(request))
}

fn number(option: &str, word: &str) -> Result<f64, Failure> {
    let bad = || Failure::user(format!("bad value '{word}' for option '{option}': expected a number"));
    word.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(bad)
}

fn run(program: &str, arguments: &[String]) -> Result<(), Stop> {
    let request = match parse(arguments)? {
        Asked::Octree(request) => request,
        Asked::Text(text) => {
            answer(text.as_bytes());
            return Ok(());
        }
    };
    let notify = ConsoleMessages { program: program.to_owned(), warnings: !request.quiet };
    let search = ambit_tools::search_path();
    let find = |name: &str| search.find_path(name);
    let mut header = Header::empty();
    let octree = convert(&request, &mut header, &find, Commands::new(&search), &notify)?;
    header.push(command_line(&bytes_of(program), arguments.iter().map(|w| bytes_of(w))));
    let frozen = octree.frozen;
    let objects = if frozen {
        Objects::Frozen(&octree.scene)
    } else {
        Objects::InFiles { names: &octree.names, count: octree.scene.len() }
    };
    let mut out = BufWriter::with_capacity(BUFFER, StandardOutput::ending());
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

fn convert(
    request: &Request,
    header: &mut Header,
    find: &Find<'_>,
    mut commands: Commands<'_>,
    notify: &dyn Notify,
) -> Result<Octree, Stop> {
    let mut scene = Scene::new();
    let mut names = Vec::new();
    let mut frozen = request.frozen;
    let mut start = None;
    if let Some(name) = &request.input {
        let source = Source::open(name, &mut commands)?;
        let (loaded, tree) = ambit_octree::read_octree(&source.bytes, name, &mut scene, &mut commands, notify)?;
        source.complain(notify);
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
    let mut reader = Reader::new(&mut scene, notify, &mut commands);
    for name in &request.files {
        if name == "-" {
            frozen = true;
            reader.read_stream("standard input", std::io::stdin().lock())?;
            continue;
        }
        if names.len() >= MOST_FILES && !frozen {
            return Err(Failure::internal("too many scene files").into());
        }
        names.push(name.clone());
        reader.read(name)?;
    }
    let objects = first..scene.ids().end;
    let prepared = ambit_octree::prepare(&mut scene, objects, find, notify)?;
    let (cube, tree) = plant(request, &mut scene, &prepared, start, find, notify)?;
    Ok(Octree { scene, names, frozen, cube, tree })
}

/// The cube and its tree.
fn plant(
    request: &Request,
    scene: &mut Scene,
    prepared: &Prepared,
    start: Option<(Cube, Tree)>,
    find: &Find<'_>,
    notify: &dyn Notify,
) -> Result<(Cube, Tree), Error> {
    let geometry = &prepared.geometry;
    // The cube of an octree without surfaces has no size and fits nothing.
    let given = start.as_ref().map(|s| s.0).filter(|c| c.edge > 0.0).or(request.cube);
    if given.is_some_and(|cube| geometry.bounds().is_some_and(|b| !cube.encloses(&b))) {
        return Err(Error::Outside);
    }
    for text in &prepared.warnings {
        notify.warn(text);
    }
    let cube = given.unwrap_or_else(|| Cube::around(geometry.bounds()));
    let Some((_, tree)) = start else {
        return Ok((cube, ambit_octree::build(scene, geometry, cube, request.limits)?));
    };
    let present = ambit_octree::prepare_present(scene, 0..geometry.first(), find)?;
    let extended = ambit_octree::extend(scene, geometry, cube, request.limits, &tree, &present)?;
    // Objects that were tested are frozen as put right, the others as they were.
    for id in extended.moved {
        for warning in scene.clean(id)? {
            notify.warn(&warning.text);
        }
    }
    Ok((cube, extended.tree))
}
