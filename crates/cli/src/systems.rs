//! Options of interreflection that Radiance does not have, a switch for each system.

use crate::common::Carries;
use crate::failure::Failure;
use crate::rendering::Rendering;
use crate::table::{Place, Row};
use ambit_render::{Bounces, Clamping, Interpolation, MOST_OVERLAP, Spacing, StepTest};

/// Beyond it, values of other walls' corners come in.
const MOST_SMOOTHING: f32 = 2.0;

/// The rows of `--unbiased`, its parts, and the systems of the irradiance cache.
pub(crate) fn system_rows<S: Carries<Rendering>>() -> Vec<Row<S>> {
    fn light<S: Carries<Rendering>>(s: &mut S) -> &mut Rendering {
        s.part()
    }
    vec![
        Row::new(
            "-unbiased",
            Place::Bare(|s: &mut S| light(s).options.unbiased()),
            "no bias in interreflection: -aa 0 -as 0 -ar 0 -aw 0 -lr 0 -dt 0 --unbounded-bounces --exact-textures \
             --actual-weights; options after it count as usual, and -ab must be 1 or more",
        ),
        Row::new(
            "-unbounded-bounces",
            Place::Bare(|s: &mut S| light(s).options.ambient.unbounded = true),
            "after the last of -ab bounces go on with single paths until Russian roulette ends them, instead of -av",
        ),
        Row::new(
            "-exact-textures",
            Place::Bare(|s: &mut S| light(s).options.ambient.exact_textures = true),
            "with -aa 0: sample about the normal as textures turn it, not about the surface's with a first-order correction",
        ),
        Row::new(
            "-actual-weights",
            Place::Bare(|s: &mut S| light(s).options.ambient.systems.actual_weights = true),
            "weigh deeper irradiance values by the actual reflectances, not by half for each bounce: fewer are shared",
        ),
        Row::new(
            "-bounces",
            Place::Word(|s: &mut S, how, _| {
                light(s).options.ambient.systems.bounces = match how.as_str() {
                    "apart" => Bounces::Apart,
                    "mixed" => Bounces::Mixed,
                    other => return Err(Failure::choice("--bounces", other, &["apart", "mixed"])),
                };
                Ok(())
            }),
            "what irradiance values nearer the eye answer where deeper ones are wanted: apart (the bounces that -ab leaves \
             there) or mixed (all they have, as in Radiance, which brings some light of further bounces)",
        )
        .values("HOW"),
        Row::new(
            "-neighbor-clamping",
            Place::Bare(|s: &mut S| light(s).options.ambient.systems.clamping = Clamping::All),
            "let all irradiance values rein each other in: none reaches farther than a neighbor does, plus the distance between them (otherwise those of deeper bounces, by twice the distance)",
        ),
        Row::new(
            "-measured-reuse",
            Place::Word(|s: &mut S, how, _| {
                light(s).measured_reuse = match how.as_str() {
                    "auto" => None,
                    "on" => Some(true),
                    "off" => Some(false),
                    other => return Err(Failure::choice("--measured-reuse", other, &["auto", "on", "off"])),
                };
                Ok(())
            }),
            "where irradiance values of deeper bounces are hardly reused (leaves, blades, hair), use few samples and do not \
             keep them: on, off, or auto (unless there is an ambient file, which others may want complete)",
        )
        .values("HOW"),
        Row::new(
            "-overlap",
            Place::Reals(1, |s: &mut S, weight| {
                light(s).options.ambient.overlap = within("--overlap", weight[0], 0.0..=MOST_OVERLAP)?;
                Ok(())
            }),
            "the weight that irradiance values around a point must add up to before it does without one of its own, for what \
             is seen directly; those of ambient files count threefold; 0 (as in Radiance, whose pixels come in another order: \
             any) to 0.9; .3 unless given",
        )
        .values("WEIGHT"),
        Row::new(
            "-smoothing",
            Place::Reals(1, |s: &mut S, factor| {
                light(s).options.ambient.smoothing = within("--smoothing", factor[0], 1.0..=MOST_SMOOTHING)?;
                Ok(())
            }),
            "how far irradiance values count in what is seen directly, as a multiple of their reach, once there are enough \
             within it; 1 (as in Radiance, and with its ambient files whatever is given) to 2; 1.25 unless given",
        )
        .values("FACTOR"),
        Row::new(
            "-interpolation",
            Place::Word(|s: &mut S, order, _| {
                light(s).options.ambient.systems.interpolation = match order.as_str() {
                    "second" => Interpolation::Second,
                    "first" => Interpolation::First,
                    other => return Err(Failure::choice("--interpolation", other, &["second", "first"])),
                };
                Ok(())
            }),
            "of what order values between irradiance values are: second (exact for quadratic functions where irradiance \
             values lie evenly around; unless given) or first (for linear ones, as in Radiance)",
        )
        .values("ORDER"),
        Row::new(
            "-step-test",
            Place::Word(|s: &mut S, how, _| {
                light(s).options.ambient.systems.step_test = match how.as_str() {
                    "on" => StepTest::On,
                    "off" => StepTest::Off,
                    other => return Err(Failure::choice("--step-test", other, &["on", "off"])),
                };
                Ok(())
            }),
            "whether irradiance values serve surfaces a step above or below theirs: on (they do not; unless given) or off (they do, \
             as in Radiance, and with its ambient files whatever is given; fewer are made, and light may come under lintels)",
        )
        .values("HOW"),
        Row::new(
            "-spacing",
            Place::Word(|s: &mut S, how, _| {
                light(s).options.ambient.systems.spacing = match how.as_str() {
                    "hessian" => Spacing::Hessian,
                    "classical" => Spacing::Classical,
                    other => return Err(Failure::choice("--spacing", other, &["hessian", "classical"])),
                };
                Ok(())
            }),
            "how far irradiance values reach: hessian (the curvature of irradiance, as in Radiance since 2014) or classical \
             (harmonic mean distance and the gradients of rings and sectors, as before)",
        )
        .values("HOW"),
    ]
}

/// A value that an option allows.
fn within(option: &str, value: f64, allowed: std::ops::RangeInclusive<f32>) -> Result<f32, Failure> {
    let value = value as f32;
    if allowed.contains(&value) {
        return Ok(value);
    }
    let (least, most) = allowed.into_inner();
    Err(Failure::user(format!("command line error at '{option}': {value} (expected {least} to {most})")))
}
