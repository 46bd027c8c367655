//! The tree: boxes in, eight-wide nodes and lists of leaves out.
//!
//! Surfaces with equal boxes are grouped first, since clustering would chain them. Large inputs are cut into portions
//! by [`crate::split`], which bounds the memory that clustering takes; obvhs clusters each portion, as many at a
//! time as there are threads (PLOC, Meister and Bittner 2018, with parallel reinsertion, Meister and Bittner 2018b); if its
//! tree is too deep the splitter does that portion too. Up to eight surfaces of a kind become a leaf; [`crate::collapse`] makes wide nodes of the rest.

use crate::BuildError;
use crate::block::LANES;
use crate::bounds::Box32;
use crate::collapse::Collapse;
use crate::node::{self, ITEMS, MOST_LEAVES, Node};
use crate::split::split;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, reinsertion::ReinsertionOptimizer};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use std::ops::Range;

/// Groups of equal boxes that are clustered at a time.
const PORTION: usize = 1 << 15;

/// Reinsertion candidates as a share of the nodes: in a small world, and in larger ones, where it takes a third of the time
/// of building. Against 0.1 rays visit a quarter fewer nodes of the first, a twentieth fewer of the others.
const REINSERTION: f32 = 1.0;
const REINSERTION_LARGE: f32 = 0.4;

/// Surfaces of a small world: to reinsert all of them takes some 10 ms.
const SMALL: usize = 1 << 12;

/// Levels after which the splitter halves without looking.
const DEEPEST: usize = 64;

/// Nodes, and the surfaces of each leaf.
#[derive(Debug)]
pub(crate) struct Tree {
    /// The root comes first.
    pub(crate) nodes: Vec<Node>,
    /// Levels of nodes.
    pub(crate) depth: usize,
    /// Numbers of the surfaces in each block, by kind; `u32::MAX` fills up.
    pub(crate) blocks: [Vec<[u32; LANES]>; 2],
    /// Surfaces of the first two kinds.
    pub(crate) counts: [usize; 2],
}

/// A subtree or leaf with its box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child {
    pub(crate) bounds: Box32,
    pub(crate) word: u32,
}

/// What lies under a node of the binary tree: a few surfaces that may still join a leaf, or something finished.
enum Under {
    Few { bounds: Box32, kind: u32, count: usize, surfaces: [u32; LANES] },
    Done(Child),
}

/// A binary tree and its leaves.
#[derive(Default)]
pub(crate) struct Part {
    /// Children before their parents.
    pub(crate) nodes: Vec<[Child; 2]>,
    pub(crate) blocks: [Vec<[u32; LANES]>; 2],
}

/// Portions with their trees, and how they lie in the whole.
enum Portions {
    One(Part, Under),
    Two(Box<[Self; 2]>),
}

/// Surfaces numbered kind by kind: `boxes[i]` is that of surface `i`, the first `counts[0]` are of kind 0 and so on.
struct Input<'a> {
    boxes: &'a [Box32],
    counts: [usize; 2],
}

impl Input<'_> {
    fn kind(&self, surface: u32) -> u32 {
        let i = surface as usize;
        u32::from(i >= self.counts[0]) + u32::from(i >= self.counts[0] + self.counts[1])
    }

    fn bounds(&self, surface: u32) -> Box32 {
        self.boxes[surface as usize]
    }
}

/// Builds the tree over `boxes`, of which the first `counts[0]` are triangles, the next `counts[1]` quadrilaterals,
/// the rest items.
pub(crate) fn build(boxes: Vec<Box32>, counts: [usize; 2]) -> Result<Tree, BuildError> {
    if boxes.len() >= MOST_LEAVES {
        return Err(BuildError::TooManySurfaces { limit: MOST_LEAVES });
    }
    let input = Input { boxes: &boxes, counts };
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut part = Part::default();
    let root = (!order.is_empty()).then(|| {
        let under = part.gather(input.portions(&mut order));
        part.finish(&under)
    });
    drop(order);
    drop(boxes);
    let Collapse { nodes, depth, blocks, .. } = Collapse::run(part, root);
    Ok(Tree { nodes, depth, blocks, counts })
}

