//! The plan of one hemisphere of samples: an n × n grid mapped to the disk so that every cell has equal projected solid
//! angle (Nusselt analog; Shirley & Chiu 1997 for the concentric map), a random point a cell, a random turn about the normal.

use crate::grid::Grid;
use crate::params::{ASSUMED_REFLECTANCE, Params, Spacing};
use crate::sampler::SampleRay;
use crate::separation::separated;
use ambit_base::{DVec3, EPSILON, Frame, Stream};
use std::f64::consts::TAU;

/// Sides of the grid below which no record is made (49 samples).
const MIN_SIDE: u32 = 7;
/// Largest side of the grid: beyond it memory, not noise, is what grows.
const MAX_SIDE: u32 = 4096;
/// From this side on first samples of neighbouring cells are kept apart.
const SEPARATED_SIDE: u32 = 4;
/// Keeps points of the disk off its rim, so that no direction lies in the surface.
const RIM: f64 = 1.0 - 1e-13;

/// Names of the random dimensions of a hemisphere.
pub(crate) mod tag {
    pub(crate) const TURN: u64 = 0x7075_726e;
    pub(crate) const CELL: u64 = 0x6365_6c6c;
    pub(crate) const RAY: u64 = 0x0072_6179;
    pub(crate) const POOL: u64 = 0x706f_6f6c;
    pub(crate) const TRADE: u64 = 0x7472_6164;
    pub(crate) const EXTRA: u64 = 0x6578_7472;
    pub(crate) const SHARE: u64 = 0x7368_6172;
}

/// Directions and weights of the samples of one hemisphere.
#[derive(Clone, Debug)]
pub struct Hemisphere {
    frame: Frame,
    grid: Grid,
    stream: Stream,
    child_weight: f32,
    /// Points of the unit disk, one a cell, where they have been kept apart; else they are drawn when asked for.
    points: Vec<[f64; 2]>,
}

impl Hemisphere {
    /// Plans a hemisphere about `normal` (unit, the lit side).
    ///
    /// `weight` is the record's weight when `caching`, else the asking ray's; `coefficient` is the largest channel of the
    /// colour that the answer is multiplied by, unused when `caching`. None: no divisions, or nothing would be seen of it.
    pub fn new(
        params: &Params,
        weight: f32,
        coefficient: f32,
        normal: DVec3,
        stream: Stream,
        caching: bool,
    ) -> Option<Self> {
        if params.divisions <= 0 || !caching && f64::from(coefficient) <= EPSILON {
            return None;
        }
        let divisions = f64::from(params.divisions);
        let mut weight = f64::from(weight);
        if !caching && params.min_weight > 0.0 {
            // No child may fall below the smallest weight.
            weight = weight.min(0.8 * weight * f64::from(coefficient) / (divisions * params.min_weight));
        }
        let least = if caching { MIN_SIDE } else { 1 };
        let side = (((divisions * weight).sqrt() + 0.5) as u32).clamp(least, MAX_SIDE);
        let classical = caching && params.systems.spacing == Spacing::Classical;
        let grid = if classical { Grid::polar(divisions * weight) } else { Grid::Disk { side } };
        let child_weight = if caching { ASSUMED_REFLECTANCE as f32 } else { coefficient / (side * side) as f32 };
        let frame = Frame::turned(normal, TAU * stream.child(tag::TURN).one());
        let apart = caching && !classical && side >= SEPARATED_SIDE;
        let points = if apart { separated(side, stream) } else { Vec::new() };
        Some(Self { frame, grid, stream, child_weight, points })
    }

    /// Plans a hemisphere of at most `-ad` × `weight` samples, one at least, whose value is not kept. Its rays weigh what
    /// those of records do.
    pub(crate) fn few(params: &Params, weight: f32, normal: DVec3, stream: Stream) -> Option<Self> {
        if params.divisions <= 0 {
            return None;
        }
        let side = ((f64::from(params.divisions) * f64::from(weight)).sqrt() as u32).clamp(1, MAX_SIDE);
        let frame = Frame::turned(normal, TAU * stream.child(tag::TURN).one());
        let child_weight = ASSUMED_REFLECTANCE as f32;
        Some(Self { frame, grid: Grid::Disk { side }, stream, child_weight, points: Vec::new() })
    }

    /// How it is divided.
    pub(crate) fn grid(&self) -> Grid {
        self.grid
    }

    /// The number of cells, each of projected solid angle π/len.
    #[expect(clippy::len_without_is_empty, reason = "a hemisphere always has cells")]
    pub fn len(&self) -> usize {
        self.grid.len()
    }

    /// What the weight of a sample's ray is multiplied by, beside the medium's extinction.
    pub fn child_weight(&self) -> f32 {
        self.child_weight
    }

    /// The tangents and the normal.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The sample direction of a cell in the frame (x, y tangential, z along the normal, positive), unit length. Cell
    /// `row · side + column`.
    pub(crate) fn local(&self, cell: usize) -> DVec3 {
        if let Some(&point) = self.points.get(cell) {
            return raise(point);
        }
        raise(self.grid.point(cell, self.stream.child(tag::CELL ^ (cell as u64) << 32).two()))
    }

