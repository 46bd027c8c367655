//! Collapses a binary tree into nodes of eight children, and numbers the leaves in the order of the nodes.

use crate::block::LANES;
use crate::node::{self, ITEMS, LEAF, Node, WIDTH};
use crate::pages;
use crate::tree::{Child, Part};

/// Two leaves of a node are joined if the box around both has at most this share of the surface of the two.
const CLOSE: f32 = 1.2;

/// Cost of a node and of a leaf, in the same units.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.0;

/// What f32 arithmetic of the walk can be wrong by, in units of the coordinates involved: eight roundings, twice what
/// the analysis in [`crate::walk`] needs.
pub(crate) const SLACK: f32 = 8.0 * 0.5 * f32::EPSILON;

/// Turns a binary tree into wide nodes.
pub(crate) struct Collapse {
    binary: Part,
    choices: Vec<[u8; WIDTH + 1]>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) depth: usize,
    /// The leaves in the order of the nodes.
    pub(crate) blocks: [Vec<[u32; LANES]>; 2],
}

impl Collapse {
    pub(crate) fn run(binary: Part, root: Option<Child>) -> Self {
        let blocks = [0, 1].map(|k| Vec::with_capacity(binary.blocks[k].len()));
        let choices = choose(&binary.nodes);
        let mut wide = Self { binary, choices, nodes: vec![Node::EMPTY], depth: 1, blocks };
        if let Some(root) = root {
            wide.expand(root);
        }
        let mut nodes = pages::list(wide.nodes.len());
        nodes.append(&mut wide.nodes);
        wide.nodes = nodes;
        wide
    }

    fn expand(&mut self, root: Child) {
        let mut todo = vec![(root, 0, 1)];
        while let Some((from, slot, level)) = todo.pop() {
            self.depth = self.depth.max(level);
            let children = self.children(from);
            for (i, c) in children.iter().enumerate() {
                let node = &mut self.nodes[slot];
                for axis in 0..3 {
                    let (low, high) = (c.bounds.min[axis], c.bounds.max[axis]);
                    node.planes[2 * axis][i] = (low - SLACK * low.abs()).next_down();
                    node.planes[2 * axis + 1][i] = (high + SLACK * high.abs()).next_up();
                }
                let word = if c.word & LEAF == 0 {
                    self.nodes.push(Node::EMPTY);
                    todo.push((*c, self.nodes.len() - 1, level + 1));
                    self.nodes.len() as u32 - 1
                } else {
                    self.place(c.word)
                };
                self.nodes[slot].child[i] = word;
            }
        }
    }

    /// The children of a wide node; leaves that fit into one and lie close are joined.
    fn children(&mut self, from: Child) -> Vec<Child> {
        let mut children = Vec::with_capacity(WIDTH);
        if from.word & LEAF == 0 {
            self.open(from, WIDTH, &mut children);
        } else {
            children.push(from);
        }
        while self.join_leaves(&mut children) {}
        children
    }

    /// The roots that stand for the two children of an inner node, `most` of them.
    fn open(&self, child: Child, most: usize, roots: &mut Vec<Child>) {
        let [a, b] = self.binary.nodes[child.word as usize];
        let left = usize::from(self.choices[child.word as usize][most]);
        self.roots(a, left, roots);
        self.roots(b, most - left, roots);
    }

    /// The best at most `most` roots that stand for a subtree.
    fn roots(&self, child: Child, most: usize, roots: &mut Vec<Child>) {
        if child.word & LEAF == 0 {
            let choice = &self.choices[child.word as usize];
            if let Some(n) = (2..=most).rev().find(|&n| choice[n] != 0) {
                return self.open(child, n, roots);
            }
        }
        roots.push(child);
    }

    /// Joins the pair of leaves that gains most; false if none gains.
    fn join_leaves(&mut self, children: &mut Vec<Child>) -> bool {
        let block = |c: &Child| c.word & LEAF != 0 && node::kind(c.word) != ITEMS;
        let mut best: Option<(f32, usize, usize)> = None;
        for i in 0..children.len() {
            for j in i + 1..children.len() {
                let (a, b) = (&children[i], &children[j]);
                if !(block(a) && block(b)) || node::kind(a.word) != node::kind(b.word) {
                    continue;
                }
                if self.count(a.word) + self.count(b.word) > LANES {
                    continue;
                }
                let joined = a.bounds.union(&b.bounds).half_area();
                let ratio = joined / (a.bounds.half_area() + b.bounds.half_area());
                if ratio <= CLOSE && best.is_none_or(|(r, _, _)| ratio < r) {
                    best = Some((ratio, i, j));
                }
            }
        }
        let Some((_, i, j)) = best else { return false };
        let other = children.swap_remove(j);
        let into = &mut children[i];
        into.bounds = into.bounds.union(&other.bounds);
        let n = self.count(into.word);
        let surfaces = *self.list(other.word);
        self.list(into.word)[n..].copy_from_slice(&surfaces[..LANES - n]);
        true
    }

    fn list(&mut self, leaf: u32) -> &mut [u32; LANES] {
        &mut self.binary.blocks[node::kind(leaf) as usize][node::index(leaf)]
    }

    fn count(&self, leaf: u32) -> usize {
        let list = &self.binary.blocks[node::kind(leaf) as usize][node::index(leaf)];
        list.iter().filter(|s| **s != u32::MAX).count()
    }

    /// Gives a leaf its final number.
    fn place(&mut self, leaf: u32) -> u32 {
        let kind = node::kind(leaf);
        if kind == ITEMS {
            return leaf;
        }
        let list = *self.list(leaf);
        self.blocks[kind as usize].push(list);
        node::leaf(kind, self.blocks[kind as usize].len() as u32 - 1)
    }
}

/// For each binary node and each number of roots from 2 to 8 that may stand for it, how many of them the first child
/// gets; 0 if fewer roots cost no more. Dynamic programming over the surface area heuristic, after Ylitie, Karras and
/// Laine 2017, section 3.
fn choose(binary: &[[Child; 2]]) -> Vec<[u8; WIDTH + 1]> {
    let mut costs: Vec<[f32; WIDTH]> = Vec::with_capacity(binary.len());
    let mut choices = Vec::with_capacity(binary.len());
    for pair in binary {
        let [a, b] = pair.map(|c| {
            if c.word & LEAF == 0 { costs[c.word as usize] } else { [c.bounds.half_area() * LEAF_COST; WIDTH] }
        });
        let area = pair[0].bounds.union(&pair[1].bounds).half_area();
        // cost[n]: of at most n roots; the first entry stands for one root, a wide node with the best eight below.
        let mut cost = [f32::INFINITY; WIDTH];
        let mut choice = [0u8; WIDTH + 1];
        let split = |n: usize| {
            (1..n).map(|k| (a[k] + b[n - k], k as u8)).fold((f32::INFINITY, 1), |x, y| if y.0 < x.0 { y } else { x })
        };
        let (below, k) = split(WIDTH);
        choice[WIDTH] = k;
        cost[1] = area * NODE_COST + below;
        for n in 2..WIDTH {
            let (c, k) = split(n);
            if c < cost[n - 1] {
                (cost[n], choice[n]) = (c, k);
            } else {
                cost[n] = cost[n - 1];
            }
        }
        costs.push(cost);
        choices.push(choice);
    }
    choices
}
