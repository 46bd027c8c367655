//! Text laid out in space: lines of glyphs over a slanted grid of characters (scene.md 13.1).
//!
//! A point P is solved for P = O + x R + y D + z (D × R); x counts characters to the right, y lines down. Along a line
//! positions are whole glyph units. Without spacing every character that the font has is one square wide; with spacing
//! s, x is scaled by (w + 255 |s|), w being the font's mean width, and glyphs take their own widths with a gap of
//! 2 ⌊⌊255 |s|⌋ / 2⌋ between them. Positive spacing then stretches or squeezes the gaps, run by run, so that a run of n
//! characters takes n (w + ⌊255 s⌋): columns line up. A run ends after three or more blanks that follow a character.

use crate::font::{Font, GLYPH_SIZE};
use crate::{Glyph, Problem};
use ambit_base::{DVec3, EPSILON};
use std::sync::Arc;

/// Blanks in a row that end a run, if a character of the font precedes them.
const RUN_BREAK: usize = 3;

/// Widest gap, in units: spacing beyond any use is held to this, which keeps sums far from overflow.
const MAX_GAP: f64 = 1e9;

/// How characters follow each other on a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layout {
    /// One square each.
    Uniform,
    /// Own widths, half a gap before and after.
    Proportional { half: i64 },
    /// Own widths, gaps adjusted so that characters average `cell` units.
    Squeezed { half: i64, cell: i64 },
}

/// A glyph with ink and its place on a line.
#[derive(Clone, Copy, Debug)]
struct Placed {
    code: u8,
    /// Left edge of the glyph's square, in units.
    origin: i64,
    /// Left of this the glyph is hidden: the farthest origin of it and whatever precedes it. (Squeezed glyphs overlap.)
    from: i64,
}

/// What there is to see of a line.
#[derive(Clone, Debug)]
struct Line {
    placed: Box<[Placed]>,
    /// Nothing shows from here on.
    end: i64,
}

/// Text in space.
#[derive(Clone, Debug)]
pub struct TextBlock {
    font: Arc<Font>,
    lines: Vec<Line>,
    origin: DVec3,
    /// Gives units to the right.
    right: DVec3,
    /// Gives lines down.
    down: DVec3,
}

impl TextBlock {
    /// Lays out lines of character codes with upper left corner `origin`, one character to the `right` and one line
    /// `down`, in scene units; `spacing` as given after the other arguments of a text, if it was.
    ///
    /// # Errors
    /// [`Problem::IllegalMotion`] if the two motion vectors are parallel.
    pub fn new<L: AsRef<[u8]>>(
        font: Arc<Font>,
        lines: impl IntoIterator<Item = L>,
        origin: DVec3,
        right: DVec3,
        down: DVec3,
        spacing: Option<f64>,
    ) -> Result<Self, Problem> {
        let normal = right.cross(down);
        let parallel = normal.length() <= EPSILON * right.length() * down.length();
        if parallel || !normal.is_finite() || !origin.is_finite() {
            return Err(Problem::IllegalMotion);
        }
        let (layout, cell) = Layout::new(&font, spacing);
        let (to_right, to_down) = (down.cross(normal), normal.cross(right));
        let lines = lines.into_iter().map(|line| layout.place(&font, line.as_ref())).collect();
        Ok(Self {
            lines,
            origin,
            right: to_right * (cell / right.dot(to_right)),
            down: to_down / down.dot(to_down),
            font,
        })
    }

    /// True if a point, moved along the normal of the text's plane, falls inside a glyph.
    pub fn covers(&self, point: DVec3) -> bool {
        let d = point - self.origin;
        let (x, y) = (d.dot(self.right), d.dot(self.down));
        if !(x >= 0.0 && y >= 0.0) {
            return false;
        }
        // The cast of a large number gives the largest index.
        let Some(line) = self.lines.get(y as usize) else { return false };
        let height = GLYPH_SIZE as f64 * (1.0 - y.fract());
        x < line.end as f64
            && line.placed.iter().take_while(|p| p.from as f64 <= x).any(|p| {
                let inner = x - p.origin as f64;
                inner <= GLYPH_SIZE as f64 && self.font.glyph(p.code).is_some_and(|g| g.covers(inner, height))
            })
    }
}

