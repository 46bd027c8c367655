//! Text on surfaces: what brighttext, colortext and mixtext have in common.

use super::compiler::Compiler;
use crate::Error;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{DVec3, Transform};
use ambit_scene::{ObjectId, Scene, TextBlock};

/// Longest text given word by word, in bytes.
const MAX_WORDS: usize = 511;

impl Compiler<'_> {
    /// Lays out the text of primitive `id`: string `font` names the font, what follows is the text. The reals begin
    /// with origin and motion vectors; the spacing is number `spacing`, if there is one.
    pub(crate) fn lettering(
        &mut self,
        scene: &Scene,
        id: ObjectId,
        font: usize,
        spacing: usize,
    ) -> Result<TextBlock, Error> {
        let bad = |text: &str| Error::primitive(scene, id, text);
        let r = scene.reals(id);
        let (Some(name), 9..) = (scene.string(id, font), r.len()) else { return Err(bad("bad # arguments")) };
        let vector = |i: usize| DVec3::new(r[i], r[i + 1], r[i + 2]);
        let (origin, right, down) = (vector(0), vector(3), vector(6));
        let text = match scene.string_count(id) - font {
            0 | 1 => return Err(bad("bad # arguments")),
            2 => {
                let file = scene.string(id, font + 1).unwrap_or_default();
                self.files.text(scene, id, &file)?
            }
            _ => {
                let words: Vec<&[u8]> = scene.strings_bytes(id).skip(font + 2).collect();
                let text = words.join(&b' ');
                if text.len() > MAX_WORDS {
                    return Err(bad("text too long"));
                }
                text
            }
        };
        let font = self.files.font(scene, id, &name)?;
        let lines: Vec<&[u8]> = text.split(|&b| b == b'\n').collect();
        TextBlock::new(font, lines, origin, right, down, r.get(spacing).copied())
            .map_err(|problem| bad(&problem.to_string()))
    }
}

impl<O: Observer> Walk<'_, O> {
    /// True if the hit lies inside a glyph.
    pub(crate) fn lettered(&self, ray: &Ray<'_>, text: &TextBlock) -> bool {
        text.covers(self.function_frame(ray, &Transform::default()).point_back(ray.point))
    }
}
