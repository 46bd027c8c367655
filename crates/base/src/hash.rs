//! Integer hashes that key random streams by what is being sampled, never by time, thread or order.

use glam::DVec3;

/// Mixes two 64-bit words into one (the finaliser of `SplitMix64` over their combination).
#[inline]
pub fn mix(a: u64, b: u64) -> u64 {
    let mut z = a.rotate_left(23) ^ b.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x632b_e59b_d9b4_e019);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Hashes a sequence of words.
pub fn hash_bits(words: &[u64]) -> u64 {
    words.iter().fold(0x2545_f491_4f6c_dd1d, |h, &w| mix(h, w))
}

/// Hashes the bits of a position or direction; −0 and +0 hash alike.
pub fn hash_point(p: DVec3) -> u64 {
    hash_bits(&[(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits(), (p.z + 0.0).to_bits()])
}
