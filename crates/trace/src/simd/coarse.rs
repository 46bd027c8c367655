//! The coarse test of a block in f32 ([`crate::block`] has the formulas and their errors), and what waits for the exact one.

use crate::block::{Block, LANES, Slopes};
use ambit_base::EPSILON;
#[allow(clippy::wildcard_imports)]
use std::arch::x86_64::*;
use std::mem::MaybeUninit;

/// A ray as [`coarse`] needs it.
pub(super) struct Line {
    pub(super) origin: [__m256; 3],
    pub(super) direction: [__m256; 3],
    /// How much wider than usual the margins of blocks have to be, because the ray comes from afar.
    pub(super) widening: f32,
    /// How far beyond a hit others still count, for ties and rounding.
    pub(super) beyond: f32,
    /// Surfaces nearer than this that stop shadow rays end the walk, and which lanes count as such in any case.
    pub(super) end: f32,
    pub(super) all: u32,
}

/// What [`coarse`] found.
pub(super) struct Coarse {
    /// Lanes that may be hit.
    pub(super) mask: u32,
    /// A distance that each of them is surely not nearer than.
    pub(super) low: [f32; LANES],
    /// Some lane likely lies ahead, but it is not sure that it is hit.
    pub(super) unsure: bool,
    /// A lane that surely ends the walk.
    pub(super) blocked: Option<usize>,
    /// How far the walk still has to go, for the lanes that are surely hit.
    pub(super) reach: f32,
}

/// Surfaces that may be hit and wait for the exact test, since their tables first have to come from memory.
pub(super) struct Waiting {
    list: [MaybeUninit<(u32, f32)>; WAITING + LANES],
    count: usize,
}

impl Waiting {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { list: [MaybeUninit::uninit(); WAITING + LANES], count: 0 }
    }

    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count > WAITING
    }

    #[inline(always)]
    pub(super) fn push(&mut self, found: &Coarse, place: impl Fn(u32) -> u32) {
        let mut mask = found.mask;
        while mask != 0 {
            let lane = mask.trailing_zeros();
            mask &= mask - 1;
            self.list[self.count].write((place(lane), found.low[lane as usize % LANES]));
            self.count += 1;
        }
    }

    /// Tests what waits and may still matter; `test` gives how far the walk has to go after a hit.
    #[inline(always)]
    pub(super) fn settle(&mut self, mut reach: f32, mut test: impl FnMut(u32) -> Option<f32>) -> f32 {
        for i in 0..self.count {
            // SAFETY: entries below the count have been written.
            let (place, low) = unsafe { self.list[i].assume_init() };
            if low > reach {
                continue;
            }
            if let Some(nearer) = test(place) {
                reach = reach.min(nearer);
            }
        }
        self.count = 0;
        reach
    }
}

/// Surfaces that wait at most, before those of one more leaf.
const WAITING: usize = 8;

