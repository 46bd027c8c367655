//! Neighbour clamping (Křivánek, Bouatouch, Pattanaik, Žára 2006, *Making Radiance and Irradiance Caching Practical*): what
//! one record sees at distance R, one at distance d from it sees at R + d at most, so that no radius may exceed another's
//! by more than their distance. A small feature or a crack that one record happens to find reins in its neighbours.
//!
//! All records are reined in so if that is asked for; otherwise those of deeper bounces, by twice the distance. Their few
//! samples miss what is small or low, such as the next row of solar panels, and a record that sees nothing but the sky
//! reaches as far as any may, under the panels.
//!
//! Radii are those before widening by weight. A new one is lowered to min(Rⱼ + s dⱼ), then the others to its own plus s times
//! their distance; the result, R(x) = min over all records of (R as computed + s · distance), does not depend on the order.

use crate::params::{Clamping, Params};
use ambit_base::DVec3;

/// Records of a leaf before it is divided.
const LEAF: usize = 16;
/// Depth at which leaves are not divided any more.
const DEEPEST: u32 = 32;

/// One cell: bounds of the radii in it, and what is in it.
#[derive(Clone, Debug)]
struct Node {
    least: f64,
    greatest: f64,
    /// Index of the first of eight children; 0: a leaf.
    children: u32,
    members: Vec<u32>,
}

impl Node {
    const EMPTY: Self = Self { least: f64::INFINITY, greatest: 0.0, children: 0, members: Vec::new() };
}

/// Which records rein each other in, and how far radii may differ for the distance between them.
#[derive(Clone, Copy, Debug)]
struct Rule {
    /// Those of this level and deeper ones.
    level: u8,
    slope: f64,
}

const ALL: Rule = Rule { level: 0, slope: 1.0 };
/// In rooms errors stay the same and records grow little; with a slope of 4 some still reach under the panels.
const DEEPER: Rule = Rule { level: 1, slope: 2.0 };

/// Radii of records before widening, no two of which differ by more than a multiple of the distance between them.
#[derive(Clone, Debug)]
pub(crate) struct Reins {
    rule: Rule,
    corner: DVec3,
    edge: f64,
    nodes: Vec<Node>,
    /// The record's number, of each that is reined in.
    ids: Vec<u32>,
    positions: Vec<DVec3>,
    radii: Vec<f64>,
}

/// A cell of the tree on the way down.
#[derive(Clone, Copy)]
struct At {
    node: usize,
    corner: DVec3,
    edge: f64,
}

impl At {
    /// A child's cell.
    fn child(self, first: u32, k: usize) -> Self {
        let edge = 0.5 * self.edge;
        let half = |axis: usize| if k >> axis & 1 == 1 { edge } else { 0.0 };
        Self { node: first as usize + k, corner: self.corner + DVec3::new(half(0), half(1), half(2)), edge }
    }

    fn child_of(self, p: DVec3) -> usize {
        p.cmpgt(self.corner + 0.5 * self.edge).bitmask() as usize
    }

    fn distance(self, p: DVec3) -> f64 {
        (p - p.clamp(self.corner, self.corner + self.edge)).length()
    }
}

impl Reins {
    /// None in the cube with the given low corner and edge, if a calculation has records that rein each other in.
    pub(crate) fn new(params: &Params, corner: DVec3, edge: f64) -> Option<Self> {
        let rule = match params.systems.clamping {
            Clamping::All => ALL,
            Clamping::Deeper => DEEPER,
            Clamping::Nobody => return None,
        };
        let any = params.caches() && params.bounces > i32::from(rule.level);
        any.then(|| Self::by(rule, corner, edge))
    }

    fn by(rule: Rule, corner: DVec3, edge: f64) -> Self {
        let (ids, positions, radii) = (Vec::new(), Vec::new(), Vec::new());
        Self { rule, corner, edge, nodes: vec![Node::EMPTY], ids, positions, radii }
    }

    /// True if records of this level are reined in.
    pub(crate) fn hold(&self, level: u8) -> bool {
        level >= self.rule.level
    }

    fn root(&self) -> At {
        At { node: 0, corner: self.corner, edge: self.edge }
    }

    /// Enters record `id`; returns its radius as clamped. Records that it reins in are pushed on `changed` with their
    /// new radii.
    pub(crate) fn insert(&mut self, id: u32, position: DVec3, radius: f64, changed: &mut Vec<(u32, f64)>) -> f64 {
        // Whatever lies outside counts at the border of the cube, where bounds of distances hold for it, too.
        let inside = position.clamp(self.corner, self.corner + self.edge);
        let radius = self.lowest(self.root(), inside, radius);
        self.rein_in(self.root(), inside, radius, changed);
        let number = self.radii.len() as u32;
        self.ids.push(id);
        self.positions.push(inside);
        self.radii.push(radius);
        self.enter(number);
        radius
    }

    /// What the radius of a record that wants `radius` may be.
    pub(crate) fn allowed(&self, position: DVec3, radius: f64) -> f64 {
        self.lowest(self.root(), position.clamp(self.corner, self.corner + self.edge), radius)
    }

