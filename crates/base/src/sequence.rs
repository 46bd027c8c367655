//! Random numbers as pure functions of what is sampled: hash-based Owen scrambling of the Sobol' sequence
//! (Burley 2020, *Practical Hash-based Owen Scrambling*; Laine & Karras 2011). Successive indices of one key fill the
//! strata of every dyadic partition, different keys are independent, and no number depends on thread, time or order.

use crate::hash::mix;

/// A stream of random numbers: sample `index` of the point set named by `key`.
///
/// Neighbouring pixels, or the samples of one hemisphere, share a key and have successive indices, so they stratify
/// every dimension together. An uncorrelated stream hashes the index away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    index: u32,
    key: u64,
}

impl Stream {
    /// Sample `index` of the point set `key`.
    pub const fn new(index: u32, key: u64) -> Self {
        Self { index, key }
    }

    /// An uncorrelated stream: nothing is stratified across successive indices.
    pub fn uncorrelated(index: u32, key: u64) -> Self {
        Self { index: 0, key: mix(key, index as u64) }
    }

    /// Another set of dimensions for the same sample: `tag` names what is sampled (a source's part, a lobe, an event).
    #[inline]
    pub fn child(self, tag: u64) -> Self {
        Self { index: self.index, key: mix(self.key, tag) }
    }

    /// Sample `index` of a point set of this sample's own, named by `tag`.
    #[inline]
    pub fn split(self, tag: u64, index: u32) -> Self {
        Self { index, key: mix(mix(self.key, self.index as u64), tag) }
    }

    /// The key, for mixing into further hashes.
    pub fn key(self) -> u64 {
        self.key
    }

    /// The index within the point set.
    pub fn index(self) -> u32 {
        self.index
    }

    /// A number in [0, 1), stratified over successive indices.
    #[inline]
    pub fn one(self) -> f64 {
        let i = scramble(self.index, self.key as u32);
        unit(scramble(i.reverse_bits(), (self.key >> 32) as u32))
    }

    /// Two numbers in [0, 1), stratified jointly over successive indices.
    #[inline]
    pub fn two(self) -> [f64; 2] {
        let seeds = mix(self.key, 0x51ed_270b);
        let i = scramble(self.index, self.key as u32);
        [unit(scramble(i.reverse_bits(), (self.key >> 32) as u32)), unit(scramble(sobol_second(i), seeds as u32))]
    }

    /// Three numbers in [0, 1): a stratified pair and a stratified single.
    pub fn three(self) -> [f64; 3] {
        let [a, b] = self.two();
        [a, b, self.child(0x3d).one()]
    }
}

/// Nested uniform scramble in base 2 (Laine–Karras hash on the reversed bits).
#[inline]
fn scramble(x: u32, seed: u32) -> u32 {
    let mut v = x.reverse_bits().wrapping_add(seed);
    v ^= v.wrapping_mul(0x6c50_b47c);
    v ^= v.wrapping_mul(0xb82f_1e52);
    v ^= v.wrapping_mul(0xc7af_e638);
    v ^= v.wrapping_mul(0x8d22_f6e6);
    v.reverse_bits()
}

/// The second dimension of the Sobol' sequence: Pascal's triangle modulo 2 applied to the index, lowest bit first.
///
/// With the bits as coefficients of a polynomial in t this is the substitution t → 1 + t, one power t^2ᵐ at a time
/// (Ahmed 2024, *An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact*).
#[inline]
fn sobol_second(i: u32) -> u32 {
    let mut v = i;
    v ^= v >> 16;
    v ^= (v & 0xff00_ff00) >> 8;
    v ^= (v & 0xf0f0_f0f0) >> 4;
    v ^= (v & 0xcccc_cccc) >> 2;
    v ^= (v & 0xaaaa_aaaa) >> 1;
    v.reverse_bits()
}

#[inline]
fn unit(x: u32) -> f64 {
    x as f64 * (1.0 / 4_294_967_296.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aligned_runs_fill_every_elementary_interval_once() {
        for key in [1u64, 77, 0xdead_beef_0123] {
            for run in [0u32, 256, 4096] {
                for bits in 0..=8u32 {
                    let (nx, ny) = (1usize << bits, 1usize << (8 - bits));
                    let mut seen = vec![false; nx * ny];
                    for i in run..run + 256 {
                        let [x, y] = Stream::new(i, key).two();
                        let cell = (x * nx as f64) as usize * ny + (y * ny as f64) as usize;
                        assert!(!seen[cell], "key {key} run {run} bits {bits}");
                        seen[cell] = true;
                    }
                }
            }
        }
    }

    #[test]
    fn the_second_dimension_is_pascals_triangle() {
        let slowly = |mut i: u32| {
            let (mut direction, mut r) = (1u32 << 31, 0);
            while i != 0 {
                r ^= if i & 1 == 0 { 0 } else { direction };
                direction ^= direction >> 1;
                i >>= 1;
            }
            r
        };
        for k in 0..32 {
            assert_eq!(sobol_second(1 << k), slowly(1 << k));
        }
        for k in 0..10_000u64 {
            let i = mix(k, 3) as u32;
            assert_eq!(sobol_second(i), slowly(i));
        }
    }

    #[test]
    fn different_keys_are_uncorrelated() {
        let n = 4096;
        let mean = (0..n)
            .map(|i| {
                let s = Stream::new(i, 5);
                (s.child(1).one() - 0.5) * (s.child(2).one() - 0.5)
            })
            .sum::<f64>()
            / n as f64;
        // The standard deviation of the mean of independent products is 1/(12 √n).
        assert!(mean.abs() < 4.0 / (12.0 * f64::from(n).sqrt()), "{mean}");
    }
}