impl Input<'_> {
    /// Cuts what is too large to cluster at once.
    fn portions(&self, order: &mut [u32]) -> Portions {
        if order.len() <= PORTION {
            let mut part = Part::default();
            let under = self.cluster(order, &mut part);
            return Portions::One(part, under);
        }
        let middle = split(order, &|i| self.bounds(i));
        let (left, right) = order.split_at_mut(middle);
        let (a, b) = rayon::join(|| self.portions(left), || self.portions(right));
        Portions::Two(Box::new([a, b]))
    }

    fn cluster(&self, order: &mut [u32], part: &mut Part) -> Under {
        let groups = self.group(order);
        let bounds = |g: u32| self.bounds(order[groups[g as usize].start as usize]);
        let reinsertion = if self.boxes.len() <= SMALL { REINSERTION } else { REINSERTION_LARGE };
        if groups.len() > 2
            && let Some(tree) = ploc(groups.len(), &bounds, reinsertion)
        {
            return self.convert(&tree, 0, order, &groups, part);
        }
        let mut all: Vec<u32> = (0..groups.len() as u32).collect();
        self.divide(&mut all, order, &groups, part, 0)
    }

    /// Sorts surfaces with equal boxes next to each other; gives the runs.
    fn group(&self, order: &mut [u32]) -> Vec<Range<u32>> {
        let key = |i: u32| {
            let b = self.bounds(i);
            let words = b.min.iter().chain(&b.max);
            words.fold(0u64, |h, x| (h.rotate_left(23) ^ u64::from(x.to_bits())).wrapping_mul(0x9E37_79B9_7F4A_7C15))
        };
        let mut keyed: Vec<(u64, u32)> = order.iter().map(|&i| (key(i), i)).collect();
        keyed.sort_unstable();
        let mut groups: Vec<Range<u32>> = Vec::with_capacity(order.len());
        for (at, (slot, &(_, i))) in order.iter_mut().zip(&keyed).enumerate() {
            *slot = i;
            let at = at as u32;
            match groups.last_mut() {
                Some(g) if self.bounds(keyed[g.start as usize].1) == self.bounds(i) => g.end = at + 1,
                _ => groups.push(at..at + 1),
            }
        }
        groups
    }

    /// The splitter's tree; halves from [`DEEPEST`] on.
    fn divide(&self, of: &mut [u32], order: &[u32], groups: &[Range<u32>], part: &mut Part, level: usize) -> Under {
        if let [g] = *of {
            let g = &groups[g as usize];
            return self.heap(&order[g.start as usize..g.end as usize], part);
        }
        let middle = if level < DEEPEST {
            split(of, &|g| self.bounds(order[groups[g as usize].start as usize]))
        } else {
            of.len() / 2
        };
        let (left, right) = of.split_at_mut(middle);
        let a = self.divide(left, order, groups, part, level + 1);
        let b = self.divide(right, order, groups, part, level + 1);
        part.join(a, b)
    }

    /// Surfaces with the same box: a balanced tree in order of kind.
    fn heap(&self, surfaces: &[u32], part: &mut Part) -> Under {
        if let [s] = *surfaces {
            let mut few = [u32::MAX; LANES];
            let kind = self.kind(s);
            few[0] = if kind == ITEMS { s - (self.counts[0] + self.counts[1]) as u32 } else { s };
            return Under::Few { bounds: self.bounds(s), kind, count: 1, surfaces: few };
        }
        let n = surfaces.len();
        let middle = if n > LANES { (n / 2).next_multiple_of(LANES) } else { n / 2 };
        let (left, right) = surfaces.split_at(middle);
        let a = self.heap(left, part);
        let b = self.heap(right, part);
        part.join(a, b)
    }

    fn convert(&self, tree: &Bvh2, at: usize, order: &[u32], groups: &[Range<u32>], part: &mut Part) -> Under {
        let node = &tree.nodes[at];
        let first = node.first_index as usize;
        if node.is_leaf() {
            let g = &groups[tree.primitive_indices[first] as usize];
            return self.heap(&order[g.start as usize..g.end as usize], part);
        }
        let a = self.convert(tree, first, order, groups, part);
        let b = self.convert(tree, first + 1, order, groups, part);
        part.join(a, b)
    }
}

