//! First samples of neighbouring cells kept apart: the mesh between them divides by areas and edge lengths.

use crate::hemisphere::{cell_point, in_cell, tag};
use ambit_base::{Stream, square_to_disk};
use std::f64::consts::PI;

/// Rejected points that wait to be used elsewhere, so that the density stays uniform over all.
const POOL: usize = 64;
/// Trades before giving up.
const TRIES: u32 = 20;
/// Least distance on the disk over the side of a cell.
const LEAST: f64 = 0.2;
/// The part of the cell the last resort is taken from.
const CENTRE: f64 = 0.6;

/// One point of the unit disk a cell, at least 0.2 of a cell's side from those of the eight neighbours.
pub(crate) fn separated(side: u32, stream: Stream) -> Vec<[f64; 2]> {
    let n = side as usize;
    let mut disk = vec![[0.0; 2]; n * n];
    let mut pool = [[f64::NAN; 2]; POOL];
    let least = LEAST * PI.sqrt() / f64::from(side);
    let mut trades = 0;
    for cell in (0..n * n).rev() {
        let mut point = cell_point(side, cell, stream);
        let mut tries = 0;
        disk[cell] = loop {
            let [p, q] = square_to_disk(point[0], point[1]);
            if tries > TRIES || is_clear(&disk, n, cell, [p, q], least) {
                break [p, q];
            }
            let chance = stream.split(tag::TRADE, trades);
            trades += 1;
            tries += 1;
            point = if tries > TRIES {
                let [s, t] = chance.two();
                let central = |x: f64| 0.5 + CENTRE * (x - 0.5);
                in_cell(side, cell, central(s), central(t))
            } else {
                let slot = (chance.one() * POOL as f64) as usize;
                let fresh = || stream.split(tag::POOL, slot as u32).two();
                let [s, t] = if pool[slot][0].is_nan() { fresh() } else { pool[slot] };
                pool[slot] = within_cell(side, cell, point);
                in_cell(side, cell, s, t)
            };
        };
    }
    disk
}

/// The position of a point of the square within its cell, the inverse of [`in_cell`].
fn within_cell(side: u32, cell: usize, [x, y]: [f64; 2]) -> [f64; 2] {
    let n = f64::from(side);
    let (row, column) = (cell as u32 / side, cell as u32 % side);
    [(y * n - f64::from(row)).clamp(0.0, 1.0), (x * n - f64::from(column)).clamp(0.0, 1.0)]
}

/// True if no neighbour drawn already (all later cells) is nearer than `least`.
fn is_clear(disk: &[[f64; 2]], n: usize, cell: usize, [p, q]: [f64; 2], least: f64) -> bool {
    let (row, column) = (cell / n, cell % n);
    let far = |row: usize, column: usize| {
        let [a, b] = disk[row * n + column];
        (a - p).powi(2) + (b - q).powi(2) >= least * least
    };
    let right = column + 1 < n;
    let below = row + 1 < n;
    !(right && !far(row, column + 1)
        || below && column > 0 && !far(row + 1, column - 1)
        || below && !far(row + 1, column)
        || below && right && !far(row + 1, column + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::disk_to_square;

    #[test]
    fn neighbours_stay_apart_and_cells_stay_uniform() {
        let side = 16u32;
        let n = side as usize;
        let least = LEAST * PI.sqrt() / f64::from(side);
        let mut histogram = [0.0; 4];
        let mut close = 0;
        for key in 0..50 {
            let disk = separated(side, Stream::new(0, key));
            let points: Vec<_> = disk.iter().map(|p| disk_to_square(p[0], p[1])).collect();
            for cell in 0..n * n {
                assert!(within_cell(side, cell, points[cell]).iter().all(|x| (0.0..=1.0).contains(x)));
                assert_eq!((points[cell][0] * 16.0) as usize, cell % n);
                assert_eq!((points[cell][1] * 16.0) as usize, cell / n);
                close += usize::from(!is_clear(&disk, n, cell, disk[cell], least));
                let [s, t] = within_cell(side, cell, points[cell]);
                histogram[usize::from(s > 0.5) * 2 + usize::from(t > 0.5)] += 1.0 / (50.0 * 256.0);
            }
        }
        assert_eq!(close, 0);
        // Each quarter of a cell gets a quarter of the points; the standard deviation is 0.0038.
        assert!(histogram.iter().all(|h: &f64| (h - 0.25).abs() < 0.015), "{histogram:?}");
    }
}
