//! Where extra samples go: to cells that differ from their neighbours, relative to their sum, blurred so that a lone
//! bright cell shares its samples with those around it.

/// Sides of the grid below which there are no extra samples.
const MIN_SIDE: usize = 8;
/// Extra samples per side of the grid below which there are none.
const MIN_PER_SIDE: usize = 4;

/// The number of extra samples of a hemisphere of side `n`: `-as` times the weight, rounded, 0 where too few to matter.
pub(crate) fn budget(super_samples: i32, weight: f32, n: usize) -> usize {
    let m = (f64::from(super_samples.max(0)) * f64::from(weight) + 0.5) as usize;
    if n >= MIN_SIDE && m >= MIN_PER_SIDE * n { m } else { 0 }
}

/// The number of extra samples of each cell of a grid of `size` rows and columns; `brightness` row by row, `chance` a random
/// number a cell. The last column of rings does not know the first: cells on a border make up for missing neighbours.
pub(crate) fn allocate(size: [usize; 2], brightness: &[f32], budget: usize, chance: impl Fn(usize) -> f64) -> Vec<u32> {
    let mut error = blurred(size, &differences(size, brightness));
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

/// The difference measure: (b − b′)²/(b + b′) over pairs left–right, up–down and along one diagonal, added to both;
/// cells on the border have fewer neighbours and count 6/5, corners 6/3.
fn differences([rows, n]: [usize; 2], brightness: &[f32]) -> Vec<f64> {
    let mut error = vec![0.0; rows * n];
    let mut pair = |a: usize, b: usize| {
        let (x, y) = (f64::from(brightness[a]), f64::from(brightness[b]));
        if x + y > 0.0 {
            let e = (x - y) * (x - y) / (x + y);
            error[a] += e;
            error[b] += e;
        }
    };
    for i in 0..rows {
        for j in 0..n {
            let cell = i * n + j;
            if j > 0 {
                pair(cell, cell - 1);
            }
            if i > 0 {
                pair(cell, cell - n);
            }
            if i > 0 && j > 0 {
                pair(cell, cell - n - 1);
            }
        }
    }
    let outer = |k: usize, of: usize| k == 0 || k == of - 1;
    for i in 0..rows {
        for j in 0..n {
            error[i * n + j] *= match (outer(i, rows), outer(j, n)) {
                (true, true) => 6.0 / 3.0,
                (true, false) | (false, true) => 6.0 / 5.0,
                (false, false) => 1.0,
            };
        }
    }
    error
}

/// Half a cell's own and an eighth of each of the four neighbours'.
fn blurred([rows, n]: [usize; 2], error: &[f64]) -> Vec<f64> {
    let at = |i: Option<usize>, j: Option<usize>| match (i, j) {
        (Some(i), Some(j)) if i < rows && j < n => error[i * n + j],
        _ => 0.0,
    };
    let mut out = Vec::with_capacity(rows * n);
    for i in 0..rows {
        for j in 0..n {
            let around = at(i.checked_sub(1), Some(j))
                + at(Some(i + 1), Some(j))
                + at(Some(i), j.checked_sub(1))
                + at(Some(i), Some(j + 1));
            out.push(0.5 * error[i * n + j] + 0.125 * around);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

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