impl Layout {
    /// The layout and the units that one character's motion to the right is worth.
    fn new(font: &Font, spacing: Option<f64>) -> (Self, f64) {
        let Some(spacing) = spacing else { return (Self::Uniform, GLYPH_SIZE as f64) };
        let gap = (GLYPH_SIZE as f64 * spacing.abs()).min(MAX_GAP);
        let (units, width) = (gap as i64, font.mean_width());
        let layout = if units == 0 {
            Self::Uniform
        } else if spacing < 0.0 {
            Self::Proportional { half: units / 2 }
        } else {
            Self::Squeezed { half: units / 2, cell: width + units }
        };
        (layout, width as f64 + gap)
    }

    fn place(self, font: &Font, line: &[u8]) -> Line {
        let spaces = match self {
            Self::Uniform => vec![0; line.len() + 1],
            Self::Proportional { half } => natural_spaces(font, line, half),
            Self::Squeezed { half, cell } => {
                let mut spaces = natural_spaces(font, line, half);
                squeeze(font, line, cell, &mut spaces);
                spaces
            }
        };
        let mut placed = Vec::new();
        let (mut position, mut from) = (0, i64::MIN);
        for (&code, space) in line.iter().zip(&spaces) {
            position += *space;
            from = from.max(position);
            let Some(glyph) = font.glyph(code) else { continue };
            if !glyph.is_blank() {
                placed.push(Placed { code, origin: position, from });
            }
            position += if self == Self::Uniform { GLYPH_SIZE } else { advance(font, glyph) };
        }
        Line { placed: placed.into(), end: position + spaces[line.len()] }
    }
}

/// From a glyph's origin to its right edge; blanks are as wide as the mean.
fn advance(font: &Font, glyph: &Glyph) -> i64 {
    if glyph.is_blank() { font.mean_width() } else { glyph.right() }
}

/// The space before each character's origin, and after the last: half a gap on either side of glyphs with ink and at
/// both ends of the line, less what is empty in a glyph's square to its left. Characters that the font lacks take over
/// what their predecessor leaves, but not the margin.
fn natural_spaces(font: &Font, line: &[u8], half: i64) -> Vec<i64> {
    let mut spaces = Vec::with_capacity(line.len() + 1);
    let (mut margin, mut after) = (half, 0);
    for &code in line {
        let mut space = std::mem::take(&mut after);
        if let Some(glyph) = font.glyph(code) {
            space += std::mem::take(&mut margin);
            if !glyph.is_blank() {
                space += half - glyph.left();
                after = half;
            }
        }
        spaces.push(space);
    }
    spaces.push(after + half);
    spaces
}

/// Adjusts the spaces so that each run of characters takes `cell` units a character of the font.
fn squeeze(font: &Font, line: &[u8], cell: i64, spaces: &mut [i64]) {
    let is_blank = |&code: &u8| font.glyph(code).is_some_and(Glyph::is_blank);
    let mut start = 0;
    while start < line.len() {
        let rest = &line[start..];
        let breaks = |k: usize| {
            let blanks = rest[k + 1..].iter().take_while(|c| is_blank(c)).count();
            (font.glyph(rest[k]).is_some() && blanks >= RUN_BREAK).then_some(k + 1 + blanks)
        };
        let length = (0..rest.len()).find_map(breaks).unwrap_or(rest.len());
        let glyphs = || rest[..length].iter().filter_map(|&code| font.glyph(code));
        let inner = &mut spaces[start + 1..=start + length];
        let taken: i64 = glyphs().map(|g| advance(font, g)).sum::<i64>() + inner.iter().sum::<i64>();
        let mut missing = cell * glyphs().count() as i64 - taken;
        for (i, space) in inner.iter_mut().enumerate() {
            let share = missing / (length - i) as i64;
            *space += share;
            missing -= share;
        }
        start += length;
    }
}

#[cfg(test)]
mod tests;
