//! Parts of a source: flat sources and cylinders are halved until each part is small against its distance (`-ds`).

use crate::sources::{Emitter, Source};
use ambit_base::DVec3;

/// Halvings at most: 64 equal parts.
const DEEPEST: u32 = 6;

/// A part in the coordinates of the source's axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Centre, in [−1,1]³.
    pub(crate) centre: [f64; 3],
    /// Half-widths along the axes.
    pub(crate) half: [f64; 3],
    /// Share of the source's size.
    pub(crate) share: f64,
}

/// All of a source.
pub(super) const WHOLE: Part = Part { centre: [0.0; 3], half: [1.0; 3], share: 1.0 };

/// The parts of `source` for a point, in subdivision order; `ratio` is `-ds` over the weight of the ray that hit
/// (infinite for undivided sources). Nothing if the point cannot be lit.
pub(crate) fn parts(source: &Source, point: DVec3, ratio: f64, out: &mut Vec<Part>) {
    out.clear();
    match &source.emitter {
        Emitter::Polygon(_) | Emitter::Ring(_) => {
            if source.normal.dot(point - source.centre) <= ambit_base::EPSILON {
                return;
            }
            divide(source, point, ratio, 2, WHOLE, DEEPEST, out);
        }
        Emitter::Cylinder(c) => {
            // Inside the square that is sampled there is no light; up to twice that distance division gains nothing.
            let to = point - c.p0;
            let off = (to - c.axis * to.dot(c.axis)).length_squared();
            let near = 1.365 * (source.axes[1].length_squared());
            if off < near {
                return;
            }
            if off < 4.0 * near {
                out.push(WHOLE);
            } else {
                divide(source, point, ratio, 1, WHOLE, DEEPEST, out);
            }
        }
        Emitter::Sphere(_) | Emitter::Distant => out.push(WHOLE),
    }
}

/// Halves the longest of the first `axes` axes as long as the point is too near for the part's width.
fn divide(source: &Source, point: DVec3, ratio: f64, axes: usize, part: Part, depth: u32, out: &mut Vec<Part>) {
    let longest = if axes == 1 {
        0
    } else {
        let u = source.axes[0].length_squared() * part.half[0] * part.half[0];
        let v = source.axes[1].length_squared() * part.half[1] * part.half[1];
        usize::from(u <= v)
    };
    let width = source.axes[longest].length() * part.half[longest];
    let centre = source.centre + (0..axes).map(|i| source.axes[i] * part.centre[i]).sum::<DVec3>();
    if depth == 0 || !ratio.is_finite() || point.distance(centre) * ratio >= 2.0 * width {
        out.push(part);
        return;
    }
    let mut child = part;
    child.share *= 0.5;
    child.half[longest] *= 0.5;
    for side in [-1.0, 1.0] {
        child.centre[longest] = part.centre[longest] + side * child.half[longest];
        divide(source, point, ratio, axes, child, depth - 1, out);
    }
}
