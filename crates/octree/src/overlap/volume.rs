//! Instances and meshes against cubes: the volume is the transformed cube of the file they refer to.

use super::{AxisBox, Relation};
use crate::Cube;
use ambit_base::{DVec3, Transform};
use ambit_scene::Bounds;

/// Corners from which edges leave along x, y and z; together they give all twelve.
const EDGE_STARTS: [usize; 4] = [0, 3, 5, 6];

/// The cube of another file, placed in the scene.
#[derive(Clone, Debug)]
pub struct Volume {
    inner: Cube,
    placement: Transform,
    corners: [DVec3; 8],
}

impl Volume {
    /// Places a cube by a transform.
    pub fn new(inner: Cube, placement: Transform) -> Self {
        let corners = std::array::from_fn(|i| placement.point(inner.corner(i)));
        Self { inner, placement, corners }
    }

    /// The box around the placed cube.
    pub fn bounds(&self) -> Bounds {
        let mut b = Bounds::EMPTY;
        for &p in &self.corners {
            b.add(p);
        }
        b
    }

    /// How a cube lies in relation to the volume.
    pub fn relation(&self, cube: &Cube) -> Relation {
        let own = AxisBox::new(self.inner.origin, self.inner.edge);
        let back = own.classify((0..8).map(|i| self.placement.point_back(cube.corner(i))));
        if back.inside == back.count {
            return Relation::Inside;
        }
        if back.inside > 0 {
            return Relation::Hit;
        }
        if back.one_sided {
            return Relation::Miss;
        }
        let outer = AxisBox::new(cube.origin, cube.edge);
        let there = outer.classify(self.corners);
        if there.inside > 0 {
            return Relation::Hit;
        }
        if there.one_sided {
            return Relation::Miss;
        }
        let crosses = EDGE_STARTS
            .iter()
            .any(|&start| (0..3).any(|axis| outer.clip(self.corners[start], self.corners[start ^ (1 << axis)])));
        crosses.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_is_inside_outside_or_across() {
        let unit = Cube { origin: DVec3::ZERO, edge: 1.0 };
        let place = Transform::parse(&["-s", "4", "-t", "10", "0", "0"]).unwrap();
        let v = Volume::new(unit, place);
        let at = |x: f64, edge: f64| v.relation(&Cube { origin: DVec3::new(x, 1.0, 1.0), edge });
        assert_eq!(at(11.0, 1.0), Relation::Inside);
        assert_eq!(at(9.5, 1.0), Relation::Hit);
        assert_eq!(at(20.0, 1.0), Relation::Miss);
        let large = v.relation(&Cube { origin: DVec3::splat(-50.0), edge: 100.0 });
        assert_eq!(large, Relation::Hit);
        assert_eq!(v.bounds(), Bounds { min: DVec3::new(10.0, 0.0, 0.0), max: DVec3::new(14.0, 4.0, 4.0) });
    }
}
