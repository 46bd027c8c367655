//! `fprism_val` against what Radiance 6.0a printed.

use ambit_cal::{CHANNELS, Channel, Context, Flag, Inputs, Library, Scratch};

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// Values of expressions for a ray; light is sought in the direction `sought`.
fn values(expressions: &[&str], reals: &[f64], ray: [f64; 3], sought: [f64; 3]) -> (Vec<f64>, Flag) {
    let mut library = Library::renderer().unwrap();
    let length = ray.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut channels = [0.0; CHANNELS];
    for (channel, x) in [Channel::Dx, Channel::Dy, Channel::Dz].into_iter().zip(ray) {
        channels[channel as usize] = x / length;
    }
    for (channel, x) in [Channel::DxA, Channel::DyA, Channel::DzA].into_iter().zip(sought) {
        channels[channel as usize] = x;
    }
    let programs: Vec<_> =
        expressions.iter().map(|text| library.compile(text, &Context::GLOBAL, "prism1 \"m\"").unwrap()).collect();
    let mut scratch = Scratch::new();
    let mut pass = scratch.pass(Inputs { channels: &channels, reals });
    let values = programs.iter().map(|program| pass.eval(program).unwrap()).collect();
    (values, pass.flag())
}

/// x, y and z of the direction and the coefficient of the ray of a rank.
fn exit(side: &str, rank: &str, reals: &[f64], ray: [f64; 3], sought: [f64; 3]) -> [f64; 4] {
    let expressions = [0, 1, 2, 3].map(|what| format!("fprism_val({what},{side},{rank})"));
    let (found, flag) = values(&expressions.each_ref().map(String::as_str), reals, ray, sought);
    assert_eq!(flag, Flag::Clear);
    found.try_into().unwrap()
}

const REALS: [f64; 10] = [1.0, 0.5, 0.3, 0.2, 1.5, 0.01, 4.0, 0.0, 1e-4, 0.1];
const RAY: [f64; 3] = [0.6, 0.0, -0.8];

#[test]
fn light_goes_where_radiance_sends_it() {
    let (mut rows, mut sum) = (0, 0.0);
    for row in include_str!("panel.tsv").lines().filter(|row| !row.starts_with('#')) {
        let fields: Vec<_> = row.split('\t').collect();
        let (reals, ray, printed) = (numbers(fields[0]), numbers(fields[1]), numbers(fields[3]));
        // What was printed was printed for a ray that meets the panel.
        let ray = [ray[0], ray[1], if ray[2] == 0.0 { -1e-6 } else { ray[2] }];
        let found = exit("0", fields[2], &reals, ray, [0.0; 3]);
        for (a, b) in found.iter().zip(&printed[1..]) {
            assert!((a - b).abs() < 1e-5, "{row}: {found:?}");
        }
        // Light after many surfaces differs by what the module says; the strong rays meet few.
        let off = (found[3] - printed[0]).abs();
        assert!(off < if printed[0] > 0.1 && reals[8] < 0.01 { 5e-4 * printed[0] } else { 7e-3 }, "{row}: {found:?}");
        sum += off;
        rows += 1;
    }
    assert!(rows > 180 && sum / f64::from(rows) < 3e-4, "{rows} {sum}");
}

#[test]
fn paths_of_few_surfaces_are_exact() {
    // Straight through either face, reflected by the flat side, and by either face from outside.
    for (ray, rank, printed) in [
        (RAY, "1", 0.576_197_5),
        (RAY, "2", 0.265_054_4),
        (RAY, "3", 0.064_524_97),
        ([-0.8, 0.2, -0.3], "3", 0.026_596_53),
        ([1.0, 0.0, -1e-4], "4", 0.024_580_4),
    ] {
        let light = exit("0", rank, &REALS, ray, [0.0; 3])[3];
        assert!((light - printed).abs() < 2e-6, "{ray:?} {rank}: {light}");
    }
}