    /// The least of `best` and Rⱼ + s dⱼ over a cell.
    fn lowest(&self, at: At, p: DVec3, mut best: f64) -> f64 {
        let node = &self.nodes[at.node];
        if node.least + self.rule.slope * at.distance(p) >= best {
            return best;
        }
        for &j in &node.members {
            best = best.min(self.radii[j as usize] + self.rule.slope * self.positions[j as usize].distance(p));
        }
        if node.children != 0 {
            let nearest = at.child_of(p);
            for k in 0..8 {
                best = self.lowest(at.child(node.children, k ^ nearest), p, best);
            }
        }
        best
    }

    /// Lowers all radii of a cell to `radius` plus s times the distance from `p`.
    fn rein_in(&mut self, at: At, p: DVec3, radius: f64, changed: &mut Vec<(u32, f64)>) {
        let node = &self.nodes[at.node];
        let slope = self.rule.slope;
        if node.greatest <= radius + slope * at.distance(p) {
            return;
        }
        let children = node.children;
        let (mut least, mut greatest) = (f64::INFINITY, 0.0f64);
        for &j in &node.members {
            let most = radius + slope * self.positions[j as usize].distance(p);
            let own = &mut self.radii[j as usize];
            if *own > most {
                *own = most;
                changed.push((self.ids[j as usize], most));
            }
            least = least.min(*own);
            greatest = greatest.max(*own);
        }
        if children != 0 {
            for k in 0..8 {
                self.rein_in(at.child(children, k), p, radius, changed);
                let child = &self.nodes[children as usize + k];
                least = least.min(child.least);
                greatest = greatest.max(child.greatest);
            }
        }
        let node = &mut self.nodes[at.node];
        (node.least, node.greatest) = (least, greatest);
    }

    /// Files a record in its leaf.
    fn enter(&mut self, number: u32) {
        let (p, r) = (self.positions[number as usize], self.radii[number as usize]);
        let mut at = self.root();
        let mut depth = 0;
        loop {
            let node = &mut self.nodes[at.node];
            node.least = node.least.min(r);
            node.greatest = node.greatest.max(r);
            if node.children == 0 {
                node.members.push(number);
                if node.members.len() > LEAF && depth < DEEPEST {
                    self.divide(at);
                }
                return;
            }
            at = at.child(node.children, at.child_of(p));
            depth += 1;
        }
    }

    /// Makes eight leaves of one.
    fn divide(&mut self, at: At) {
        let first = self.nodes.len() as u32;
        self.nodes.resize(first as usize + 8, Node::EMPTY);
        self.nodes[at.node].children = first;
        for j in std::mem::take(&mut self.nodes[at.node].members) {
            let r = self.radii[j as usize];
            let node = &mut self.nodes[first as usize + at.child_of(self.positions[j as usize])];
            node.least = node.least.min(r);
            node.greatest = node.greatest.max(r);
            node.members.push(j);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::Stream;

    fn points(count: u32, scale: f64) -> Vec<(DVec3, f64)> {
        let point = |k: u32| {
            let [x, y] = Stream::new(k, 1).two();
            let [z, r] = Stream::new(k, 2).two();
            (DVec3::new(x, y, z) * scale, (0.01 + r * r) * scale)
        };
        (0..count).map(point).collect()
    }

    /// R(x) = min over all of (R + s · distance), by brute force.
    fn expected(all: &[(DVec3, f64)], p: DVec3, slope: f64) -> f64 {
        all.iter().map(|(q, r)| r + slope * q.distance(p)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn radii_are_those_of_brute_force_in_any_order_and_at_any_scale() {
        for (scale, rule) in [1e-4, 1.0, 1e5].into_iter().flat_map(|scale| [(scale, ALL), (scale, DEEPER)]) {
            let all = points(600, scale);
            for reversed in [false, true] {
                let mut reins = Reins::by(rule, DVec3::ZERO, scale);
                let mut order = all.clone();
                if reversed {
                    order.reverse();
                }
                let mut seen: Vec<f64> = Vec::new();
                for (k, &(p, r)) in order.iter().enumerate() {
                    let mut changed = Vec::new();
                    seen.push(reins.insert(10 + k as u32, p, r, &mut changed));
                    for &(id, r) in &changed {
                        seen[id as usize - 10] = r;
                    }
                }
                for (k, &(p, _)) in order.iter().enumerate() {
                    let want = expected(&all, p, rule.slope);
                    assert!((seen[k] - want).abs() <= 1e-9 * scale, "scale {scale}: {} for {want}", seen[k]);
                }
            }
        }
    }

    #[test]
    fn coincident_records_end_with_the_smallest_radius() {
        let mut reins = Reins::by(ALL, DVec3::ZERO, 1.0);
        let mut changed = Vec::new();
        for k in 0..100 {
            let r = 1.0 / f64::from(k + 1);
            assert_eq!(reins.insert(k, DVec3::splat(0.3), r, &mut changed), r);
        }
        assert!(reins.radii.iter().all(|&r| r == 0.01));
    }
}
