//! A tensor tree as a lobe: directions to coordinates, totals per incident direction, samples.

use super::colour::{Cie, Coloured};
use super::lobe::{Cell, DROPPED};
use super::tree::{Axes, Node, Point, Tree, quantised};
use ambit_base::{DVec3, EPSILON, Rgb, disk_to_square, square_to_disk};
use std::f64::consts::PI;
use std::sync::Arc;

/// One component's numbers as the file has them.
#[derive(Debug)]
pub(super) struct Trees {
    /// Y.
    pub(super) visible: Tree,
    /// u′ and v′.
    pub(super) chroma: Option<[Tree; 2]>,
}

/// The numbers less their Lambertian part.
#[derive(Debug)]
pub(super) struct Remainder {
    values: Tree,
    /// u′ and v′.
    chroma: Option<[Tree; 2]>,
    /// What was taken out, 1/sr: its Y and its colour.
    least: f32,
    base: Rgb,
    least_width: f64,
}

/// A tree with the roles of its directions.
#[derive(Debug)]
pub(super) struct TreeLobe {
    data: Arc<Remainder>,
    /// The incident direction is the tree's exiting one (Helmholtz reciprocity).
    exchanged: bool,
    /// Mean value by the known direction's coordinates. None for exchanged trees of rank 3, which are evaluated but,
    /// as in Radiance, never sampled.
    means: Option<Tree>,
}

impl Trees {
    /// Splits off the Lambertian part: its reflectance or transmittance, and the rest.
    pub(super) fn split(mut self) -> (Rgb, Arc<Remainder>) {
        let (least, index) = self.visible.split();
        let mut base = Rgb::splat(least);
        if let Some(chroma) = &self.chroma
            && least > 0.0
        {
            // The Lambertian part has the colour of the darkest cell.
            base = colour_at(chroma, least, self.visible.centre(index));
        }
        let least_width = self.visible.least_width();
        let rest = Remainder { values: self.visible, chroma: self.chroma, least, base, least_width };
        (base * std::f32::consts::PI, Arc::new(rest))
    }
}

fn colour_at(chroma: &[Tree; 2], y: f32, at: Point) -> Rgb {
    let [u, v] = chroma.each_ref().map(|t| t.values[t.leaf(at).index]);
    Cie::from_chromaticity(y, u, v).rgb()
}

impl TreeLobe {
    /// The lobe with the roles as in the file or exchanged, if there is enough of it, and its largest total with the
    /// Lambertian part.
    pub(super) fn new(data: &Arc<Remainder>, exchanged: bool) -> (Option<Self>, f64) {
        let rank = data.values.rank;
        let axes = if exchanged { Axes::EXCHANGED } else { Axes::of(rank) };
        // What an exchanged isotropic tree scatters is bounded by what the tree does as it is.
        let means = data.values.means(if rank == 3 { Axes::of(3) } else { axes });
        let most = PI * means.values.iter().copied().fold(0.0f64, |m, v| m.max(f64::from(v)));
        let total = most + PI * f64::from(data.least);
        let means = (rank == 4 || !exchanged).then_some(means);
        ((most > DROPPED).then(|| Self { data: data.clone(), exchanged, means }), total)
    }

    fn axes(&self) -> Axes {
        if self.exchanged { Axes::EXCHANGED } else { Axes::of(self.data.values.rank) }
    }

    /// Coordinates of a pair of directions.
    fn point(&self, incident: DVec3, exiting: DVec3) -> Point {
        let (a, b) = if self.exchanged { (exiting, incident) } else { (incident, exiting) };
        if self.data.values.rank == 3 {
            let (c, s) = turn(a);
            let [q, r] = disk_to_square(c * b.x + s * b.y, c * b.y - s * b.x);
            [quantised(half_sine(a)), quantised(q), quantised(r), 0]
        } else {
            let [m, n] = disk_to_square(-a.x, -a.y);
            let [q, r] = disk_to_square(b.x, b.y);
            [quantised(m), quantised(n), quantised(q), quantised(r)]
        }
    }

    /// Coordinates that the incident direction alone fixes.
    fn known(&self, incident: DVec3) -> Point {
        // The other direction may be anything.
        self.point(incident, DVec3::Z)
    }

    pub(super) fn cell(&self, incident: DVec3, exiting: DVec3) -> Cell {
        let leaf = self.data.values.leaf(self.point(incident, exiting));
        let value = self.data.values.values[leaf.index];
        let area = PI * leaf.width * leaf.width;
        Cell { index: leaf.index, value, area, incident_area: area }
    }

    pub(super) fn colour(&self, cell: &Cell, incident: DVec3, exiting: DVec3) -> Coloured {
        match &self.data.chroma {
            None => Coloured::Grey(cell.value),
            Some(chroma) => {
                let full = colour_at(chroma, cell.value + self.data.least, self.point(incident, exiting));
                Coloured::Rgb((full - self.data.base).max(Rgb::ZERO))
            }
        }
    }

    pub(super) fn least_area(&self) -> f64 {
        PI * self.data.least_width * self.data.least_width
    }

    pub(super) fn total(&self, incident: DVec3) -> f64 {
        let Some(means) = &self.means else { return 0.0 };
        let p = self.known(incident);
        let at = if self.exchanged { [p[2], p[3], 0, 0] } else { p };
        PI * f64::from(means.values[means.leaf(at).index])
    }

