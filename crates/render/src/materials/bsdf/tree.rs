//! Tensor trees: values constant on the cells of an adaptive grid in three (isotropic) or four dimensions, over the
//! square that Shirley & Chiu's map makes of each hemisphere's projection (Ward, Kurt & Bonneel 2012, *A Practical
//! Framework for Sharing and Rendering Real-World Bidirectional Scattering Distribution Functions*).
//!
//! The map keeps areas, so a cell of width w has the projected solid angle πw². Four dimensions: the square of the
//! reversed incident direction, then that of the exiting one. Three: ½ − ½ sin θ of the incident direction, then the
//! square of the exiting one turned so that the mirror direction lies on the x axis.

use super::tree_text::Problem;
use std::f64::consts::PI;
use std::ops::Range;

/// Coordinates are integers of this many bits, which bounds the depth.
const BITS: u32 = 24;
/// Deepest nesting of nodes: what remains of [`BITS`] resolves grids and keeps shifts in range.
pub(super) const MOST_LEVELS: u32 = 20;

/// A point in a tree's domain, [0, 1) in each dimension scaled to [`BITS`] bits; of rank 3 the last is unused.
pub(super) type Point = [u32; 4];

/// From [0, 1] to coordinates of a tree.
pub(super) fn quantised(x: f64) -> u32 {
    // A cast takes what is below 0 (or NaN) to 0.
    ((x * f64::from(1u32 << BITS)) as u32).min((1 << BITS) - 1)
}

/// A node of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Node {
    /// 2^`bits` values along each dimension, the first dimension slowest, from `first` on.
    Grid { bits: u32, first: usize },
    /// One child for each combination of halves, from `first` on; bit k of a child's number is the half of dimension k.
    Branch { first: usize },
}

/// A tree of numbers.
#[derive(Debug, PartialEq)]
pub(super) struct Tree {
    pub(super) rank: usize,
    /// The root comes first.
    pub(super) nodes: Vec<Node>,
    pub(super) values: Vec<f32>,
}

/// A value and the width of its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leaf {
    pub(super) index: usize,
    pub(super) width: f64,
}

/// The dimensions that a known direction fixes, as bits, and the two that are integrated over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axes {
    known: usize,
    free: [usize; 2],
}

impl Axes {
    /// The incident direction is known, the exiting one is free.
    pub(super) fn of(rank: usize) -> Self {
        if rank == 3 { Self { known: 0b001, free: [1, 2] } } else { Self { known: 0b0011, free: [2, 3] } }
    }

    /// The exiting direction is known (four dimensions only).
    pub(super) const EXCHANGED: Self = Self { known: 0b1100, free: [0, 1] };

    /// The known dimensions in order.
    pub(super) fn known(self, rank: usize) -> Vec<usize> {
        (0..rank).filter(|k| self.known & (1 << k) != 0).collect()
    }
}

impl Tree {
    /// The leaf of a point.
    pub(super) fn leaf(&self, at: Point) -> Leaf {
        let mut node = self.nodes[0];
        let mut level = 0;
        loop {
            match node {
                Node::Branch { first } => {
                    level += 1;
                    let child = (0..self.rank).fold(0, |c, k| c | (half(at[k], level) << k));
                    node = self.nodes[first + child];
                }
                Node::Grid { bits, first } => {
                    let index = (0..self.rank).fold(0, |i, k| (i << bits) | within(at[k], level, bits));
                    return Leaf { index: first + index, width: 0.5f64.powi((level + bits) as i32) };
                }
            }
        }
    }

    /// Width of the smallest cell.
    pub(super) fn least_width(&self) -> f64 {
        let mut most = 0;
        self.each_grid(0, 0, &mut |level, bits, _| most = most.max(level + bits));
        0.5f64.powi(most as i32)
    }

    fn each_grid(&self, node: usize, level: u32, visit: &mut impl FnMut(u32, u32, usize)) {
        match self.nodes[node] {
            Node::Grid { bits, first } => visit(level, bits, first),
            Node::Branch { first } => {
                for child in 0..1 << self.rank {
                    self.each_grid(first + child, level + 1, visit);
                }
            }
        }
    }

