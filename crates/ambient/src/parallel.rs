//! Parallel steps whose results do not depend on the number of threads: collected by index, never reduced.

use rayon::prelude::*;

/// `f(0), f(1), … f(count − 1)`, in parallel from `least` on in pieces of at least `piece`.
pub(crate) fn in_order<R: Send>(
    count: usize,
    least: usize,
    piece: usize,
    f: impl Fn(usize) -> R + Sync + Send,
) -> Vec<R> {
    if count < least {
        (0..count).map(f).collect()
    } else {
        (0..count).into_par_iter().with_min_len(piece).map(f).collect()
    }
}