#[test]
fn sides_ranks_and_sources_choose() {
    let light = |side: &str, rank: &str, sought| exit(side, rank, &REALS, RAY, sought)[3];
    let (first, second, mirrored) = (0.576_197_5, 0.265_054_4, 0.064_524_97);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
    // Arguments are rounded towards 0 after adding a half, so -1 is either side, too.
    near(light("-1", "1", [0.0; 3]), first);
    near(light("-2", "1", [0.0; 3]), mirrored);
    near(light("0.4", "1.6", [0.0; 3]), second);
    near(light("2", "2", [0.0; 3]), second);
    near(light("1", "3", [0.0; 3]), 0.0);
    assert_eq!(exit("0", "99", &REALS, RAY, [0.0; 3]), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(exit("0", "0", &REALS, RAY, [0.0; 3]), [1.0, 0.0, 0.0, 0.0]);
    // Where a source is sought, the rank does not count: the strongest ray of about its angle across the prisms.
    near(light("0", "3", [0.5841642, -0.1369387, -0.8]), first);
    near(light("0", "1", [0.5198424, 0.2996061, -0.8]), second);
    near(light("0", "2", [-0.6, 0.0, 0.8]), mirrored);
    near(light("1", "2", [-0.6, 0.0, 0.8]), 0.0);
    near(light("0", "2", [0.0, 0.0, 0.5]), 0.0);
    near(light("0", "1", [0.7, -0.1, -0.7]), first);
}

#[test]
fn arguments_out_of_their_domain_have_no_effect() {
    let illegal: [(usize, &[f64]); 10] = [
        (0, &[-1.0]),
        (1, &[-0.5]),
        (2, &[-0.3]),
        (3, &[-0.2]),
        (4, &[0.9]),
        (5, &[-0.1, 1.0]),
        (6, &[0.0, 3.0, 5.0]),
        (7, &[-0.1, 1.1]),
        (8, &[0.0, -1.0]),
        (9, &[-0.1]),
    ];
    for (argument, numbers) in illegal {
        for number in numbers {
            let mut reals = REALS;
            reals[argument] = *number;
            let found = values(&["fprism_val(0,0,1)"], &reals, RAY, [0.0; 3]);
            assert_eq!(found, (vec![0.0], Flag::Domain), "{argument} {number}");
        }
    }
    assert_eq!(values(&["fprism_val(4,0,1)"], &REALS, RAY, [0.0; 3]), (vec![0.0], Flag::Domain));
    assert_eq!(values(&["fprism_val(-3,0,1)"], &REALS, RAY, [0.0; 3]), (vec![0.0], Flag::Domain));
}

#[test]
fn no_panel_yields_more_light_than_it_gets() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..500 {
        let mut pick = |numbers: &[f64], scale: f64| match numbers.get((random() * 4.0) as usize) {
            Some(number) => *number,
            None => random() * scale,
        };
        let reals = [
            pick(&[0.0, 1e-9], 2.0),
            pick(&[0.0, 1e3], 2.0),
            pick(&[0.0], 1.0),
            pick(&[0.0, 1e-9], 2.0),
            1.0 + pick(&[0.0, 1e-9], 2.0),
            pick(&[0.0, 0.01], 0.1),
            [1.0, 2.0, 4.0][(pick(&[], 3.0)) as usize],
            pick(&[0.0, 1.0], 1.0),
            pick(&[1e-9], 1.0) + 1e-9,
            0.1,
        ];
        let ray = [pick(&[0.0, 1.0], 2.0) - 1.0, pick(&[1.0], 2.0) - 1.0, pick(&[1.0], 2.0) - 1.0];
        if ray == [0.0; 3] {
            continue;
        }
        let expressions: Vec<_> = (1..=64).map(|rank| format!("fprism_val(3,0,{rank})")).collect();
        let expressions: Vec<_> = expressions.iter().map(String::as_str).collect();
        let (lights, flag) = values(&expressions, &reals, ray, [0.0; 3]);
        let sum: f64 = lights.iter().sum();
        assert!(
            flag == Flag::Clear && sum <= 1.0 + 1e-9 && lights.iter().all(|light| *light >= 0.0),
            "{reals:?} {ray:?} {sum}"
        );
    }
}
