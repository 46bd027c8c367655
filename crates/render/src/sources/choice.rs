//! Which lamps stand for all of them where a hemisphere sample ends: for every cell of a grid over the scene, and for
//! every side that surfaces in it may face, the probability with which each lamp is looked at.
//!
//! A hemisphere averages tens to hundreds of such points, so that each need not ask all lamps. A lamp is looked at with
//! probability π and its light counts 1/π times, which is right in the mean whatever the probabilities are (Horvitz and
//! Thompson 1952); they are in proportion to what the lamp would bring to the cell unobstructed, and are 1 for those that
//! bring most (systematic sampling with unequal probabilities, Madow 1949).
//!
//! A table is made when a point asks for it first. It depends on nothing but its cell and side, so it does not matter who
//! asks, and there are no more of them than the grid has places for; the more lamps, the fewer.

use super::Lamp;
use ambit_base::DVec3;
use ambit_scene::Bounds;
use std::sync::OnceLock;

/// Lamps that are looked at, in the mean.
const LOOKED_AT: usize = 8;
/// Cells of the grid, about: cubes of a tenth of a room, within which lamps change little.
const CELLS: f64 = 1024.0;
/// Lamps in all tables together, at most about: 12 bytes each, so that many lamps have fewer cells instead.
const ENTRIES: f64 = 4e6;
/// Sides that a surface may face: along the axes, and all of them.
const SIDES: usize = 7;
/// The share of the choice that is even, for lamps that bring more to a point than the cell would tell.
const EVEN: f32 = 0.1;
/// Steps of the running sum of probabilities for each unit.
const STEPS: f32 = 4.0;
/// The grid reaches beyond the scene by this share of its size, so that rounding puts no hit outside.
const MARGIN: f64 = 1e-6;

/// The grid; empty where there are no more lamps than are looked at anyway.
#[derive(Debug, Default)]
pub(crate) struct Choice {
    low: DVec3,
    cell: f64,
    counts: [usize; 3],
    tables: Vec<OnceLock<Table>>,
}

/// Points that see about the same of the lamps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    index: usize,
    /// The middle of the cell.
    pub(crate) centre: DVec3,
    /// Half the edge of the cell.
    pub(crate) half: f64,
    /// The side that surfaces face; None: any.
    pub(crate) facing: Option<DVec3>,
}

/// The lamps of one cell and side, those that are always looked at first.
#[derive(Debug, Default)]
pub(crate) struct Table {
    lamps: Box<[Chosen]>,
    certain: usize,
    /// Where among those that may be looked at to begin for each step of the running sum of probabilities.
    starts: Box<[u16]>,
}

/// A lamp that may be looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chosen {
    /// Index among the lamps.
    pub(crate) lamp: u32,
    /// 1/π.
    pub(crate) factor: f32,
    /// Sum of the probabilities up to this one, without those that are certain.
    upto: f32,
}

impl Choice {
    /// A grid over what the lamps light.
    pub(crate) fn new(lamps: &[Lamp], bounds: &Bounds) -> Self {
        if lamps.len() <= LOOKED_AT || bounds.is_empty() {
            return Self::default();
        }
        Self::over(bounds, CELLS.min(ENTRIES / (lamps.len() * SIDES) as f64).max(1.0))
    }

    fn over(bounds: &Bounds, cells: f64) -> Self {
        let margin = MARGIN * (bounds.max - bounds.min).max_element();
        let low = bounds.min - margin;
        let size = bounds.max + margin - low;
        // Cubes, no flatter in number than one along each axis.
        let mut cell = (size.element_product() / cells).cbrt().max(size.max_element() / cells);
        let number = |cell: f64| size.to_array().map(|s| (s / cell).ceil().max(1.0));
        while number(cell).iter().product::<f64>() > 2.0 * cells {
            cell *= 1.1;
        }
        let counts = number(cell).map(|n| n as usize);
        let tables = (0..counts.iter().product::<usize>() * SIDES).map(|_| OnceLock::new()).collect();
        Self { low, cell, counts, tables }
    }

