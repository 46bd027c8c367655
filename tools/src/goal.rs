//! `--error`: settings are chosen with a pilot, a small part of the work that is computed beforehand with coarse ones.
//!
//! Direct light errs by how light sources are divided and by what shadow tests are left out. That is cheap to compute, so
//! its error is measured against fine settings. Then [`Search`] finds the settings of interreflection for what of the
//! asked error is left: the squares of both add up. Everything depends on the command and the scene alone, never on time
//! or threads. The ambient file is not touched before the settings are settled.

use crate::light::Scene;
use crate::session::{Session, Stop};
use ambit_base::Notify;
use ambit_cli::Failure;
use ambit_file::general;
use ambit_measure::{SAFETY, SPACINGS, Search, Setting, TYPICAL, difference, mean, super_samples};
use ambit_render::Options;

/// Rays of a pilot along each side of a picture.
pub(crate) const SIDE: u32 = 48;
/// Rays of a pilot in a list of rays.
pub(crate) const RAYS: usize = 256;

/// `-ds` and `-dt` from coarse to fine.
const DIRECT: [(f64, f64); 6] = [(1.0, 0.2), (0.5, 0.1), (0.25, 0.05), (0.12, 0.03), (0.06, 0.01), (0.03, 0.003)];
/// What stands for exact direct light.
const EXACT_DIRECT: (f64, f64) = (0.015, 0.0);
/// The part of the asked error that direct light may have: so much of it takes little from what interreflection may have.
const DIRECT_SHARE: f64 = 0.5;

/// Divisions that are chosen from: powers of 2 with these exponents.
const DIVISIONS: std::ops::RangeInclusive<u32> = 4..=12;
/// Fewer divisions than this have no super-samples.
const SUPER_SAMPLED: i32 = 64;

/// Keys the random numbers of pilots, so that none shares them with the work itself.
const PILOT_SEED: u64 = 0x9170_7000;

/// What settings are sought for.
pub(crate) struct Goal<'a> {
    /// The asked error, relative to the mean.
    pub(crate) error: f64,
    /// Options as they are without `--error`.
    pub(crate) options: &'a Options,
    /// What a pilot is made of: `pixels`, `rays`.
    pub(crate) unit: &'static str,
}

/// What computes a pilot: radiance or irradiance of its rays.
pub(crate) type Pilot<'a> = dyn FnMut(&mut Scene<'_>) -> Result<Vec<[f32; 3]>, Stop> + 'a;

/// Which settings the command line gives, so that they stay.
struct Given<'a>(&'a [&'static str]);

impl Given<'_> {
    fn has(&self, flag: &str) -> bool {
        let unbiased = ["aa", "as", "ar", "dt"].contains(&flag) && self.0.contains(&"-unbiased");
        unbiased || self.0.contains(&flag)
    }
}

/// A choice and what is known of it.
struct Choice {
    options: Options,
    /// Relative error that it is estimated to have.
    error: f64,
    /// What it may well have.
    bound: f64,
    /// Runs of the pilot.
    tried: usize,
}

/// Chooses the settings and tells of it; the scene stands at the beginning with the settings returned.
pub(crate) fn choose(
    session: &Session,
    scene: &mut Scene<'_>,
    goal: &Goal<'_>,
    pilot: &mut Pilot<'_>,
) -> Result<Options, Stop> {
    let mut run = Runner { scene, pilot, seed: goal.options.seed, runs: 0, rays: 0 };
    let choice = seek(&mut run, goal, &Given(&session.flags))?;
    let (rays, unit) = (run.rays, goal.unit);
    scene.restart(choice.as_ref().map_or(goal.options, |c| &c.options));
    let Some(choice) = choice else {
        let text = format!("--error: a pilot of {rays} {unit} saw nothing but black: settings are as without it");
        session.messages.warn(&text);
        return Ok(goal.options.clone());
    };
    let percent = |x: f64| format!("{} %", general(100.0 * x, 2));
    let asked = general(100.0 * goal.error, 4);
    let doubt = if choice.error > goal.error {
        "; that is above what is asked: no setting is expected to reach it".to_owned()
    } else if choice.bound > goal.error {
        format!("; it may be as much as {}: no setting is sure to reach what is asked", percent(choice.bound))
    } else {
        String::new()
    };
    let text = format!(
        "error of {asked} % asked: {}; estimated error {} (pilots of {rays} {unit}, {} runs){doubt}",
        words(&choice.options),
        percent(choice.error),
        choice.tried
    );
    if choice.bound > goal.error {
        session.messages.warn(&text);
    } else {
        session.messages.print(text);
    }
    Ok(choice.options)
}

/// The chosen settings as options.
fn words(options: &Options) -> String {
    let (a, d) = (&options.ambient, &options.direct);
    let g = |x: f64| general(x, 6);
    let indirect = if a.bounces > 0 {
        let (accuracy, more) = (g(a.accuracy), a.super_samples);
        format!("-aa {accuracy} -ar {} -ad {} -as {more} ", a.resolution, a.divisions)
    } else {
        String::new()
    };
    format!("{indirect}-ds {} -dt {}", g(d.sampling), g(d.threshold))
}

struct Runner<'r, 's, 'p> {
    scene: &'r mut Scene<'s>,
    pilot: &'r mut Pilot<'p>,
    seed: u64,
    runs: u64,
    /// Rays of a pilot.
    rays: usize,
}

