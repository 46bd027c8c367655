use super::*;
use ambit_base::Stream;

/// Side of the pictures that are made up.
const SIDE: u32 = 64;

/// Makes pictures of mean 2 with noise of the standard deviation that the option `-ad` says as 2/√N, at N microseconds;
/// the second program takes three times as long.
struct Model {
    seeds: bool,
    jobs: Vec<(usize, usize, u64)>,
    constant: bool,
}

impl Bench for Model {
    fn run(&mut self, job: &Job) -> Result<Output, Error> {
        self.jobs.push((job.side, job.view, job.seed));
        let at = job.options.iter().rposition(|w| w == "-ad").expect("the ladder says -ad");
        let count: f64 = job.options[at + 1].parse().expect("a number");
        let seed = if self.seeds { job.seed } else { count as u64 };
        let key = ambit_base::hash_bits(&[job.view as u64, seed, count as u64, job.side as u64]);
        // Uniform in [−√3, √3]: standard deviation 1.
        let noise = |i: u32| (Stream::uncorrelated(i, key).one() * 2.0 - 1.0) * 3.0_f64.sqrt();
        let value = |i: u32| if self.constant { 2.0 } else { (2.0 + 2.0 / count.sqrt() * noise(i)) as f32 };
        let values = (0..SIDE * SIDE).map(|i| [value(3 * i), value(3 * i + 1), value(3 * i + 2)]).collect();
        let wall = count * 1e-6 * if job.side == 1 { 3.0 } else { 1.0 };
        let cost = Cost { wall, cpu: wall, peak: 1 << 20 };
        Ok(Output { part: Part { width: SIDE, height: SIDE }, values, cost, rays: Some(10), records: Some(5) })
    }

    fn say(&mut self, _: &str) {}
}

fn plan(sides: usize, seeds: bool) -> Plan {
    let ladder = Ladder::parse("-ad 100\n-ad 400\n-ad 1600", "test").unwrap();
    let sides = ["ours", "theirs"].iter().take(sides).map(|n| Side { name: (*n).to_owned(), seeds }).collect();
    Plan { sides, ladder, views: 2, repeats: 3, cell: 1, bright: None }
}

fn words(text: &str) -> Vec<String> {
    text.split(' ').map(str::to_owned).collect()
}

#[test]
fn a_model_of_sampling_gives_back_its_errors_and_its_ratio() {
    for seeds in [true, false] {
        let plan = plan(2, seeds);
        let mut model = Model { seeds, jobs: Vec::new(), constant: false };
        let reference = make_reference(&mut model, &plan, 0, &words("-ad 900"), 6, 0.0).unwrap();
        assert_eq!(reference.line("PASSES"), Some("6"));
        model.jobs.clear();
        let (rows, comparison) = measure(&mut model, &plan, &reference).unwrap();
        for (row, error) in rows.iter().zip([0.1, 0.05, 0.025]) {
            for side in &row.sides {
                assert!((side.score.rms.value / error - 1.0).abs() < 0.03, "{seeds}: {error}: {:?}", side.score);
                assert!(side.score.bias.value.abs() < 0.002, "{:?}", side.score);
                assert_eq!((side.rays, side.records, side.runs.len()), (Some(20), Some(5), 3));
            }
        }
        let Some(Comparison::Overlap { mean, range: Some(range), levels, .. }) = comparison else { panic!() };
        assert!((mean / 3.0 - 1.0).abs() < 0.05, "{mean}");
        assert!(range[0] <= mean * 1.001 && range[1] >= mean * 0.999 && levels.len() >= 3);
        // Warming up, then in turns; views share a file; repeats have seeds of their own.
        let expected = [(0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 1)];
        assert_eq!(model.jobs[..6], expected);
        assert_eq!(model.jobs[2 + 12..][..4], [(1, 0, 2), (1, 1, 2), (0, 0, 2), (0, 1, 2)]);
    }
}

#[test]
fn passes_end_when_the_reference_is_quiet() {
    let mut model = Model { seeds: true, jobs: Vec::new(), constant: false };
    // One pass has 1/30 of noise, four 1/60.
    let reference = make_reference(&mut model, &plan(1, true), 0, &words("-ad 900"), 64, 0.0172).unwrap();
    assert_eq!(reference.line("PASSES"), Some("4"));
    let noise = reference.noise().unwrap();
    assert!((noise.rms * 60.0 - 1.0).abs() < 0.02 && noise.floor < noise.rms, "{noise:?}");
}

#[test]
fn equal_passes_are_no_reference() {
    let mut model = Model { seeds: true, jobs: Vec::new(), constant: true };
    let e = make_reference(&mut model, &plan(1, true), 0, &words("-ad 900"), 4, 0.0).unwrap_err();
    assert!(e.to_string().contains("bit by bit"), "{e}");
    let e = make_reference(&mut model, &plan(1, false), 0, &words("-ab 2"), 4, 0.0).unwrap_err();
    assert!(e.to_string().contains("need -ad"), "{e}");
}

#[test]
fn another_size_than_the_reference_has_is_an_error() {
    let mut model = Model { seeds: true, jobs: Vec::new(), constant: false };
    let part = Part { width: 8, height: 8 };
    let reference =
        Reference { parts: vec![part; 2], a: vec![[1.0; 3]; 128], b: None, header: Vec::new(), ignored: Vec::new() };
    let e = measure(&mut model, &plan(1, true), &reference).unwrap_err().to_string();
    assert!(e.contains("ours, rung 1 (-ad 100): 4096 values (expected 128"), "{e}");
}
