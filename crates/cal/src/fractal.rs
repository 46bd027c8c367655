//! Fractal noise by midpoint displacement in the unit cube around a point. Answers function-files.md 8.3.

/// Lattice steps to the unit of length.
const UNIT: i64 = 2000;

/// Displacement for each lattice step of the cube's size.
const ROUGHNESS: f64 = 0.0005;

/// The value of a lattice point in (−1, 1]: an integer hash of which the low 31 bits matter.
fn lattice(p: [i64; 3]) -> f64 {
    let s = p[0].wrapping_mul(17).wrapping_add(p[1].wrapping_mul(23)).wrapping_add(p[2].wrapping_mul(29)) as u64;
    let s = s.wrapping_mul(1 << 13) ^ s;
    let s = s.wrapping_mul(s.wrapping_mul(s).wrapping_mul(15731).wrapping_add(789221)).wrapping_add(1376312589);
    1.0 - (s & 0x7fff_ffff) as f64 / 1073741824.0
}

/// `p` moved by `step` along the axes of the bits of `axes`: up where `octant` has the bit, down where not.
fn moved(mut p: [i64; 3], step: i64, axes: usize, octant: usize) -> [i64; 3] {
    for (axis, coordinate) in p.iter_mut().enumerate() {
        if axes >> axis & 1 == 1 {
            *coordinate = coordinate.wrapping_add(if octant >> axis & 1 == 1 { step } else { -step });
        }
    }
    p
}

/// Fractal noise at a point; not confined to ±1.
pub fn fnoise3(x: f64, y: f64, z: f64) -> f64 {
    if !(x.is_finite() && y.is_finite() && z.is_finite()) {
        return f64::NAN;
    }
    let unit = UNIT as f64;
    let target = [x, y, z].map(|c| (unit * c) as i64);
    let mut base = [x, y, z].map(|c| UNIT.wrapping_mul(c.floor() as i64));
    let mut corners: [f64; 8] = std::array::from_fn(|c| lattice(moved(base, UNIT, c, c)));
    let mut step = UNIT;
    loop {
        let mean = corners.iter().sum::<f64>() / 8.0;
        step /= 2;
        if step == 0 {
            return mean;
        }
        let rough = ROUGHNESS * step as f64;
        let centre = base.map(|c| c.wrapping_add(step));
        let octant: usize = (0..3).map(|axis| usize::from(target[axis] > centre[axis]) << axis).sum();
        let old = corners;
        corners[7 ^ octant] = mean + rough * lattice(centre);
        for axis in 0..3 {
            let bit = 1 << axis;
            let face: f64 = (0..8).filter(|c| (c ^ octant) & bit == 0).map(|c| old[c]).sum();
            corners[7 ^ octant ^ bit] = face / 4.0 + rough * lattice(moved(centre, step, bit, octant));
            let edge = old[octant & !bit] + old[octant | bit];
            corners[octant ^ bit] = edge / 2.0 + rough * lattice(moved(centre, step, 7 ^ bit, octant));
        }
        base = moved(base, step, octant, octant);
    }
}