impl Runner<'_, '_, '_> {
    /// The pilot with these options and the random numbers of the seed.
    fn run(&mut self, options: &Options, seed: u64) -> Result<Vec<[f32; 3]>, Stop> {
        self.scene.restart(&Options { seed, ..options.clone() });
        let values = (self.pilot)(self.scene)?;
        self.rays = values.len();
        self.runs += 1;
        Ok(values)
    }

    /// Random numbers that no other run has.
    fn fresh(&self) -> u64 {
        self.seed.wrapping_add(PILOT_SEED).wrapping_add(self.runs)
    }
}

/// The settings; none if the pilot is black.
fn seek(run: &mut Runner<'_, '_, '_>, goal: &Goal<'_>, given: &Given<'_>) -> Result<Option<Choice>, Stop> {
    let mut settings = interreflection(goal.options, given);
    let coarsest = settings.first().map_or_else(|| goal.options.clone(), |(_, options)| options.clone());
    let level = mean(&run.run(&coarsest, run.fresh())?);
    if !(level.is_finite() && level > 0.0) {
        return Ok(None);
    }
    let (sources, direct) = direct(run, goal, given, level)?;
    if settings.is_empty() {
        let (error, tried) = (direct, run.runs as usize);
        let options = with_direct(goal.options, sources);
        return Ok(Some(Choice { options, error, bound: error, tried }));
    }
    for (_, options) in &mut settings {
        *options = with_direct(options, sources);
    }
    let left = (goal.error * goal.error - direct * direct).max(0.0).sqrt();
    let mut search = Search::new(settings.iter().map(|s| s.0).collect(), left / SAFETY);
    while let Some(index) = search.next() {
        let values = run.run(&settings[index].1, run.fresh())?;
        search.add(index, values).map_err(|e| Failure::internal(e.to_string()))?;
    }
    let Some(found) = search.found() else { return Ok(None) };
    let options = settings.swap_remove(found.index).1;
    let (error, bound) = (direct.hypot(TYPICAL * found.error), direct.hypot(SAFETY * found.error));
    Ok(Some(Choice { options, error, bound, tried: run.runs as usize }))
}

/// The settings of interreflection to choose from, from the coarsest on; none if there is no interreflection.
fn interreflection(options: &Options, given: &Given<'_>) -> Vec<(Setting, Options)> {
    let a = &options.ambient;
    if a.bounces <= 0 || given.has("ad") && a.divisions <= 0 {
        return Vec::new();
    }
    let mut spacings: Vec<(f64, i32)> = SPACINGS.iter().map(|s| (s.accuracy, s.resolution)).collect();
    if given.has("ar") {
        for spacing in &mut spacings {
            spacing.1 = a.resolution;
        }
    }
    if given.has("aa") {
        // The resolution that goes with such an accuracy, or with the finest one that is coarser.
        let resolution = spacings.iter().rfind(|s| s.0 >= a.accuracy).map_or(spacings[0].1, |s| s.1);
        spacings = vec![(a.accuracy, resolution)];
    }
    let divisions = if given.has("ad") { vec![a.divisions] } else { DIVISIONS.map(|k| 1 << k).collect() };
    let mut settings = Vec::new();
    for divisions in divisions {
        for &(accuracy, resolution) in &spacings {
            let mut options = options.clone();
            let a = &mut options.ambient;
            (a.accuracy, a.resolution, a.divisions) = (accuracy, resolution, divisions);
            if !given.has("as") {
                a.super_samples = if divisions < SUPER_SAMPLED { 0 } else { super_samples(divisions) };
            }
            settings.push((Setting { accuracy, divisions }, options));
        }
    }
    settings
}

/// The coarsest settings of direct light that err by no more than their share, and their error, relative to `level`.
fn direct(
    run: &mut Runner<'_, '_, '_>,
    goal: &Goal<'_>,
    given: &Given<'_>,
    level: f64,
) -> Result<((f64, f64), f64), Stop> {
    let mut options = goal.options.clone();
    options.ambient.divisions = 0;
    // One seed for all: only what the settings change shall differ.
    let seed = run.fresh();
    let exact = run.run(&with_direct(&options, EXACT_DIRECT), seed)?;
    let own = goal.options.direct.sampling;
    let mut best = None;
    let mut before = None;
    for (sampling, threshold) in DIRECT {
        let sampling = if given.has("ds") { own } else { sampling };
        let threshold = if given.has("dt") { goal.options.direct.threshold } else { threshold };
        let step = (sampling, threshold);
        if before.replace(step) == Some(step) {
            continue;
        }
        let values = run.run(&with_direct(&options, step), seed)?;
        let error = difference(&exact, &values, level).map_err(|e| Failure::internal(e.to_string()))?;
        if best.is_none_or(|(_, least)| error < least) {
            best = Some((step, error));
        }
        if error <= DIRECT_SHARE * goal.error {
            break;
        }
    }
    Ok(best.unwrap_or((EXACT_DIRECT, 0.0)))
}

fn with_direct(options: &Options, (sampling, threshold): (f64, f64)) -> Options {
    let mut options = options.clone();
    (options.direct.sampling, options.direct.threshold) = (sampling, threshold);
    options
}
