//! The vector versions of the walk and of the leaf tests, for processors with AVX2 and FMA; chosen at run time.
//!
//! The leaf tests do the same operations in the same order as their scalar twins, without fused multiplication, so
//! their results are the same bits. The walk may differ in rounding, which only changes what is culled, never a hit.
#![allow(unsafe_code)]

/// Proof that the processor has what this module needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vector(());

#[cfg(not(target_arch = "x86_64"))]
mod absent {
    use super::Vector;
    use crate::mesh::MeshSearch;
    use crate::search::Search;

    impl Vector {
        pub(crate) fn detect() -> Option<Self> {
            None
        }

        pub(crate) fn search(self, _: &mut Search<'_>) {}

        pub(crate) fn search_mesh(self, _: &mut MeshSearch<'_>) {}
    }
}

#[cfg(target_arch = "x86_64")]
mod present {
    use super::Vector;
    use crate::facet::{Facets, LANES, Lanes};
    use crate::mesh::MeshSearch;
    use crate::node::{self, LEAF, Node, QUADS, TRIANGLES};
    use crate::search::Search;
    use crate::trio::{Shear, Trios, UNSURE};
    use crate::walk::{DEEP_STACK, Entry, STACK};
    use ambit_base::{DVec3, EPSILON};
    #[allow(clippy::wildcard_imports)]
    use std::arch::x86_64::*;
    use std::mem::MaybeUninit;

    type Four = __m256d;

    impl Vector {
        pub(crate) fn detect() -> Option<Self> {
            (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Self(()))
        }

        /// Runs a search through a world.
        #[allow(clippy::unused_self)]
        #[inline]
        pub(crate) fn search(self, search: &mut Search<'_>) {
            // SAFETY: a `Vector` exists only if `detect` found AVX2 and FMA.
            unsafe { if search.world.deep { world::<DEEP_STACK>(search) } else { world::<STACK>(search) } }
        }

        /// Runs a search through a mesh.
        #[allow(clippy::unused_self)]
        #[inline]
        pub(crate) fn search_mesh(self, search: &mut MeshSearch<'_>) {
            // SAFETY: a `Vector` exists only if `detect` found AVX2 and FMA.
            unsafe { if search.mesh.deep { mesh::<DEEP_STACK>(search) } else { mesh::<STACK>(search) } }
        }
    }

    #[target_feature(enable = "avx2,fma")]
    fn world<const N: usize>(s: &mut Search<'_>) {
        let Some(entry) = s.entry else { return };
        let w = s.world;
        let (o, d) = (s.ray.origin, s.ray.direction);
        let (of, df) = (splat(o), splat(d));
        let fetch = |word: u32| {
            if word & LEAF == 0 {
                prefetch::<4, _>(&w.nodes, word as usize);
            } else if node::kind(word) == TRIANGLES {
                prefetch::<6, _>(&w.triangles, node::index(word));
            } else if node::kind(word) == QUADS {
                prefetch::<7, _>(&w.quads, node::index(word));
            }
        };
        walk::<N>(&w.nodes, &entry, s.best.bound(), fetch, |word| {
            let index = node::index(word);
            match node::kind(word) {
                TRIANGLES => {
                    let block = &w.triangles[index];
                    if let Some(lanes) = facets(block, of, df, s.best.bound()) {
                        s.take(word, block, lanes);
                        return Some(s.reach(&entry));
                    }
                    None
                }
                QUADS => {
                    let block = &w.quads[index];
                    if let Some(lanes) = facets(block, of, df, s.best.bound()) {
                        s.take(word, block, lanes);
                        return Some(s.reach(&entry));
                    }
                    None
                }
                _ => {
                    s.item(word, index);
                    Some(s.reach(&entry))
                }
            }
        });
    }

    #[target_feature(enable = "avx2,fma")]
    fn mesh<const N: usize>(s: &mut MeshSearch<'_>) {
        let Some(entry) = s.entry else { return };
        let m = s.mesh;
        let fetch = |word: u32| {
            if word & LEAF == 0 {
                prefetch::<4, _>(&m.nodes, word as usize);
            } else {
                prefetch::<5, _>(&m.trios, node::index(word));
            }
        };
        walk::<N>(&m.nodes, &entry, s.bound, fetch, |word| {
            let index = node::index(word);
            let mask = trios(&m.trios[index], &s.shear);
            if mask == 0 {
                return None;
            }
            s.take(index, mask);
            Some(s.reach(&entry))
        });
    }

