//! Polygons to triangles by cutting off ears (Meisters 1975, *Polygons have ears*): a corner goes whose triangle turns
//! the way of the polygon and has no other vertex in it.

use ambit_base::DVec3;

/// Cuts a polygon into triangles of vertex numbers, in Radiance's order: ears are looked for from the first vertex on
/// (or from the last one backwards, if the normal's largest component is negative), and after each one the next vertex
/// is passed over. Ears without area are cut off and not given. False if there are corners left of which none is an
/// ear, because the outline crosses itself.
pub(super) fn triangulate(positions: &[DVec3], mut take: impl FnMut([usize; 3])) -> bool {
    let (flat, backwards) = project(positions);
    let mut left: Vec<usize> = (0..positions.len()).collect();
    if backwards {
        left.reverse();
    }
    let (mut at, mut failed) = (0, 0);
    while left.len() > 2 {
        let n = left.len();
        let ear = [left[(at + n - 1) % n], left[at % n], left[(at + 1) % n]];
        let [a, b, c] = ear.map(|i| flat[i]);
        let area = turn(a, b, c);
        let inside = |&i: &usize| !ear.contains(&i) && contains([a, b, c], flat[i]);
        if area < 0.0 || (area > 0.0 && left.iter().any(inside)) {
            at = (at + 1) % n;
            failed += 1;
            if failed > n {
                return false;
            }
            continue;
        }
        if area > 0.0 {
            let [a, b, c] = ear;
            take(if backwards { [c, b, a] } else { ear });
        }
        left.remove(at % n);
        failed = 0;
        // What was the next vertex is now at `at`.
        at = (at % n + 1) % (n - 1);
    }
    true
}

/// The polygon seen along the largest component of its normal, and whether it turns clockwise then.
fn project(positions: &[DVec3]) -> (Vec<[f64; 2]>, bool) {
    let first = positions[0];
    let pairs = positions.windows(2).map(|w| (w[0] - first).cross(w[1] - first));
    let normal: DVec3 = pairs.sum();
    let a = normal.abs();
    let axis = if a.x > a.y && a.x > a.z {
        0
    } else if a.y > a.z {
        1
    } else {
        2
    };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    (positions.iter().map(|p| [p[u], p[v]]).collect(), normal[axis] < 0.0)
}

/// Twice the area of a triangle, positive if it turns counter-clockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// True if a point lies in a triangle or on its border.
fn contains([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
}
