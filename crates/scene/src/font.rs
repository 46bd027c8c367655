//! Fonts: polygonal glyphs on a grid of 255 by 255 units (scene.md 15.4).
//!
//! A font file repeats `code n x1 y1 … xn yn`, integers from 0 to 255 with (0, 0) the lower left corner; the polygons
//! are closed implicitly and filled even–odd. A glyph without vertices is a blank.

use crate::grammar::integer;
use crate::tokens::Tokens;
use crate::{AuxiliaryProblem, Error, ErrorKind, FontProblem};

/// Units along the side of a glyph's square.
pub const GLYPH_SIZE: i64 = 255;

/// Most vertices of a glyph.
const MAX_VERTICES: i32 = 32000;

/// Where Radiance begins when it looks for a glyph's extent: no glyph's right edge is left of this, nor its left edge
/// right of it.
const MIDDLE: u8 = 128;

/// The shape of one character.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Glyph {
    vertices: Box<[[u8; 2]]>,
    left: u8,
    right: u8,
}

/// A set of glyphs.
#[derive(Clone, Debug)]
pub struct Font {
    glyphs: Vec<Option<Glyph>>,
    mean_width: i64,
}

impl Glyph {
    fn new(vertices: Vec<[u8; 2]>) -> Self {
        let left = vertices.iter().map(|v| v[0]).fold(MIDDLE, u8::min);
        let right = vertices.iter().map(|v| v[0]).fold(MIDDLE, u8::max);
        Self { vertices: vertices.into(), left, right }
    }

    /// True if there is nothing to see.
    pub fn is_blank(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Left edge for spacing, in units; at most 128.
    pub fn left(&self) -> i64 {
        i64::from(self.left)
    }

    /// Right edge for spacing, in units; at least 128.
    pub fn right(&self) -> i64 {
        i64::from(self.right)
    }

    /// True if the point (in units, y upwards) lies inside the polygon.
    pub fn covers(&self, x: f64, y: f64) -> bool {
        let corner = |v: &[u8; 2]| (f64::from(v[0]) - x, f64::from(v[1]) - y);
        let Some((mut x0, mut y0)) = self.vertices.last().map(corner) else { return false };
        let mut inside = false;
        for (x1, y1) in self.vertices.iter().map(corner) {
            // The edge crosses the half line to the right of the point.
            if (y0 > 0.0) != (y1 > 0.0) && (x0 * y1 > x1 * y0) == (y1 > y0) {
                inside = !inside;
            }
            (x0, y0) = (x1, y1);
        }
        inside
    }
}

impl Font {
    /// Parses a font file; `path` is where it was found.
    pub fn parse(path: &str, bytes: &[u8]) -> Result<Self, Error> {
        let mut tokens = Tokens::new(bytes);
        Self::read(&mut tokens).map_err(|problem| {
            let problem = AuxiliaryProblem::Font(problem, path.to_owned());
            Error::new(ErrorKind::Auxiliary(problem), tokens.location(path))
        })
    }

    fn read(tokens: &mut Tokens<'_>) -> Result<Self, FontProblem> {
        let mut glyphs: Vec<Option<Glyph>> = vec![None; 256];
        while let Some(word) = tokens.next() {
            let code = integer(word).ok_or(FontProblem::NotInteger)?;
            let code = u8::try_from(code).ok().filter(|&c| c > 0).ok_or(FontProblem::Character(code))?;
            let slot = &mut glyphs[usize::from(code)];
            if slot.is_some() {
                return Err(FontProblem::Duplicate(code));
            }
            let mut next = || tokens.next().and_then(integer);
            let count = next().filter(|n| (0..=MAX_VERTICES).contains(n)).ok_or(FontProblem::VertexCount(code))?;
            let mut coordinate = || next().and_then(|n| u8::try_from(n).ok()).ok_or(FontProblem::Vertex(code));
            let vertices = (0..count).map(|_| Ok([coordinate()?, coordinate()?])).collect::<Result<Vec<_>, _>>()?;
            *slot = Some(Glyph::new(vertices));
        }
        let inked = || glyphs.iter().flatten().filter(|g| !g.is_blank());
        let total: i64 = inked().map(|g| g.right() - g.left()).sum();
        let mean_width = total.checked_div(inked().count() as i64).unwrap_or(GLYPH_SIZE);
        Ok(Self { glyphs, mean_width })
    }

