//! obj2mesh: Wavefront OBJ files to compiled meshes.

use ambit_base::Notify;
use ambit_cli::{Class, ConsoleMessages, Failure, VERSION};
use ambit_file::{Header, bytes_of, command_line, os_text, path_of};
use ambit_octree::{Error, Limits, MESH_LIMITS, compile_mesh};
use ambit_scene::{Commands, ErrorClass, Reader, Scene};
use std::fs::File;
use std::io::{BufWriter, Read, Write, stdin};
use std::process::ExitCode;

const HELP: &str = "\
Usage: obj2mesh [OPTION]... [INPUT [OUTPUT]]

Compiles a Wavefront OBJ file to a triangle mesh, for scenes to place by the
primitive `mesh`. Without INPUT and OUTPUT: standard input and output.

  -a FILE     read materials that faces may name by `usemtl` (or `g`); may be repeated
  -l FILE     the same
  -n N        divide cubes with more than N triangles (9)
  -r N        divide no cubes smaller than 1/N of the whole (16384)
  -v          tell what is in the mesh
  -w          print no warnings
  --help      print this text
  --version   print the version

Faces of more than three corners become triangles. Normals and texture
coordinates are kept where all corners of a triangle have them.
";

fn main() -> ExitCode {
    let mut words = std::env::args_os().map(|w| ambit_file::word_of(&w));
    let program = words.next().unwrap_or_default();
    let program = program.rsplit('/').next().unwrap_or_default().to_owned();
    let arguments: Vec<String> = words.collect();
    match run(&program, &arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            ConsoleMessages { program, warnings: true }.fail(&failure);
            ExitCode::from(failure.class.status())
        }
    }
}

struct Request {
    materials: Vec<String>,
    limits: Limits,
    verbose: bool,
    quiet: bool,
    input: Option<String>,
    output: Option<String>,
    /// Arguments that the header tells: all but the output.
    told: usize,
}

enum Asked {
    Mesh(Request),
    Text(String),
}

fn parse(arguments: &[String]) -> Result<Asked, Failure> {
    let mut request = Request {
        materials: Vec::new(),
        limits: MESH_LIMITS,
        verbose: false,
        quiet: false,
        input: None,
        output: None,
        told: arguments.len(),
    };
    let mut words = arguments.iter().enumerate();
    while let Some((at, word)) = words.next() {
        let mut value = || {
            let missing = || Failure::user(format!("option '{word}' needs a value"));
            words.next().map(|(_, w)| w.clone()).ok_or_else(missing)
        };
        match word.as_str() {
            "--help" => return Ok(Asked::Text(HELP.to_owned())),
            "--version" => return Ok(Asked::Text(format!("obj2mesh (Ambit) {VERSION}\n"))),
            "-a" | "-l" => request.materials.push(value()?),
            "-n" => request.limits.objects = number(word, &value()?)?,
            "-r" => request.limits.resolution = number(word, &value()?)?.max(1),
            "-v" => request.verbose = true,
            "-w" => request.quiet = true,
            _ if word.starts_with('-') => {
                return Err(Failure::user(format!("unknown option: '{word}'")).hint("--help lists the options"));
            }
            _ if request.input.is_none() => request.input = Some(word.clone()),
            _ if request.output.is_none() => (request.output, request.told) = (Some(word.clone()), at),
            _ => return Err(Failure::user("too many file arguments")),
        }
    }
    Ok(Asked::Mesh(request))
}

fn number(option: &str, word: &str) -> Result<i64, Failure> {
    let bad = || Failure::user(format!("bad value '{word}' for option '{option}': expected an integer"));
    word.parse().map_err(|_| bad())
}

fn run(program: &str, arguments: &[String]) -> Result<(), Failure> {
    let request = match parse(arguments)? {
        Asked::Mesh(request) => request,
        Asked::Text(text) => {
            ambit_cli::answer(text.as_bytes());
            return Ok(());
        }
    };
    let notify = ConsoleMessages { program: program.to_owned(), warnings: !request.quiet };
    let materials = materials(&request, &notify)?;
    let mut text = Vec::new();
    let name = request.input.clone().unwrap_or_else(|| "standard input".to_owned());
    match &request.input {
        Some(file) => {
            text = std::fs::read(path_of(file)).map_err(|_| Failure::user(format!("cannot open \"{file}\"")))?;
        }
        None => {
            stdin().lock().read_to_end(&mut text).map_err(|e| Failure::system("cannot read standard input", &e))?;
        }
    }
    let mesh = compile_mesh(&text, &name, materials, request.limits, &notify).map_err(|e| failure(&e))?;
    if request.verbose {
        let _ = write!(std::io::stderr(), "{mesh}");
    }
    let mut header = Header::empty();
    header.push("#?RADIANCE");
    header.push(command_line(&bytes_of(program), arguments[..request.told].iter().map(|word| bytes_of(word))));
    match &request.output {
        Some(file) => {
            let file = File::create(path_of(file)).map_err(|e| Failure::system("cannot open output file", &e))?;
            mesh.write(&mut BufWriter::new(file), &header)
        }
        None => mesh.write(&mut BufWriter::new(ambit_cli::StandardOutput::ending()), &header),
    }
    .map_err(|e| failure(&e))
}

fn materials(request: &Request, notify: &dyn Notify) -> Result<Scene, Failure> {
    let mut scene = Scene::new();
    let search = ambit_tools::search_path();
    let mut commands = Commands::new(&search);
    let mut reader = Reader::new(&mut scene, notify, &mut commands);
    request.materials.iter().try_for_each(|file| reader.read(file)).map_err(|e| failure(&e.into()))?;
    Ok(scene)
}

fn failure(e: &Error) -> Failure {
    let class = match e.class() {
        ErrorClass::User => Class::User,
        ErrorClass::System => Class::System,
        ErrorClass::Internal => Class::Internal,
    };
    let text = match e {
        // As Radiance says it of meshes.
        Error::Write(e) => format!("output error in writescene: {}", os_text(e)),
        _ => e.to_string(),
    };
    Failure::new(class, text)
}
