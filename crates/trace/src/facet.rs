//! Triangles and convex quadrilaterals, four to a block, in double precision.
//!
//! The plane gives the distance, as for every polygon; the edges then decide in the projection of
//! [`crate::polygon`]. With E the least cross product of an edge and the way to the point: above zero the point is
//! inside; below −`margin` it is outside even by the tolerances of the general test; in between the general test
//! decides. So the answer is always that of the general test, at the price of the plane and three or four products.

use crate::polygon;
use ambit_base::{DVec3, EPSILON};
use ambit_scene::{Bounds, ObjectId};

/// Surfaces in a block.
pub(crate) const LANES: usize = 4;

/// Ranks from this one on are found by the object.
pub(crate) const FAR_RANK: u8 = u8::MAX;

/// One triangle (`K` = 3) or convex quadrilateral (4), as the builder keeps it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet<const K: usize> {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// Projected vertices, counter-clockwise in the projection.
    pub(crate) corners: [[f64; 2]; K],
}

impl<const K: usize> Facet<K> {
    /// None if the outline is not strictly convex.
    pub(crate) fn new(vertices: &[DVec3], normal: DVec3, offset: f64) -> Option<Self> {
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
        (0..K).all(turns_left).then_some(Self { normal, offset, corners })
    }

    pub(crate) fn dropped(&self) -> usize {
        polygon::dropped_axis(self.normal)
    }

    /// The box around all points that can be hit but for tolerances along the axes.
    pub(crate) fn bounds(&self) -> Bounds {
        polygon::bounds(self.normal, self.offset, self.dropped(), &self.corners)
    }

    /// How negative the least edge product can be where the general test still says inside: such a point is within
    /// reach of the polygon, and the product with an edge is the distance from it times its length. The factor and
    /// the last term allow for rounding.
    fn margin(&self) -> f32 {
        let length = |i: usize| {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % K]);
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let longest = (0..K).map(length).fold(0.0, f64::max);
        let margin = longest * polygon::reach(&self.corners) * 1.01 + longest * longest * 1e-14;
        (margin as f32).next_up().min(f32::MAX)
    }
}

/// Four facets, component by component.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Facets<const K: usize> {
    pub(crate) normal: [[f64; LANES]; 3],
    pub(crate) offset: [f64; LANES],
    pub(crate) x: [[f64; LANES]; K],
    pub(crate) y: [[f64; LANES]; K],
    pub(crate) margin: [f32; LANES],
    pub(crate) object: [ObjectId; LANES],
    pub(crate) dropped: [u8; LANES],
    /// Index of the rank, at hand without another table; [`FAR_RANK`] if it does not fit.
    pub(crate) rank: [u8; LANES],
}

/// What a block answers: `mask` has a bit for each lane whose plane is met between ε and the bound with the point not
/// surely outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes {
    pub(crate) mask: u32,
    pub(crate) distance: [f64; LANES],
    /// Least edge product: positive inside.
    pub(crate) edge: [f64; LANES],
}

impl<const K: usize> Facets<K> {
    /// No surfaces; such lanes are never hit.
    pub(crate) const EMPTY: Self = Self {
        normal: [[0.0; LANES]; 3],
        offset: [0.0; LANES],
        x: [[0.0; LANES]; K],
        y: [[0.0; LANES]; K],
        margin: [0.0; LANES],
        object: [ObjectId::MAX; LANES],
        dropped: [0; LANES],
        rank: [FAR_RANK; LANES],
    };

    pub(crate) fn set(&mut self, lane: usize, f: &Facet<K>, object: ObjectId, rank: u32) {
        for a in 0..3 {
            self.normal[a][lane] = f.normal[a];
        }
        self.offset[lane] = f.offset;
        for (k, c) in f.corners.iter().enumerate() {
            self.x[k][lane] = c[0];
            self.y[k][lane] = c[1];
        }
        self.margin[lane] = f.margin();
        self.object[lane] = object;
        self.dropped[lane] = f.dropped() as u8;
        self.rank[lane] = u8::try_from(rank).unwrap_or(FAR_RANK);
    }

    pub(crate) fn normal(&self, lane: usize) -> DVec3 {
        DVec3::new(self.normal[0][lane], self.normal[1][lane], self.normal[2][lane])
    }

    /// One lane, the arithmetic of the vector version operation by operation.
    #[inline]
    fn lane(&self, i: usize, o: DVec3, d: DVec3, bound: f64) -> Option<(f64, f64)> {
        let n = self.normal(i);
        let dn = d.x * n.x + d.y * n.y + d.z * n.z;
        let t = (self.offset[i] - (n.x * o.x + n.y * o.y + n.z * o.z)) / dn;
        if !(dn.abs() > EPSILON && t > EPSILON && t <= bound) {
            return None;
        }
        let [x, y] = polygon::project(o + d * t, self.dropped[i] as usize);
        let mut least = f64::INFINITY;
        for k in 0..K {
            let j = if k == 0 { K - 1 } else { k - 1 };
            let (dx0, dy0) = (self.x[j][i] - x, self.y[j][i] - y);
            let (dx1, dy1) = (self.x[k][i] - x, self.y[k][i] - y);
            least = least.min(dx0 * dy1 - dy0 * dx1);
        }
        (least >= -f64::from(self.margin[i])).then_some((t, least))
    }

    /// All lanes.
    pub(crate) fn test(&self, o: DVec3, d: DVec3, bound: f64) -> Lanes {
        let mut out = Lanes { mask: 0, distance: [0.0; LANES], edge: [0.0; LANES] };
        for i in 0..LANES {
            if let Some((t, e)) = self.lane(i, o, d, bound) {
                out.mask |= 1 << i;
                out.distance[i] = t;
                out.edge[i] = e;
            }
        }
        out
    }

    /// The general test, for a point between surely inside and surely outside.
    #[cold]
    pub(crate) fn decide(&self, lane: usize, o: DVec3, d: DVec3, distance: f64) -> bool {
        let [x, y] = polygon::project(o + d * distance, self.dropped[lane] as usize);
        polygon::inside(x, y, (0..K).map(|k| [self.x[k][lane], self.y[k][lane]]))
    }

    /// The hit of one surface alone, whatever its distance.
    pub(crate) fn hit(&self, lane: usize, o: DVec3, d: DVec3) -> Option<f64> {
        let (t, e) = self.lane(lane, o, d, f64::INFINITY)?;
        (e > 0.0 || self.decide(lane, o, d, t)).then_some(t)
    }
}
