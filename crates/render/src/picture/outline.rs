//! The outlines of a scene's light sources.

use super::small::SourceOutline;
use crate::sources::{Emitter, Source};
use ambit_base::DVec3;

/// The outlines of the sources that may be too small for a picture's pixels: all that are seen and light others, but
/// illums, which are windows, and images in mirrors.
pub(crate) fn outlines(sources: &[Source]) -> Vec<SourceOutline> {
    let drawn = sources.iter().enumerate().filter(|(_, s)| s.sampled && !s.illum && s.image.is_none());
    drawn.map(|(i, source)| outline(i as u32, source)).collect()
}

fn outline(number: u32, source: &Source) -> SourceOutline {
    let [u, v, w] = source.axes;
    let flat = matches!(source.emitter, Emitter::Polygon(_) | Emitter::Ring(_));
    let distant = matches!(source.emitter, Emitter::Distant);
    let signs = [-1.0, 1.0];
    let depth = if flat || distant { &signs[..1] } else { &signs[..] };
    let mut corners: Vec<DVec3> = Vec::with_capacity(8);
    for a in signs {
        for b in signs {
            for &c in depth {
                let third = if flat || distant { DVec3::ZERO } else { w * c };
                corners.push(source.centre + u * a + v * b + third);
            }
        }
    }
    let facing = flat.then_some((source.centre, source.normal));
    SourceOutline { source: number, corners, distant, radius: source.radius, facing }
}