/// What a ray may hit in a block no farther than `reach`; see [`crate::block`] for the formulas. What is no number may be
/// hit. None if nothing is.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn coarse(b: &Block, slopes: Option<&Slopes>, line: &Line, reach: f32) -> Option<Coarse> {
    // SAFETY: the array has room for one unaligned vector.
    let load = |a: &[f32; LANES]| unsafe { _mm256_loadu_ps(a.as_ptr()) };
    let vector = |a: &[[f32; LANES]; 3]| [load(&a[0]), load(&a[1]), load(&a[2])];
    let (d, v, e1, e2) = (&line.direction, vector(&b.corner), vector(&b.edges[0]), vector(&b.edges[1]));
    let c: [__m256; 3] = std::array::from_fn(|a| _mm256_sub_ps(v[a], line.origin[a]));
    let cross = |a: &[__m256; 3], b: &[__m256; 3]| {
        let minor = |i: usize, j: usize| _mm256_fmsub_ps(a[i], b[j], _mm256_mul_ps(a[j], b[i]));
        [minor(1, 2), minor(2, 0), minor(0, 1)]
    };
    let dot = |a: &[__m256; 3], b: &[__m256; 3]| {
        _mm256_fmadd_ps(a[0], b[0], _mm256_fmadd_ps(a[1], b[1], _mm256_mul_ps(a[2], b[2])))
    };
    let (r, n) = (cross(&c, d), cross(&e1, &e2));
    let (facing, depth) = (dot(&n, d), dot(&n, &c));
    let minus = _mm256_set1_ps(-0.0);
    let sign = _mm256_and_ps(facing, minus);
    let size = _mm256_andnot_ps(minus, facing);
    let u = _mm256_xor_ps(dot(&r, &e2), sign);
    let w = _mm256_xor_ps(dot(&r, &e1), _mm256_xor_ps(sign, minus));
    let t = _mm256_xor_ps(depth, sign);
    let opposite = match slopes {
        None => _mm256_sub_ps(_mm256_sub_ps(size, u), w),
        Some(s) => _mm256_min_ps(
            _mm256_fmadd_ps(load(&s[0]), w, _mm256_sub_ps(size, u)),
            _mm256_fmadd_ps(load(&s[1]), u, _mm256_sub_ps(size, w)),
        ),
    };
    let least = _mm256_min_ps(_mm256_min_ps(u, w), opposite);
    let margin = _mm256_set1_ps(b.margin * line.widening);
    let deep = _mm256_set1_ps(b.depth * line.widening);
    let (nearest, farthest) = (_mm256_sub_ps(t, deep), _mm256_add_ps(t, deep));
    let inside = _mm256_cmp_ps::<_CMP_NLT_UQ>(least, _mm256_xor_ps(margin, minus));
    let before = _mm256_cmp_ps::<_CMP_NGT_UQ>(nearest, _mm256_mul_ps(size, _mm256_set1_ps(reach)));
    let behind = _mm256_cmp_ps::<_CMP_NLT_UQ>(farthest, _mm256_setzero_ps());
    let mask = _mm256_movemask_ps(_mm256_and_ps(inside, _mm256_and_ps(before, behind))) as u32 & b.used();
    if mask == 0 {
        return None;
    }
    let surely_inside = _mm256_cmp_ps::<_CMP_GT_OQ>(_mm256_min_ps(least, size), margin);
    let surely_ahead = _mm256_cmp_ps::<_CMP_GT_OQ>(nearest, _mm256_mul_ps(size, _mm256_set1_ps(SURELY_AHEAD)));
    let sure = _mm256_and_ps(surely_inside, surely_ahead);
    let low = _mm256_div_ps(nearest, size);
    let high = _mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), _mm256_div_ps(farthest, size), sure);
    let ends = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(high, _mm256_set1_ps(line.end))) as u32;
    let ends = ends & mask & (b.blocks() | line.all);
    let high = _mm_min_ps(_mm256_castps256_ps128(high), _mm256_extractf128_ps::<1>(high));
    let high = _mm_min_ps(high, _mm_movehl_ps(high, high));
    let high = _mm_cvtss_f32(_mm_min_ss(high, _mm_movehdup_ps(high)));
    let mut out = [0.0; LANES];
    // SAFETY: the array has room for one unaligned vector.
    unsafe { _mm256_storeu_ps(out.as_mut_ptr(), low) };
    // Likely beyond the surface that the ray leaves: errors are mostly far below their bound.
    let ahead = _mm256_cmp_ps::<_CMP_GT_OQ>(t, _mm256_mul_ps(deep, _mm256_set1_ps(LIKELY)));
    let (sure, ahead) = (_mm256_movemask_ps(sure) as u32 & mask, _mm256_movemask_ps(ahead) as u32 & mask);
    let unsure = ahead & !sure != 0;
    let blocked = (ends != 0).then(|| ends.trailing_zeros() as usize & 7);
    Some(Coarse { mask, low: out, unsure, blocked, reach: high * (1.0 + 8.0 * f32::EPSILON) + line.beyond })
}

/// Share of the bound of a distance's error that it hardly reaches.
const LIKELY: f32 = 1.0 / 16.0;

/// Surfaces farther than this from the origin are surely beyond ε.
const SURELY_AHEAD: f32 = 2.0 * EPSILON as f32;

#[cfg(test)]
mod tests {
    use super::super::Vector;
    use super::super::present::enter;
    use super::*;
    use crate::facet::{Facet, Facets};
    use crate::frame::Frame;
    use crate::ray::{Opacity, Rank, Ray};
    use crate::search::End;
    use crate::walk::Gate;
    use ambit_base::DVec3;

    struct Rng(u64);

    impl Rng {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn point(&mut self) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
    }

