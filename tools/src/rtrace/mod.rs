//! rtrace: rays in, records out.

mod header;
mod input;
mod pilot;
mod record;
mod stream;
mod tree;

use crate::light::{self, Scene};
use crate::session::{Session, Stop, Tool, split};
use crate::spectral::Converter;
use crate::threads::{on_deep_stack, processors, start_threads};
use ambit_base::Notify;
use ambit_cli::{
    About, COMMON_FEATURES, Failure, Features, Field, OutputFormat, OutputSpec, RAY_FEATURES, RayOptions,
    StandardOutput, ray_table,
};
use input::{Awaited, Patient, RayReader};
use record::RecordWriter;
use std::ffi::OsString;
use std::fs::File;
use std::io::{Read, Write, stdin};
use std::os::fd::AsFd;
use std::process::ExitCode;
use tree::TreeWriter;

const ABOUT: About = About {
    name: "rtrace",
    summary: "Traces rays from standard input in a scene and prints what they see.",
    synopsis: "[options] [$NAME] [@FILE] OCTREE < RAYS > RECORDS",
    notes: "A ray is an origin and a direction, six numbers. A direction of zero flushes the output. OCTREE may be a \
            '!command'.",
};

/// Runs the program.
pub fn main(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let (program, words) = split(arguments);
    on_deep_stack(&program.clone(), move || work(program, words))
}

fn work(program: String, words: Vec<String>) -> ExitCode {
    let mut session = Session::new(program, false);
    let result = run(&mut session, words);
    session.end(result)
}

fn run(session: &mut Session, words: Vec<String>) -> Result<(), Stop> {
    let tool = Tool { about: ABOUT, features: Features(&[COMMON_FEATURES, RAY_FEATURES]), table: ray_table() };
    let processors = processors();
    let mut options = RayOptions::new(processors.as_ref().map_or(1, |&n| n));
    if !session.read(words, &tool, &mut options)? {
        return Ok(());
    }
    if options.common.threads == 0 {
        processors?;
    }
    options.rendering.check()?;
    let (output, spectrum) = (options.common.output, &options.rendering.options.spectrum);
    if !spectrum.shows_colour() && !output.bins() && Converter::new(output, spectrum).channels() == 3 {
        session.messages.warn("spectral range incompatible with color output");
    }
    session.attach(&options.common)?;
    session.refuse_attachment(&options.common)?;
    let Some(octree) = session.octree.clone() else {
        return Err(Failure::user("missing octree argument").into());
    };
    let job = Job::new(&options, session)?;
    start_threads(options.common.threads())?;
    let source = light::octree(&octree, session)?;
    let mut scene = Scene::open(session, source, &options.rendering, !job.spec.shades(), options.common.output)?;
    // Not by way of Rust's own buffer, of which a poll knows nothing.
    let input = stdin().as_fd().try_clone_to_owned().map_err(|e| Failure::system("cannot read standard input", &e))?;
    let mut input = Patient::new(File::from(input), session.stop());
    let goal = options.rendering.goal.filter(|_| job.spec.shades());
    let Some(error) = goal else {
        scene.begin(&octree, &options.rendering)?;
        let result = job.run(session, &options, &mut scene, input);
        // The ambient file is closed whatever happened; the first error counts.
        return result.and(scene.close());
    };
    // The pilot is made of rays from everywhere in the input.
    let mut rays = Vec::new();
    input.read_to_end(&mut rays).map_err(|e| Failure::system("cannot read standard input", &e))?;
    session.check()?;
    let stream = stream::Stream::new(&options, &job.spec);
    options.rendering.options = pilot::choose(session, &options, &stream, &rays, &mut scene, error)?;
    scene.begin(&octree, &options.rendering)?;
    let result = job.run(session, &options, &mut scene, &rays[..]);
    // The ambient file is closed whatever happened; the first error counts.
    result.and(scene.close())
}

/// What a run has to do, complete and checked.
pub(crate) struct Job {
    spec: OutputSpec,
    conversion: Converter,
}

impl Job {
    fn new(options: &RayOptions, session: &Session) -> Result<Self, Stop> {
        let spec = OutputSpec::parse(&options.fields)?;
        let spectrum = &options.rendering.options.spectrum;
        let conversion = Converter::new(options.common.output, spectrum);
        if options.format == OutputFormat::Colour {
            if spec.tree.is_some() || !matches!(spec.fields[..], [Field::Value | Field::Mirrored | Field::Unmirrored]) {
                return Err(Failure::user("color format only with -ov, -or, -ox").into());
            }
            if conversion.channels() < 3 {
                return Err(Failure::user("color format incompatible with -pY, -pS, -pM").into());
            }
        }
        let irradiance = options.immediate || options.rendering.options.irradiance;
        if irradiance && !spec.shades() {
            return Err(Failure::user("-I+ and -i+ options require some value output").into());
        }
        let ambient = &options.rendering.options.ambient;
        let coarse = ambient.bounces > 0 && (ambient.accuracy > 0.0 || ambient.super_samples > 0);
        let contributions = |fields: &[Field], traced: bool| {
            for field in fields {
                let letter = match field {
                    Field::Contribution => 'V',
                    Field::Coefficient => 'W',
                    _ => continue,
                };
                if coarse {
                    session.messages.warn(&format!("-ot{letter} accuracy depends on -aa 0 -as 0"));
                }
                if !traced {
                    session.messages.warn("-oVW options require trace mode");
                }
            }
        };
        contributions(&spec.fields, false);
        contributions(spec.tree.as_ref().map_or(&[], |t| &t.fields), true);
        let parts = [Field::Mirrored, Field::MirroredLength, Field::Unmirrored, Field::UnmirroredLength];
        if irradiance && spec.has(&parts) {
            session.messages.warn("-orRxX options incompatible with -I+ and -i+");
        }
        Ok(Self { spec, conversion })
    }

    fn run(
        &self,
        session: &Session,
        options: &RayOptions,
        scene: &mut Scene<'_>,
        input: impl Awaited,
    ) -> Result<(), Stop> {
        let mut out = StandardOutput::new();
        let picture = (options.width > 0 && options.height > 0).then_some((options.width, options.height));
        let mut head = Vec::new();
        if options.header {
            header::write(&mut head, session, options, &scene.header, &self.spec, self.conversion.channels())?;
        }
        if let Some((width, height)) = picture {
            let resolution = ambit_file::Resolution::new(width as u32, height as u32);
            head.extend_from_slice(format!("{resolution}\n").as_bytes());
        }
        let written = out.write_all(&head).and_then(|()| if options.width > 0 { out.flush() } else { Ok(()) });
        written.map_err(|e| Stop::writing("write error", &e))?;
        let records = RecordWriter::new(&self.spec.fields, &self.conversion, options);
        let tree = self.spec.tree.as_ref().map(|t| TreeWriter::new(t, &self.conversion, options));
        let mut rays = RayReader::new(input, options.input);
        let complete =
            stream::Stream::new(options, &self.spec).run(&mut rays, &records, tree.as_ref(), scene, &mut out)?;
        if let Some(odd) = rays.odd() {
            session.messages.warn(odd);
        }
        if !complete {
            session.messages.warn("unexpected EOF on input");
        }
        Ok(())
    }
}
