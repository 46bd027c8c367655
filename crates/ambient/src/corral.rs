//! Azimuths in which something stands nearer than the record reaches: 32 bits, for which look-ups trace a short ray.

use crate::grid::Grid;
use crate::lookup::sector_of_angle;
use ambit_base::{DVec3, EPSILON};

/// Sides of the grid below which the border is too coarse to tell azimuths.
const MIN_SIDE: usize = 8;
/// Share of the cells overhead that must see something within reach in a crevice, where probes would all be stopped.
/// Radiance asks for the mean nearness, which a wall beside the point is enough for; a wall fills at most half of the cells,
/// a corner three quarters.
const CREVICE: f64 = 0.9;

/// The bits of a record: `point` gives the sample directions in the frame (tangential components suffice), `nearness`
/// the reciprocal distances of the closest sample of each cell; `reach` are the radii along the axes turned by `turn`,
/// times the tolerance, and `smoothing` how much farther the record counts.
///
/// Radiance skips occluders nearer than R₋a + 0.001, since its probe would reject the record at its own place; the
/// look-up here accepts coincident queries without a probe, so the nearest occluders count too.
pub(crate) fn corral(
    grid: Grid,
    point: impl Fn(usize) -> DVec3,
    nearness: impl Fn(usize) -> f64,
    reach: [f64; 2],
    smoothing: f64,
    turn: f64,
) -> u32 {
    if grid.side() < MIN_SIDE {
        return 0;
    }
    let ceiling = grid.ceiling();
    let low = ceiling.iter().filter(|&&c| nearness(c) * reach[0] >= 1.0).count();
    if low as f64 > CREVICE * ceiling.len() as f64 {
        return 0;
    }
    let spread = grid.spread();
    let mut bits = 0u32;
    for cell in grid.border() {
        let (near, p) = (nearness(cell), point(cell));
        let flat = p.x.hypot(p.y);
        if near <= EPSILON || flat == 0.0 {
            continue;
        }
        let azimuth = p.y.atan2(p.x) - turn;
        let (s, c) = azimuth.sin_cos();
        if near * smoothing * (reach[0] * c).hypot(reach[1] * s) > 1.0 {
            let (first, last) = (sector_of_angle(azimuth - spread), sector_of_angle(azimuth + spread));
            let mut k = first;
            bits |= 1 << k;
            while k != last {
                k = (k + 1) & 31;
                bits |= 1 << k;
            }
        }
    }
    bits
}

/// The cells on the border of the grid.
pub(crate) fn border(n: usize) -> impl Iterator<Item = usize> {
    let rows = (0..n).flat_map(move |j| [j, (n - 1) * n + j]);
    let columns = (1..n - 1).flat_map(move |i| [i * n, i * n + n - 1]);
    rows.chain(columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_wall_on_one_side_sets_the_bits_of_that_side() {
        let n = 32;
        let points: Vec<DVec3> = (0..n * n)
            .map(|c| {
                let [p, q] =
                    ambit_base::square_to_disk(((c % n) as f64 + 0.5) / n as f64, ((c / n) as f64 + 0.5) / n as f64);
                DVec3::new(p, q, (1.0 - p * p - q * q).sqrt())
            })
            .collect();
        // A wall at x = 0.1: distance 0.1/p where p > 0.
        let nearness: Vec<f64> = points.iter().map(|p| (p.x / 0.1).max(0.0)).collect();
        let bits = corral(Grid::Disk { side: 32 }, |c| points[c], |c| nearness[c], [0.2, 0.2], 1.0, 0.0);
        // cos φ > 0.1/0.2, so azimuths within ±60°: sectors 27…31 and 0…5, those at the ends cut by the border's tilt.
        for k in [0, 1, 2, 3, 28, 29, 30, 31] {
            assert!(bits >> k & 1 == 1, "sector {k} of {bits:032b}");
        }
        for k in 7..25 {
            assert!(bits >> k & 1 == 0, "sector {k} of {bits:032b}");
        }
        // Turned axes: the wall moves from azimuth 0 to −90°.
        let turned = corral(Grid::Disk { side: 32 }, |c| points[c], |c| nearness[c], [0.2, 0.2], 1.0, PI / 2.0);
        assert_eq!(turned, bits.rotate_right(8));
        assert_eq!(corral(Grid::Disk { side: 32 }, |c| points[c], |c| nearness[c], [0.01, 0.01], 1.0, 0.0), 0);
        // Records that smooth look a little farther.
        let wide =
            |smoothing| corral(Grid::Disk { side: 32 }, |c| points[c], |c| nearness[c], [0.09, 0.09], smoothing, 0.0);
        assert!(wide(1.0) == 0 && wide(1.25) & 1 == 1);
        let ceiling = vec![100.0; n * n];
        assert_eq!(corral(Grid::Disk { side: 32 }, |c| points[c], |c| ceiling[c], [0.2, 0.2], 1.0, 0.0), 0);
    }

    #[test]
    fn the_border_has_every_cell_once() {
        let mut cells: Vec<usize> = border(8).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 28);
    }
}
