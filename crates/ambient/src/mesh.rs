//! Derivatives of irradiance from hemisphere samples: the sample points form a triangle mesh of constant radiance a
//! triangle, whose irradiance is differentiated (occlusion-aware Hessian of Schwarzhaupt, Jensen, Jarosz 2012). A triangle
//! has the mean radiance of its farthest vertex and of those that lie on surfaces connected with it, so that edges of near
//! occluders move, not what is behind them. An inner edge counts with the difference of its two triangles' radiances.
//! (Radiance takes the farthest vertex alone: on a wall beside the point that is always the one higher up, and gradients at
//! a twentieth of the room's height from a wall are wrong by four tenths at 256 samples, with means by a fiftieth.)
//!
//! From its rim the mesh is continued straight down to the horizon, as walls do: uniform surroundings then have no
//! derivatives, where Radiance's open rim gives gradients of up to 0.65/m near walls. From 500 samples on, record counts stay
//! within a few per cent of Radiance's (with 64 samples they are up to a fifth higher).

use crate::derivatives::Derivatives;
use crate::edges::{Points, Weights, add_edges};
use std::f64::consts::FRAC_1_PI;

/// Derivatives of the mesh over an n × n grid of points (row by row, first index along v, second along u), n ≥ 2.
/// `values` are relative radiances less their mean.
pub(crate) fn mesh(n: usize, points: &Points, values: &[f32]) -> Derivatives {
    let near = points.nearness();
    let last = n - 1;
    // Edges to the right, down and along the diagonal (i,j+1)–(i+1,j) that cuts quads, from each cell that has them.
    let joined = Joined {
        right: points.joined(0, 1, last * n + last),
        down: points.joined(0, n, last * n),
        diagonal: points.joined(1, n, last * n - 1),
    };
    // What a triangle has, of its corners and whether those of the edges opposite to them are joined.
    let triangle = |[a, b, c]: [usize; 3], [bc, ca, ab]: [bool; 3]| -> f32 {
        // The farthest first.
        let (a, b, c, ab, ca) = if near[a] <= near[b] && near[a] <= near[c] {
            (a, b, c, ab, ca)
        } else if near[b] <= near[c] {
            (b, c, a, bc, ab)
        } else {
            (c, a, b, ca, bc)
        };
        let (b_share, c_share) = (f32::from(u8::from(ab)), f32::from(u8::from(ca)));
        (values[a] + b_share * values[b] + c_share * values[c]) / (1.0 + b_share + c_share)
    };
    // What the strips below the mesh's rim have, along each side counter-clockwise.
    let strip = |a: usize, b: usize, joined: bool| {
        if joined {
            0.5 * (values[a] + values[b])
        } else if near[b] < near[a] {
            values[b]
        } else {
            values[a]
        }
    };
    let mut right = Weights::new(last * n + last);
    let mut down = Weights::new(last * n);
    let mut diagonal = Weights::new(last * n);
    let (rights, downs, diagonals) = (right.all(), down.all(), diagonal.all());
    for (j, weight) in rights[..last].iter_mut().enumerate() {
        *weight = -strip(j, j + 1, joined.right[j]);
    }
    for i in 0..last {
        let at = i * n;
        let mut left = strip(at + n, at, joined.down[at]);
        for j in 0..last {
            let (here, beside, below, across) = (at + j, at + j + 1, at + n + j, at + n + j + 1);
            let cut = joined.diagonal[here];
            let first = triangle([here, beside, below], [cut, joined.down[here], joined.right[here]]);
            let second = triangle([across, below, beside], [cut, joined.down[beside], joined.right[below]]);
            rights[here] += first;
            rights[below] -= second;
            downs[here] = left - first;
            diagonals[here] = first - second;
            left = second;
        }
        downs[at + last] = left - strip(at + last, at + n + last, joined.down[at + last]);
    }
    // The strip below the last row runs against it.
    for (j, weight) in rights.iter_mut().enumerate().skip(last * n) {
        *weight += strip(j + 1, j, joined.right[j]);
    }
    let mut sum = Derivatives::default();
    add_edges(&mut sum, points, 0, 1, &right);
    add_edges(&mut sum, points, 0, n, &down);
    add_edges(&mut sum, points, 1, n, &diagonal);
    let rim = rim(n);
    for (k, &a) in rim.iter().enumerate() {
        let b = rim[(k + 1) % rim.len()];
        let joined = if a.abs_diff(b) == 1 { joined.right[a.min(b)] } else { joined.down[a.min(b)] };
        let value = f64::from(strip(a, b, joined));
        add_foot(&mut sum, points, b, value);
        add_foot(&mut sum, points, a, -value);
    }
    sum
}

