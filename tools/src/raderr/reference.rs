//! Takes a reference from its file, or makes it and keeps it there.

use super::bench::{Runner, Target};
use super::options::Measure;
use ambit_base::mix;
use ambit_cli::VERSION;
use ambit_file::{name_of, path_of};
use ambit_measure::{Bench, Error, Part, Plan, Reference, make_reference};
use std::path::Path;

/// Line of the header: hash of the scene, the views, and the sensors.
const SCENE: &str = "SCENE";

/// Line of the header: options of its passes, those of every run included.
const OPTIONS: &str = "OPTIONS";

/// The reference of a measurement; `side` makes it if need be.
pub(super) fn obtain(runner: &mut Runner, plan: &Plan, side: usize, options: &Measure) -> Result<Reference, Error> {
    let words: Vec<String> = options.reference_options.split_whitespace().map(str::to_owned).collect();
    let identity = format!("{:016x}", identity(runner)?);
    let all = [&runner.common[..], &words].concat().join(" ");
    let there: Vec<_> = options.reference.iter().filter(|f| f.exists()).collect();
    if !there.is_empty() && there.len() == options.reference.len() {
        let read = there.iter().map(|f| {
            let name = name_of(f).into_owned();
            let reference = Reference::open(&name)?;
            if !options.any_reference {
                fits(&reference, &name, OPTIONS, &all, "set of options")?;
                fits(&reference, &name, SCENE, &identity, "scene or view")?;
            }
            runner.say(&format!("reference: {name}"));
            Ok(reference)
        });
        let read: Result<Vec<_>, Error> = read.collect();
        let joined = Reference::join(read?).ok_or_else(|| Error::Program("no reference".to_owned()))?;
        return Ok(joined);
    }
    if options.reference.len() > 1 {
        let missing =
            options.reference.iter().find(|f| !f.exists()).map_or_else(String::new, |f| name_of(f).into_owned());
        let problem = "not found (of several references all must be there; one alone is made)".to_owned();
        return Err(Error::Reference { file: missing, problem });
    }
    runner.check(side, &words)?;
    let mut reference = make_reference(runner, plan, side, &words, options.passes as usize, options.noise / 100.0)?;
    let program = &runner.programs[side];
    let mut header = vec![
        format!("SOFTWARE=raderr, {VERSION}"),
        format!(
            "MADE_BY={} ({})",
            [&[name_of(&program.path).into_owned()], &program.words[..]].concat().join(" "),
            program.version
        ),
        format!("{OPTIONS}={all}"),
        format!("{SCENE}={identity}"),
    ];
    header.append(&mut reference.header);
    reference.header = header;
    if let Some(file) = options.reference.first() {
        reference.write(&name_of(file))?;
    }
    Ok(reference)
}

/// Stops if the reference says that it was made for something else. A picture says nothing.
fn fits(reference: &Reference, file: &str, line: &str, wanted: &str, what: &str) -> Result<(), Error> {
    match reference.line(line) {
        Some(found) if found != wanted => {
            let hint = "remove it, name another file, or take it nevertheless with --any-reference";
            let problem = format!("made for another {what} ({line}={found}, now {wanted}); {hint}");
            Err(Error::Reference { file: file.to_owned(), problem })
        }
        _ => Ok(()),
    }
}

/// Hash of the octree, the words of the views, the view files they name, and the sensors.
fn identity(runner: &Runner) -> Result<u64, Error> {
    let read =
        |path: &Path| std::fs::read(path).map_err(|source| Error::File { file: name_of(path).into_owned(), source });
    let mut hash = bytes(0, &read(&runner.octree)?);
    match &runner.target {
        Target::Sensors(file) | Target::Rays(file) => hash = bytes(hash, &read(file)?),
        Target::Views(views) => {
            // Words of all runs are compared as they are; here only the view file that they name counts.
            for words in views.iter().chain([&runner.common]) {
                if *words != runner.common {
                    hash = bytes(hash, words.join(" ").as_bytes());
                }
                for pair in words.windows(2).filter(|p| p[0] == "-vf") {
                    hash = bytes(hash, &read(&path_of(&pair[1]))?);
                }
            }
        }
    }
    Ok(hash)
}

/// Mixes bytes into a hash, their number included.
fn bytes(hash: u64, data: &[u8]) -> u64 {
    let (words, rest) = data.as_chunks::<8>();
    let hash = words.iter().fold(mix(hash, data.len() as u64), |h, w| mix(h, u64::from_le_bytes(*w)));
    rest.iter().fold(hash, |h, b| mix(h, u64::from(*b)))
}

/// Stops if the reference has not the parts that the results will have, as far as that is known before the first run.
pub(super) fn count_parts(reference: &Reference, target: &Target) -> Result<(), Error> {
    let wanted = target.count();
    if reference.parts.len() == wanted && !reference.parts.iter().any(|p: &Part| p.is_empty()) {
        return Ok(());
    }
    let problem = format!("{} pictures (expected {wanted}, one for each view)", reference.parts.len());
    Err(Error::Reference { file: "as given".to_owned(), problem })
}
