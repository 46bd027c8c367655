//! Perlin's improved noise (K. Perlin, "Improving Noise", SIGGRAPH 2002), with the differences Radiance takes of it.
//! Answers function-files.md 8.1 and 8.2.

/// Perlin's published permutation.
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99, 37, 240,
    21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88,
    237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83,
    111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216,
    80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186,
    3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17,
    182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129,
    22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238,
    210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184,
    84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195,
    78, 66, 215, 61, 156, 180,
];

/// Step of the backward differences.
const STEP: f64 = 0.0005;

/// Cells beyond this have no fractional part left to speak of; the noise is 0 there.
const LIMIT: f64 = 4503599627370496.0;

fn hash(index: i64) -> i64 {
    i64::from(PERMUTATION[(index & 255) as usize])
}

/// Dot product of the gradient at corner `h` with the vector from it.
fn gradient(h: i64, x: f64, y: f64, z: f64) -> f64 {
    let h = h & 15;
    let u = if h < 8 { x } else { y };
    let v = match h {
        0..4 => y,
        12 | 14 => x,
        _ => z,
    };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

fn weight(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn mix(t: f64, from: f64, to: f64) -> f64 {
    from + t * (to - from)
}

/// The cell a coordinate lies in, and its place there; negative integers belong to the cell below.
fn cell(x: f64) -> (i64, f64) {
    let cell = x as i64 - i64::from(x < 0.0);
    (cell, x - cell as f64)
}

/// Noise at a point: continuous, 0 on the integer lattice, within about ±1.
pub fn noise3(x: f64, y: f64, z: f64) -> f64 {
    if x.abs() > LIMIT || y.abs() > LIMIT || z.abs() > LIMIT {
        return 0.0;
    }
    let ((i, x), (j, y), (k, z)) = (cell(x), cell(y), cell(z));
    let (u, v, w) = (weight(x), weight(y), weight(z));
    let (a, b) = (hash(i) + j, hash(i + 1) + j);
    let (aa, ab, ba, bb) = (hash(a) + k, hash(a + 1) + k, hash(b) + k, hash(b + 1) + k);
    let edge = |low: i64, high: i64, dy: f64, dz: f64| {
        mix(u, gradient(hash(low), x, y - dy, z - dz), gradient(hash(high), x - 1.0, y - dy, z - dz))
    };
    let bottom = mix(v, edge(aa, ba, 0.0, 0.0), edge(ab, bb, 1.0, 0.0));
    let top = mix(v, edge(aa + 1, ba + 1, 0.0, 1.0), edge(ab + 1, bb + 1, 1.0, 1.0));
    mix(w, bottom, top)
}

/// Difference of the noise along x.
pub fn noise3x(x: f64, y: f64, z: f64) -> f64 {
    (noise3(x, y, z) - noise3(x - STEP, y, z)) / STEP
}

/// Difference of the noise along y.
pub fn noise3y(x: f64, y: f64, z: f64) -> f64 {
    (noise3(x, y, z) - noise3(x, y - STEP, z)) / STEP
}

/// Difference of the noise along z.
pub fn noise3z(x: f64, y: f64, z: f64) -> f64 {
    (noise3(x, y, z) - noise3(x, y, z - STEP)) / STEP
}
