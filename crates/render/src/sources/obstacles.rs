//! What is known beforehand to stand in each source's light: for every cell of directions around a local source, and
//! for every cell across a distant one's beam, the first opaque surface on the way.
//!
//! A shadow ray that meets its cell's obstacle needs no search, and the sample is known not to count, which keeps the
//! estimate for untested sources honest where many sources are blocked. A cell is filled when it is asked for first, and
//! only by what the scene is, so that nothing depends on the order of rays.

use super::SourceId;
use super::direct::Sample;
use super::emitter::{Emitter, Source};
use crate::prepare::Prepared;
use ambit_base::{DVec3, EPSILON, FAR, Frame};
use ambit_scene::{ObjectId, VOID};
use ambit_trace::{Ray, World};
use std::sync::atomic::{AtomicU32, Ordering};

/// Cells along each edge of the cube of directions around a local source.
const DIRECTIONS: usize = 20;
/// No direction is farther than this from the middle of its cell: half the diagonal of one in the middle of a face, and
/// a little. Flat sources light nothing behind them.
const CELL: f64 = 1.5 / DIRECTIONS as f64;
/// Cells along each side of a distant source's beam.
const POSITIONS: usize = 40;
/// Sources beyond these have no table.
const MOST: usize = 200;

/// What no one has looked for yet.
const UNKNOWN: ObjectId = VOID - 1;

/// Distances that differ by more than this factor need no exact comparison: polygons may be out of plane by a little.
const SURELY: f64 = 0.99;

/// The tables of all sources; empty where a source has none.
#[derive(Debug, Default)]
pub(crate) struct Obstacles {
    tables: Vec<Table>,
}

#[derive(Debug, Default)]
struct Table {
    cells: Vec<AtomicU32>,
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
    /// Tables for `sources` in a world, still empty.
    pub(crate) fn new(sources: &[Source], world: &World) -> Self {
        let plain = |s: &Source| s.sampled && !s.glow && s.spot.is_none() && s.image.is_none();
        let table = |s: &Source| if plain(s) { Table::new(s, world) } else { Table::default() };
        Self { tables: sources[..sources.len().min(MOST)].iter().map(table).collect() }
    }

    /// True if the obstacle that is known for the point of a hit blocks a sample of source `id`.
    pub(crate) fn block(&self, id: SourceId, scene: &Prepared, ray: &crate::ray::Ray<'_>, sample: &Sample) -> bool {
        let Some(table) = self.tables.get(id as usize).filter(|t| !t.cells.is_empty()) else { return false };
        let source = &scene.sources[id as usize];
        let Some(obstacle) = table.at(source, scene, ray.point) else { return false };
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
    fn new(source: &Source, world: &World) -> Self {
        let unknown = |count: usize| (0..count).map(|_| AtomicU32::new(UNKNOWN)).collect();
        if !matches!(source.emitter, Emitter::Distant) {
            return Self { cells: unknown(6 * DIRECTIONS * DIRECTIONS), beam: None };
        }
        let Some(beam) = Beam::across(source.centre, world) else { return Self::default() };
        Self { cells: unknown(POSITIONS * POSITIONS), beam: Some(beam) }
    }

    /// The obstacle of the cell that a point lies in.
    fn at(&self, source: &Source, scene: &Prepared, point: DVec3) -> Option<ObjectId> {
        let index = match &self.beam {
            Some(beam) => beam.index(point)?,
            None => direction_cell(point - source.centre),
        };
        // Whoever fills a cell fills it with the same.
        let cell = self.cells.get(index)?;
        let mut obstacle = cell.load(Ordering::Relaxed);
        if obstacle == UNKNOWN {
            obstacle = self.find(source, scene, index).unwrap_or(VOID);
            cell.store(obstacle, Ordering::Relaxed);
        }
        (obstacle != VOID).then_some(obstacle)
    }

    #[cold]
    fn find(&self, source: &Source, scene: &Prepared, index: usize) -> Option<ObjectId> {
        let (mut origin, direction) = match &self.beam {
            Some(beam) => (beam.start(source.centre, index, &scene.world), -source.centre),
            None => (source.centre, cell_direction(index)),
        };
        if self.beam.is_none() && direction.dot(source.normal) <= -CELL {
            return None;
        }
        let mut hit = scene.world.nearest(&Ray { origin, direction, limit: FAR })?;
        // From inside a source the way leads through its own surface.
        for _ in 0..2 {
            if hit.object == source.object {
                origin += direction * hit.distance;
                hit = scene.world.nearest(&Ray { origin, direction, limit: FAR })?;
            }
        }
        // Only what belongs to the main scene and stops every shadow ray is sure to block.
        let sure = hit.placement.is_none() && !hit.mesh_triangle && scene.modifiers.blocks(hit.modifier);
        (sure && hit.object != source.object).then_some(hit.object)
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

    /// A point outside the world from which the middle of a cell is seen along the beam.
    fn start(&self, direction: DVec3, index: usize, world: &World) -> DVec3 {
        let middle = |i: usize, low: f64| low + (i as f64 + 0.5) * self.cell;
        let u = middle(index % POSITIONS, self.low[0]);
        let v = middle(index / POSITIONS, self.low[1]);
        let bounds = world.bounds();
        let along = ((bounds.min + bounds.max) * 0.5).dot(direction) + self.cell * POSITIONS as f64 * 4.0;
        self.frame.u * u + self.frame.v * v + direction * along
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
