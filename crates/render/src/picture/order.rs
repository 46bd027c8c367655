//! Orders of pixels: along a Hilbert curve for numbering samples, coarse to fine for tracing them, and the growing
//! batches in which they are traced.

/// Largest batch. Batches depend on counts alone, so that results do not depend on threads or timing.
const LARGEST_BATCH: usize = 4096;

/// The position of pixel (x, y) along the Hilbert curve over the smallest square of 2ⁿ pixels that holds a picture of
/// the given size: neighbours in the picture have near numbers (Skilling 2004, *Programming the Hilbert curve*, in the
/// iterative form for two dimensions).
pub fn hilbert_index(x: u32, y: u32, width: u32, height: u32) -> u32 {
    let bits = bits(width.max(height));
    let (mut x, mut y) = (x, y);
    let mut index = 0u32;
    for bit in (0..bits).rev() {
        let (right, up) = ((x >> bit) & 1, (y >> bit) & 1);
        index = (index << 2) | ((3 * right) ^ up);
        // Turn the quadrant so that its curve runs as the whole one does.
        if up == 0 {
            let mask = (1 << bit) - 1;
            if right == 1 {
                (x, y) = (!x & mask, !y & mask);
            }
            (x, y) = (y, x);
        }
    }
    index
}

/// The places of a grid from coarse to fine: by bit-reversed Morton code, every prefix is spread over the whole grid.
pub(crate) fn coarse_to_fine(width: u32, height: u32) -> Vec<(u32, u32)> {
    let bits = bits(width.max(height)).max(1);
    let mut places: Vec<(u32, u32, u32)> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (((spread(y) << 1) | spread(x)).reverse_bits() >> (32 - 2 * bits), x, y)))
        .collect();
    places.sort_unstable();
    places.into_iter().map(|(_, x, y)| (x, y)).collect()
}

/// How many bits number `n` things; at most 16, as pictures are smaller than 65536 pixels across.
fn bits(n: u32) -> u32 {
    n.max(1).next_power_of_two().trailing_zeros().min(16)
}

/// Puts a zero bit before each of the low 16 bits.
fn spread(v: u32) -> u32 {
    let v = (v | (v << 8)) & 0x00ff_00ff;
    let v = (v | (v << 4)) & 0x0f0f_0f0f;
    let v = (v | (v << 2)) & 0x3333_3333;
    (v | (v << 1)) & 0x5555_5555
}

/// Sizes of batches: 1, 1, 2, 4, … 4096, 4096, …, so that a cache fills from a few well-spread samples first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Batches {
    done: usize,
}

impl Batches {
    /// The next size if there are `left` things to do.
    pub fn next(&mut self, left: usize) -> usize {
        let size = self.done.clamp(1, LARGEST_BATCH).min(left);
        self.done += size;
        size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_pixel_and_steps_to_neighbours() {
        let mut at = vec![None; 64];
        for y in 0..8 {
            for x in 0..8 {
                assert!(at[hilbert_index(x, y, 8, 5) as usize].replace((x as i32, y as i32)).is_none());
            }
        }
        for pair in at.windows(2) {
            let ((a, b), (c, d)) = (pair[0].unwrap(), pair[1].unwrap());
            assert_eq!((a - c).abs() + (b - d).abs(), 1);
        }
        assert!(hilbert_index(65535, 65535, 65536, 65536) < u32::MAX);
        assert_eq!(hilbert_index(0, 0, 1, 1), 0);
    }

    #[test]
    fn coarse_to_fine_starts_with_the_corners_of_quadrants() {
        let places = coarse_to_fine(8, 8);
        assert_eq!(places.len(), 64);
        let mut first = places[..4].to_vec();
        first.sort_unstable();
        assert_eq!(first, [(0, 0), (0, 4), (4, 0), (4, 4)]);
        assert_eq!(coarse_to_fine(3, 2).len(), 6);
        assert_eq!(coarse_to_fine(1, 1), [(0, 0)]);
    }

    #[test]
    fn batches_double_up_to_the_largest() {
        let mut batches = Batches::default();
        let sizes: Vec<usize> = (0..16).map(|_| batches.next(100_000)).collect();
        assert_eq!(sizes, [1, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 4096, 4096]);
        assert_eq!(batches.next(7), 7);
    }
}
