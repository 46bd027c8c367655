//! What is known beforehand to stand in each source's light: for every cell of directions around a local source, and
//! for every cell across a distant one's beam, the first opaque surface on the way.
//!
//! A shadow ray that meets its cell's obstacle needs no search, and the sample is known not to count, which keeps the
//! estimate for untested sources honest where many sources are blocked. The table is made once and never changes, so
//! nothing depends on the order of rays.

use super::SourceId;
use super::direct::Sample;
use super::emitter::{Emitter, Source};
use crate::prepare::{Modifiers, Prepared};
use ambit_base::{DVec3, EPSILON, FAR, Frame};
use ambit_scene::{ObjectId, VOID};
use ambit_trace::{Ray, World};
use rayon::prelude::*;

/// Cells along each edge of the cube of directions around a local source.
const DIRECTIONS: usize = 20;
/// No direction is farther than this from the middle of its cell: half the diagonal of one in the middle of a face, and
/// a little. Flat sources light nothing behind them.
const CELL: f64 = 1.5 / DIRECTIONS as f64;
/// Cells along each side of a distant source's beam.
const POSITIONS: usize = 40;
/// Sources beyond these have no table.
const MOST: usize = 200;

/// Distances that differ by more than this factor need no exact comparison: polygons may be out of plane by a little.
const SURELY: f64 = 0.99;

/// The tables of all sources; empty where a source has none.
#[derive(Debug, Default)]
pub(crate) struct Obstacles {
    tables: Vec<Table>,
}

#[derive(Debug, Default)]
struct Table {
    cells: Vec<ObjectId>,
    /// The beam of a distant source: axes across it, low corner and width of a cell.
    beam: Option<Beam>,
}

#[derive(Clone, Copy, Debug)]
struct Beam {
    frame: Frame,
    low: [f64; 2],
    cell: f64,
}

impl Obstacles {
    /// Finds the obstacles of `sources` in a world.
    pub(crate) fn find(sources: &[Source], world: &World, modifiers: &Modifiers) -> Self {
        let plain = |s: &Source| s.sampled && !s.glow && s.spot.is_none() && s.image.is_none();
        let table = |s: &Source| if plain(s) { Table::of(s, world, modifiers) } else { Table::default() };
        Self { tables: sources[..sources.len().min(MOST)].par_iter().map(table).collect() }
    }

    /// True if the obstacle that is known for the point of a hit blocks a sample of source `id`.
    pub(crate) fn block(&self, id: SourceId, scene: &Prepared, ray: &crate::ray::Ray<'_>, sample: &Sample) -> bool {
        let Some(table) = self.tables.get(id as usize).filter(|t| !t.cells.is_empty()) else { return false };
        let source = &scene.sources[id as usize];
        let Some(obstacle) = table.at(source, ray.point) else { return false };
        // A flat surface cannot shade itself.
        if ray.hit.as_ref().is_some_and(|h| h.object == obstacle) && scene.is_flat(obstacle) {
            return false;
        }
        let Sample { direction, distance, .. } = *sample;
        let way = Ray { origin: ray.point, direction, limit: FAR };
        let Some(t) = scene.world.distance(obstacle, &way) else { return false };
        // Mostly it is plain which comes first. A source's surface is nowhere farther from a sample than its samples are
        // from each other.
        let before = if t < SURELY * (distance - 2.0 * source.extent) {
            true
        } else if t * SURELY > distance {
            false
        } else {
            let reach = source.intersect(ray.point, direction).map_or(distance, |(t, _)| t);
            t < reach - EPSILON
        };
        before && !scene.world.bends(&way)
    }
}

impl Table {
    fn of(source: &Source, world: &World, modifiers: &Modifiers) -> Self {
        let first = |mut origin: DVec3, direction: DVec3| {
            let mut hit = world.nearest(&Ray { origin, direction, limit: FAR })?;
            // From inside a source the way leads through its own surface.
            for _ in 0..2 {
                if hit.object == source.object {
                    origin += direction * hit.distance;
                    hit = world.nearest(&Ray { origin, direction, limit: FAR })?;
                }
            }
            // Only what belongs to the main scene and stops every shadow ray is sure to block.
            let sure = hit.placement.is_none() && !hit.mesh_triangle && modifiers.blocks(hit.modifier);
            (sure && hit.object != source.object).then_some(hit.object)
        };
        let first = |origin: DVec3, direction: DVec3| first(origin, direction).unwrap_or(VOID);
        if matches!(source.emitter, Emitter::Distant) {
            let Some(beam) = Beam::across(source.centre, world) else { return Self::default() };
            let far = source.centre * beam.cell * POSITIONS as f64 * 4.0;
            let middle = {
                let b = world.bounds();
                (b.min + b.max) * 0.5
            };
            let cells = (0..POSITIONS * POSITIONS)
                .map(|i| {
                    let u = beam.low[0] + ((i % POSITIONS) as f64 + 0.5) * beam.cell;
                    let v = beam.low[1] + ((i / POSITIONS) as f64 + 0.5) * beam.cell;
                    let on = beam.frame.u * u + beam.frame.v * v + source.centre * middle.dot(source.centre);
                    first(on + far, -source.centre)
                })
                .collect();
            return Self { cells, beam: Some(beam) };
        }
        let seen = |d: DVec3| d.dot(source.normal) > -CELL;
        let cells = (0..6 * DIRECTIONS * DIRECTIONS)
            .map(cell_direction)
            .map(|d| if seen(d) { first(source.centre, d) } else { VOID })
            .collect();
        Self { cells, beam: None }
    }

