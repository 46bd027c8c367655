//! Spheres against cubes: the cube's circumscribed ball, then its inscribed one, then the nearest point of the cube.

use super::ROOT_3;
use ambit_base::{DVec3, EPSILON};

/// True if the surface of the sphere comes within the cube.
pub(crate) fn sphere_meets(centre: DVec3, radius: f64, origin: DVec3, edge: f64) -> bool {
    let half = edge * 0.5;
    let around = ROOT_3 * 0.5 * edge;
    let middle = origin + half;
    let distance = centre.distance_squared(middle);
    let square = |x: f64| x * x;
    if distance > square(radius + around + EPSILON) {
        return false;
    }
    if around < radius {
        if distance < square(radius - around - EPSILON) {
            return false;
        }
        if distance < square(radius + EPSILON) {
            return true;
        }
    }
    let nearest = centre.clamp(origin, origin + edge);
    centre.distance_squared(nearest) <= square(radius + EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_surface_counts_for_large_spheres() {
        let at = |x: f64, y: f64, z: f64| sphere_meets(DVec3::ZERO, 10.0, DVec3::new(x, y, z), 1.0);
        assert!(!at(0.0, 0.0, 0.0));
        assert!(at(9.5, 0.0, 0.0));
        assert!(at(10.0, -0.5, -0.5));
        assert!(!at(10.1, 0.0, 0.0));
        assert!(!at(8.0, 8.0, 0.0));
    }
}