    /// Takes the smallest value out if it makes a Lambertian part of a usual size; that value and its index. What no
    /// direction reaches becomes 0.
    pub(super) fn split(&mut self) -> (f32, usize) {
        let mut reached = vec![false; self.values.len()];
        // The first coordinate of rank 3 stays below a half.
        self.each_reached(0, self.rank == 3, &mut |cells| reached[cells].fill(true));
        let (mut least, mut index) = (f32::INFINITY, 0);
        for (i, &v) in self.values.iter().enumerate() {
            if reached[i] && v < least {
                (least, index) = (v, i);
            }
        }
        if !super::lobe::is_diffuse(f64::from(least)) || f64::from(least) * PI >= MOST_DIFFUSE {
            least = 0.0;
        }
        for (v, reached) in self.values.iter_mut().zip(reached) {
            *v = if reached { *v - least } else { 0.0 };
        }
        (least, index)
    }

    /// Visits the values below a node, or of a `cut` node those of the lower half of its first dimension.
    fn each_reached(&self, node: usize, cut: bool, visit: &mut impl FnMut(Range<usize>)) {
        match self.nodes[node] {
            Node::Grid { bits, first } => {
                let cells = 1usize << (bits as usize * self.rank);
                visit(first..first + if cut && bits > 0 { cells / 2 } else { cells });
            }
            Node::Branch { first } => {
                for child in (0..1usize << self.rank).filter(|child| !cut || child & 1 == 0) {
                    self.each_reached(first + child, false, visit);
                }
            }
        }
    }

    /// Centre of the cell of a value.
    pub(super) fn centre(&self, index: usize) -> Point {
        let mut found = [0; 4];
        let mut path = Vec::new();
        self.find(0, index, &mut path, &mut found);
        found
    }

    fn find(&self, node: usize, index: usize, path: &mut Vec<usize>, found: &mut Point) -> bool {
        match self.nodes[node] {
            Node::Grid { bits, first } => {
                let count = 1 << (bits as usize * self.rank);
                if !(first..first + count).contains(&index) {
                    return false;
                }
                let level = path.len() as u32 + bits;
                for (k, coordinate) in found.iter_mut().enumerate().take(self.rank) {
                    let branches = path.iter().fold(0, |c, child| (c << 1) | ((child >> k) & 1));
                    let mask = (1usize << bits) - 1;
                    let cell = ((index - first) >> (bits as usize * (self.rank - 1 - k))) & mask;
                    let number = ((branches << bits) | cell) as u32;
                    *coordinate = (2 * number + 1) << (BITS - level - 1);
                }
                true
            }
            Node::Branch { first } => (0..1usize << self.rank).any(|child| {
                path.push(child);
                let done = self.find(first + child, index, path, found);
                if !done {
                    path.pop();
                }
                done
            }),
        }
    }

    /// Mean over the free dimensions below `node`, which `level` branches lead to.
    fn mean(&self, axes: Axes, at: Point, node: usize, level: u32) -> f64 {
        match self.nodes[node] {
            Node::Branch { first } => {
                let level = level + 1;
                let known = known_half(axes, at, self.rank, level);
                let children = quarters(axes).map(|q| self.mean(axes, at, first + (known | q), level));
                children.iter().sum::<f64>() * 0.25
            }
            Node::Grid { bits, first } => {
                let n = 1usize << bits;
                let grid = Grid::new(self, axes, at, level, bits, first);
                grid.sum([0, 0], n) / (n * n) as f64
            }
        }
    }

    /// Finds a place in the free square with density ∝ value, by warping two numbers in [0, 1) down the tree
    /// (Clarberg et al. 2005, *Wavelet Importance Sampling*); None if all values there are 0.
    pub(super) fn warp(&self, axes: Axes, at: Point, [mut x, mut y]: [f64; 2]) -> Option<[f64; 2]> {
        let (mut node, mut level) = (0, 0);
        let (mut corner, mut width) = ([0.0; 2], 1.0);
        loop {
            match self.nodes[node] {
                Node::Branch { first } => {
                    level += 1;
                    let known = known_half(axes, at, self.rank, level);
                    let means = quarters(axes).map(|q| self.mean(axes, at, first + (known | q), level));
                    let (chosen, rest) = choose(means, [x, y])?;
                    [x, y] = rest;
                    width *= 0.5;
                    corner[0] += width * f64::from(chosen as u32 & 1);
                    corner[1] += width * f64::from(chosen as u32 >> 1);
                    node = first + (known | quarters(axes)[chosen]);
                }
                Node::Grid { bits, first } => {
                    let grid = Grid::new(self, axes, at, level, bits, first);
                    let (mut cell, mut n) = ([0, 0], 1usize << bits);
                    if grid.sum(cell, n) <= 0.0 {
                        return None;
                    }
                    while n > 1 {
                        n /= 2;
                        let starts = [[0, 0], [n, 0], [0, n], [n, n]].map(|[i, j]| [cell[0] + i, cell[1] + j]);
                        let (chosen, rest) = choose(starts.map(|s| grid.sum(s, n)), [x, y])?;
                        [x, y] = rest;
                        cell = starts[chosen];
                        width *= 0.5;
                    }
                    let place = |c: f64, i: usize, x: f64| (c + width * (i as f64 + x)).clamp(0.0, 1.0);
                    return Some([place(corner[0], cell[0], x), place(corner[1], cell[1], y)]);
                }
            }
        }
    }
}