    /// Asks for the first `LINES` cache lines of an element.
    #[inline]
    fn prefetch<const LINES: usize, T>(list: &[T], index: usize) {
        let start = list.as_ptr().wrapping_add(index).cast::<i8>();
        for line in 0..LINES {
            // SAFETY: a prefetch is a hint and faults on no address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line)) };
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn splat(v: DVec3) -> [Four; 3] {
        [_mm256_set1_pd(v.x), _mm256_set1_pd(v.y), _mm256_set1_pd(v.z)]
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn load(a: &[f64; LANES]) -> Four {
        // SAFETY: the array has room for one unaligned vector.
        unsafe { _mm256_loadu_pd(a.as_ptr()) }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn store(v: Four) -> [f64; LANES] {
        let mut a = [0.0; LANES];
        // SAFETY: the array has room for one unaligned vector.
        unsafe { _mm256_storeu_pd(a.as_mut_ptr(), v) };
        a
    }

    /// `a·b`, summed from the left.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn dot(a: [Four; 3], b: [Four; 3]) -> Four {
        _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(a[0], b[0]), _mm256_mul_pd(a[1], b[1])), _mm256_mul_pd(a[2], b[2]))
    }

    /// `a·b − c·d`
    #[inline]
    #[target_feature(enable = "avx2")]
    fn minor(a: Four, b: Four, c: Four, d: Four) -> Four {
        _mm256_sub_pd(_mm256_mul_pd(a, b), _mm256_mul_pd(c, d))
    }

    /// The vector twin of [`Facets::test`]; None if no lane is hit.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn facets<const K: usize>(b: &Facets<K>, o: [Four; 3], d: [Four; 3], bound: f64) -> Option<Lanes> {
        let n = [load(&b.normal[0]), load(&b.normal[1]), load(&b.normal[2])];
        let dn = dot(d, n);
        let t = _mm256_div_pd(_mm256_sub_pd(load(&b.offset), dot(n, o)), dn);
        let eps = _mm256_set1_pd(EPSILON);
        let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), dn);
        let mut ok = _mm256_and_pd(
            _mm256_cmp_pd::<_CMP_GT_OQ>(size, eps),
            _mm256_and_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(t, eps), _mm256_cmp_pd::<_CMP_LE_OQ>(t, _mm256_set1_pd(bound))),
        );
        let p = [
            _mm256_add_pd(o[0], _mm256_mul_pd(d[0], t)),
            _mm256_add_pd(o[1], _mm256_mul_pd(d[1], t)),
            _mm256_add_pd(o[2], _mm256_mul_pd(d[2], t)),
        ];
        // The two coordinates after the dropped one.
        let dropped = _mm256_cvtepu8_epi64(_mm_cvtsi32_si128(i32::from_le_bytes(b.dropped)));
        let is0 = _mm256_castsi256_pd(_mm256_cmpeq_epi64(dropped, _mm256_setzero_si256()));
        let is1 = _mm256_castsi256_pd(_mm256_cmpeq_epi64(dropped, _mm256_set1_epi64x(1)));
        let x = _mm256_blendv_pd(_mm256_blendv_pd(p[0], p[2], is1), p[1], is0);
        let y = _mm256_blendv_pd(_mm256_blendv_pd(p[1], p[0], is1), p[2], is0);
        let mut dx0 = _mm256_sub_pd(load(&b.x[K - 1]), x);
        let mut dy0 = _mm256_sub_pd(load(&b.y[K - 1]), y);
        let mut least = _mm256_set1_pd(f64::INFINITY);
        for k in 0..K {
            let dx1 = _mm256_sub_pd(load(&b.x[k]), x);
            let dy1 = _mm256_sub_pd(load(&b.y[k]), y);
            least = _mm256_min_pd(minor(dx0, dy1, dy0, dx1), least);
            (dx0, dy0) = (dx1, dy1);
        }
        // SAFETY: the array has room for one unaligned vector.
        let margin = _mm256_cvtps_pd(unsafe { _mm_loadu_ps(b.margin.as_ptr()) });
        let margin = _mm256_xor_pd(margin, _mm256_set1_pd(-0.0));
        ok = _mm256_and_pd(ok, _mm256_cmp_pd::<_CMP_GE_OQ>(least, margin));
        let mask = _mm256_movemask_pd(ok) as u32;
        (mask != 0).then(|| Lanes { mask, distance: store(t), edge: store(least) })
    }

    /// The vector twin of [`Trios::test`].
    #[inline]
    #[target_feature(enable = "avx2")]
    fn trios(b: &Trios, s: &Shear) -> u32 {
        let [i, j, k] = s.axes;
        let o = s.origin;
        let (oi, oj, ok) = (_mm256_set1_pd(o[i]), _mm256_set1_pd(o[j]), _mm256_set1_pd(o[k]));
        let (si, sj) = (_mm256_set1_pd(s.slope[0]), _mm256_set1_pd(s.slope[1]));
        let corner = |c: usize| {
            let v = &b.corners[c];
            let height = _mm256_sub_pd(load(&v[k]), ok);
            let x = _mm256_sub_pd(_mm256_sub_pd(load(&v[i]), oi), _mm256_mul_pd(si, height));
            let y = _mm256_sub_pd(_mm256_sub_pd(load(&v[j]), oj), _mm256_mul_pd(sj, height));
            (x, y)
        };
        let v = [corner(0), corner(1), corner(2)];
        let sign = _mm256_set1_pd(-0.0);
        let (mut positive, mut negative) = (_mm256_setzero_pd(), _mm256_setzero_pd());
        for c in 0..3 {
            let (a, b) = (v[c], v[(c + 1) % 3]);
            let (p, q) = (_mm256_mul_pd(a.0, b.1), _mm256_mul_pd(a.1, b.0));
            let size = _mm256_add_pd(_mm256_andnot_pd(sign, p), _mm256_andnot_pd(sign, q));
            let unsure = _mm256_mul_pd(_mm256_set1_pd(UNSURE), size);
            let d = _mm256_sub_pd(p, q);
            positive = _mm256_or_pd(positive, _mm256_cmp_pd::<_CMP_GT_OQ>(d, unsure));
            negative = _mm256_or_pd(negative, _mm256_cmp_pd::<_CMP_GT_OQ>(_mm256_xor_pd(d, sign), unsure));
        }
        !_mm256_movemask_pd(_mm256_and_pd(positive, negative)) as u32 & 0xf
    }

    /// The vector twin of [`crate::walk::walk`].
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn walk<const N: usize>(
        nodes: &[Node],
        e: &Entry,
        bound: f64,
        fetch: impl Fn(u32),
        mut leaf: impl FnMut(u32) -> Option<f32>,
    ) {
        let set = |v: &[f32; 3]| [_mm256_set1_ps(v[0]), _mm256_set1_ps(v[1]), _mm256_set1_ps(v[2])];
        let (inverse, near, far) = (set(&e.inverse), set(&e.near), set(&e.far));
        let array = e.array;
        let mut reach = e.reach(bound);
        // The stack holds no more than seven entries for each level of the tree; `N` is chosen for that.
        let mut stack = [MaybeUninit::<(u32, f32)>::uninit(); N];
        let mut top = 0usize;
        let mut word = 0u32;
        loop {
            if word & LEAF != 0 {
                // Most leaves are missed: then nothing has to be computed again.
                if let Some(nearer) = leaf(word) {
                    reach = nearer;
                }
            } else {
                let node = &nodes[word as usize];
                let plane = |k: usize| {
                    // SAFETY: `k` is one of 0 to 5 by construction of `array`, and a row is one aligned vector: rows
                    // are 32 bytes and nodes are aligned to 64.
                    unsafe { _mm256_load_ps(node.planes.get_unchecked(k).as_ptr()) }
                };
                let nx = _mm256_fmadd_ps(plane(array[0]), inverse[0], near[0]);
                let ny = _mm256_fmadd_ps(plane(array[1]), inverse[1], near[1]);
                let nz = _mm256_fmadd_ps(plane(array[2]), inverse[2], near[2]);
                let fx = _mm256_fmadd_ps(plane(array[0] ^ 1), inverse[0], far[0]);
                let fy = _mm256_fmadd_ps(plane(array[1] ^ 1), inverse[1], far[1]);
                let fz = _mm256_fmadd_ps(plane(array[2] ^ 1), inverse[2], far[2]);
                let n = _mm256_max_ps(_mm256_max_ps(nx, ny), _mm256_max_ps(nz, _mm256_setzero_ps()));
                let f = _mm256_min_ps(_mm256_min_ps(fx, fy), _mm256_min_ps(fz, _mm256_set1_ps(reach)));
                let mut hits = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(n, f)) as u32;
                if hits != 0 {
                    let mut distance = [0.0f32; 8];
                    // SAFETY: the array has room for one unaligned vector.
                    unsafe { _mm256_storeu_ps(distance.as_mut_ptr(), n) };
                    let mut next = || {
                        let i = hits.trailing_zeros() as usize & 7;
                        hits &= hits - 1;
                        fetch(node.child[i]);
                        ((node.child[i], distance[i]), hits != 0)
                    };
                    let (first, more) = next();
                    if !more {
                        word = first.0;
                        continue;
                    }
                    let (second, mut more) = next();
                    let (a, b) = if second.1 < first.1 { (second, first) } else { (first, second) };
                    let base = top;
                    stack[top].write(b);
                    if !more {
                        top += 1;
                        word = a.0;
                        continue;
                    }
                    stack[top + 1].write(a);
                    top += 2;
                    while more {
                        let (c, rest) = next();
                        more = rest;
                        let mut at = top;
                        while at > base {
                            // SAFETY: entries below `top` have been written.
                            let below = unsafe { stack[at - 1].assume_init() };
                            if below.1 >= c.1 {
                                break;
                            }
                            stack[at].write(below);
                            at -= 1;
                        }
                        stack[at].write(c);
                        top += 1;
                    }
                    top -= 1;
                    // SAFETY: entries up to the former `top` have been written.
                    word = unsafe { stack[top].assume_init() }.0;
                    continue;
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                // SAFETY: entries below the former `top` have been written.
                let (w, distance) = unsafe { stack[top].assume_init() };
                if distance <= reach {
                    word = w;
                    break;
                }
            }
        }
    }
}
