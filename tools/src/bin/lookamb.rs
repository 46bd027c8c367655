//! Prints an ambient file as text, or turns such text back into an ambient file.

use ambit_ambient::{Components, FORMAT, Layout, Record, TextForm, scan_header};
use ambit_base::{DVec3, Rgb};
use ambit_cli::{StandardOutput, VERSION, answer, say};
use ambit_file::{Header, command_line, word_of};
use ambit_render::Spectrum;
use std::env::args_os;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::os::unix::ffi::OsStrExt;
use std::process::ExitCode;

const HELP: &str = "\
Usage: lookamb [-d] [-h] [-r] [FILE]

Prints the irradiance records of an ambient file as text, or turns such text back
into an ambient file. Without FILE: standard input.

  -d         a line of numbers for each record: position, normal, first axis, level,
             weight, two radii, red, green and blue, gradients of position and of
             direction, directions left out (corral); without it, labelled lines
  -h         no header
  -r         the reverse: text (labelled, or with -d lines of numbers; with -h without
             a header) becomes an ambient file. Text does not hold what the last bounces
             brought: such values count as Radiance's do (--bounces mixed)
  --help     print this text
  --version  print the version
";

/// What the arguments ask for.
#[derive(Clone, Copy, Debug)]
struct Options {
    form: TextForm,
    header: bool,
    reverse: bool,
}

fn main() -> ExitCode {
    match run(&args_os().collect::<Vec<_>>()) {
        Err(failure) => {
            say(failure);
            ExitCode::FAILURE
        }
        Ok(()) => ExitCode::SUCCESS,
    }
}

/// What may go wrong, in Radiance's words.
#[derive(Debug)]
enum Failure {
    Option(String),
    Missing(String),
    Input(io::Error),
    Format(String),
    Output(io::Error),
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Option(word) => write!(f, "lookamb: unknown option '{word}'"),
            Self::Missing(file) => write!(f, "{file}: file not found"),
            Self::Input(e) => write!(f, "lookamb: cannot read input: {e}"),
            Self::Format(problem) => write!(f, "lookamb: format error on input: {problem}"),
            Self::Output(e) => write!(f, "lookamb: cannot write output: {}", ambit_file::os_text(e)),
        }
    }
}

fn run(words: &[OsString]) -> Result<(), Failure> {
    let mut options = Options { form: TextForm::Labelled, header: true, reverse: false };
    let mut words_left = words.iter().skip(1);
    let mut file = None;
    for word in words_left.by_ref() {
        match word.as_bytes() {
            b"--help" => {
                answer(HELP.as_bytes());
                return Ok(());
            }
            b"--version" => {
                answer(format!("{VERSION}\n").as_bytes());
                return Ok(());
            }
            [b'-', b'd', ..] => options.form = TextForm::Tabular,
            [b'-', b'h', ..] => options.header = false,
            [b'-', b'r', ..] => options.reverse = true,
            [b'-', ..] => return Err(Failure::Option(word_of(word))),
            _ => {
                file = Some(word);
                break;
            }
        }
    }
    let mut bytes = Vec::new();
    let name = if let Some(path) = file {
        let name = word_of(path);
        let mut file = File::open(path).map_err(|_| Failure::Missing(name.clone()))?;
        file.read_to_end(&mut bytes).map_err(Failure::Input)?;
        name
    } else {
        io::stdin().lock().read_to_end(&mut bytes).map_err(Failure::Input)?;
        "standard input".to_owned()
    };
    let mut out = BufWriter::new(StandardOutput::ending());
    if options.reverse {
        let line = command_line(b"lookamb", words.iter().skip(1).map(|w| w.as_bytes()));
        to_binary(&bytes, &name, options, &line, &mut out)?;
    } else {
        to_text(&bytes, &name, options, &mut out)?;
    }
    out.flush().map_err(Failure::Output)
}

/// The lines of a header that text and binary share.
fn kept(header: &Header) -> Header {
    let mut out = Header::empty();
    let dropped = [&b"NCOMP="[..], b"WAVELENGTH_SPLITS="];
    out.extend(header.lines_without_format().filter(|l| !dropped.iter().any(|d| l.starts_with(d))));
    out
}

/// Whether the records of the file that the text was made of told what the last bounces brought, which text leaves out.
fn tells_bounces(header: &Header) -> bool {
    let has = |word: &str| header.values("AMBIT_OPTIONS").any(|v| v.split(' ').any(|w| w == word));
    has("bounces=apart") && !has("ab=1")
}

fn to_text(bytes: &[u8], name: &str, options: Options, out: &mut impl Write) -> Result<(), Failure> {
    let (header, layout, start) = scan_header(bytes, name).map_err(Failure::Format)?;
    if options.header {
        let mut lines = kept(&header);
        lines.push("FORMAT=ascii");
        lines.write(out).map_err(Failure::Output)?;
    }
    // As in Radiance the listing ends at the first record that makes no sense.
    let components = Components::in_order(header.components() as usize);
    let colours = Colours::new(&header);
    let records = bytes[start..].chunks_exact(layout.record_bytes(&components));
    for mut record in records.map(|r| layout.decode(r, &components)).take_while(Record::is_plausible) {
        if let Some(colours) = &colours {
            record.value = colours.of(components.of(&record));
        }
        out.write_all(options.form.write(&record).as_bytes()).map_err(Failure::Output)?;
    }
    Ok(())
}

/// Colours of spectra.
struct Colours(Vec<DVec3>);

impl Colours {
    /// None for a file in red, green and blue, or whose wavelengths make no sense.
    fn new(header: &Header) -> Option<Self> {
        let [longest, .., shortest] = header.wavelength_splits().unwrap_or(Spectrum::default().limits());
        let spectrum = Spectrum::new(header.components() as i32, shortest, longest).filter(|s| !s.is_rgb())?;
        Some(Self(spectrum.tristimulus()))
    }

    fn of(&self, bins: impl Iterator<Item = f32>) -> Rgb {
        Spectrum::rgb(self.0.iter().zip(bins).map(|(&xyz, bin)| xyz * f64::from(bin)).sum()).as_vec3()
    }
}

fn to_binary(bytes: &[u8], name: &str, options: Options, line: &[u8], out: &mut impl Write) -> Result<(), Failure> {
    let (mut header, start) = if options.header {
        let (header, start) = Header::parse(bytes, name).map_err(|e| Failure::Format(e.problem()))?;
        if let Some(format) = header.format()
            && format != "ascii"
        {
            return Err(Failure::Format(format!("FORMAT={format} (expected ascii)")));
        }
        if tells_bounces(&header) {
            say(
                "lookamb: warning - text does not hold what the last bounces brought: values count as with --bounces mixed",
            );
        }
        (kept(&header), start)
    } else {
        let mut header = Header::new();
        header.push(line);
        (header, 0)
    };
    header.push("NCOMP=3");
    header.push(format!("FORMAT={FORMAT}"));
    header.write(out).map_err(Failure::Output)?;
    out.write_all(&Layout::CURRENT.magic().to_be_bytes()).map_err(Failure::Output)?;
    let text = String::from_utf8_lossy(&bytes[start..]);
    let mut words = text.split_ascii_whitespace();
    while let Some(record) = options.form.read(&mut words) {
        match record {
            Ok(record) => {
                out.write_all(&Layout::CURRENT.encode(&record, &Components::default())).map_err(Failure::Output)?;
            }
            Err(problem) => {
                // Radiance stops here without a word.
                say(format_args!("lookamb: warning - stopped at {problem}"));
                break;
            }
        }
    }
    Ok(())
}