/// Which neighbours in the grid lie on connected surfaces, by the edges from each cell.
struct Joined {
    right: Vec<bool>,
    down: Vec<bool>,
    diagonal: Vec<bool>,
}

/// Adds the end below point `k` of an edge on the horizon. What such an edge adds to the form factor is the angle under
/// which it is seen over 2π, and the derivatives of an angle are those of its ends' azimuths: ∇φ = (y, −x)/ρ².
fn add_foot(sum: &mut Derivatives, points: &Points, k: usize, value: f64) {
    let [x, y] = points.tangential(k).map(f64::from);
    let near = f64::from(points.nearness()[k]) / (x * x + y * y);
    let factor = 0.5 * FRAC_1_PI * value * near;
    sum.gradient[0] += factor * y;
    sum.gradient[1] -= factor * x;
    let factor = factor * near;
    sum.hessian[0] += 2.0 * factor * x * y;
    sum.hessian[1] += factor * (y * y - x * x);
    sum.hessian[2] -= 2.0 * factor * x * y;
}

/// Derivatives of the form factor of all that the mesh covers: of a mesh of radiance 1 only the open rim counts.
pub(crate) fn cover(n: usize, points: &Points) -> Derivatives {
    let rim = rim(n);
    // The loop's first point once more at its end.
    let around = points.picked(rim.iter().copied().chain(rim.first().copied()).collect::<Vec<_>>().into_iter());
    let mut weights = Weights::new(rim.len());
    weights.all().fill(1.0);
    let mut sum = Derivatives::default();
    add_edges(&mut sum, &around, 0, 1, &weights);
    sum
}

/// The cells of the grid's border, counter-clockwise about the normal.
fn rim(n: usize) -> Vec<usize> {
    let m = n - 1;
    let bottom = 0..m;
    let right = (0..m).map(|i| i * n + m);
    let top = (1..n).rev().map(|j| m * n + j);
    let left = (1..n).rev().map(|i| i * n);
    bottom.chain(right).chain(top).chain(left).collect()
}

