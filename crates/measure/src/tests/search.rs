use super::*;
use ambit_base::Stream;

fn settings() -> Vec<Setting> {
    let accuracies = crate::SPACINGS.map(|s| s.accuracy);
    let divisions = (4..=12).map(|k| 1 << k);
    divisions.flat_map(|divisions| accuracies.map(|accuracy| Setting { accuracy, divisions })).collect()
}

/// Normal deviates (Box & Muller 1958), independent for different keys.
fn normal(key: u64, i: usize) -> f64 {
    let [u, v] = Stream::uncorrelated(i as u32, key).two();
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// A result of mean 2 that errs as the model says.
fn result(truth: &Model, setting: Setting, key: u64) -> Vec<[f32; 3]> {
    let error = 2.0 * truth.error(setting);
    (0..2000).map(|i| [0, 1, 2].map(|c| (2.0 + error * normal(key, 3 * i + c)) as f32)).collect()
}

/// Searches until nothing is left to run; the answer and the places of the runs.
fn search(truth: &Model, settings: &[Setting], goal: f64) -> (Found, Vec<usize>) {
    let mut search = Search::new(settings.to_vec(), goal);
    let mut places = Vec::new();
    while let Some(index) = search.next() {
        search.add(index, result(truth, settings[index], search.runs() as u64)).unwrap();
        places.push(index);
        assert!(places.len() < 20, "{places:?}");
    }
    (search.found().unwrap(), places)
}

#[test]
fn differences_and_means_are_those_of_their_definitions() {
    let (a, b) = ([[1.0, 2.0, 3.0]; 4], [[1.0, 2.0, 6.0]; 4]);
    assert!((mean(&a) - 2.0).abs() < 1e-12);
    // Mean square 9/3.
    assert!((difference(&a, &b, 2.0).unwrap() - 3_f64.sqrt() / 2.0).abs() < 1e-12);
    assert!(difference(&a, &b[1..], 2.0).is_err());
}

#[test]
fn exact_differences_give_the_variances_back() {
    // The ratio lies on the prior's centre: nothing pulls.
    let truth = Model { spacing: 0.04, sampling: 0.04 };
    let pairs: Vec<_> = [(0, 1), (0, 2), (1, 2)]
        .map(|(i, j)| (FIRST[i], FIRST[j], truth.error(FIRST[i]).powi(2) + truth.error(FIRST[j]).powi(2)))
        .to_vec();
    let model = Model::fit(&pairs, 3);
    assert!((model.spacing / 0.04 - 1.0).abs() < 1e-9 && (model.sampling / 0.04 - 1.0).abs() < 1e-9, "{model:?}");
    assert!((model.error(UNIT) - 0.08_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn errors_of_synthetic_runs_are_found() {
    let all = settings();
    // Where one variance is all that matters, the belief that there is some of the other errs on the safe side.
    for (spacing, sampling, least) in
        [(0.04, 0.04, 0.8), (0.09, 0.01, 0.8), (0.01, 0.09, 0.8), (0.2, 0.005, 0.6), (0.005, 0.2, 0.6)]
    {
        let truth = Model { spacing, sampling };
        for goal in [0.2, 0.1, 0.05] {
            let (found, _) = search(&truth, &all, goal);
            let ratio = truth.error(all[found.index]) / found.error;
            assert!((least..1.2).contains(&ratio), "{truth:?} {goal}: {ratio} {found:?}");
            assert!(found.error <= goal);
        }
    }
}

#[test]
fn the_answer_is_about_the_cheapest_one_and_runs_cost_little_beside_it() {
    let all = settings();
    let truth = Model { spacing: 0.06, sampling: 0.02 };
    let (found, places) = search(&truth, &all, 0.03);
    let enough = all.iter().filter(|s| truth.error(**s) <= 0.03);
    let least = enough.map(|s| s.cost()).fold(f64::INFINITY, f64::min);
    let cost = all[found.index].cost();
    assert!(cost < 2.5 * least, "{cost} {least}");
    let dearest = places.iter().map(|&i| all[i].cost()).fold(0.0, f64::max);
    assert!(cost > dearest && cost <= REACH * dearest, "{cost} {dearest}");
}

#[test]
fn what_no_setting_reaches_ends_at_the_most_exact_one() {
    let all = settings();
    let (found, _) = search(&Model { spacing: 1.0, sampling: 1.0 }, &all, 0.001);
    assert_eq!(all[found.index], Setting { accuracy: 0.05, divisions: 4096 });
    assert!(found.error > 0.001);
}

#[test]
fn one_setting_is_judged_by_runs_of_itself() {
    for accuracy in [0.0, 0.2] {
        let one = [Setting { accuracy, divisions: 512 }];
        let truth = Model { spacing: 0.05, sampling: 0.05 };
        let (found, places) = search(&truth, &one, 0.5);
        assert_eq!(places, [0, 0, 0]);
        assert!((found.error / truth.error(one[0]) - 1.0).abs() < 0.05, "{found:?}");
    }
}

#[test]
fn equal_and_black_results_have_no_error() {
    for value in [0.0, 1.0] {
        let mut search = Search::new(settings(), 0.05);
        while let Some(index) = search.next() {
            search.add(index, vec![[value; 3]; 10]).unwrap();
        }
        let found = search.found().unwrap();
        assert!(found.error < 1e-5 && search.runs() == 3, "{found:?}");
    }
    assert!(Search::new(settings(), 0.05).add(0, vec![[f32::NAN; 3]]).is_err());
}
