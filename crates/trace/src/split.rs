//! A small top-down splitter: binned surface area heuristic (Wald 2007) with a split in the middle where centres
//! coincide. It cuts large worlds into portions and takes over where clustering degenerates into chains.

use crate::bounds::Box32;

const BINS: usize = 24;

/// Reorders `indices` and gives the place to cut them, strictly between the ends of two or more.
pub(crate) fn split(indices: &mut [u32], boxes: &impl Fn(u32) -> Box32) -> usize {
    let n = indices.len();
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &i in indices.iter() {
        let b = boxes(i);
        for a in 0..3 {
            low[a] = low[a].min(b.middle(a));
            high[a] = high[a].max(b.middle(a));
        }
    }
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        let Some(bin) = binning(low[axis], high[axis]) else { continue };
        let mut bins = [(Box32::EMPTY, 0usize); BINS];
        for &i in indices.iter() {
            let b = boxes(i);
            let slot = &mut bins[bin(b.middle(axis))];
            slot.0 = slot.0.union(&b);
            slot.1 += 1;
        }
        let mut right = [0.0f32; BINS];
        let (mut all, mut count) = (Box32::EMPTY, 0);
        for k in (1..BINS).rev() {
            all = all.union(&bins[k].0);
            count += bins[k].1;
            right[k] = if count == 0 { 0.0 } else { all.half_area() * count as f32 };
        }
        let (mut all, mut count) = (Box32::EMPTY, 0);
        for k in 1..BINS {
            all = all.union(&bins[k - 1].0);
            count += bins[k - 1].1;
            if count == 0 || count == n {
                continue;
            }
            let cost = all.half_area() * count as f32 + right[k];
            if best.is_none_or(|(c, _, _)| cost < c) {
                best = Some((cost, axis, k));
            }
        }
    }
    let Some((_, axis, cut)) = best else { return n / 2 };
    let Some(bin) = binning(low[axis], high[axis]) else { return n / 2 };
    let mut left = 0;
    for i in 0..n {
        if bin(boxes(indices[i]).middle(axis)) < cut {
            indices.swap(i, left);
            left += 1;
        }
    }
    left
}

/// Which bin a coordinate falls in; none if the range is a point.
fn binning(low: f32, high: f32) -> Option<impl Fn(f32) -> usize> {
    let scale = BINS as f32 / (high - low);
    (high > low && scale.is_finite()).then_some(move |x: f32| (((x - low) * scale) as usize).min(BINS - 1))
}
