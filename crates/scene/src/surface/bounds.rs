//! Axis-aligned boxes around surfaces, tight, as the octree's cube is derived from them.

use super::{Facet, Shape, point};
use crate::{Kind, ObjectId, Scene};
use ambit_base::{DVec3, EPSILON};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: DVec3,
    /// Upper corner.
    pub max: DVec3,
}

impl Bounds {
    /// Nothing at all: absorbs whatever is added.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// True if nothing was added.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// Extends the box to a point.
    #[inline]
    pub fn add(&mut self, p: DVec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// Extends the box to another.
    #[inline]
    pub fn join(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// The eight corners; bit 0 of the index is x, bit 1 y, bit 2 z.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Extends the box to a circle with unit axis `axis`: c ± r √(1 − a²) on each coordinate axis.
    fn add_circle(&mut self, centre: DVec3, axis: DVec3, radius: f64) {
        let reach = radius * (DVec3::ONE - axis * axis).max(DVec3::ZERO).map(f64::sqrt);
        self.add(centre - reach);
        self.add(centre + reach);
    }

    /// The cube around a sphere.
    fn add_sphere(&mut self, centre: DVec3, radius: f64) {
        let low = centre - radius;
        self.add(low);
        self.add(low + 2.0 * radius);
    }
}

impl Shape {
    /// The box around the surface; `None` for sources, which are at infinity, and for degenerate surfaces (but see
    /// [`Scene::surface_bounds`] for those that still count).
    pub fn bounds(&self) -> Option<Bounds> {
        let mut b = Bounds::EMPTY;
        match self {
            Self::Polygon(p) => p.vertices.iter().for_each(|&v| b.add(v)),
            Self::Sphere(s) => b.add_sphere(s.centre, s.radius),
            Self::Cone(c) => {
                b.add_circle(c.p0, c.axis, c.r0);
                b.add_circle(c.p1, c.axis, c.r1);
            }
            Self::Ring(r) => b.add_circle(r.centre, r.normal, r.r1),
            Self::Source(_) | Self::Degenerate => return None,
        }
        Some(b)
    }
}

impl Facet<'_> {
    /// The box around the vertices, degenerate or not.
    pub fn bounds(&self) -> Bounds {
        let mut b = Bounds::EMPTY;
        self.vertices().for_each(|v| b.add(v));
        b
    }
}

impl Scene {
    /// What a surface adds to the scene's box, given its shape: polygons without area and spheres without radius, though
    /// never hit, still count. `None` for sources, ignored cones and rings, volumes, modifiers and whatever is not finite.
    pub fn surface_bounds(&self, id: ObjectId, shape: &Shape) -> Option<Bounds> {
        if !matches!(shape, Shape::Degenerate) {
            return shape.bounds();
        }
        let reals = self.reals(id);
        let bounds = match self.object(id).kind {
            Kind::Polygon => Facet::new(reals)?.bounds(),
            Kind::Sphere | Kind::Bubble if reals.len() == 4 && reals[3].abs() <= EPSILON => {
                let mut b = Bounds::EMPTY;
                b.add_sphere(point(reals), reals[3].abs());
                b
            }
            _ => return None,
        };
        (bounds.min.is_finite() && bounds.max.is_finite()).then_some(bounds)
    }
}