    fn at(&self, source: &Source, point: DVec3) -> Option<ObjectId> {
        let cell = match &self.beam {
            Some(beam) => beam.index(point)?,
            None => direction_cell(point - source.centre),
        };
        self.cells.get(cell).copied().filter(|&o| o != VOID)
    }
}

impl Beam {
    fn across(direction: DVec3, world: &World) -> Option<Self> {
        let bounds = world.bounds();
        if bounds.is_empty() {
            return None;
        }
        let frame = Frame::around(direction);
        let corners = bounds.corners();
        let span = |axis: DVec3| {
            let along = corners.map(|c| c.dot(axis));
            (along.iter().copied().fold(FAR, f64::min), along.iter().copied().fold(-FAR, f64::max))
        };
        let (u, v) = (span(frame.u), span(frame.v));
        let cell = (u.1 - u.0).max(v.1 - v.0) / POSITIONS as f64;
        (cell > 0.0).then_some(Self { frame, low: [u.0, v.0], cell })
    }

    fn index(&self, p: DVec3) -> Option<usize> {
        let u = (p.dot(self.frame.u) - self.low[0]) / self.cell;
        let v = (p.dot(self.frame.v) - self.low[1]) / self.cell;
        let within = |x: f64| (0.0..POSITIONS as f64).contains(&x);
        (within(u) && within(v)).then(|| v as usize * POSITIONS + u as usize)
    }
}

/// The cell of a direction on the cube of directions: face by the largest component, then a grid on the face.
fn direction_cell(d: DVec3) -> usize {
    let a = d.abs();
    let (face, main, u, v) = if a.x >= a.y && a.x >= a.z {
        (0, d.x, d.y, d.z)
    } else if a.y >= a.z {
        (2, d.y, d.z, d.x)
    } else {
        (4, d.z, d.x, d.y)
    };
    if main == 0.0 {
        return 0;
    }
    let scale = 0.5 * DIRECTIONS as f64 / main.abs();
    let place = |x: f64| ((x * scale + 0.5 * DIRECTIONS as f64) as i32).clamp(0, DIRECTIONS as i32 - 1) as usize;
    let face = face + usize::from(main < 0.0);
    (face * DIRECTIONS + place(u)) * DIRECTIONS + place(v)
}

/// The unit direction through the middle of a cell.
fn cell_direction(cell: usize) -> DVec3 {
    let (face, rest) = (cell / (DIRECTIONS * DIRECTIONS), cell % (DIRECTIONS * DIRECTIONS));
    let middle = |i: usize| (i as f64 + 0.5) * (2.0 / DIRECTIONS as f64) - 1.0;
    let axis = face / 2;
    let mut d = DVec3::ZERO;
    d[axis] = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    d[(axis + 1) % 3] = middle(rest / DIRECTIONS);
    d[(axis + 2) % 3] = middle(rest % DIRECTIONS);
    d.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beam_counts_cells_across_and_not_along() {
        for direction in [DVec3::Z, DVec3::new(0.3, -0.5, 0.8).normalize(), -DVec3::X] {
            let beam = Beam { frame: Frame::around(direction), low: [-2.0, 10.0], cell: 0.25 };
            let at = |u: f64, v: f64, along: f64| beam.frame.u * u + beam.frame.v * v + direction * along;
            for along in [-1e3, 0.0, 7.0] {
                assert_eq!(beam.index(at(-1.9, 10.1, along)), Some(0));
                assert_eq!(beam.index(at(-1.6, 10.1, along)), Some(1));
                assert_eq!(beam.index(at(-1.9, 10.3, along)), Some(POSITIONS));
                assert_eq!(beam.index(at(7.9, 19.9, along)), Some(POSITIONS * POSITIONS - 1));
                for outside in [at(-2.1, 12.0, along), at(8.1, 12.0, along), at(0.0, 9.9, along), at(0.0, 20.1, along)]
                {
                    assert_eq!(beam.index(outside), None);
                }
            }
        }
    }

    #[test]
    fn directions_and_cells_are_inverse() {
        for cell in 0..6 * DIRECTIONS * DIRECTIONS {
            assert_eq!(direction_cell(cell_direction(cell) * 3.7), cell);
        }
    }

    #[test]
    fn cells_reach_no_farther_than_they_may() {
        let mut widest = 0.0_f64;
        for i in 0..100_000 {
            let d = DVec3::from(ambit_base::Stream::new(i, 0).three()) * 2.0 - 1.0;
            let Some(d) = d.try_normalize() else { continue };
            widest = widest.max(d.distance(cell_direction(direction_cell(d))));
        }
        assert!(widest < CELL && widest > 0.9 * CELL, "{widest} {CELL}");
    }
}
