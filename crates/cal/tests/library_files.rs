//! The library files against what the real renderer printed with its own (rtrace on a distant glow, to 7 digits).

#![expect(clippy::approx_constant, reason = "these are printed values, not constants")]

use ambit_cal::{CHANNELS, Channel, Context, EMBEDDED, Flag, Inputs, Library, Scratch, embedded};

/// Directions of the rays, not normalized.
const DIRECTIONS: [[f64; 3]; 11] = [
    [0.48, 0.64, 0.6],
    [-0.6, 0.3, 0.8],
    [0.2, -0.7, 0.5],
    [-0.4, -0.1, 0.05],
    [0.1, 0.9, 0.004],
    [0.3, -0.8, -0.01],
    [-0.4, 0.1, -0.3],
    [0.0, 0.0, 1.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
];

/// File, expression, real arguments, values for the directions.
type Row = (&'static str, &'static str, &'static [f64], &'static [f64]);

#[rustfmt::skip]
const SKIES_AND_LAMPS: &[Row] = &[
    ("skybright.cal", "skybr", &[1.0, 30.0, 8.0, 1.6, 0.038267, -0.247596, 0.968107], &[10.46848, 11.81571, 18.81848, 17.57585, 13.91584, 14.3619, 8.0, 30.85852, 13.81272, 13.70193, 8.0]),
    ("skybright.cal", "skybr", &[2.0, 40.0, 8.0], &[29.33178, 33.7667, 28.42808, 15.86567, 11.11306, 10.46783, 8.0, 39.99997, 10.93114, 10.93114, 8.0]),
    ("skybright.cal", "skybr", &[3.0, 40.0, 8.0], &[39.99766, 39.99967, 39.99643, 37.46073, 26.27477, 23.72726, 8.000001, 39.99997, 25.58682, 25.58682, 8.0]),
    ("skybright.cal", "skybr", &[4.0, 36.0, 8.0, 1.2, 0.038267, -0.247596, 0.968107], &[5.992818, 9.91562, 11.63812, 5.721024, 5.807111, 7.850737, 8.0, 35.72164, 6.561837, 5.879649, 8.0]),
    ("perezlum.cal", "skybright", &[43.31, 25.31, -0.895661, -0.315027, 12.930416, -3.533044, 0.062448, 0.038267, -0.247596, 0.968107], &[25.74733, 28.76912, 43.36285, 42.38865, 36.20964, 36.69413, 25.31, 95.1637, 36.25022, 35.78818, 25.31]),
    ("perezlum.cal", "skybright", &[2.624, 0.698, 0.674128, -0.627893, 0.473913, -0.414817, -0.035193, 0.80516, -0.583979, 0.103366], &[4.071166, 4.026942, 4.246443, 2.900204, 2.084364, 2.090985, 0.6980001, 4.48679, 1.965208, 2.014222, 0.698]),
    ("source.cal", "corr(2)", &[3.0, 4.0, 5.0, 6.0], &[6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0]),
    ("source.cal", "flatcorr(2)", &[3.0, 4.0, 5.0, 6.0], &[6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0]),
    ("source.cal", "boxcorr(2)", &[3.0, 4.0, 5.0, 6.0], &[0.1436782, 0.1520433, 0.1615566, 0.1618173, 0.2201493, 0.1805195, 0.1499712, 0.3, 0.2, 0.25, 0.3]),
    ("source.cal", "cylcorr(2)", &[3.0, 4.0, 5.0, 6.0], &[0.2548872, 0.2669074, 0.2542318, 0.2808022, 0.2991726, 0.2978303, 0.2546089, 0.4774648, 0.3, 0.3, 0.4774648]),
    ("source.cal", "src_theta", &[3.0, 4.0, 5.0, 6.0], &[53.1301, 39.98069, 55.51861, 83.08562, 89.74691, 90.67056, 126.0399, 0.0, 90.0, 90.0, 180.0]),
    ("source.cal", "src_phi", &[3.0, 4.0, 5.0, 6.0], &[233.1301, 333.4349, 105.9454, 14.03624, 263.6598, 110.556, 345.9637, 0.0, 0.0, 270.0, 0.0]),
    ("source.cal", "src_phi2", &[3.0, 4.0, 5.0, 6.0], &[126.8699, 26.56505, 105.9454, 14.03624, 96.34019, 110.556, 14.03624, 0.0, 0.0, 90.0, 0.0]),
    ("source.cal", "src_phi4", &[3.0, 4.0, 5.0, 6.0], &[53.1301, 26.56505, 74.0546, 14.03624, 83.65981, 69.44395, 14.03624, 0.0, 0.0, 90.0, 0.0]),
    ("source.cal", "srcB_vert", &[3.0, 4.0, 5.0, 6.0], &[-38.65981, 36.8699, -21.80141, 82.87498, -87.70939, -91.90915, 126.8699, 0.0, 90.0, 0.0, -180.0]),
    ("source.cal", "srcB_horiz", &[3.0, 4.0, 5.0, 6.0], &[46.84761, 20.55605, -54.46232, -63.43495, 89.74535, -90.71616, 161.565, 0.0, 0.0, 90.0, 180.0]),
    ("source.cal", "srcB_vert2", &[3.0, 4.0, 5.0, 6.0], &[38.65981, 36.8699, 21.80141, 82.87498, 87.70939, 91.90915, 126.8699, 0.0, 90.0, 0.0, 180.0]),
    ("source.cal", "srcB_horiz2", &[3.0, 4.0, 5.0, 6.0], &[46.84761, 20.55605, 54.46232, 63.43495, 89.74535, 90.71616, 161.565, 0.0, 0.0, 90.0, 180.0]),
    ("source.cal", "corr(-2)", &[3.0, 4.0, 5.0, 6.0], &[-6.0, -6.0, -6.0, -6.0, -6.0, -6.0, -6.0, -6.0, -6.0, -6.0, -6.0]),
    ("source.cal", "corr(2)", &[], &[2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0]),
    ("source.cal", "flatcorr(2)", &[], &[2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0]),
    ("illum.cal", "il_alth", &[0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0], &[0.36, 0.5871559, 0.3205128, 0.01449275, 1.951181e-05, 0.0001369675, 0.3461539, 1.0, 0.0, 0.0, 1.0]),
    ("illum.cal", "il_azih", &[0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0], &[3.141593, 4.892242, 0.9218008, 5.600869, 3.674437, 1.002272, 5.110911, 6.283185, 5.35589, 3.785094, 6.283185]),
    ("illum.cal", "il_alt", &[0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0], &[0.6, 0.766261, 0.5661385, 0.1203859, 0.004417218, -0.01170331, -0.5883484, 1.0, 0.0, 0.0, -1.0]),
    ("illum.cal", "il_azi", &[0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0], &[0.9272952, 2.677945, 4.990689, 3.386571, 1.460139, 5.07116, 2.896614, 6.283185, 3.141593, 1.570796, 6.283185]),
];

/// File, expression, real arguments, hit point, value.
type Point = (&'static str, &'static str, &'static [f64], [f64; 3], f64);

#[rustfmt::skip]
const SURFACES: &[Point] = &[
    ("surf.cal", "surf_dx", &[2.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.3, 0.7, 0.0], 0.5225),
    ("surf.cal", "surf_dy", &[2.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.3, 0.7, 0.0], 0.095),
    ("surf.cal", "surf_dz", &[2.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.3, 0.7, 0.0], 0.6175),
    ("surf.cal", "surf_dx", &[2.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [1.5, -0.4, 0.0], 1.34),
    ("surf.cal", "surf_dy", &[2.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [1.5, -0.4, 0.0], 1.14),
    ("surf.cal", "surf_dz", &[2.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [1.5, -0.4, 0.0], -0.34),
    ("surf.cal", "surf_dx", &[0.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.0, 0.3, 0.7], 0.5225),
    ("surf.cal", "surf_dy", &[0.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.0, 0.3, 0.7], 0.095),
    ("surf.cal", "surf_dz", &[0.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.0, 0.3, 0.7], 0.6175),
    ("surf.cal", "surf_dx", &[0.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.0, 1.5, -0.4], 1.34),
    ("surf.cal", "surf_dy", &[0.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.0, 1.5, -0.4], 1.14),
    ("surf.cal", "surf_dz", &[0.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.0, 1.5, -0.4], -0.34),
    ("surf.cal", "surf_dx", &[1.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.3, 0.0, 0.7], 0.8825),
    ("surf.cal", "surf_dy", &[1.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.3, 0.0, 0.7], 0.295),
    ("surf.cal", "surf_dz", &[1.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [0.3, 0.0, 0.7], 0.4975),
    ("surf.cal", "surf_dx", &[1.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [1.5, 0.0, -0.4], -0.37),
    ("surf.cal", "surf_dy", &[1.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [1.5, 0.0, -0.4], 0.19),
    ("surf.cal", "surf_dz", &[1.0, 0.25, -0.5, 0.75, 0.3, 0.9, -0.2, -0.6, 0.4, 0.1, 0.8, -0.35, 0.45], [1.5, 0.0, -0.4], 0.23),
    ("rev.cal", "rev_dx", &[0.3, 0.2, -0.5, 0.7], [0.5, 0.0, 1.0], 0.45),
    ("rev.cal", "rev_dy", &[0.3, 0.2, -0.5, 0.7], [0.5, 0.0, 1.0], 0.0),
    ("rev.cal", "rev_dz", &[0.3, 0.2, -0.5, 0.7], [0.5, 0.0, 1.0], 0.5),
    ("rev.cal", "rev_dx", &[0.3, 0.2, -0.5, 0.7], [0.5, 0.8, 0.4], 0.1209993),
    ("rev.cal", "rev_dy", &[0.3, 0.2, -0.5, 0.7], [0.5, 0.8, 0.4], 0.1935988),
    ("rev.cal", "rev_dz", &[0.3, 0.2, -0.5, 0.7], [0.5, 0.8, 0.4], 0.32),
    ("rev.cal", "rev_dx", &[0.3, 0.2, -0.5, 0.7], [0.5, -0.8, 2.0], 0.1209993),
    ("rev.cal", "rev_dy", &[0.3, 0.2, -0.5, 0.7], [0.5, -0.8, 2.0], -0.1935988),
    ("rev.cal", "rev_dz", &[0.3, 0.2, -0.5, 0.7], [0.5, -0.8, 2.0], 0.8),
    ("rev.cal", "rev_dx", &[-0.12, 0.0, 5.9, -1.78], [0.5, 0.0, 1.0], 1.17),
    ("rev.cal", "rev_dy", &[-0.12, 0.0, 5.9, -1.78], [0.5, 0.0, 1.0], 0.0),
    ("rev.cal", "rev_dz", &[-0.12, 0.0, 5.9, -1.78], [0.5, 0.0, 1.0], -0.12),
    ("rev.cal", "rev_dx", &[-0.12, 0.0, 5.9, -1.78], [0.5, 0.8, 0.4], 2.006602),
    ("rev.cal", "rev_dy", &[-0.12, 0.0, 5.9, -1.78], [0.5, 0.8, 0.4], 3.210563),
    ("rev.cal", "rev_dz", &[-0.12, 0.0, 5.9, -1.78], [0.5, 0.8, 0.4], -0.048),
    ("rev.cal", "rev_dx", &[-0.12, 0.0, 5.9, -1.78], [0.5, -0.8, 2.0], 2.006602),
    ("rev.cal", "rev_dy", &[-0.12, 0.0, 5.9, -1.78], [0.5, -0.8, 2.0], -3.210563),
    ("rev.cal", "rev_dz", &[-0.12, 0.0, 5.9, -1.78], [0.5, -0.8, 2.0], -0.24),
];

fn value(library: &mut Library, file: &str, expression: &str, reals: &[f64], channels: &[f64; CHANNELS]) -> f64 {
    if !library.is_loaded(file) {
        let text = embedded(file).expect("a file that comes with the program");
        library.load_file(file, file, text.as_bytes()).unwrap();
        assert_eq!(library.drain_messages().count(), 0);
    }
    let program = library.compile(expression, &Context::of_file(file), "").unwrap();
    let mut scratch = Scratch::new();
    let mut pass = scratch.pass(Inputs { channels, reals });
    let value = pass.eval(&program).unwrap();
    assert_eq!(pass.flag(), Flag::Clear, "{file} {expression}");
    assert_eq!(scratch.drain_warnings().count(), 0);
    value
}

fn close(value: f64, printed: f64) -> bool {
    // Seven digits, of which the float before printing took part of the last.
    (value - printed).abs() <= 1e-6 * printed.abs() + 1e-9
}

#[test]
fn skies_and_lamps_have_the_values_of_the_real_ones() {
    let mut library = Library::renderer().unwrap();
    for (file, expression, reals, printed) in SKIES_AND_LAMPS {
        assert_eq!(printed.len(), DIRECTIONS.len());
        for (direction, printed) in DIRECTIONS.iter().zip(*printed) {
            let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
            let mut channels = [0.0; CHANNELS];
            for axis in 0..3 {
                channels[Channel::Dx as usize + axis] = direction[axis] / length;
                channels[Channel::Nx as usize + axis] = -direction[axis] / length;
            }
            channels[Channel::Rdot as usize] = 1.0;
            let value = value(&mut library, file, expression, reals, &channels);
            assert!(close(value, *printed), "{file} {expression} {direction:?}: {value}, not {printed}");
        }
    }
}

#[test]
fn smoothed_surfaces_have_the_values_of_the_real_ones() {
    let mut library = Library::renderer().unwrap();
    for (file, expression, reals, point, printed) in SURFACES {
        let mut channels = [0.0; CHANNELS];
        channels[Channel::Px as usize..][..3].copy_from_slice(point);
        let value = value(&mut library, file, expression, reals, &channels);
        assert!(close(value, *printed), "{file} {expression} {point:?}: {value}, not {printed}");
    }
}

#[test]
fn every_file_loads_without_a_word() {
    for (name, text) in EMBEDDED {
        let mut library = Library::renderer().unwrap();
        library.load_file(name, name, text.as_bytes()).unwrap();
        assert_eq!(library.drain_messages().collect::<Vec<_>>(), Vec::<String>::new(), "{name}");
    }
    assert!(embedded("nothing.cal").is_none());
}
