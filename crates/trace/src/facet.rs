//! Triangles and convex quadrilaterals, tested exactly; [`crate::block`] says which may be hit at all.
//!
//! The plane gives the distance, as for every polygon; the edges then decide in the projection of
//! [`crate::polygon`]. Where every cross product of an edge and the way to the point is above zero the point is inside; else
//! the general test decides. So the answer is always that of the general test, at the price of the plane and three
//! or four products.

use crate::block::{Block, LANES, Scale, Slopes};
use crate::pages;
use crate::polygon;
use crate::ray::Rank;
use ambit_base::{DVec3, EPSILON};
use ambit_scene::{Bounds, ObjectId};

/// One triangle (`K` = 3) or convex quadrilateral (4).
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Facet<const K: usize> {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// Projected vertices, counter-clockwise in the projection.
    pub(crate) corners: [[f64; 2]; K],
    pub(crate) object: ObjectId,
    /// Index of the rank, and above [`RANK_BITS`] the dropped axis.
    packed: u32,
}

/// Bits for the index of a rank.
const RANK_BITS: u32 = 30;

impl<const K: usize> Facet<K> {
    /// None if the outline is not strictly convex.
    pub(crate) fn new(
        vertices: &[DVec3],
        normal: DVec3,
        offset: f64,
        object: ObjectId,
        rank: impl FnOnce() -> u32,
    ) -> Option<Self> {
        let dropped = polygon::dropped_axis(normal);
        if vertices.len() != K {
            return None;
        }
        let mut corners: [[f64; 2]; K] = std::array::from_fn(|i| polygon::project(vertices[i], dropped));
        if normal[dropped] < 0.0 {
            corners.reverse();
        }
        let turns_left = |i: usize| {
            let [a, b, c] = [corners[i], corners[(i + 1) % K], corners[(i + 2) % K]];
            (b[0] - a[0]) * (c[1] - b[1]) > (b[1] - a[1]) * (c[0] - b[0])
        };
        let packed = |rank: u32| rank | (dropped as u32) << RANK_BITS;
        (0..K).all(turns_left).then(|| Self { normal, offset, corners, object, packed: packed(rank()) })
    }

    #[inline]
    fn dropped(&self) -> usize {
        (self.packed >> RANK_BITS) as usize
    }

    /// Index of the rank.
    #[inline]
    pub(crate) fn rank(&self) -> usize {
        (self.packed & ((1 << RANK_BITS) - 1)) as usize
    }

    /// The box around all points that can be hit but for tolerances along the axes.
    pub(crate) fn bounds(&self) -> Bounds {
        polygon::bounds(self.normal, self.offset, self.dropped(), &self.corners)
    }

    /// Distance of the hit, if that is above ε and no farther than the bound.
    #[inline(always)]
    pub(crate) fn hit(&self, o: DVec3, d: DVec3, bound: f64) -> Option<f64> {
        let n = self.normal;
        let dn = d.x * n.x + d.y * n.y + d.z * n.z;
        let t = (self.offset - (n.x * o.x + n.y * o.y + n.z * o.z)) / dn;
        if !(dn.abs() > EPSILON && t > EPSILON && t <= bound) {
            return None;
        }
        let [x, y] = polygon::project(o + d * t, self.dropped());
        let mut least = f64::INFINITY;
        for k in 0..K {
            let (p, q) = (self.corners[if k == 0 { K - 1 } else { k - 1 }], self.corners[k]);
            let e = (p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x);
            least = if e < least { e } else { least };
        }
        (least > 0.0 || self.decide(x, y)).then_some(t)
    }

    /// The general test, for a point on an edge, beside one, or outside.
    #[cold]
    fn decide(&self, x: f64, y: f64) -> bool {
        polygon::inside(x, y, self.corners.iter().copied())
    }
}

/// All facets of a world.
#[derive(Debug)]
pub(crate) struct Facets<const K: usize> {
    pub(crate) blocks: Vec<Block>,
    /// One a block if K is 4, else none.
    pub(crate) slopes: Vec<Slopes>,
    /// In the order of the blocks.
    pub(crate) list: Vec<Facet<K>>,
}

impl<const K: usize> Facets<K> {
    /// With room for the facets of that many blocks.
    pub(crate) fn with_capacity(blocks: usize, facets: usize) -> Self {
        let slopes = if K == 4 { blocks } else { 0 };
        Self { blocks: pages::list(blocks), slopes: pages::list(slopes), list: pages::list(facets) }
    }

    /// Adds a block.
    pub(crate) fn push(&mut self, scale: &Scale, ranks: &[Rank], facets: impl Iterator<Item = Facet<K>>) {
        let mut block = Block::new(self.list.len() as u32);
        let mut slopes = [[0.0; LANES]; 2];
        for (lane, f) in facets.enumerate() {
            let dropped = f.dropped();
            let corners = f.corners.map(|c| polygon::on_plane(f.normal, f.offset, dropped, c));
            let s = block.push(scale, &corners, polygon::tolerance(&f.corners), f.object, ranks[f.rank()].blocks);
            (slopes[0][lane], slopes[1][lane]) = (s[0], s[1]);
            self.list.push(f);
        }
        self.blocks.push(block);
        if K == 4 {
            self.slopes.push(slopes);
        }
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>()
            + self.slopes.capacity() * size_of::<Slopes>()
            + self.list.capacity() * size_of::<Facet<K>>()
    }
}
