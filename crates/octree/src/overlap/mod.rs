//! Does a surface lie in a cube? One test a family of surfaces, each decided with the tolerances of Radiance, so that
//! trees come out the same: a surface counts as present if it comes within about [`ambit_base::EPSILON`] of the cube.

mod boxes;
mod cone;
mod polygon;
mod sphere;
mod volume;

pub(crate) use boxes::AxisBox;
pub(crate) use cone::ConeFamily;
pub(crate) use polygon::{Octants, PolygonTest};
pub(crate) use sphere::sphere_meets;
pub use volume::Volume;

/// Half the diagonal of a cube in terms of half its edge: the square root of 3, with the digits Radiance uses.
const ROOT_3: f64 = 1.732_050_808;

/// Where an object is in relation to a cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// No part of it in the cube.
    Miss,
    /// Some of it in the cube.
    Hit,
    /// The cube is wholly inside the volume (instances and meshes only).
    Inside,
}

impl From<bool> for Relation {
    fn from(hit: bool) -> Self {
        if hit { Self::Hit } else { Self::Miss }
    }
}