    pub(super) fn sample(&self, incident: DVec3, x: [f64; 2]) -> Option<DVec3> {
        self.means.as_ref()?;
        let [q, r] = self.data.values.warp(self.axes(), self.known(incident), x)?;
        let [a, b] = square_to_disk(q, r);
        let z = (1.0 - a * a - b * b).max(0.0).sqrt();
        Some(if self.exchanged {
            DVec3::new(-a, -b, z)
        } else if self.data.values.rank == 3 {
            let (c, s) = turn(incident);
            DVec3::new(c * a - s * b, s * a + c * b, z)
        } else {
            DVec3::new(a, b, z)
        })
    }
}

/// Cosine and sine of the azimuth of a reversed direction; straight on, that is π.
fn turn(v: DVec3) -> (f64, f64) {
    let r = v.x.hypot(v.y);
    if r > 0.0 { (-v.x / r, -v.y / r) } else { (-1.0, 0.0) }
}

/// The first coordinate of isotropic trees.
fn half_sine(v: DVec3) -> f64 {
    0.5 - EPSILON - 0.5 * v.x.hypot(v.y)
}

/// Sums that depend on the known coordinates, as deep as they need.
enum Sums {
    Leaf(f64),
    Split(Vec<Sums>),
}

impl Sums {
    fn add(&mut self, other: Self) {
        match (self, other) {
            (Self::Leaf(a), Self::Leaf(b)) => *a += b,
            (Self::Split(all), Self::Leaf(b)) => all.iter_mut().for_each(|s| s.add(Self::Leaf(b))),
            (Self::Split(all), Self::Split(more)) => all.iter_mut().zip(more).for_each(|(s, m)| s.add(m)),
            (leaf @ Self::Leaf(_), mut split @ Self::Split(_)) => {
                let Self::Leaf(a) = *leaf else { return };
                split.add(Self::Leaf(a));
                *leaf = split;
            }
        }
    }

    fn flatten(&self, tree: &mut Tree, slot: usize) {
        match self {
            Self::Leaf(v) => {
                tree.nodes[slot] = Node::Grid { bits: 0, first: tree.values.len() };
                tree.values.push(*v as f32);
            }
            Self::Split(all) => {
                let first = tree.nodes.len();
                tree.nodes.resize(first + all.len(), tree.nodes[slot]);
                tree.nodes[slot] = Node::Branch { first };
                for (child, sums) in all.iter().enumerate() {
                    sums.flatten(tree, first + child);
                }
            }
        }
    }
}

impl Tree {
    /// Means over the free dimensions as a tree over the known ones.
    fn means(&self, axes: Axes) -> Self {
        let known = axes.known(self.rank);
        let mut means = Self { rank: known.len(), nodes: vec![Node::Branch { first: 0 }], values: Vec::new() };
        self.sums(&known, 0).flatten(&mut means, 0);
        means
    }

    /// Means below a node.
    fn sums(&self, known: &[usize], node: usize) -> Sums {
        match self.nodes[node] {
            Node::Branch { first } => {
                let mut parts: Vec<Option<Sums>> = (0..1 << known.len()).map(|_| None).collect();
                for child in 0..1usize << self.rank {
                    let part = &mut parts[compressed(child, known)];
                    let more = self.sums(known, first + child).scaled(0.25);
                    match part {
                        Some(sums) => sums.add(more),
                        None => *part = Some(more),
                    }
                }
                Sums::Split(parts.into_iter().map(|p| p.unwrap_or(Sums::Leaf(0.0))).collect())
            }
            Node::Grid { bits, first } => {
                let cells = 1usize << (bits as usize * known.len());
                let mut means = vec![0.0; cells];
                let share = 0.25f64.powi(bits as i32);
                for index in 0..1usize << (bits as usize * self.rank) {
                    let mask = (1usize << bits) - 1;
                    let cell = known
                        .iter()
                        .fold(0, |c, &k| (c << bits) | ((index >> (bits as usize * (self.rank - 1 - k))) & mask));
                    means[cell] += share * f64::from(self.values[first + index]);
                }
                nested(&means, known.len(), bits, [0; 2], bits)
            }
        }
    }
}

/// The bits of a child's number that known dimensions have, together.
fn compressed(child: usize, known: &[usize]) -> usize {
    known.iter().enumerate().fold(0, |c, (i, &k)| c | (((child >> k) & 1) << i))
}

/// A grid as nested halves: the block of 2^`left` cells a side at `start`.
fn nested(means: &[f64], dimensions: usize, bits: u32, start: [usize; 2], left: u32) -> Sums {
    if left == 0 {
        let index = start[..dimensions].iter().fold(0, |i, s| (i << bits) | s);
        return Sums::Leaf(means[index]);
    }
    let step = 1 << (left - 1);
    let child = |c: usize| [start[0] + step * (c & 1), start[1] + step * (c >> 1)];
    Sums::Split((0..1 << dimensions).map(|c| nested(means, dimensions, bits, child(c), left - 1)).collect())
}

impl Sums {
    fn scaled(mut self, by: f64) -> Self {
        match &mut self {
            Self::Leaf(v) => *v *= by,
            Self::Split(all) => {
                for s in all {
                    *s = std::mem::replace(s, Self::Leaf(0.0)).scaled(by);
                }
            }
        }
        self
    }
}
