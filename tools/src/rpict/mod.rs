//! rpict: views to pictures.

mod frame;
mod header;
mod output;
mod pilot;
mod recover;
mod sequence;
mod shots;
mod watch;

use crate::colour::Conversion;
use crate::light::{Scene, octree};
use crate::session::{Session, Stop, Tool, split};
use crate::threads::{on_deep_stack, processors, start_threads};
use ambit_base::Notify;
use ambit_cli::{About, COMMON_FEATURES, Failure, Features, Output, PICTURE_FEATURES, PictureOptions, picture_table};
use ambit_file::PixelSpace;
use ambit_octree::Source;
use frame::{Frame, Picture};
use std::ffi::OsString;
use std::io::{Read, stdin};
use std::process::ExitCode;

const ABOUT: About = About {
    name: "rpict",
    summary: "Renders a view of a scene to a Radiance picture on standard output.",
    synopsis: "[options] [$NAME] [@FILE] [OCTREE] > PICTURE",
    notes: "Without OCTREE, the octree is read from standard input. OCTREE may be a '!command'.",
};

/// Greatest sample spacing.
const GREATEST_SPACING: i32 = 16;

/// Runs the program.
pub fn main(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let (program, words) = split(arguments);
    on_deep_stack(&program.clone(), move || work(program, words))
}

fn work(program: String, words: Vec<String>) -> ExitCode {
    let mut session = Session::new(program, true);
    let result = run(&mut session, words);
    // Radiance reports after every message, and has none where it ends without a word.
    let failed = match &result {
        Err(Stop::Failure(failure)) => !failure.text.is_empty(),
        other => other.is_err(),
    };
    let status = session.end(result);
    if failed {
        session.meter.report();
    }
    status
}

fn run(session: &mut Session, words: Vec<String>) -> Result<(), Stop> {
    let tool = Tool { about: ABOUT, features: Features(&[COMMON_FEATURES, PICTURE_FEATURES]), table: picture_table() };
    let processors = processors();
    let mut options = PictureOptions::new(processors.as_ref().map_or(1, |&n| n));
    if !session.read(words, &tool, &mut options)? {
        return Ok(());
    }
    if options.common.threads == 0 {
        processors?;
    }
    options.rendering.check()?;
    let spectrum = &options.rendering.options.spectrum;
    if !spectrum.shows_colour() {
        return Err(Failure::user("unsupported spectral sampling").into());
    }
    if options.sequence > 0 || options.recover.is_none() {
        // A recovered picture brings its own view; in a sequence each line changes this one.
        options.view.set_up().map_err(|e| Failure::user(e.to_string()))?;
    }
    session.attach(&options.common)?;
    // Reports end with what can be counted at no great cost, where there is a cache.
    options.rendering.counts = options.report > 0 && options.rendering.options.ambient.asks();
    if options.spacing > GREATEST_SPACING {
        let text = format!("pixel sampling reduced from {} to {GREATEST_SPACING}", options.spacing);
        session.messages.warn(&text);
    }
    options.spacing = options.spacing.clamp(1, GREATEST_SPACING);
    if options.rendering.goal.is_some() && !session.flags.contains(&"ps") {
        // What lies between pixels that are traced cannot be told from a part of them.
        options.spacing = 1;
    }
    if options.common.persist.is_some() {
        if options.sequence <= 0 {
            return Err(Failure::user("persist option only for sequences").into());
        }
        if options.recover.is_some() {
            return Err(Failure::user("persist option used with recover file").into());
        }
    }
    session.refuse_attachment(&options.common)?;
    if options.sequence > 0 {
        if session.octree.is_none() {
            return Err(Failure::user("missing octree argument").into());
        }
        sequence::check(&options)?;
    }
    start_threads(options.common.threads())?;
    let source = source(session)?;
    let name = source.name.clone();
    let mut scene = Scene::open(session, source, &options.rendering, false, options.common.output)?;
    if let Some(error) = options.rendering.goal {
        options.rendering.options = pilot::choose(session, &options, space(&options), &mut scene, error)?;
    }
    scene.begin(&name, &options.rendering)?;
    let result = render(session, &options, &mut scene);
    // The ambient file is closed whatever happened; the first error counts.
    result.and(scene.close())
}

fn source(session: &Session) -> Result<Source, Stop> {
    if let Some(name) = &session.octree {
        return octree(name, session);
    }
    let mut bytes = Vec::new();
    stdin().lock().read_to_end(&mut bytes).map_err(|e| Failure::system("cannot read standard input", &e))?;
    Ok(Source { name: "standard input".to_owned(), bytes, failed: false })
}

/// The space of the pixels that are written.
fn space(options: &PictureOptions) -> PixelSpace {
    if options.common.output == Output::Xyz { PixelSpace::Xyz } else { PixelSpace::Rgb }
}

fn render(session: &Session, options: &PictureOptions, scene: &mut Scene<'_>) -> Result<(), Stop> {
    let space = space(options);
    // Spectra come converted.
    let by_wavelength = !options.rendering.options.spectrum.is_rgb();
    let conversion = if by_wavelength { Conversion::Same } else { Conversion::new(options.common.output, true) };
    let picture = Picture { session, options, conversion, space };
    if options.sequence > 0 {
        return sequence::run(&picture, scene, stdin().lock());
    }
    let frame = Frame::single(&picture)?;
    picture.make(&frame, scene).map(|_| ())
}
