//! The general polygon: its plane, and the even–odd test in two dimensions.
//!
//! The coordinate along which the normal is largest is dropped (the first of equals). With ε = 1e-6 the boundary
//! belongs to the polygon; for oblique edges ε is held against the cross product of the edge, as Radiance does, so
//! that the tolerance in distance is ε over the length of the edge.

use ambit_base::{DVec3, EPSILON};
use ambit_scene::{Bounds, ObjectId};

/// The axis to drop for a plane with normal `n`: the one of the largest component.
pub(crate) fn dropped_axis(n: DVec3) -> usize {
    let a = n.abs();
    if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    }
}

/// The two coordinates that remain, in cyclic order after the dropped one.
#[inline]
pub(crate) fn project(p: DVec3, dropped: usize) -> [f64; 2] {
    match dropped {
        0 => [p.y, p.z],
        1 => [p.z, p.x],
        _ => [p.x, p.y],
    }
}

/// Undoes [`project`].
pub(crate) fn lift(q: [f64; 2], dropped: usize, height: f64) -> DVec3 {
    match dropped {
        0 => DVec3::new(height, q[0], q[1]),
        1 => DVec3::new(q[1], height, q[0]),
        _ => DVec3::new(q[0], q[1], height),
    }
}

/// The point of the plane `n·p = offset` over `q`.
pub(crate) fn on_plane(n: DVec3, offset: f64, dropped: usize, q: [f64; 2]) -> DVec3 {
    let flat = lift(q, dropped, 0.0);
    lift(q, dropped, (offset - n.dot(flat)) / n[dropped])
}

/// How far outside the outline a point can be that still counts as inside: √2 ε beside vertices and edges along an
/// axis; beside an oblique edge ε over its length, but no farther than its box reaches.
pub(crate) fn reach(vertices: &[[f64; 2]]) -> f64 {
    let mut most = EPSILON * std::f64::consts::SQRT_2;
    for (i, a) in vertices.iter().enumerate() {
        let b = vertices[(i + 1) % vertices.len()];
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        if length > 0.0 {
            most = most.max((EPSILON / length).min(0.5 * length));
        }
    }
    most
}

/// How negative the product of an edge of a convex outline, counter-clockwise, and the way to a point can be where the point still
/// counts as inside. [`inside`] takes what is beyond an edge by ε over its length, or by ε along an axis; such a point is
/// a point of that edge, moved, and so is off any other edge by no more than the product of that and the movement.
pub(crate) fn tolerance(vertices: &[[f64; 2]]) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (vertices[i], vertices[(i + 1) % vertices.len()]);
        [b[0] - a[0], b[1] - a[1]]
    };
    let mut most = 0.0f64;
    for i in 0..vertices.len() {
        let e = edge(i);
        let length2 = e[0] * e[0] + e[1] * e[1];
        for j in 0..vertices.len() {
            let f = edge(j);
            // A movement of ε/|e| at right angles to e, or of ε along an axis.
            let across = (e[0] * f[0] + e[1] * f[1]).abs() / length2;
            most = most.max(across).max(f[0].abs()).max(f[1].abs());
        }
    }
    1.01 * EPSILON * most
}

/// The box around all points of the plane that count as inside the outline. The tolerances along the axes that remain
/// are left to [`crate::frame`]; on the dropped axis, heights change by up to √2 of the reach.
pub(crate) fn bounds(n: DVec3, offset: f64, dropped: usize, vertices: &[[f64; 2]]) -> Bounds {
    let mut b = Bounds::EMPTY;
    for &q in vertices {
        b.add(on_plane(n, offset, dropped, q));
    }
    let more = 1.5 * reach(vertices);
    b.min[dropped] -= more;
    b.max[dropped] += more;
    b
}

