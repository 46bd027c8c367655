use super::*;
use ambit_base::Stream;

const SIDE: u32 = 128;
const PART: Part = Part { width: SIDE, height: SIDE };

/// Normal deviates (Box & Muller 1958), independent for different keys.
fn normal(key: u64, i: usize) -> f32 {
    let [u, v] = Stream::uncorrelated(i as u32, key).two();
    ((-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()) as f32
}

/// Values `mean` + `spread`·N(0, 1).
fn noisy(mean: f32, spread: f32, key: u64) -> Vec<[f32; 3]> {
    (0..PART.len()).map(|i| [0, 1, 2].map(|c| mean + spread * normal(key, 3 * i + c))).collect()
}

fn reference(a: Vec<[f32; 3]>, b: Option<Vec<[f32; 3]>>) -> Reference {
    Reference { parts: vec![PART], a, b, header: Vec::new(), ignored: Vec::new() }
}

fn scored(values: &[Vec<[f32; 3]>], reference: &Reference) -> Score {
    let repeats: Vec<_> = values.iter().map(|v| blocks(&[PART], v, reference, "test").unwrap()).collect();
    score(&repeats, 1).unwrap()
}

#[test]
fn a_constant_offset_is_error_and_bias() {
    let s = scored(&[vec![[2.2; 3]; PART.len()]], &reference(vec![[2.0; 3]; PART.len()], None));
    for number in [s.rms, s.bias, s.p99] {
        assert!((number.value - 0.1).abs() < 1e-6 && number.high - number.low < 1e-6, "{s:?}");
    }
    assert!((s.raw - 0.1).abs() < 1e-6);
}

#[test]
fn noise_has_its_standard_deviation_and_percentile() {
    let s = scored(&[noisy(2.0, 0.1, 3)], &reference(vec![[2.0; 3]; PART.len()], None));
    assert!((s.rms.value / 0.05 - 1.0).abs() < 0.02, "{s:?}");
    assert!(s.bias.value.abs() < 1e-3 && s.bias.low < 0.0 && s.bias.high > 0.0, "{s:?}");
    // 99 % of chi-squared with three degrees of freedom lies below 11.345.
    let expected = 0.05 * (11.345_f64 / 3.0).sqrt();
    assert!((s.p99.value / expected - 1.0).abs() < 0.05, "{s:?}, expected {expected}");
    assert!(s.rms.low < s.rms.value && s.rms.value < s.rms.high);
}

#[test]
fn noise_of_the_reference_is_taken_out() {
    // The reference is noisier than the result: 0.2 in each half, 0.1 in the result.
    let r = reference(noisy(2.0, 0.2, 5), Some(noisy(2.0, 0.2, 6)));
    let s = scored(&[noisy(2.0, 0.1, 7)], &r);
    assert!((s.rms.value / 0.05 - 1.0).abs() < 0.05, "{s:?}");
    let raw = (0.01_f64 + 0.02).sqrt() / 2.0;
    assert!((s.raw / raw - 1.0).abs() < 0.02, "{s:?}, expected {raw}");
    // A perfect result: what remains is compatible with nothing.
    let s = scored(&[vec![[2.0; 3]; PART.len()]], &r);
    assert!(s.rms.value < r.noise().unwrap().floor, "{s:?}");
}

#[test]
fn bounds_hold_the_truth_about_as_often_as_promised() {
    // Blocks that err alike: an offset each, so that single pixels would promise far too much.
    let (spread, trials) = (0.1_f32, 100);
    let truth = spread as f64;
    let one = reference(vec![[1.0; 3]; PART.len()], None);
    let inside = (0..trials).filter(|t| {
        let values = (0..PART.len()).map(|i| [1.0 + spread * normal(100 + t, PART.block(i)); 3]).collect();
        let s = scored(&[values], &one);
        s.rms.low <= truth && truth <= s.rms.high
    });
    let inside = inside.count();
    // 95 of 100 expected; percentile bounds of 64 blocks are a little narrow.
    assert!(inside >= 86, "{inside} of {trials}");
}

#[test]
fn repeats_are_averaged_and_widen_the_bounds() {
    let one = reference(vec![[1.0; 3]; PART.len()], None);
    let values = [vec![[1.1; 3]; PART.len()], vec![[0.9; 3]; PART.len()]];
    let s = scored(&values, &one);
    assert!((s.rms.value - 0.1).abs() < 1e-6 && s.bias.value.abs() < 1e-6, "{s:?}");
    assert!((s.bias.low + 0.1).abs() < 1e-6 && (s.bias.high - 0.1).abs() < 1e-6, "{s:?}");
}

#[test]
fn what_can_not_be_compared_is_an_error() {
    let one = reference(vec![[1.0; 3]; PART.len()], None);
    let mut values = vec![[1.0; 3]; PART.len()];
    values[7][1] = f32::NAN;
    let e = blocks(&[PART], &values, &one, "rung 2").unwrap_err().to_string();
    assert_eq!(e, "rung 2: value 7 is not finite (NaN)");
    assert!(blocks(&[PART], &values[1..], &one, "x").unwrap_err().to_string().contains("expected 16384"));
    let black = reference(vec![[0.0; 3]; PART.len()], None);
    let b = blocks(&[PART], &vec![[1.0; 3]; PART.len()], &black, "x").unwrap();
    assert!(matches!(score(&[b], 1), Err(Error::Black { .. })));
}

#[test]
fn a_lamp_in_one_block_does_not_widen_the_bounds() {
    // One block is a hundred times brighter and exact; the error is the same in all others.
    let lamp = |v: f32| -> Vec<[f32; 3]> {
        (0..PART.len()).map(|i| if PART.block(i) == 5 { [100.0; 3] } else { [v; 3] }).collect()
    };
    let s = scored(&[lamp(1.1)], &reference(lamp(1.0), None));
    let expected = 0.1 * (63.0_f64 / 64.0).sqrt() / (163.0 / 64.0);
    assert!((s.rms.value / expected - 1.0).abs() < 1e-5, "{s:?}");
    assert!(s.rms.low > 0.95 * expected && s.rms.high < 1.05 * expected, "{s:?}");
}