/// obvhs's tree with one group a leaf, unless it is so deep that the walk would suffer.
fn ploc(count: usize, bounds: &impl Fn(u32) -> Box32, reinsertion: f32) -> Option<Bvh2> {
    let boxes: Vec<Aabb> = (0..count as u32)
        .map(|g| {
            let b = bounds(g);
            Aabb::new(b.min.into(), b.max.into())
        })
        .collect();
    let indices = (0..count as u32).collect();
    let mut tree =
        PlocBuilder::with_capacity(count).build(PlocSearchDistance::Medium, &boxes, indices, SortPrecision::U64, 2);
    drop(boxes);
    let limit = 16 + 3 * count.ilog2() as usize;
    if depth(&tree) > limit {
        return None;
    }
    ReinsertionOptimizer::default().run(&mut tree, reinsertion, None);
    (depth(&tree) <= limit).then_some(tree)
}

fn depth(tree: &Bvh2) -> usize {
    let mut deepest = 0;
    let mut todo = vec![(0usize, 1usize)];
    while let Some((at, level)) = todo.pop() {
        deepest = deepest.max(level);
        let node = &tree.nodes[at];
        if !node.is_leaf() {
            let first = node.first_index as usize;
            todo.extend([(first, level + 1), (first + 1, level + 1)]);
        }
    }
    deepest
}

impl Part {
    /// Two subtrees side by side: one leaf if they fit into one.
    fn join(&mut self, a: Under, b: Under) -> Under {
        match (a, b) {
            (
                Under::Few { bounds, kind, count, mut surfaces },
                Under::Few { bounds: more, kind: other, count: n, surfaces: others },
            ) if kind == other && kind != ITEMS && count + n <= LANES => {
                surfaces[count..count + n].copy_from_slice(&others[..n]);
                Under::Few { bounds: bounds.union(&more), kind, count: count + n, surfaces }
            }
            (a, b) => {
                let pair = [self.finish(&a), self.finish(&b)];
                let bounds = pair[0].bounds.union(&pair[1].bounds);
                self.nodes.push(pair);
                Under::Done(Child { bounds, word: self.nodes.len() as u32 - 1 })
            }
        }
    }

    /// Puts portions into one, in their order.
    fn gather(&mut self, portions: Portions) -> Under {
        match portions {
            Portions::One(part, under) => self.append(part, under),
            Portions::Two(both) => {
                let [a, b] = *both;
                let a = self.gather(a);
                let b = self.gather(b);
                self.join(a, b)
            }
        }
    }

    /// Adds another's nodes and leaves behind those that are there; `under` is its root.
    fn append(&mut self, part: Self, under: Under) -> Under {
        if self.nodes.is_empty() && self.blocks.iter().all(Vec::is_empty) {
            *self = part;
            return under;
        }
        let nodes = self.nodes.len() as u32;
        let leaves = [0, 1].map(|kind| self.blocks[kind].len() as u32);
        let moved = |child: Child| {
            let by = match child.word {
                word if word & node::LEAF == 0 => nodes,
                // An item stands for itself.
                word => leaves.get(node::kind(word) as usize).copied().unwrap_or(0),
            };
            Child { word: child.word + by, ..child }
        };
        self.nodes.extend(part.nodes.into_iter().map(|pair| pair.map(moved)));
        for (all, more) in self.blocks.iter_mut().zip(part.blocks) {
            all.extend(more);
        }
        match under {
            Under::Done(child) => Under::Done(moved(child)),
            few @ Under::Few { .. } => few,
        }
    }

    fn finish(&mut self, under: &Under) -> Child {
        match *under {
            Under::Done(child) => child,
            Under::Few { bounds, kind: ITEMS, surfaces, .. } => Child { bounds, word: node::leaf(ITEMS, surfaces[0]) },
            Under::Few { bounds, kind, surfaces, .. } => {
                let list = &mut self.blocks[kind as usize];
                list.push(surfaces);
                Child { bounds, word: node::leaf(kind, list.len() as u32 - 1) }
            }
        }
    }
}