    /// True if there are more lamps than are looked at.
    #[inline]
    pub(crate) fn has_many(&self) -> bool {
        !self.tables.is_empty()
    }

    /// Where a point belongs that faces a side. None if every lamp is to be looked at.
    #[inline]
    pub(crate) fn spot(&self, point: DVec3, facing: Option<DVec3>) -> Option<Spot> {
        if !self.has_many() {
            return None;
        }
        let at = ((point - self.low) / self.cell).floor();
        let mut index = 0;
        for (x, n) in at.to_array().into_iter().zip(self.counts) {
            if !(0.0..n as f64).contains(&x) {
                return None;
            }
            index = index * n + x as usize;
        }
        let (side, facing) = facing.map_or((SIDES - 1, None), |n| {
            let (side, axis) = side(n);
            (side, Some(axis))
        });
        let centre = self.low + (at + 0.5) * self.cell;
        Some(Spot { index: index * SIDES + side, centre, half: 0.5 * self.cell, facing })
    }

    /// The table of a spot, made of what each lamp (by index) brings there if it has not been asked for before.
    #[inline]
    pub(crate) fn table(&self, spot: &Spot, make: impl FnOnce() -> Vec<(u32, f32)>) -> &Table {
        self.tables[spot.index].get_or_init(|| Table::new(make(), LOOKED_AT))
    }
}

/// The number and direction of the axis nearest to a normal.
fn side(n: DVec3) -> (usize, DVec3) {
    let a = n.abs();
    let axis = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    let mut along = DVec3::ZERO;
    along[axis] = 1.0f64.copysign(n[axis]);
    (2 * axis + usize::from(n[axis] < 0.0), along)
}

impl Table {
    /// Probabilities in proportion to what the lamps bring, `count` in sum.
    fn new(mut brought: Vec<(u32, f32)>, count: usize) -> Self {
        let mean = brought.iter().map(|b| b.1).sum::<f32>() / brought.len().max(1) as f32;
        // Where no lamp brings anything by the look of the cell, all count the same.
        let even = if mean > 0.0 { EVEN * mean } else { 1.0 };
        for b in &mut brought {
            b.1 += even;
        }
        brought.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let weights = brought.iter().map(|b| b.1);
        let Share { certain, scale } = Share::of(weights, count);
        let mut upto = 0.0;
        let chosen = |(i, &(lamp, weight)): (usize, &(u32, f32))| {
            if i < certain {
                return Chosen { lamp, factor: 1.0, upto: 0.0 };
            }
            let probability = weight * scale;
            upto += probability;
            Chosen { lamp, factor: probability.recip(), upto }
        };
        let lamps: Box<[Chosen]> = brought.iter().enumerate().map(chosen).collect();
        let maybe = &lamps[certain..];
        let start = |step: usize| maybe.partition_point(|c| c.upto <= step as f32 / STEPS) as u16;
        let starts = (0..=(upto * STEPS) as usize).map(start).collect();
        Self { lamps, certain, starts }
    }

    /// Calls `look` with the lamps that `x`, even in [0,1), chooses.
    #[inline]
    pub(crate) fn choose(&self, x: f64, mut look: impl FnMut(Chosen)) {
        let (always, maybe) = self.lamps.split_at(self.certain);
        for &chosen in always {
            look(chosen);
        }
        let total = maybe.last().map_or(0.0, |c| c.upto);
        let mut at = x as f32;
        while at < total {
            let start = self.starts[(at * STEPS) as usize] as usize;
            let Some(&chosen) = maybe[start..].iter().find(|c| at < c.upto) else { break };
            look(chosen);
            at += 1.0;
        }
    }
}

/// How weights in descending order become probabilities: the first `certain` are 1, the others `scale` times the weight.
pub(crate) struct Share {
    pub(crate) certain: usize,
    pub(crate) scale: f32,
}

