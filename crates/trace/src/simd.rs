//! The vector versions of the walk and of the leaf tests, for processors with AVX2 and FMA; chosen at run time.
//!
//! What is computed here, in f32, only decides which surfaces need not be tested; those tests are the same code for
//! all processors. So rounding may differ from the scalar walk, hits are the same bits.
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
mod coarse;

#[cfg(target_arch = "x86_64")]
mod present {
    use super::Vector;
    use super::coarse::{Line, Waiting, coarse};
    use crate::block::LANES;
    use crate::collapse::SLACK;
    use crate::mesh::MeshSearch;
    use crate::node::{self, LEAF, Node, QUADS, TRIANGLES};
    use crate::ray::Ray;
    use crate::search::{End, Search};
    use crate::walk::{DEEP_STACK, Entry, GRAZING, Gate, LEAST_DIRECTION, ROUNDING, STACK, Start};
    use ambit_base::{DVec3, EPSILON};
    #[allow(clippy::wildcard_imports)]
    use std::arch::x86_64::*;
    use std::mem::MaybeUninit;

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
        let w = s.world;
        let entered = enter(&w.gate, s.ray, s.end());
        let Some((entry, line)) = &entered else { return };
        let fetch = |word: u32| {
            if word & LEAF == 0 {
                prefetch::<4, _>(&w.nodes, word as usize);
            } else if node::kind(word) == TRIANGLES {
                prefetch::<6, _>(&w.triangles.blocks, node::index(word));
            } else if node::kind(word) == QUADS {
                prefetch::<6, _>(&w.quads.blocks, node::index(word));
                prefetch::<1, _>(&w.quads.slopes, node::index(word));
            }
        };
        let mut waiting = Waiting::new();
        let bound = s.best.bound();
        let reach = walk::<N>(&w.nodes, entry, bound, fetch, |word, reach| {
            let index = node::index(word);
            let found = match node::kind(word) {
                TRIANGLES => {
                    let block = &w.triangles.blocks[index];
                    let found = coarse(block, None, line, reach)?;
                    if let Some(lane) = found.blocked {
                        s.block(block.object[lane]);
                        return Some(-1.0);
                    }
                    waiting.push(&found, |lane| {
                        let number = block.first + lane;
                        prefetch::<2, _>(&w.triangles.list, number as usize);
                        node::place(TRIANGLES, number)
                    });
                    found
                }
                QUADS => {
                    let block = &w.quads.blocks[index];
                    let found = coarse(block, Some(&w.quads.slopes[index]), line, reach)?;
                    if let Some(lane) = found.blocked {
                        s.block(block.object[lane]);
                        return Some(-1.0);
                    }
                    waiting.push(&found, |lane| {
                        let number = block.first + lane;
                        prefetch::<2, _>(&w.quads.list, number as usize);
                        node::place(QUADS, number)
                    });
                    found
                }
                _ => {
                    s.item(index, entry.distance(reach));
                    return Some(reach.min(s.reach(entry)));
                }
            };
            let mut reach = reach.min(found.reach);
            if waiting.is_full() || found.unsure {
                reach = waiting.settle(reach, |place| s.test(place).then(|| s.reach(entry)));
            }
            Some(reach)
        });
        waiting.settle(reach, |place| s.test(place).then(|| s.reach(entry)));
    }

    #[target_feature(enable = "avx2,fma")]
    fn mesh<const N: usize>(s: &mut MeshSearch<'_>) {
        let m = s.mesh;
        let entered = enter(&m.gate, &s.ray, s.end());
        let Some((entry, line)) = &entered else { return };
        let fetch = |word: u32| {
            if word & LEAF == 0 {
                prefetch::<4, _>(&m.nodes, word as usize);
            } else {
                prefetch::<6, _>(&m.blocks, node::index(word));
            }
        };
        let mut waiting = Waiting::new();
        let bound = s.bound;
        let reach = walk::<N>(&m.nodes, entry, bound, fetch, |word, reach| {
            let block = &m.blocks[node::index(word)];
            let found = coarse(block, None, line, reach)?;
            if found.blocked.is_some() {
                s.block();
                return Some(-1.0);
            }
            waiting.push(&found, |lane| {
                prefetch::<1, _>(&m.trios, (block.first + lane) as usize);
                block.first + lane
            });
            let mut reach = reach.min(found.reach);
            if waiting.is_full() || found.unsure {
                reach = waiting.settle(reach, |trio| s.test(trio).then(|| s.reach(entry)));
            }
            Some(reach)
        });
        waiting.settle(reach, |trio| s.test(trio).then(|| s.reach(entry)));
    }

    /// The vector twin of [`Entry::new`].
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn enter(gate: &Gate, ray: &Ray, end: End) -> Option<(Entry, Line)> {
        let four = |v: DVec3| _mm256_set_pd(0.0, v.z, v.y, v.x);
        let (o, d) = (four(ray.origin), four(ray.direction));
        let above = _mm256_cmp_pd::<_CMP_GE_OQ>(o, four(gate.bounds.min));
        let below = _mm256_cmp_pd::<_CMP_LE_OQ>(o, four(gate.bounds.max));
        let inside = _mm256_movemask_pd(_mm256_and_pd(above, below)) == 0xf;
        let start = if inside && (ray.direction.x + ray.direction.y + ray.direction.z).is_finite() {
            Start { distance: 0.0, extent: gate.extent }
        } else {
            Start::new(gate, ray)?
        };
        let moved = _mm256_add_pd(o, _mm256_mul_pd(d, _mm256_set1_pd(start.distance)));
        let o = _mm256_cvtpd_ps(_mm256_sub_pd(moved, four(gate.centre)));
        let d = _mm256_cvtpd_ps(d);
        let sign = _mm_set1_ps(-0.0);
        let size = _mm_max_ps(_mm_andnot_ps(sign, d), _mm_set1_ps(LEAST_DIRECTION));
        let r = _mm_div_ps(_mm_set1_ps(1.0), _mm_or_ps(size, _mm_and_ps(sign, d)));
        let noise = _mm_set1_ps((start.extent * ROUNDING) as f32);
        let shift = _mm_add_ps(_mm_mul_ps(_mm_set1_ps(SLACK), _mm_andnot_ps(sign, o)), noise);
        let shift = _mm_or_ps(shift, _mm_and_ps(sign, r));
        let store = |v| {
            let mut a = [0.0f32; 4];
            // SAFETY: the array has room for one unaligned vector.
            unsafe { _mm_storeu_ps(a.as_mut_ptr(), v) };
            a
        };
        let negative = _mm_movemask_ps(r) as usize;
        let splat = |v| {
            [
                _mm256_broadcastss_ps(v),
                _mm256_broadcastss_ps(_mm_movehdup_ps(v)),
                _mm256_broadcastss_ps(_mm_movehl_ps(v, v)),
            ]
        };
        let line = Line {
            origin: splat(o),
            direction: splat(d),
            widening: (start.extent / gate.extent) as f32,
            beyond: (2.0 * EPSILON + GRAZING * start.extent) as f32,
            // Rounded down, with room for the division.
            end: (end.before - start.distance) as f32 * (1.0 - 8.0 * f32::EPSILON),
            all: if end.all { (1 << LANES) - 1 } else { 0 },
        };
        let entry = Entry {
            start: start.distance,
            extent: start.extent,
            inverse: store(r),
            near: store(_mm_xor_ps(sign, _mm_mul_ps(_mm_add_ps(o, shift), r))),
            far: store(_mm_xor_ps(sign, _mm_mul_ps(_mm_sub_ps(o, shift), r))),
            array: [negative & 1, 2 + (negative >> 1 & 1), 4 + (negative >> 2 & 1)],
        };
        Some((entry, line))
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

    /// The vector twin of [`crate::walk::walk`].
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn walk<const N: usize>(
        nodes: &[Node],
        e: &Entry,
        bound: f64,
        fetch: impl Fn(u32),
        mut leaf: impl FnMut(u32, f32) -> Option<f32>,
    ) -> f32 {
        let set = |v: &[f32; 4]| [_mm256_set1_ps(v[0]), _mm256_set1_ps(v[1]), _mm256_set1_ps(v[2])];
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
                if let Some(nearer) = leaf(word, reach) {
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
                    return reach;
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