/// Rotational gradient from the same cells: the mean of v·tanθ times the unit vector at azimuth + 90°, as components
/// along u and v, 1/radian.
///
/// The mean of tan²θ over the hemisphere diverges, so tanθ is replaced by its mean over the cell's ring of the disk,
/// [asin ρ − ρ√(1−ρ²)] between the ring's radii over the difference of ρ².
pub(crate) fn rotational(n: usize, points: &Points, values: &[f32]) -> [f64; 2] {
    let integral = |rho: f64| rho.min(1.0).asin() - rho * (1.0 - rho * rho).max(0.0).sqrt();
    let mut rings = vec![0.0; n];
    for (k, tangent) in rings.iter_mut().enumerate() {
        // Column k spans these coordinates of [−1, 1].
        let (a, b) = (2.0 * k as f64 / n as f64 - 1.0, 2.0 * (k + 1) as f64 / n as f64 - 1.0);
        let (outer, inner) = (a.abs().max(b.abs()), if a * b < 0.0 { 0.0 } else { a.abs().min(b.abs()) });
        *tangent = (integral(outer) - integral(inner)) / (outer * outer - inner * inner);
    }
    let mut h = [0.0; 2];
    for (row, values) in values.chunks_exact(n).enumerate() {
        for (column, v) in values.iter().enumerate() {
            let [x, y] = points.tangential(row * n + column).map(f64::from);
            let rho2 = x * x + y * y;
            if rho2 > 0.0 {
                // Outer rings have the larger tangent.
                let factor = f64::from(*v) * rings[row].max(rings[column]) / rho2.sqrt();
                h[0] -= factor * y;
                h[1] += factor * x;
            }
        }
    }
    h.map(|x| x / (n * n) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::{DVec3, Stream, square_to_disk};

    fn close(got: f64, expected: f64, tolerance: f64) {
        assert!((got - expected).abs() <= tolerance, "{got} instead of {expected}");
    }

    fn grid(n: usize) -> Vec<DVec3> {
        (0..n * n)
            .map(|c| {
                let at = |k: usize| (k as f64 + 0.5) / n as f64;
                let [p, q] = square_to_disk(at(c % n), at(c / n));
                DVec3::new(p, q, (1.0 - p * p - q * q).sqrt())
            })
            .collect()
    }

    #[test]
    fn uniform_surroundings_cancel_whatever_the_shape() {
        // A wall 0.1 away: nearness is up to 10, and its square what the Hessian consists of.
        let points = Points::new(grid(16).into_iter().map(|d| (d, (d.x.max(0.02) / 0.1) as f32, DVec3::ZERO)));
        let d = mesh(16, &points, &[1.0; 256]);
        assert!(d.gradient.iter().all(|g| g.abs() < 1e-14), "{d:?}");
        assert!(d.hessian.iter().all(|h| h.abs() < 1e-12), "{d:?}");
    }

    /// Every triangle, and the strips down to the horizon, one edge after the other.
    fn one_by_one(n: usize, points: &[DVec3], values: &[f32]) -> Derivatives {
        let mut sum = Derivatives::default();
        // Of surfaces that face the origin: neither is farther in front of the other's plane than it recedes between them.
        let joined = |a: usize, b: usize| {
            let (r, s) = (points[a].length(), points[b].length());
            let cosine = points[a].dot(points[b]) / (r * s);
            (s * cosine - r) * (s - r * cosine) / (r * s) <= 0.0
        };
        let value = |corners: &[usize]| {
            let mut far = corners[0];
            for &c in &corners[1..] {
                far = if points[c].length_squared() > points[far].length_squared() { c } else { far };
            }
            let with: Vec<f64> =
                corners.iter().filter(|c| **c == far || joined(far, **c)).map(|c| f64::from(values[*c])).collect();
            with.iter().sum::<f64>() / with.len() as f64
        };
        let mut polygon = |corners: &[DVec3], value: f64| {
            for (k, &a) in corners.iter().enumerate() {
                sum.add_edge(a, corners[(k + 1) % corners.len()], value);
            }
        };
        for i in 0..n - 1 {
            for j in 0..n - 1 {
                let (a, b, c, d) = (i * n + j, i * n + j + 1, i * n + n + j, i * n + n + j + 1);
                polygon(&[points[a], points[b], points[c]], value(&[a, b, c]));
                polygon(&[points[d], points[c], points[b]], value(&[d, c, b]));
            }
        }
        let rim = rim(n);
        for (k, &a) in rim.iter().enumerate() {
            let b = rim[(k + 1) % rim.len()];
            let foot = |p: DVec3| DVec3::new(p.x, p.y, 0.0);
            polygon(&[points[b], points[a], foot(points[a]), foot(points[b])], value(&[a, b]));
        }
        sum
    }

    #[test]
    fn the_mesh_is_the_sum_of_its_triangles_and_strips() {
        for n in [7, 8, 16, 21] {
            for key in 0..20 {
                let draw = |tag: u64, cell: usize| Stream::new(0, key).split(tag, cell as u32).one();
                let scale = [1e-4, 1.0, 1e5][key as usize % 3];
                let distances: Vec<f64> = (0..n * n).map(|c| scale * (1.0 + 3.0 * draw(1, c))).collect();
                let values: Vec<f32> = (0..n * n).map(|c| draw(2, c) as f32 - 0.5).collect();
                let columns = || grid(n).into_iter().zip(&distances);
                let corners: Vec<DVec3> = columns().map(|(d, r)| d * *r).collect();
                let points = Points::new(
                    columns().map(|(d, r)| (d, (1.0 / r) as f32, DVec3::ZERO)).collect::<Vec<_>>().into_iter(),
                );
                let (got, exact) = (mesh(n, &points, &values), one_by_one(n, &corners, &values));
                // Coarse meshes have long edges.
                let tolerance = if n < 16 { 1e-2 } else { 1e-3 };
                for (x, y) in got.gradient.iter().zip(exact.gradient) {
                    close(x * scale, y * scale, tolerance * 0.1);
                }
                for (x, y) in got.hessian.iter().zip(exact.hessian) {
                    close(x * scale * scale, y * scale * scale, tolerance);
                }
            }
        }
    }

    /// A floor at distance `h` from a wall whose radiance falls off with height, under a grey sky: the cells of a grid of
    /// side `n` (directions, reciprocal distances, radiances).
    fn beside_a_wall(n: usize, h: f64) -> Vec<(DVec3, f32, f64)> {
        let seen = |d: DVec3| {
            if d.x < 0.0 {
                let t = -h / d.x;
                (d, (1.0 / t) as f32, 2.0 * (-t * d.z).exp())
            } else {
                (d, 1e-9, 0.5)
            }
        };
        grid(n).into_iter().map(seen).collect()
    }

    #[test]
    fn gradients_beside_a_wall_come_of_connected_surfaces() {
        let mean = |h: f64| beside_a_wall(1000, h).iter().map(|c| c.2).sum::<f64>() / 1e6;
        for h in [0.05, 0.1, 0.3] {
            // The wall lies towards −x: along x the point moves away from it.
            let step = 0.1 * h;
            let exact = (mean(h + step) - mean(h - step)) / (2.0 * step) / mean(h);
            let cells = beside_a_wall(16, h);
            let whole = cells.iter().map(|c| c.2).sum::<f64>() / cells.len() as f64;
            let values: Vec<f32> = cells.iter().map(|c| (c.2 / whole - 1.0) as f32).collect();
            let normal = |d: DVec3| if d.x < 0.0 { DVec3::X } else { DVec3::ZERO };
            let points = Points::new(cells.iter().map(|c| (c.0, c.1, normal(c.0))).collect::<Vec<_>>().into_iter());
            // With the radiance of the farthest vertex alone it is off by a quarter at the nearest.
            close(mesh(16, &points, &values).gradient[0], exact, 0.1 * exact.abs());
        }
    }

    #[test]
    fn ring_means_sum_to_the_mean_tangent() {
        // All light at azimuth 0 to 90°: the mean of tanθ over the hemisphere is π/2, of the unit vectors 2/π.
        for n in [7, 16, 33] {
            let grid = grid(n);
            let values: Vec<f32> = grid.iter().map(|p| f32::from(u8::from(p.x > 0.0 && p.y > 0.0))).collect();
            let points = Points::new(grid.into_iter().map(|d| (d, 0.0, DVec3::ZERO)));
            let [hu, hv] = rotational(n, &points, &values);
            let tolerance = if n == 7 { 0.1 } else { 0.02 };
            close(hu, -0.25, tolerance);
            close(hv, 0.25, tolerance);
        }
    }

    #[test]
    fn the_rim_is_a_closed_loop() {
        let rim = rim(8);
        assert_eq!(rim.len(), 28);
        for (k, &a) in rim.iter().enumerate() {
            let b = rim[(k + 1) % 28];
            assert!((a / 8).abs_diff(b / 8) + (a % 8).abs_diff(b % 8) == 1);
        }
    }
}