/// Lambertian parts from this reflectance or transmittance on are no such thing but a peak of full width.
const MOST_DIFFUSE: f64 = 1.5;

/// Which half of its interval a coordinate is in, `level` halvings down.
fn half(x: u32, level: u32) -> usize {
    (x >> (BITS - level)) as usize & 1
}

/// The cell of a grid of 2^`bits` cells that a coordinate is in, below `level` halvings.
fn within(x: u32, level: u32, bits: u32) -> usize {
    (x >> (BITS - level - bits)) as usize & ((1 << bits) - 1)
}

/// The part of a child's number that the known dimensions fix.
fn known_half(axes: Axes, at: Point, rank: usize, level: u32) -> usize {
    (0..rank).filter(|k| axes.known & (1 << k) != 0).fold(0, |c, k| c | (half(at[k], level) << k))
}

/// The parts of children's numbers that the free dimensions add: near-near, far-near, near-far, far-far.
fn quarters(axes: Axes) -> [usize; 4] {
    let [a, b] = axes.free.map(|k| 1 << k);
    [0, a, b, a | b]
}

/// Chooses one of four quarters by their weights and two numbers, which are made anew from what they have left.
fn choose(weights: [f64; 4], [x, y]: [f64; 2]) -> Option<(usize, [f64; 2])> {
    let rows = [weights[0] + weights[1], weights[2] + weights[3]];
    let (row, y) = pick(rows, y)?;
    let (column, x) = pick([weights[2 * row], weights[2 * row + 1]], x)?;
    Some((2 * row + column, [x, y]))
}

fn pick(weights: [f64; 2], x: f64) -> Option<(usize, f64)> {
    let sum = weights[0] + weights[1];
    if sum <= 0.0 {
        return None;
    }
    let first = weights[0] / sum;
    Some(if x < first {
        (0, x / first)
    } else {
        (1, ((x - first) / (1.0 - first).max(f64::MIN_POSITIVE)).min(ONE_LESS))
    })
}

/// The largest number below 1.
const ONE_LESS: f64 = 1.0 - f64::EPSILON / 2.0;

/// The free cells of one grid node.
struct Grid<'t> {
    values: &'t [f32],
    /// Index of the first of them.
    base: usize,
    strides: [usize; 2],
}

impl<'t> Grid<'t> {
    fn new(tree: &'t Tree, axes: Axes, at: Point, level: u32, bits: u32, first: usize) -> Self {
        let stride = |k: usize| 1usize << (bits as usize * (tree.rank - 1 - k));
        let fixed = (0..tree.rank).filter(|k| axes.known & (1 << k) != 0);
        let base = fixed.fold(first, |i, k| i + within(at[k], level, bits) * stride(k));
        Self { values: &tree.values, base, strides: axes.free.map(stride) }
    }

    /// Sum over a square block of `n` × `n` cells.
    fn sum(&self, start: [usize; 2], n: usize) -> f64 {
        let mut sum = 0.0;
        for i in start[0]..start[0] + n {
            for j in start[1]..start[1] + n {
                sum += f64::from(self.values[self.base + i * self.strides[0] + j * self.strides[1]]);
            }
        }
        sum
    }
}

/// Checks that a tree's deepest cells can be addressed.
pub(super) fn check_depth(level: u32, bits: u32) -> Result<(), Problem> {
    if level + bits > MOST_LEVELS { Err(Problem::TooDeep) } else { Ok(()) }
}
