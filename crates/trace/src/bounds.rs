//! Axis-aligned boxes of the tree: f32 relative to a centre, rounded outward from exact ones.

use ambit_base::DVec3;
use ambit_scene::Bounds;

/// `b` grown by `by` on all sides.
pub(crate) fn grown(b: Bounds, by: f64) -> Bounds {
    Bounds { min: b.min - by, max: b.max + by }
}

/// True if a ray meets a box, rounding included: never false where one does.
pub(crate) fn meets(b: &Bounds, o: DVec3, d: DVec3) -> bool {
    let inverse = d.recip();
    let (x, y) = ((b.min - o) * inverse, (b.max - o) * inverse);
    // `min` and `max` pass over what 0/0 gives, for a ray in the plane of a side.
    let (near, far) = (x.min(y), x.max(y));
    let (enter, leave) = (near.x.max(near.y).max(near.z).max(0.0), far.x.min(far.y).min(far.z));
    enter <= leave + LEEWAY * leave.abs()
}

/// Relative rounding of the distances at which a box is met.
const LEEWAY: f64 = 1e-12;

/// The box around points.
pub(crate) fn around(points: impl IntoIterator<Item = DVec3>) -> Bounds {
    let mut b = Bounds::EMPTY;
    points.into_iter().for_each(|p| b.add(p));
    b
}

/// A box of the tree, relative to the tree's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Box32 {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

/// Coordinates beyond this are clamped: far beyond any hit, yet times 1e20 they fit an f32.
const FARTHEST: f64 = 1e15;

impl Box32 {
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest f32 box around `b − centre`.
    pub(crate) fn around(b: &Bounds, centre: DVec3) -> Self {
        let down = |x: f64| {
            let y = x.clamp(-FARTHEST, FARTHEST) as f32;
            if f64::from(y) > x { y.next_down() } else { y }
        };
        let (min, max) = ((b.min - centre).to_array(), (b.max - centre).to_array());
        Self { min: min.map(down), max: max.map(|x| -down(-x)) }
    }

    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|a| self.min[a].min(other.min[a])),
            max: std::array::from_fn(|a| self.max[a].max(other.max[a])),
        }
    }

    /// Half the surface.
    pub(crate) fn half_area(&self) -> f32 {
        let d: [f32; 3] = std::array::from_fn(|a| (self.max[a] - self.min[a]).max(0.0));
        d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    }

    /// Twice the middle along an axis.
    pub(crate) fn middle(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }
}