    /// Flat outlines of `K` corners, some slender, some tiny.
    fn facets<const K: usize>(rng: &mut Rng, scale: f64, offset: DVec3) -> Vec<Facet<K>> {
        let mut list = Vec::new();
        while list.len() < 400 {
            let size = scale * 10f64.powf(-3.0 * rng.unit());
            let (v, e1) = (rng.point() * scale + offset, rng.point() * size);
            let e2 = rng.point() * size * if rng.unit() < 0.3 { 1e-3 } else { 1.0 };
            let (a, b) = if rng.unit() < 0.5 { (1.0, 1.0) } else { (0.3 + 2.0 * rng.unit(), 0.3 + 2.0 * rng.unit()) };
            let corners = [v, v + e1, v + e1 * a + e2 * b, v + e2];
            let corners = if K == 3 { vec![corners[0], corners[1], corners[3]] } else { corners.to_vec() };
            let normal = e1.cross(e2).normalize_or_zero();
            let mean = corners.iter().map(|c| normal.dot(*c)).sum::<f64>() / K as f64;
            list.extend(Facet::new(&corners, normal, mean, list.len() as u32, || 0));
        }
        list
    }

    fn what_may_be_hit<const K: usize>(scale: f64, offset: DVec3) -> (usize, usize) {
        let mut rng = Rng(K as u64);
        let list = facets::<K>(&mut rng, scale, offset);
        let frame = Frame::around(list.iter().map(Facet::bounds));
        let gate = Gate::new(frame.bounds, frame.centre);
        let ranks = [Rank { opacity: Opacity::Opaque, modifier: 0, blocks: true, bends: false }];
        let mut all = Facets::<K>::with_capacity(100, 400);
        for some in list.chunks(LANES) {
            all.push(&gate.scale(), &ranks, some.iter().copied());
        }
        let (mut hits, mut sure) = (0, 0);
        for k in 0..60_000 {
            let number = (rng.unit() * list.len() as f64) as usize;
            let (block, lane) = (number / LANES, number % LANES);
            // Towards a corner, an edge, or a point inside, off by a little more or less.
            let corner = |c: usize| {
                let f = &list[number];
                let dropped = crate::polygon::dropped_axis(f.normal);
                crate::polygon::on_plane(f.normal, f.offset, dropped, f.corners[c % K])
            };
            let (u, w) = ([0.0, rng.unit(), rng.unit()][k % 3], if k % 2 == 0 { 0.0 } else { rng.unit() });
            let aim = corner(k)
                + (corner(k + 1) - corner(k)) * u * (1.0 - w)
                + (corner(k + K - 1) - corner(k)) * w * (1.0 - u);
            let aim = aim + rng.point() * 10f64.powf(-12.0 * rng.unit()) * scale;
            let away = if k % 5 == 0 { 1e3 } else { 3.0 * rng.unit() * rng.unit() };
            let direction = rng.point().normalize();
            let ray = Ray::new(aim - direction * away * scale, direction);
            let end = End { before: f64::INFINITY, all: false };
            // SAFETY: the test has found the features.
            let Some((entry, line)) = (unsafe { enter(&gate, &ray, end) }) else { continue };
            let exact = list[number].hit(ray.origin, ray.direction, f64::INFINITY);
            let slopes = all.slopes.get(block);
            // SAFETY: as above.
            let found = unsafe { coarse(&all.blocks[block], slopes, &line, f32::INFINITY) };
            let may = found.as_ref().is_some_and(|f| f.mask >> lane & 1 == 1);
            if let Some(t) = exact {
                hits += 1;
                assert!(may, "{K} {scale} {ray:?}");
                let low = found.as_ref().map_or(0.0, |f| f.low[lane]);
                assert!(low <= entry.reach(t), "{K} {scale} {ray:?} {low} {t}");
                // SAFETY: as above.
                assert!(
                    unsafe { coarse(&all.blocks[block], slopes, &line, entry.reach(t)) }
                        .is_some_and(|f| f.mask >> lane & 1 == 1)
                );
            }
            if let Some(at) = found.and_then(|f| f.blocked) {
                sure += 1;
                let facet = &list[block * LANES + at];
                assert!(facet.hit(ray.origin, ray.direction, f64::INFINITY).is_some(), "{K} {scale} {ray:?}");
            }
        }
        (hits, sure)
    }

    #[test]
    fn what_is_hit_passes_and_what_is_sure_is_hit() {
        if Vector::detect().is_none() {
            return;
        }
        for (scale, offset) in
            [(1.0, DVec3::ZERO), (1e-3, DVec3::ONE), (1e4, DVec3::ZERO), (5.0, DVec3::new(4e6, 5e5, 20.0))]
        {
            let counts = [what_may_be_hit::<3>(scale, offset), what_may_be_hit::<4>(scale, offset)];
            // In a scene of millimetres the tolerance of the exact test is as large as what is tested.
            let least = if scale < 1.0 { 0 } else { 1000 };
            assert!(counts.iter().all(|c| c.0 > 10_000 && c.1 >= least), "{scale}: {counts:?}");
        }
    }
}
