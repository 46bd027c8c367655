//! The order of a measurement: passes of the reference until it is quiet enough, then every rung, programs in turns.

use crate::error::Error;
use crate::ladder::Ladder;
use crate::parts::{Part, cells};
use crate::ratio::{Comparison, compare};
use crate::reference::Reference;
use crate::report::{Row, Run, SideRow, Spread, curve, single_curve};
use crate::score::{Block, blocks, finite, score, single};

/// Seeds of the reference's passes start here, so that no timed run shares its random numbers with them.
const REFERENCE_SEED: u64 = 1_000_001;

/// What runs programs: the tool's business.
pub trait Bench {
    /// Runs a job and returns its values and cost.
    fn run(&mut self, job: &Job) -> Result<Output, Error>;

    /// Tells the user how far things are.
    fn say(&mut self, line: &str);
}

/// One run of one program for one view.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Which program: index into `Plan::sides`.
    pub side: usize,
    /// Which view: index into what the bench knows.
    pub view: usize,
    /// The rung's options, or the reference's.
    pub options: &'a [String],
    /// Names the random numbers, if the program has such an option.
    pub seed: u64,
    /// Whether it is timed: then it has the threads the user said and an ambient file.
    pub timed: bool,
    /// Whether to start with an empty ambient file; otherwise the one of the run before is used again.
    pub fresh: bool,
}

/// What a run costs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Wall-clock seconds from start to end of the process.
    pub wall: f64,
    /// Processor seconds, the user's and the system's.
    pub cpu: f64,
    /// Greatest resident size, bytes.
    pub peak: u64,
}

/// What a run gives.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its size.
    pub part: Part,
    /// Radiance or irradiance, pixels from the lower left in rows or sensors in order.
    pub values: Vec<[f32; 3]>,
    /// Its cost.
    pub cost: Cost,
    /// Rays traced, if the program tells.
    pub rays: Option<u64>,
    /// Records now in the ambient file, if there is one.
    pub records: Option<u64>,
}

/// A program, as far as the order of things depends on it.
#[derive(Clone, Debug)]
pub struct Side {
    /// What messages call it.
    pub name: String,
    /// Whether it can be told to use other random numbers. If not, all its runs of the same options are the same.
    pub seeds: bool,
}

/// What to measure.
#[derive(Clone, Debug)]
pub struct Plan {
    /// One program or two.
    pub sides: Vec<Side>,
    /// The settings.
    pub ladder: Ladder,
    /// How many views there are; a repeat renders all of them in order, with one ambient file.
    pub views: usize,
    /// How often every rung is run.
    pub repeats: usize,
    /// Side of the cells of pixels that are averaged before comparing.
    pub cell: u32,
    /// Leave out values where the reference is above so many times its mean.
    pub bright: Option<f64>,
}

impl Plan {
    /// The reference as results are compared with it.
    pub fn compared(&self, reference: &Reference) -> Reference {
        let small = reference.cells(self.cell);
        if let Some(times) = self.bright { small.without_bright(times) } else { small }
    }
}

/// Makes a reference: pairs of passes, one for either half, until the noise of their mean is at most `noise` or `passes`
/// have been made (at least two are). Programs without seeds get other random numbers by other counts of divisions.
pub fn make_reference(
    bench: &mut dyn Bench,
    plan: &Plan,
    side: usize,
    options: &[String],
    passes: usize,
    noise: f64,
) -> Result<Reference, Error> {
    let program = &plan.sides[side];
    let mut parts = Vec::new();
    let mut sums: [Vec<[f64; 3]>; 2] = [Vec::new(), Vec::new()];
    let mut first: Vec<[f32; 3]> = Vec::new();
    let mut pairs = 0;
    loop {
        for (half, sum) in sums.iter_mut().enumerate() {
            let pass = 2 * pairs + half;
            let words = if program.seeds { options.to_vec() } else { other_divisions(options, pass, &program.name)? };
            let (mut values, mut sizes) = (Vec::new(), Vec::new());
            for view in 0..plan.views {
                let seed = REFERENCE_SEED + pass as u64;
                let job = Job { side, view, options: &words, seed, timed: false, fresh: true };
                let out = bench.run(&job)?;
                finite(&out.values, &format!("reference by {}", program.name))?;
                sizes.push(out.part);
                values.extend(out.values);
            }
            match pass {
                0 => (parts, first) = (sizes, values.clone()),
                1 if values == first => return Err(Error::EqualPasses { program: program.name.clone() }),
                _ => {}
            }
            sum.resize(values.len(), [0.0; 3]);
            sum.iter_mut().zip(&values).for_each(|(s, v)| (0..3).for_each(|c| s[c] += v[c] as f64));
        }
        pairs += 1;
        let [a, b] = [0, 1].map(|h| sums[h].iter().map(|s| s.map(|c| (c / pairs as f64) as f32)).collect::<Vec<_>>());
        let mut reference = Reference { parts: parts.clone(), a, b: Some(b), header: Vec::new(), ignored: Vec::new() };
        let mean = reference.mean();
        let found = plan.compared(&reference).noise().ok_or(Error::Black { mean })?;
        bench.say(&format!("reference: {} passes, noise {:.2} %", 2 * pairs, 100.0 * found.rms));
        if found.rms <= noise || 2 * (pairs + 1) > passes {
            reference.header.push(format!("PASSES={}", 2 * pairs));
            reference.header.push(format!("NOISE={:.6}", found.rms));
            return Ok(reference);
        }
    }
}

