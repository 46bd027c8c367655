//! The root cube of an octree, in scene units and world coordinates: derivation from bounding boxes and the decimal
//! text in which files keep it.
//!
//! The cube that fits a scene is the union of its objects' boxes, grown by [`MARGIN`] on every side, with the longest
//! side as edge and the same centre.

use ambit_base::{DVec3, EPSILON};
use ambit_file::general;
use ambit_scene::Bounds;

/// What is added on each side of a scene's bounds, in scene units: ten times the "tiny" of the simulation, so that
/// surfaces lying in the faces of the bounds are well inside.
pub const MARGIN: f64 = 10.0 * EPSILON;

/// Significant digits of the cube's numbers in a file.
const DIGITS: usize = 12;

/// An axis-aligned cube, half open: a point belongs to it if `origin <= p < origin + edge`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cube {
    /// Corner with the smallest coordinates.
    pub origin: DVec3,
    /// Length of the edges; 0 for a scene without bounded objects.
    pub edge: f64,
}

impl Cube {
    /// The cube around the bounds of all objects; the empty one if there are none.
    pub fn around(bounds: Option<Bounds>) -> Self {
        let Some(b) = bounds else { return Self::default() };
        let lo = b.min - MARGIN;
        let hi = b.max + MARGIN;
        let mut size = hi - lo;
        // Radiance 6.0a as distributed adds up the last side in this order; far from the origin the digits show it.
        size.z = (hi.z - b.min.z) + MARGIN;
        let edge = size.x.max(size.y).max(size.z);
        let mut origin = (hi + lo - edge) * 0.5;
        // So too the middle of that side, without the margins, which cancel.
        origin.z = (b.max.z + b.min.z - edge) * 0.5;
        Self { origin, edge }
    }

    /// The cube of `oconv -b x y z size`: a margin more on every side.
    pub fn given(corner: DVec3, size: f64) -> Self {
        Self { origin: corner - MARGIN, edge: size + 2.0 * MARGIN }
    }

    /// Child 0 … 7: upper x if bit 0 is set, upper y for bit 1, upper z for bit 2.
    #[inline]
    pub fn child(&self, number: usize) -> Self {
        let edge = self.edge * 0.5;
        let mut origin = self.origin;
        for axis in 0..3 {
            if number >> axis & 1 != 0 {
                origin[axis] += edge;
            }
        }
        Self { origin, edge }
    }

    /// Corner 0 … 7, numbered as the children are.
    #[inline]
    pub fn corner(&self, number: usize) -> DVec3 {
        let mut p = self.origin;
        for axis in 0..3 {
            if number >> axis & 1 != 0 {
                p[axis] += self.edge;
            }
        }
        p
    }

    /// True if the box lies inside.
    pub fn encloses(&self, b: &Bounds) -> bool {
        b.min.cmpge(self.origin).all() && b.max.cmple(self.origin + self.edge).all()
    }

    /// Origin and edge as files have them: `%.12g`.
    pub fn to_text(&self) -> [String; 4] {
        [self.origin.x, self.origin.y, self.origin.z, self.edge].map(|v| general(v, DIGITS))
    }

    /// Reads the four numbers of a file the way C's `atof` does; none if one is not finite.
    pub fn from_text(text: [&[u8]; 4]) -> Option<Self> {
        let [x, y, z, edge] = text.map(leading_number);
        let cube = Self { origin: DVec3::new(x, y, z), edge };
        (cube.origin.is_finite() && edge.is_finite()).then_some(cube)
    }
}

/// The number a text begins with, after blanks; 0 if there is none.
fn leading_number(text: &[u8]) -> f64 {
    let text = text.trim_ascii_start();
    let mut at = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let digits = |from: usize| text[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let whole = digits(at);
    at += whole;
    let mut end = at;
    if text.get(at) == Some(&b'.') {
        let fraction = digits(at + 1);
        if whole + fraction > 0 {
            end = at + 1 + fraction;
        }
    }
    if end > 0 && matches!(text.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
        let power = digits(end + 1 + sign);
        if power > 0 {
            end += 1 + sign + power;
        }
    }
    std::str::from_utf8(&text[..end]).ok().and_then(|t| t.parse().ok()).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_is_centred_on_the_bounds() {
        let b = Bounds { min: DVec3::ZERO, max: DVec3::new(4.0, 4.0, 3.0) };
        let text = Cube::around(Some(b)).to_text();
        assert_eq!(text, ["-9.99999999984e-06", "-9.99999999984e-06", "-0.50001", "4.00002"]);
        let point = Bounds { min: DVec3::ONE, max: DVec3::ONE };
        assert_eq!(Cube::around(Some(point)).to_text(), ["0.99999", "0.99999", "0.99999", "2.00000000001e-05"]);
        assert_eq!(Cube::around(None).to_text(), ["0", "0", "0", "0"]);
        // The exact lower z ends in ...8931555: which way it goes the last bit says.
        let b = Bounds {
            min: DVec3::new(-1.47834662954, -1.65067639, -0.852789704),
            max: DVec3::new(0.620363752193, 1.48, 1.66394823089),
        };
        assert_eq!(Cube::around(Some(b)).to_text(), ["-1.99433963367", "-1.65068639", "-1.15976893156", "3.13069639"]);
        assert_eq!(Cube::given(DVec3::splat(-1.0), 8.0).to_text()[3], "8.00002");
    }

    #[test]
    fn numbers_are_read_as_far_as_they_go() {
        for (text, value) in [
            ("-1.00001", -1.00001),
            ("  4.5e1x", 45.0),
            ("1e", 1.0),
            ("1e+", 1.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("", 0.0),
            ("-", 0.0),
            (".", 0.0),
            ("abc", 0.0),
            ("x2", 0.0),
            ("-9.99999999984e-06", -9.99999999984e-06),
        ] {
            assert_eq!(leading_number(text.as_bytes()), value, "{text}");
        }
        assert!(Cube::from_text([b"1", b"2", b"3", b"1e999"]).is_none());
    }

    #[test]
    fn children_and_corners_share_their_numbering() {
        let c = Cube { origin: DVec3::ZERO, edge: 2.0 };
        assert_eq!(c.child(5), Cube { origin: DVec3::new(1.0, 0.0, 1.0), edge: 1.0 });
        assert_eq!(c.corner(6), DVec3::new(0.0, 2.0, 2.0));
    }
}
