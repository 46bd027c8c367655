//! What is compared: pictures and rows of sensors, and how they are divided into blocks.
//!
//! Neighbouring pixels share records and so err alike; resampling single pixels would promise bounds that are too
//! narrow. Blocks of neighbours are resampled whole (Künsch 1989, *The jackknife and the bootstrap for general stationary
//! observations*).

use serde::{Deserialize, Serialize};

/// Blocks along each side of a picture.
const TILES: u32 = 8;

/// Blocks of a row of sensors.
const RUNS: u32 = 32;

/// A picture, or sensors in a row (of height 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Pixels in x, or the number of sensors.
    pub width: u32,
    /// Pixels in y, or 1.
    pub height: u32,
}

impl Part {
    /// Values of three channels in it.
    pub fn len(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Whether it holds nothing.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Blocks along x and y.
    fn tiles(self) -> [u32; 2] {
        let most = if self.height == 1 { RUNS } else { TILES };
        [self.width.min(most), self.height.min(most)]
    }

    /// How many blocks there are.
    pub fn blocks(self) -> usize {
        let [x, y] = self.tiles();
        x as usize * y as usize
    }

    /// The block of a value.
    pub fn block(self, index: usize) -> usize {
        let (x, y) = (index as u64 % self.width as u64, index as u64 / self.width as u64);
        let [across, up] = self.tiles();
        let (i, j) = (x * across as u64 / self.width as u64, y * up as u64 / self.height as u64);
        (j * across as u64 + i) as usize
    }
}

/// Means over cells of `side` × `side` pixels, each channel by itself; the last cells of rows and columns may be smaller.
/// Sensors (parts of height 1) stay as they are.
pub fn cells(part: Part, values: &[[f32; 3]], side: u32) -> (Part, Vec<[f32; 3]>) {
    if side <= 1 || part.height == 1 {
        return (part, values.to_vec());
    }
    let small = Part { width: part.width.div_ceil(side), height: part.height.div_ceil(side) };
    let mut sums = vec![([0.0_f64; 3], 0.0_f64); small.len()];
    for (i, value) in values.iter().enumerate() {
        let (x, y) = (i as u32 % part.width / side, i as u32 / part.width / side);
        let (sum, count) = &mut sums[(y * small.width + x) as usize];
        sum.iter_mut().zip(value).for_each(|(s, v)| *s += *v as f64);
        *count += 1.0;
    }
    (small, sums.into_iter().map(|(sum, count)| sum.map(|s| (s / count) as f32)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_tiles_of_nearly_equal_size() {
        for part in [Part { width: 100, height: 37 }, Part { width: 3, height: 9 }, Part { width: 70, height: 1 }] {
            let mut count = vec![0; part.blocks()];
            (0..part.len()).for_each(|i| count[part.block(i)] += 1);
            let (least, most) = (*count.iter().min().unwrap(), *count.iter().max().unwrap());
            assert!(least > 0 && most <= 4 * least, "{part:?}: {count:?}");
        }
        assert_eq!(Part { width: 16, height: 16 }.block(16 * 16 - 1), 63);
        assert_eq!(Part { width: 16, height: 16 }.block(2), 1);
    }

    #[test]
    fn cells_keep_the_mean() {
        let part = Part { width: 5, height: 3 };
        let values: Vec<[f32; 3]> = (0..15).map(|i| [i as f32, 0.0, 1.0]).collect();
        let (small, means) = cells(part, &values, 2);
        assert_eq!(small, Part { width: 3, height: 2 });
        assert_eq!(means[0], [3.0, 0.0, 1.0]);
        assert_eq!(means[5], [14.0, 0.0, 1.0]);
        let sensors = Part { width: 15, height: 1 };
        assert_eq!(cells(sensors, &values, 2).1, values);
    }
}
