//! Where extra samples go: to cells between neighbours that differ, relative to their sum.
//!
//! What a cell's own sample found has no say in it, but by way of the total that is shared out. A cell's mean is that of all
//! its samples, the first included: if bright first samples brought further ones and dark ones did not, means would be too
//! dark. A lone one that outshines much of all else has a say after all (a lamp's reflection in a ball): it tells of chance
//! more than of light, and what it takes from the mean is less than what it would leave as a blot.

/// Sides of the grid below which there are no extra samples.
const MIN_SIDE: usize = 8;
/// Extra samples per side of the grid below which there are none.
const MIN_PER_SIDE: usize = 4;

/// The share of all brightness from which on a cell is looked at for what itself found.
const GLARING: f64 = 0.2;

/// The number of extra samples of a hemisphere of side `n`: `-as` times the weight, rounded, 0 where too few to matter.
pub(crate) fn budget(super_samples: i32, weight: f32, n: usize) -> usize {
    let m = (f64::from(super_samples.max(0)) * f64::from(weight) + 0.5) as usize;
    if n >= MIN_SIDE && m >= MIN_PER_SIDE * n { m } else { 0 }
}

/// The number of extra samples of each cell of a grid of `size` rows and columns; `brightness` row by row, `chance` a random
/// number a cell. The last column of rings does not know the first: cells on a border make up for missing neighbours.
pub(crate) fn allocate(size: [usize; 2], brightness: &[f32], budget: usize, chance: impl Fn(usize) -> f64) -> Vec<u32> {
    let mut error = differences(size, brightness);
    let glaring = GLARING * brightness.iter().map(|&b| f64::from(b)).sum::<f64>();
    for (e, &b) in error.iter_mut().zip(brightness) {
        if f64::from(b) > glaring {
            *e = e.max(f64::from(b));
        }
    }
    // Left to go: summed from the end so that the last share takes what remains.
    let mut left = vec![0.0; error.len() + 1];
    for i in (0..error.len()).rev() {
        error[i] = error[i].max(0.0);
        left[i] = left[i + 1] + error[i];
    }
    let mut counts = vec![0; error.len()];
    let mut budget = budget;
    for (cell, count) in counts.iter_mut().enumerate() {
        if budget == 0 || left[cell] <= 0.0 {
            break;
        }
        let share = (error[cell] / left[cell] * budget as f64 + chance(cell)) as usize;
        let share = share.min(budget);
        *count = share as u32;
        budget -= share;
    }
    counts
}

