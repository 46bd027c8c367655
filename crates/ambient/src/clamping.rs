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

/// How many records that came in the meantime are asked one by one: about as fast as searching the tree.
const NEWCOMERS: usize = 128;

/// What is known of a record before it is entered: what the others allow it and whether it reins any of them in takes most of
/// the time of entering, and may be asked by any thread while nothing changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Survey {
    /// The records that there were, which the radius has been clamped to.
    seen: usize,
    /// True if some of them exceed what it allows.
    exceeded: bool,
}

impl Survey {
    /// Nothing is known.
    pub(crate) const NONE: Self = Self { seen: 0, exceeded: true };
}

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

    /// Whatever lies outside counts at the border of the cube, where bounds of distances hold for it, too.
    fn inside(&self, position: DVec3) -> DVec3 {
        position.clamp(self.corner, self.corner + self.edge)
    }

    /// Those that came after a survey, if they are few.
    fn newcomers(&self, survey: Survey) -> Option<impl Iterator<Item = (DVec3, f64)>> {
        let new = survey.seen..self.radii.len();
        (new.len() <= NEWCOMERS)
            .then(|| self.positions[new.clone()].iter().copied().zip(self.radii[new].iter().copied()))
    }

    /// What the radius of a record that wants `radius` may be, which suits those that `survey` saw.
    pub(crate) fn allowed(&self, position: DVec3, radius: f64, survey: Survey) -> f64 {
        let p = self.inside(position);
        match self.newcomers(survey) {
            Some(new) => new.fold(radius, |best, (q, r)| best.min(r + self.rule.slope * q.distance(p))),
            None => self.lowest(self.root(), p, radius),
        }
    }

    /// What is to be known of a record whose radius is what it may be.
    pub(crate) fn survey(&self, position: DVec3, radius: f64) -> Survey {
        Survey { seen: self.radii.len(), exceeded: self.exceeded(self.root(), self.inside(position), radius) }
    }

    /// Enters record `id`, whose radius is what it may be. Records that it reins in are pushed on `changed` with their
    /// new radii.
    pub(crate) fn insert(
        &mut self,
        id: u32,
        position: DVec3,
        radius: f64,
        survey: Survey,
        changed: &mut Vec<(u32, f64)>,
    ) {
        let p = self.inside(position);
        let exceeds = |(q, r): (DVec3, f64)| r > radius + self.rule.slope * q.distance(p);
        if survey.exceeded || self.newcomers(survey).is_none_or(|mut new| new.any(exceeds)) {
            self.rein_in(self.root(), p, radius, changed);
        }
        let number = self.radii.len() as u32;
        self.ids.push(id);
        self.positions.push(p);
        self.radii.push(radius);
        self.enter(number);
    }

    /// True if a radius in a cell exceeds `radius` plus s times the distance from `p`.
    fn exceeded(&self, at: At, p: DVec3, radius: f64) -> bool {
        let node = &self.nodes[at.node];
        let slope = self.rule.slope;
        if node.greatest <= radius + slope * at.distance(p) {
            return false;
        }
        let beyond = |&j: &u32| self.radii[j as usize] > radius + slope * self.positions[j as usize].distance(p);
        node.members.iter().any(beyond)
            || node.children != 0 && (0..8).any(|k| self.exceeded(at.child(node.children, k), p, radius))
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
                    let allowed = reins.allowed(p, r, Survey::NONE);
                    reins.insert(10 + k as u32, p, allowed, Survey::NONE, &mut changed);
                    seen.push(allowed);
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
            assert_eq!(reins.allowed(DVec3::splat(0.3), r, Survey::NONE), r);
            reins.insert(k, DVec3::splat(0.3), r, Survey::NONE, &mut changed);
        }
        assert!(reins.radii.iter().all(|&r| r == 0.01));
    }

    /// Surveys of a while ago, of fewer and of more newcomers than are asked one by one, lead to the same.
    #[test]
    fn surveys_change_nothing() {
        for round in [1, 7, 64, 2 * NEWCOMERS] {
            let all = points(900, 1.0);
            let (mut plain, mut surveyed) = (Reins::by(DEEPER, DVec3::ZERO, 1.0), Reins::by(DEEPER, DVec3::ZERO, 1.0));
            let mut reined = 0;
            for (start, chunk) in all.chunks(round).enumerate().map(|(n, chunk)| (n * round, chunk)) {
                let known: Vec<(f64, Survey)> = chunk
                    .iter()
                    .map(|&(p, r)| {
                        let r = surveyed.allowed(p, r, Survey::NONE);
                        (r, surveyed.survey(p, r))
                    })
                    .collect();
                for (k, (&(p, r), (allowed, survey))) in chunk.iter().zip(known).enumerate() {
                    let id = (start + k) as u32;
                    let (mut one, mut other) = (Vec::new(), Vec::new());
                    let r = plain.allowed(p, r, Survey::NONE);
                    plain.insert(id, p, r, Survey::NONE, &mut one);
                    let r = surveyed.allowed(p, allowed, survey);
                    surveyed.insert(id, p, r, survey, &mut other);
                    reined += one.len();
                }
            }
            assert!(reined > 100, "{reined}");
            for (a, b) in plain.radii.iter().zip(&surveyed.radii) {
                assert!((a - b).abs() <= 1e-12, "{a} and {b} in rounds of {round}");
            }
        }
    }
}