/// The options with the count of divisions of pass number `pass`: (√D + pass)², which is D for the first.
fn other_divisions(options: &[String], pass: usize, program: &str) -> Result<Vec<String>, Error> {
    let missing = || {
        Error::Program(format!(
            "{program} has no seeds: passes of the reference need -ad with a positive number among its options"
        ))
    };
    let at = options.iter().rposition(|w| w == "-ad").ok_or_else(missing)?;
    let value: Option<f64> = options.get(at + 1).and_then(|w| w.parse().ok()).filter(|v| *v >= 1.0);
    let divisions = if pass == 0 { value } else { value.map(|v| (v.sqrt().round() + pass as f64).powi(2)) };
    let mut words = options.to_vec();
    words[at + 1] = format!("{:.0}", divisions.ok_or_else(missing)?);
    Ok(words)
}

/// What has been gathered of one program on one rung.
#[derive(Default)]
struct Gathered {
    blocks: Vec<Vec<Block>>,
    runs: Vec<Run>,
    peak: u64,
    records: Option<u64>,
    rays: Option<u64>,
}

/// Runs every rung `repeats` times, programs in turns (who goes first changes from repeat to repeat), and compares the
/// results with the reference, and two programs with each other. An untimed run of the first rung of either program
/// comes before, so that files are in memory for all alike.
pub fn measure(
    bench: &mut dyn Bench,
    plan: &Plan,
    reference: &Reference,
) -> Result<(Vec<Row>, Option<Comparison>), Error> {
    let whole: usize = reference.parts.iter().map(|p| p.len()).sum();
    let small = plan.compared(reference);
    let rungs = &plan.ladder.rungs;
    let mut gathered: Vec<Vec<Gathered>> =
        rungs.iter().map(|_| plan.sides.iter().map(|_| Gathered::default()).collect()).collect();
    for side in 0..plan.sides.len() {
        bench.say(&format!("warming up: {}", plan.sides[side].name));
        bench.run(&Job { side, view: 0, options: &rungs[0].options, seed: 0, timed: true, fresh: true })?;
    }
    for repeat in 0..plan.repeats {
        for (rung, gathered) in rungs.iter().zip(&mut gathered) {
            let mut order: Vec<usize> = (0..plan.sides.len()).collect();
            if repeat % 2 == 1 {
                order.reverse();
            }
            for side in order {
                let name = format!("{}, rung {} ({})", plan.sides[side].name, rung.label, rung.options.join(" "));
                let to = &mut gathered[side];
                let (mut values, mut walls, mut cpu) = (Vec::new(), Vec::new(), 0.0);
                (to.rays, to.records) = (Some(0), None);
                for view in 0..plan.views {
                    let seed = repeat as u64 + 1;
                    let job = Job { side, view, options: &rung.options, seed, timed: true, fresh: view == 0 };
                    let out = bench.run(&job)?;
                    finite(&out.values, &name)?;
                    if reference.parts.get(view) != Some(&out.part) {
                        return Err(Error::Size {
                            what: name,
                            found: values.len() + out.values.len(),
                            expected: whole,
                        });
                    }
                    values.extend(cells(out.part, &out.values, plan.cell).1);
                    walls.push(out.cost.wall);
                    cpu += out.cost.cpu;
                    to.peak = to.peak.max(out.cost.peak);
                    to.rays = to.rays.zip(out.rays).map(|(a, b)| a + b);
                    to.records = out.records.or(to.records);
                }
                let compared = blocks(&small.parts, &values, &small, &name)?;
                let (rms, bias) = single(&compared);
                let run = Run { views: walls, cpu, rms, bias };
                bench.say(&format!("repeat {}, {name}: {:.3} s, error {:.2} %", repeat + 1, run.wall(), 100.0 * rms));
                to.blocks.push(compared);
                to.runs.push(run);
            }
        }
    }
    let floor = small.noise().map_or(0.0, |n| n.floor);
    let mut rows = Vec::new();
    for (rung, sides) in rungs.iter().zip(gathered) {
        // The same draws of the bootstrap for either program, so that equal results have equal bounds.
        let key = rows.len() as u64;
        let sides: Result<Vec<SideRow>, Error> = sides.into_iter().map(|side| side.finish(key, floor)).collect();
        rows.push(Row { rung: rung.clone(), sides: sides? });
    }
    let comparison = if let [first, second] = &plan.sides[..] {
        let pairs: Vec<_> = (0..plan.repeats).map(|r| (single_curve(&rows, 0, r), single_curve(&rows, 1, r))).collect();
        Some(compare([&first.name, &second.name], &curve(&rows, 0), &curve(&rows, 1), &pairs))
    } else {
        None
    };
    Ok((rows, comparison))
}

impl Gathered {
    /// The statistics over the repeats; `floor` is the least error that the reference can show.
    fn finish(self, key: u64, floor: f64) -> Result<SideRow, Error> {
        let none = || Error::Program("nothing was run (expected at least one repeat)".to_owned());
        let score = score(&self.blocks, key)?;
        Ok(SideRow {
            wall: Spread::of(self.runs.iter().map(Run::wall)).ok_or_else(none)?,
            cpu: Spread::of(self.runs.iter().map(|r| r.cpu)).ok_or_else(none)?,
            peak: self.peak,
            records: self.records,
            rays: self.rays,
            visible: score.rms.low > 0.0 && score.rms.value > floor,
            score,
            runs: self.runs,
        })
    }
}

#[cfg(test)]
#[path = "tests/campaign.rs"]
mod tests;