/// The difference measure of each cell: the mean of (b − b′)²/(b + b′) over pairs of neighbours on opposite sides of it,
/// across, along and on both diagonals, as far as there are; in a corner, over the two that are beside it.
fn differences([rows, n]: [usize; 2], brightness: &[f32]) -> Vec<f64> {
    let at = |i: usize, j: usize| f64::from(brightness[i * n + j]);
    let pair = |x: f64, y: f64| if x + y > 0.0 { (x - y) * (x - y) / (x + y) } else { 0.0 };
    let mut error = Vec::with_capacity(rows * n);
    for i in 0..rows {
        for j in 0..n {
            let (inner_row, inner_column) = (i > 0 && i + 1 < rows, j > 0 && j + 1 < n);
            let (mut sum, mut pairs) = (0.0, 0.0);
            if inner_row {
                sum += pair(at(i - 1, j), at(i + 1, j));
                pairs += 1.0;
            }
            if inner_column {
                sum += pair(at(i, j - 1), at(i, j + 1));
                pairs += 1.0;
            }
            if inner_row && inner_column {
                sum += pair(at(i - 1, j - 1), at(i + 1, j + 1)) + pair(at(i - 1, j + 1), at(i + 1, j - 1));
                pairs += 2.0;
            }
            if pairs == 0.0 {
                let (beside, above) = (if j == 0 { 1 } else { n - 2 }, if i == 0 { 1 } else { rows - 2 });
                sum += pair(at(i, beside), at(above, j));
                pairs = 1.0;
            }
            error.push(sum / pairs);
        }
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::Stream;

    #[test]
    fn the_budget_has_a_threshold() {
        assert_eq!(budget(127, 1.0, 32), 0);
        assert_eq!(budget(128, 1.0, 32), 128);
        assert_eq!(budget(256, 0.5, 32), 128);
        assert_eq!(budget(1000, 1.0, 7), 0);
        assert_eq!(budget(-5, 1.0, 8), 0);
    }

    #[test]
    fn uniform_hemispheres_need_no_extra_samples() {
        assert!(allocate([8, 8], &[3.0; 64], 64, |_| 0.5).iter().all(|&c| c == 0));
        assert!(allocate([8, 8], &[0.0; 64], 64, |_| 0.5).iter().all(|&c| c == 0));
    }

    #[test]
    fn what_a_cell_found_has_no_say_in_its_own_share() {
        let random = |c: usize| (c as f64 * 0.754_877_666).fract();
        let brightness: Vec<f32> = (0..64).map(|c| random(c) as f32).collect();
        for c in 0..64 {
            let other: Vec<f32> = (0..64).map(|k| if k == c { 50.0 } else { brightness[k] }).collect();
            let (before, after) = (differences([8, 8], &brightness), differences([8, 8], &other));
            assert_eq!(before[c], after[c], "cell {c}");
            assert!((0..64).any(|k| after[k] > before[k] + 1.0), "its neighbours are looked at");
        }
    }

    /// The mean over many hemispheres of what lone bright samples bring, with extra ones, over the true mean.
    fn mean_of_rare_samples(size: [usize; 2], budget: usize) -> f64 {
        const HEMISPHERES: u32 = 20_000;
        const BRIGHT: f64 = 0.02;
        // So light that none of the bright ones glares.
        const DARK: f32 = 0.1;
        let cells = size[0] * size[1];
        let mut sum = 0.0;
        for k in 0..HEMISPHERES {
            let sample = |cell: usize, n: u32| {
                if Stream::new(k, (cell as u64) << 16 | u64::from(n)).one() < BRIGHT { 1.0 } else { DARK }
            };
            let first: Vec<f32> = (0..cells).map(|cell| sample(cell, 0)).collect();
            let extra = allocate(size, &first, budget, |cell| Stream::new(k, 1 << 40 | cell as u64).one());
            let refined =
                |cell: usize| (0..=extra[cell]).map(|n| sample(cell, n)).sum::<f32>() / (extra[cell] + 1) as f32;
            sum += (0..cells).map(|cell| f64::from(refined(cell))).sum::<f64>();
        }
        let mean = sum / (f64::from(HEMISPHERES) * cells as f64);
        (mean - f64::from(DARK)) / (BRIGHT * f64::from(1.0 - DARK))
    }

    #[test]
    fn rare_bright_samples_are_not_watered_down() {
        for (size, budget) in [([16, 16], 128), ([9, 28], 64)] {
            let mean = mean_of_rare_samples(size, budget);
            // A hundred thousand bright first samples: a standard error of .32 %.
            assert!((mean - 1.0).abs() < 0.01, "{size:?}: {mean}");
        }
    }

    #[test]
    fn a_glaring_cell_is_looked_at_itself() {
        let counts = |bright: f32| {
            let brightness: Vec<f32> = (0..256).map(|c| if c == 100 { bright } else { 1.0 }).collect();
            allocate([16, 16], &brightness, 128, |c| (c as f64 * 0.618).fract())
        };
        assert_eq!(counts(60.0)[100], 0, "less than a fifth of all");
        let glared = counts(70.0);
        assert!(glared[100] > 128 / 4, "{glared:?}");
        assert!(
            [83, 84, 85, 99, 101, 115, 116, 117].iter().all(|&c| glared[c] > 0),
            "so are its neighbours: {glared:?}"
        );
    }

    #[test]
    fn samples_gather_at_an_edge_and_the_budget_is_kept() {
        let brightness: Vec<f32> = (0..256).map(|c| if c % 16 < 8 { 1.0 } else { 0.1 }).collect();
        let counts = allocate([16, 16], &brightness, 256, |c| (c as f64 * 0.618).fract());
        let total: u32 = counts.iter().sum();
        assert!((250..=256).contains(&total), "{total}");
        let edge: u32 = (0..16).map(|i| counts[i * 16 + 7] + counts[i * 16 + 8]).sum();
        assert!(edge > total * 7 / 10, "{edge} of {total}");
        assert_eq!((0..16).map(|i| counts[i * 16] + counts[i * 16 + 15]).sum::<u32>(), 0);
    }
}