    /// The sample direction of a cell, unit length, world coordinates.
    pub fn direction(&self, cell: usize) -> DVec3 {
        self.frame.to_world(self.local(cell))
    }

    /// The direction of the `k`-th extra sample of a cell, in the frame.
    pub(crate) fn extra_local(&self, cell: usize, k: u32) -> DVec3 {
        raise(self.grid.point(cell, self.stream.split(tag::EXTRA ^ (cell as u64) << 32, k).two()))
    }

    /// The ray of a sample.
    pub(crate) fn ray(&self, direction: DVec3, sample: usize) -> SampleRay {
        SampleRay { direction, weight: self.child_weight, stream: self.stream(sample) }
    }

    /// The random numbers of a sample's ray.
    pub fn stream(&self, sample: usize) -> Stream {
        // A lone sample is stratified with those of neighbouring hemispheres, several with each other.
        if self.grid == (Grid::Disk { side: 1 }) {
            self.stream.child(tag::RAY)
        } else {
            self.stream.split(tag::RAY, sample as u32)
        }
    }

    /// The numbers that round the shares of extra samples.
    pub(crate) fn share(&self, cell: usize) -> f64 {
        self.stream.split(tag::SHARE, cell as u32).one()
    }
}

/// A point of cell `cell` from (s, t) in the unit square.
pub(crate) fn in_cell(side: u32, cell: usize, s: f64, t: f64) -> [f64; 2] {
    let (row, column) = (cell as u32 / side, cell as u32 % side);
    let n = f64::from(side);
    [(f64::from(column) + t) / n, (f64::from(row) + s) / n]
}

/// The random point of a cell.
pub(crate) fn cell_point(side: u32, cell: usize, stream: Stream) -> [f64; 2] {
    let [s, t] = stream.child(tag::CELL ^ (cell as u64) << 32).two();
    in_cell(side, cell, s, t)
}

/// From the disk to the hemisphere.
fn raise([p, q]: [f64; 2]) -> DVec3 {
    let (p, q) = (p * RIM, q * RIM);
    DVec3::new(p, q, (1.0 - p * p - q * q).max(f64::EPSILON).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(divisions: i32, caching: bool) -> Hemisphere {
        let params = Params { divisions, ..Params::default() };
        Hemisphere::new(&params, 1.0, 1.0, DVec3::Z, Stream::new(0, 7), caching).unwrap()
    }

    #[test]
    fn ray_counts_are_those_measured() {
        for (divisions, rays) in
            [(1, 49), (50, 49), (64, 64), (128, 121), (256, 256), (512, 529), (1000, 1024), (1500, 1521), (4096, 4096)]
        {
            assert_eq!(plan(divisions, true).len(), rays, "-ad {divisions}");
        }
        for (divisions, rays) in [(1, 1), (3, 4), (10, 9)] {
            assert_eq!(plan(divisions, false).len(), rays, "-ad {divisions} uncached");
        }
    }

    #[test]
    fn uncached_hemispheres_keep_children_above_the_smallest_weight() {
        let params = Params { divisions: 1024, min_weight: 1e-2, ..Params::default() };
        let h = Hemisphere::new(&params, 1.0, 0.5, DVec3::Z, Stream::new(0, 7), false).unwrap();
        // 0.8·0.5/0.01 = 40 samples at most: 6 × 6.
        assert_eq!(h.len(), 36);
        assert!(h.child_weight() > 1e-2);
        assert!(Hemisphere::new(&params, 1.0, 0.0, DVec3::Z, Stream::new(0, 7), false).is_none());
        let none = Params { divisions: 0, ..params };
        assert!(Hemisphere::new(&none, 1.0, 0.5, DVec3::Z, Stream::new(0, 7), true).is_none());
    }

    #[test]
    fn directions_are_unit_upward_and_cosine_distributed() {
        let normal = DVec3::new(0.3, -0.5, 0.2).normalize();
        for caching in [false, true] {
            let params = Params { divisions: 1024, min_weight: 0.0, ..Params::default() };
            let mut mean = DVec3::ZERO;
            let mut second = 0.0;
            let mut count = 0.0;
            for key in 0..20 {
                let h = Hemisphere::new(&params, 1.0, 1.0, normal, Stream::new(0, key), caching).unwrap();
                for cell in 0..h.len() {
                    let d = h.direction(cell);
                    assert!((d.length() - 1.0).abs() < 1e-9 && d.dot(normal) > 0.0);
                    mean += d;
                    second += d.dot(normal).powi(2);
                    count += 1.0;
                }
            }
            // For cosine density the mean direction is 2/3 of the normal and the mean of cos² is 1/2.
            assert!((mean / count - normal * (2.0 / 3.0)).length() < 2e-3, "{}", mean / count);
            assert!((second / count - 0.5).abs() < 2e-3);
        }
    }
}
