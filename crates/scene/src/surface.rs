//! Surfaces as geometry: the arguments of polygon, sphere, cone, ring and their kin checked, cleaned, in
//! scene units and world coordinates.
//!
//! The rules are those of Radiance: a sphere of negative radius is a bubble and the reverse, a cone of equal radii a
//! cylinder, a last vertex equal to the first is dropped, degenerate surfaces are kept as [`Shape::Degenerate`].

use ambit_base::DVec3;

/// A surface, cleaned.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Planar polygon, even–odd.
    Polygon(Polygon),
    /// Sphere or bubble.
    Sphere(Sphere),
    /// Cone, cup, cylinder or tube: an open lateral surface.
    Cone(Cone),
    /// Flat annulus or disk.
    Ring(Ring),
    /// Disk at infinity.
    Source(Source),
    /// Never hit, never in the octree (zero area, illegal radii …).
    Degenerate,
}

/// A planar polygon.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Vertices, counter-clockwise about `normal`; a repeated last one dropped.
    pub vertices: Box<[DVec3]>,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Mean of `normal · v`.
    pub offset: f64,
    /// Area from the sum of cross products.
    pub area: f64,
}

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub centre: DVec3,
    /// Radius, positive.
    pub radius: f64,
    /// True if the front faces the centre (bubble).
    pub inward: bool,
}

/// A cone frustum without its ends.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// End with the smaller radius `r0`.
    pub p0: DVec3,
    /// End with the larger radius `r1`.
    pub p1: DVec3,
    /// Smaller radius.
    pub r0: f64,
    /// Larger radius; equal to `r0` for cylinders.
    pub r1: f64,
    /// Unit axis from `p0` to `p1`.
    pub axis: DVec3,
    /// Length along the axis.
    pub length: f64,
    /// True if the front faces the axis (cup, tube).
    pub inward: bool,
}

/// A flat annulus.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// Centre.
    pub centre: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Inner radius, possibly 0.
    pub r0: f64,
    /// Outer radius.
    pub r1: f64,
}

/// A disk at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Unit direction towards it.
    pub direction: DVec3,
    /// Solid angle in steradians.
    pub solid_angle: f64,
}