impl Share {
    /// Probabilities whose sum is `count`.
    pub(crate) fn of(weights: impl Iterator<Item = f32> + Clone, count: usize) -> Self {
        let mut rest: f64 = weights.clone().map(f64::from).sum();
        let mut certain = 0;
        for weight in weights {
            let weight = f64::from(weight);
            if certain == count || (count - certain) as f64 * weight < rest {
                break;
            }
            rest -= weight;
            certain += 1;
        }
        let scale = if rest > 0.0 { (count - certain) as f64 / rest } else { 0.0 };
        Self { certain, scale: scale as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often each lamp is counted in the mean over `n` even choices, and how many are looked at.
    fn mean(table: &Table, lamps: usize, n: u32) -> (Vec<f64>, f64) {
        let (mut counted, mut looks) = (vec![0.0; lamps], 0);
        for i in 0..n {
            table.choose((f64::from(i) + 0.5) / f64::from(n), |c| {
                counted[c.lamp as usize] += f64::from(c.factor) / f64::from(n);
                looks += 1;
            });
        }
        (counted, f64::from(looks) / f64::from(n))
    }

    #[test]
    fn every_lamp_counts_once_in_the_mean() {
        let mut brought: Vec<(u32, f32)> = (0..100).map(|i| (i, 1.0 / (1.0 + i as f32).powi(2))).collect();
        brought[40].1 = 0.0;
        let table = Table::new(brought.clone(), LOOKED_AT);
        assert!(table.certain > 0 && table.certain < LOOKED_AT);
        let (counted, looks) = mean(&table, 100, 100_000);
        assert!(counted.iter().all(|c| (c - 1.0).abs() < 0.02), "{counted:?}");
        assert!((looks - LOOKED_AT as f64).abs() < 0.01, "{looks}");
        // Where nothing is known of the lamps, all are alike.
        for b in &mut brought {
            b.1 = 0.0;
        }
        let (counted, looks) = mean(&Table::new(brought, LOOKED_AT), 100, 100_000);
        assert!(counted.iter().all(|c| (c - 1.0).abs() < 0.01) && (looks - LOOKED_AT as f64).abs() < 0.01);
        // One that brings all, and a table of none.
        let (counted, _) = mean(&Table::new(vec![(0, 1e30), (1, 0.0), (2, 1e-30)], 2), 3, 1000);
        assert!(counted.iter().all(|c| (c - 1.0).abs() < 0.01), "{counted:?}");
        Table::new(Vec::new(), LOOKED_AT).choose(0.5, |_| unreachable!());
    }

    #[test]
    fn shares_are_no_more_than_one_and_sum_up() {
        for weights in [vec![5.0f32, 1.0, 1.0, 1.0], vec![1.0; 7], vec![9.0, 8.0, 1e-9, 1e-9]] {
            let Share { certain, scale } = Share::of(weights.iter().copied(), 2);
            let rest: Vec<f32> = weights[certain..].iter().map(|w| w * scale).collect();
            assert!(rest.iter().all(|&p| p <= 1.0));
            assert!((certain as f32 + rest.iter().sum::<f32>() - 2.0).abs() < 1e-5, "{weights:?}");
        }
    }

    #[test]
    fn cells_hold_their_points() {
        let bounds = Bounds { min: DVec3::new(-1.0, 2.0, 0.0), max: DVec3::new(39.0, 12.0, 0.0) };
        let choice = Choice::over(&bounds, CELLS);
        for i in 0..1000 {
            let [x, y] = ambit_base::Stream::new(i, 3).two();
            let point = DVec3::new(-1.0 + 40.0 * x, 2.0 + 10.0 * y, 0.0);
            let normal = DVec3::new(0.1, -0.9, 0.3);
            let spot = choice.spot(point, Some(normal)).unwrap();
            assert!((point - spot.centre).abs().max_element() <= spot.half * (1.0 + 1e-9));
            assert_eq!(spot.facing, Some(-DVec3::Y));
            assert!(spot.index < choice.tables.len());
            assert_ne!(choice.spot(point, None).unwrap().index, spot.index);
        }
        assert!(choice.spot(DVec3::new(-2.0, 3.0, 0.0), None).is_none());
        assert!(choice.tables.len() <= 2 * CELLS as usize * SIDES);
    }
}
