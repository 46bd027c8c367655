//! Planar polygons straight from their arguments, without allocation.
//!
//! Normal and area come from the fan about the first vertex v₀, N = Σ (vᵢ₋₁ − v₀) × (vᵢ − v₀), n = N/|N|, area = |N|/2;
//! the plane is n·p = mean of n·vᵢ. Points are inside by the even–odd rule, borders included.

use super::{Complaint, Polygon, Shape, point};
use ambit_base::{DVec3, EPSILON};

/// How far vertices may be off the plane before the polygon is called non-planar: absolute for planes through the
/// origin, else relative to the plane's offset (Radiance's number).
const PLANARITY: f64 = 1e-5;

/// A polygon as a view of its coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Facet<'a> {
    /// Three numbers a vertex; a repeated last vertex is cut off.
    coordinates: &'a [f64],
    /// Unit normal of the front; zero if the area is.
    pub normal: DVec3,
    /// Mean of `normal · v`.
    pub offset: f64,
    /// Area from the sum of cross products.
    pub area: f64,
    /// False if some vertex is off the plane.
    pub planar: bool,
}

impl<'a> Facet<'a> {
    /// From the real arguments of a polygon; `None` if their number is not 9, 12, 15 ….
    pub fn new(reals: &'a [f64]) -> Option<Self> {
        if reals.len() < 9 || !reals.len().is_multiple_of(3) {
            return None;
        }
        let mut coordinates = reals;
        let first = point(reals);
        if reals.len() > 9 && first.distance_squared(point(&reals[reals.len() - 3..])) <= EPSILON * EPSILON {
            coordinates = &reals[..reals.len() - 3];
        }
        let mut sum = DVec3::ZERO;
        let mut previous = point(&coordinates[3..]) - first;
        for v in coordinates[6..].chunks_exact(3) {
            let edge = point(v) - first;
            sum += previous.cross(edge);
            previous = edge;
        }
        let length = sum.length();
        // Overflow counts as "no area": nothing sensible can be hit there.
        if length == 0.0 || !length.is_finite() {
            return Some(Self { coordinates, normal: DVec3::ZERO, offset: 0.0, area: 0.0, planar: true });
        }
        let normal = sum / length;
        let count = coordinates.len() / 3;
        let mut total = normal.dot(first);
        let near_origin = total.abs() <= PLANARITY;
        let mut planar = true;
        for (i, v) in coordinates.chunks_exact(3).enumerate().skip(1) {
            let d = normal.dot(point(v));
            let mean = total / i as f64;
            let off = if near_origin { (d - mean).abs() } else { (1.0 - d / mean).abs() };
            planar &= count <= 3 || off <= PLANARITY;
            total += d;
        }
        let offset = total / count as f64;
        if !offset.is_finite() {
            return Some(Self { coordinates, normal: DVec3::ZERO, offset: 0.0, area: 0.0, planar: true });
        }
        Some(Self { coordinates, normal, offset, area: 0.5 * length, planar })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.coordinates.len() / 3
    }

    /// Vertex `i` (from 0).
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn vertex(&self, i: usize) -> DVec3 {
        point(&self.coordinates[3 * i..])
    }

    /// The vertices in order.
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = DVec3> + ExactSizeIterator + Clone + use<'a> {
        self.coordinates.chunks_exact(3).map(point)
    }

    /// True if the polygon is never hit.
    pub fn is_degenerate(&self) -> bool {
        self.area == 0.0
    }

    /// What there is to warn about.
    pub fn complaint(&self) -> Option<Complaint> {
        if self.is_degenerate() {
            Some(Complaint::ZeroArea)
        } else if self.planar {
            None
        } else {
            Some(Complaint::NonPlanarVertex)
        }
    }

    /// True if a point of the plane is inside the polygon or within [`EPSILON`] of its border.
    pub fn contains(&self, p: DVec3) -> bool {
        contains(self.vertices(), self.normal, p)
    }

    pub(super) fn to_shape(self) -> Shape {
        if self.is_degenerate() {
            return Shape::Degenerate;
        }
        Shape::Polygon(Polygon {
            vertices: self.vertices().collect(),
            normal: self.normal,
            offset: self.offset,
            area: self.area,
        })
    }
}

impl Polygon {
    /// True if a point of the plane is inside the polygon or within [`EPSILON`] of its border. Of the corners, the one
    /// farthest along the increasing directions is out, as in Radiance.
    pub fn contains(&self, p: DVec3) -> bool {
        contains(self.vertices.iter().copied(), self.normal, p)
    }
}

/// The even–odd test of formats.md 2.7: project along the axis of the largest normal component (the first on ties), count
/// the edges to the right of the point, borders count as inside.
fn contains(vertices: impl DoubleEndedIterator<Item = DVec3> + Clone, normal: DVec3, p: DVec3) -> bool {
    let n = normal.abs();
    let dropped = if n.x >= n.y && n.x >= n.z {
        0
    } else if n.y >= n.z {
        1
    } else {
        2
    };
    let (ax, ay) = ((dropped + 1) % 3, (dropped + 2) % 3);
    let (x, y) = (p[ax], p[ay]);
    let Some(last) = vertices.clone().next_back() else { return false };
    let (mut x0, mut y0) = (last[ax] - x, last[ay] - y);
    let mut inside = false;
    for v in vertices {
        let (x1, y1) = (v[ax] - x, v[ay] - y);
        let right = usize::from(x0 > 0.0) + usize::from(x1 > 0.0);
        if y0.abs() <= EPSILON && y1.abs() <= EPSILON && right == 1 {
            return true;
        }
        if (y0 > 0.0) != (y1 > 0.0) {
            match right {
                2 => inside = !inside,
                1 => {
                    let (a, b) = (y0 * x1, x0 * y1);
                    if (a - b).abs() <= EPSILON {
                        return true;
                    }
                    if (y1 > y0) != (a > b) {
                        inside = !inside;
                    }
                }
                _ if x0.abs() <= EPSILON && x1.abs() <= EPSILON => return true,
                _ => {}
            }
        }
        (x0, y0) = (x1, y1);
    }
    inside
}