    /// The glyph of a character code, if the font has one.
    #[inline]
    pub fn glyph(&self, code: u8) -> Option<&Glyph> {
        self.glyphs[usize::from(code)].as_ref()
    }

    /// Mean width of the glyphs that have vertices, in whole units.
    pub fn mean_width(&self) -> i64 {
        self.mean_width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn font(text: &str) -> Font {
        Font::parse("f.fnt", text.as_bytes()).unwrap()
    }

    #[test]
    fn glyphs_are_filled_even_odd() {
        let f = font(
            "65 3 0 0 255 0 255 255 #c\n66 10 0 0 255 0 255 255 0 255 0 0 50 50 200 50 200 200 50 200 50 50\n32 0",
        );
        let a = f.glyph(b'A').unwrap();
        assert!(a.covers(100.5, 100.2) && !a.covers(100.2, 100.5) && !a.covers(300.0, 10.0));
        let b = f.glyph(b'B').unwrap();
        assert!(b.covers(20.0, 100.0) && b.covers(220.0, 100.0) && !b.covers(100.0, 100.0));
        assert!(f.glyph(b' ').unwrap().is_blank() && f.glyph(b'C').is_none());
        assert!(!f.glyph(b' ').unwrap().covers(10.0, 10.0));
    }

    /// As measured with explicit spacing 0, which scales text by this width.
    #[test]
    fn widths_are_measured_from_the_middle() {
        for (extents, width) in [
            (&[(20, 120)][..], 108),
            (&[(0, 127)], 128),
            (&[(50, 100)], 78),
            (&[(0, 10)], 128),
            (&[(100, 255)], 155),
            (&[(20, 60)], 108),
            (&[(0, 100), (0, 200)], 164),
            (&[(0, 100), (0, 200), (0, 50)], 152),
            (&[(0, 10), (0, 10), (0, 10), (0, 10), (0, 10), (0, 255)], 149),
        ] {
            let bar = |(i, &(a, b)): (usize, &(i32, i32))| format!("{} 4 {a} 0 {b} 0 {b} 255 {a} 255\n", 65 + i);
            let text: String = extents.iter().enumerate().map(bar).collect();
            assert_eq!(font(&(text + "32 0")).mean_width(), width, "{extents:?}");
        }
        assert_eq!(font("").mean_width(), GLYPH_SIZE);
    }

    #[test]
    fn faults_are_worded() {
        for (text, message) in [
            ("65 0 65 0", "duplicate character (65)"),
            ("0 0", "illegal character (0)"),
            ("256 0", "illegal character (256)"),
            ("65 4 0 0 1 0", "bad vertex for character (65)"),
            ("65 1 0 256", "bad vertex for character (65)"),
            ("65 1 0 -1", "bad vertex for character (65)"),
            ("65 1 0 1.5", "bad vertex for character (65)"),
            ("65 x", "bad # vertices for character (65)"),
            ("65 -1", "bad # vertices for character (65)"),
            ("65 32001", "bad # vertices for character (65)"),
            ("65", "bad # vertices for character (65)"),
            ("x", "non-integer"),
        ] {
            let error = Font::parse("f.fnt", text.as_bytes()).unwrap_err();
            assert_eq!(error.to_string(), format!("{message} in font file \"f.fnt\""), "{text}");
        }
        let error = Font::parse("f.fnt", b"# c\n65 2 0 0\n 1 x\n").unwrap_err();
        assert_eq!(error.location().to_string(), "f.fnt:3:4");
    }
}