/// Is `(x, y)` inside the outline, or on it? Even–odd, over the edges from each vertex to the next and back to the
/// first. The result does not depend on where the outline starts or which way it runs.
pub(crate) fn inside(x: f64, y: f64, vertices: impl Iterator<Item = [f64; 2]> + Clone) -> bool {
    let Some(mut p0) = vertices.clone().last() else { return false };
    let mut odd = false;
    for p1 in vertices {
        let (dx0, dy0) = (p0[0] - x, p0[1] - y);
        let (dx1, dy1) = (p1[0] - x, p1[1] - y);
        let (right0, right1) = (dx0 > 0.0, dx1 > 0.0);
        if dy0.abs() <= EPSILON && dy1.abs() <= EPSILON && right0 != right1 {
            return true;
        }
        if (dy0 > 0.0) != (dy1 > 0.0) {
            if right0 && right1 {
                odd = !odd;
            } else if right0 != right1 {
                let (a, b) = (dy0 * dx1, dx0 * dy1);
                if (a - b).abs() <= EPSILON {
                    return true;
                }
                if (dy1 > dy0) != (a > b) {
                    odd = !odd;
                }
            } else if dx0.abs() <= EPSILON && dx1.abs() <= EPSILON {
                return true;
            }
        }
        p0 = p1;
    }
    odd
}

/// Distance along the ray at which the plane is met; none if nearly parallel or not in front.
#[inline]
pub(crate) fn plane(n: DVec3, offset: f64, origin: DVec3, direction: DVec3) -> Option<f64> {
    let dn = direction.dot(n);
    let t = (offset - n.dot(origin)) / dn;
    (dn.abs() > EPSILON && t > EPSILON).then_some(t)
}

/// A polygon that is neither a triangle nor a convex quadrilateral.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    pub(crate) object: ObjectId,
    pub(crate) dropped: u32,
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// The vertices' place in the world's array of projected points.
    pub(crate) start: u32,
    pub(crate) len: u32,
}

impl Outline {
    /// Distance of the hit if no farther than `bound`.
    pub(crate) fn hit(&self, points: &[[f64; 2]], origin: DVec3, direction: DVec3, bound: f64) -> Option<f64> {
        let t = plane(self.normal, self.offset, origin, direction)?;
        if t > bound {
            return None;
        }
        let [x, y] = project(origin + direction * t, self.dropped as usize);
        let vertices = &points[self.start as usize..][..self.len as usize];
        inside(x, y, vertices.iter().copied()).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn edges_belong_and_the_upper_corner_does_not() {
        let hit = |x, y| inside(x, y, SQUARE.into_iter());
        assert!(hit(0.5, 0.5) && hit(0.0, 0.0) && hit(1.0, 0.5) && hit(0.5, 1.0) && hit(0.5, 0.0));
        assert!(!hit(1.0, 1.0) && !hit(1.1, 0.5) && !hit(-0.1, 0.5));
    }

    #[test]
    fn overlaps_cancel_and_seams_make_holes() {
        let seam = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ];
        let hit = |x, y| inside(x, y, seam.into_iter());
        assert!(hit(0.5, 0.25) && hit(2.5, 1.5) && hit(1.5, 2.7));
        assert!(!hit(1.5, 1.5) && !hit(1.2, 1.9) && !hit(3.5, 1.5));
    }

    #[test]
    fn direction_and_start_of_the_outline_do_not_matter() {
        let points = [[0.0, 0.0], [2.0, 0.3], [1.1, 0.9], [2.2, 2.0], [-0.3, 1.4]];
        for i in 0..4000 {
            let (x, y) = (f64::from(i % 63) * 0.05 - 0.5, f64::from(i / 63) * 0.05 - 0.5);
            let a = inside(x, y, points.into_iter());
            for k in 0..5 {
                let mut turned = points;
                turned.rotate_left(k);
                assert_eq!(a, inside(x, y, turned.into_iter()));
                turned.reverse();
                assert_eq!(a, inside(x, y, turned.into_iter()));
            }
        }
    }

    #[test]
    fn the_lifted_point_lies_on_the_plane() {
        for n in [DVec3::new(0.8, 0.6, 0.0), DVec3::new(-0.1, -0.7, 0.7), DVec3::new(0.3, 0.4, -0.866)] {
            let n = n.normalize();
            let k = dropped_axis(n);
            let p = on_plane(n, 1.7, k, [0.3, -4.0]);
            assert!((n.dot(p) - 1.7).abs() < 1e-12);
            assert_eq!(project(p, k), [0.3, -4.0]);
        }
    }
}
