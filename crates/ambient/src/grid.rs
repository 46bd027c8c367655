//! How a hemisphere is divided into cells of equal projected solid angle: an n × n grid mapped to the disk (Shirley & Chiu
//! 1997), or the rings and sectors that the classical gradient formulas are written for (Ward & Heckbert 1992).

use crate::corral::border;
use crate::hemisphere::in_cell;
use ambit_base::square_to_disk;
use std::f64::consts::{PI, TAU};

/// Fewest rings of a polar grid (27 samples).
const MIN_RINGS: f64 = 3.0;
/// Most rings: beyond it memory, not noise, is what grows.
const MAX_RINGS: f64 = 2048.0;
/// The sine of the angle to the normal within which lies the ceiling of a polar grid: a quarter of all cells.
const CEILING: f64 = 0.5;

/// The cells of a hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Grid {
    /// `side × side` cells, row by row.
    Disk { side: u32 },
    /// Rings from the normal outwards, each of as many sectors.
    Polar { rings: u32, sectors: u32 },
}

impl Grid {
    /// About `samples` cells in rings and sectors, nearly square.
    pub(crate) fn polar(samples: f64) -> Self {
        let rings = ((samples / PI).sqrt() + 0.5).floor().clamp(MIN_RINGS, MAX_RINGS);
        Self::Polar { rings: rings as u32, sectors: (PI * rings + 0.5) as u32 }
    }

    /// Cells one after the other, in so many rows.
    pub(crate) fn rows(self) -> usize {
        match self {
            Self::Disk { side } => side as usize,
            Self::Polar { rings, .. } => rings as usize,
        }
    }

    /// Cells of a row.
    pub(crate) fn columns(self) -> usize {
        match self {
            Self::Disk { side } => side as usize,
            Self::Polar { sectors, .. } => sectors as usize,
        }
    }

    /// All cells.
    pub(crate) fn len(self) -> usize {
        self.rows() * self.columns()
    }

    /// The side of a square grid of as many cells.
    pub(crate) fn side(self) -> usize {
        match self {
            Self::Disk { side } => side as usize,
            Self::Polar { .. } => self.len().isqrt(),
        }
    }

    /// The point of the unit disk that (s, t) in the unit square stands for in a cell.
    pub(crate) fn point(self, cell: usize, [s, t]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Disk { side } => {
                let [x, y] = in_cell(side, cell, s, t);
                square_to_disk(x, y)
            }
            Self::Polar { rings, sectors } => {
                let (ring, sector) = (cell / sectors as usize, cell % sectors as usize);
                let radius = ((ring as f64 + s) / f64::from(rings)).sqrt();
                let (sin, cos) = (TAU * (sector as f64 + t) / f64::from(sectors)).sin_cos();
                [radius * cos, radius * sin]
            }
        }
    }

    /// The cells next to the horizon.
    pub(crate) fn border(self) -> Vec<usize> {
        match self {
            Self::Disk { side } => border(side as usize).collect(),
            Self::Polar { .. } => (self.len() - self.columns()..self.len()).collect(),
        }
    }

    /// The cells overhead, about a quarter of all.
    pub(crate) fn ceiling(self) -> Vec<usize> {
        match self {
            Self::Disk { side } => {
                let n = side as usize;
                let (from, to) = (n / 4, n - n / 4);
                (from..to).flat_map(|i| (i * n + from)..(i * n + to)).collect()
            }
            Self::Polar { rings, sectors } => {
                let inner = ((f64::from(rings) * CEILING * CEILING).round() as usize).max(1);
                (0..inner * sectors as usize).collect()
            }
        }
    }

    /// Half the azimuth that a cell of the border covers, radians.
    pub(crate) fn spread(self) -> f64 {
        match self {
            Self::Disk { side } => PI / (2.0 * f64::from(side)),
            Self::Polar { sectors, .. } => PI / f64::from(sectors),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polar_grids_have_the_classical_numbers() {
        for (samples, rings, sectors) in [(1.0, 3, 9), (256.0, 9, 28), (512.0, 13, 41), (1024.0, 18, 57)] {
            assert_eq!(Grid::polar(samples), Grid::Polar { rings, sectors }, "{samples}");
        }
    }

    #[test]
    fn polar_cells_have_equal_areas_in_order() {
        let grid = Grid::Polar { rings: 4, sectors: 8 };
        for cell in 0..grid.len() {
            let [p, q] = grid.point(cell, [0.5, 0.5]);
            assert_eq!(((p * p + q * q) * 4.0) as usize, cell / 8);
            assert_eq!((q.atan2(p).rem_euclid(TAU) / TAU * 8.0) as usize, cell % 8);
        }
        assert_eq!(grid.border(), (24..32).collect::<Vec<_>>());
        assert_eq!(grid.ceiling(), (0..8).collect::<Vec<_>>());
    }
}
