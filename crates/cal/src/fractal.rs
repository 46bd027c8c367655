//! Fractal noise by midpoint displacement in the unit cube around a point. Answers function-files.md 8.3.

/// Lattice steps to the unit of length.
const UNIT: i64 = 2000;

/// Displacement for each lattice step of the cube's size.
const ROUGHNESS: f64 = 0.0005;

/// What the hash of a lattice point takes of each coordinate.
const STRIDE: [u32; 3] = [17, 23, 29];

/// The value in (−1, 1] of a lattice point whose coordinates times [`STRIDE`] sum up to `s`: an integer hash of which the
/// low 31 bits matter.
#[inline]
fn lattice(s: u32) -> f64 {
    let s = s.wrapping_mul(1 << 13) ^ s;
    let s = s.wrapping_mul(s.wrapping_mul(s).wrapping_mul(15731).wrapping_add(789221)).wrapping_add(1376312589);
    1.0 - f64::from(s & 0x7fff_ffff) / 1073741824.0
}

/// The sum that [`lattice`] takes.
fn strides(p: [i64; 3]) -> u32 {
    (0..3).fold(0, |s, axis| s.wrapping_add(STRIDE[axis].wrapping_mul(p[axis] as u32)))
}

/// Fractal noise at a point; not confined to ±1.
pub fn fnoise3(x: f64, y: f64, z: f64) -> f64 {
    if !(x.is_finite() && y.is_finite() && z.is_finite()) {
        return f64::NAN;
    }
    let unit = UNIT as f64;
    let target = [x, y, z].map(|c| (unit * c) as i64);
    let mut base = [x, y, z].map(|c| UNIT.wrapping_mul(c.floor() as i64));
    let corner = |c: usize| std::array::from_fn(|axis| base[axis].wrapping_add((c >> axis & 1) as i64 * UNIT));
    let mut corners: [f64; 8] = std::array::from_fn(|c| lattice(strides(corner(c))));
    let mut step = UNIT;
    loop {
        let mean = corners.iter().sum::<f64>() / 8.0;
        step /= 2;
        if step == 0 {
            return mean;
        }
        let rough = ROUGHNESS * step as f64;
        let centre = base.map(|c| c.wrapping_add(step));
        let up: [bool; 3] = std::array::from_fn(|axis| target[axis] > centre[axis]);
        let octant = usize::from(up[0]) | usize::from(up[1]) << 1 | usize::from(up[2]) << 2;
        // Corners numbered from the one in the octant: bit k says that it lies away from there along axis k.
        let from: [f64; 8] = std::array::from_fn(|c| corners[c ^ octant]);
        let middle = strides(centre);
        let moves: [u32; 3] = std::array::from_fn(|axis| {
            let by = STRIDE[axis].wrapping_mul(step as u32);
            if up[axis] { by } else { by.wrapping_neg() }
        });
        let at = |c: usize| {
            // Towards the octant along the axes along which the corner does not lie away.
            let shift = (0..3).fold(0u32, |s, k| if c >> k & 1 == 0 { s.wrapping_add(moves[k]) } else { s });
            rough * lattice(middle.wrapping_add(shift))
        };
        let next = [
            from[0],
            0.5 * (from[0] + from[1]) + at(1),
            0.5 * (from[0] + from[2]) + at(2),
            0.25 * (from[0] + from[1] + from[2] + from[3]) + at(3),
            0.5 * (from[0] + from[4]) + at(4),
            0.25 * (from[0] + from[1] + from[4] + from[5]) + at(5),
            0.25 * (from[0] + from[2] + from[4] + from[6]) + at(6),
            mean + at(7),
        ];
        corners = std::array::from_fn(|c| next[c ^ octant]);
        base = std::array::from_fn(|axis| if up[axis] { base[axis].wrapping_add(step) } else { base[axis] });
    }
}
