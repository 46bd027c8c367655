//! The octree of records, independent of surfaces.
//!
//! A record's size class is the depth at which cells have one to two times its reach (Ward, Rubinstein, Clear 1988). It
//! is listed in every cell of that depth that its reach touches, so that a look-up follows one path from the root to a
//! leaf and reads one list a level.
//!
//! Everything lies in flat arrays: the lists are runs of columns that are compared several records at a time; what
//! passes is tested on the record itself, and its value read last.

use crate::light::{APART, Light};
use crate::lookup::{Asked, Sum, accumulate};
use crate::params::Limits;
use crate::record::Record;
use crate::sampler::{Query, Sampler};
use crate::sieve::{Block, LANES, Mark, Probe};
use ambit_base::{DVec3, Rgb, Vec3};

/// Weight from which the records of smaller cells suffice and longer-reaching ones are not searched.
const GOOD_ENOUGH: f32 = 0.05;
/// Depth at which insertion stops whatever the radius: below it cells differ by less than the rounding of coordinates.
const MAX_DEPTH: u32 = 48;
/// Relative margin between the two ways of finding a cell.
const MARGIN: f64 = 1e-9;
/// Records nearer than this fraction of their reach, with equal level, weight and normal, are duplicates.
const DUPLICATE: f64 = 1e-4;

/// Where a record is valid: read by every comparison.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Place {
    pub(crate) position: [f64; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) u: [f32; 3],
    pub(crate) inverse_radii: [f32; 2],
    weight: f32,
    level: u8,
    pub(crate) corralled: u8,
}

/// What a record answers: read once it qualifies.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Derived {
    pub(crate) gradient: [f32; 2],
    pub(crate) rotation: [f32; 2],
    pub(crate) value: Rgb,
    pub(crate) corral: u32,
}

impl Place {
    fn of(record: &Record) -> Self {
        Self {
            position: record.position.to_array(),
            normal: record.normal.as_vec3().to_array(),
            u: record.u.as_vec3().to_array(),
            inverse_radii: record.radii.map(f32::recip),
            weight: record.weight,
            level: record.level,
            corralled: u8::from(record.corral != 0),
        }
    }
}

impl Derived {
    fn of(record: &Record) -> Self {
        Self { gradient: record.gradient, rotation: record.rotation, value: record.value, corral: record.corral }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// Index of the first of eight children; 0: none (the root is nobody's child).
    children: u32,
    /// The node's list: its first block, its records and how many blocks it has.
    start: u32,
    len: u32,
    capacity: u32,
}

/// The octree.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    corner: DVec3,
    edge: f64,
    nodes: Vec<Node>,
    places: Vec<Place>,
    derived: Vec<Derived>,
    /// Values in further passes, so many a record.
    further: Vec<Rgb>,
    further_passes: usize,
    /// What the last bounces brought, in each pass, so many a record; none where bounces are not told apart.
    late: Vec<[Rgb; APART]>,
    apart: bool,
    /// The lists, each a run of blocks.
    blocks: Vec<Block>,
    /// Runs given up by lists that grew: entry k holds the starts of those of 2^k blocks.
    vacant: Vec<Vec<u32>>,
}

impl Store {
    /// An empty tree over the cube with the given low corner and edge, of records with values in so many passes; `apart`
    /// if bounces are told apart.
    pub(crate) fn new(corner: DVec3, edge: f64, passes: u8, apart: bool) -> Self {
        Self {
            corner,
            edge,
            nodes: vec![Node::default()],
            places: Vec::new(),
            derived: Vec::new(),
            further: Vec::new(),
            further_passes: usize::from(passes.max(1)) - 1,
            late: Vec::new(),
            apart,
            blocks: Vec::new(),
            vacant: Vec::new(),
        }
    }

    /// An empty tree over the same cube.
    pub(crate) fn emptied(&self) -> Self {
        Self::new(self.corner, self.edge, self.further_passes as u8 + 1, self.apart)
    }

    /// Files a record in the cells of its reach. False if an equal one is there already.
    pub(crate) fn insert(&mut self, record: &Record, accuracy: f64) -> bool {
        let reach = f64::from(record.radii[1]) * accuracy;
        let (mut edge, mut depth) = (self.edge, 0u32);
        while edge * 0.5 > reach && depth < MAX_DEPTH {
            edge *= 0.5;
            depth += 1;
        }
        let place = Place::of(record);
        if self.is_duplicate(record, &place, depth, accuracy) {
            return false;
        }
        let id = self.places.len() as u32;
        self.places.push(place);
        self.derived.push(Derived::of(record));
        self.further.extend((0..self.further_passes).map(|k| record.of_pass(k as u8 + 1)));
        if self.apart {
            self.late.extend((0..=self.further_passes).map(|k| record.light(k as u8).late));
        }
        // Cells are found by halving in look-ups and by division here: the margin covers the difference.
        let margin = DVec3::splat(reach * (1.0 + MARGIN) + self.edge * MARGIN);
        let last = (1u64 << depth) - 1;
        let corner = self.corner;
        let cell = |p: DVec3| ((p - corner) / edge).to_array().map(|c| (c.max(0.0) as u64).min(last));
        let (low, high) = (cell(record.position - margin), cell(record.position + margin));
        // Distance along one axis to the cells with one index; those at the border reach on without end.
        let off = |axis: usize, index: u64| {
            let c = record.position[axis] - (corner[axis] + index as f64 * edge);
            let below = if index == 0 { 0.0 } else { -c };
            let above = if index == last { 0.0 } else { c - edge };
            below.max(above).max(0.0)
        };
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    if DVec3::new(off(0, x), off(1, y), off(2, z)).length_squared() > margin.x * margin.x {
                        continue;
                    }
                    let node = self.cell([x, y, z], depth);
                    let corner = corner + DVec3::new(x as f64, y as f64, z as f64) * edge;
                    self.list(node, id, record.position - corner, edge, reach);
                }
            }
        }
        true
    }

    /// Lowers the radii of a record, the so-manieth inserted. It stays listed where it was: a little to search, nothing wrong.
    pub(crate) fn shrink(&mut self, id: u32, radii: [f32; 2]) {
        self.places[id as usize].inverse_radii = radii.map(f32::recip);
    }

    /// What a record answers at its own place. Of questions of the eye's nobody wants to know what the last bounces brought.
    #[inline]
    fn light<O>(&self, derived: &Derived, id: usize, level: u8, query: &Query<O>) -> Light {
        let value = match query.pass {
            0 => derived.value,
            pass => self.further[id * self.further_passes + usize::from(pass) - 1],
        };
        if query.level == 0 || !self.apart {
            return value.into();
        }
        let late = self.late[id * (self.further_passes + 1) + usize::from(query.pass)];
        Light { value, late }.deeper(query.level - level)
    }

    /// True if the cell at `depth` around a record lists one like it.
    fn is_duplicate(&self, record: &Record, place: &Place, depth: u32, accuracy: f64) -> bool {
        let (mut edge, mut corner, mut node) = (self.edge, self.corner, &self.nodes[0]);
        for _ in 0..depth {
            if node.children == 0 {
                return false;
            }
            edge *= 0.5;
            let middle = corner + edge;
            let upper = record.position.cmpgt(middle);
            corner = DVec3::select(upper, middle, corner);
            node = &self.nodes[node.children as usize + upper.bitmask() as usize];
        }
        let close = DUPLICATE * accuracy * f64::from(record.radii[0]);
        let probe = Probe::new(record.position - corner, edge, Vec3::from_array(place.normal), 0.0);
        self.run_of(node).iter().flat_map(|block| block.candidates(&probe)).any(|id| {
            let p = &self.places[id as usize];
            p.level == place.level
                && p.weight == place.weight
                && p.normal == place.normal
                && (DVec3::from_array(p.position) - record.position).length_squared() < close * close
        })
    }

    /// The node of a cell, given by its coordinates in a grid of 2^depth cells a side; made if need be.
    fn cell(&mut self, at: [u64; 3], depth: u32) -> usize {
        let mut node = 0usize;
        for level in (0..depth).rev() {
            if self.nodes[node].children == 0 {
                self.nodes[node].children = self.nodes.len() as u32;
                self.nodes.resize(self.nodes.len() + 8, Node::default());
            }
            let half = |axis: usize| (at[axis] >> level & 1) as usize;
            node = self.nodes[node].children as usize + (half(0) | half(1) << 1 | half(2) << 2);
        }
        node
    }

    /// The blocks of a node's list.
    #[inline]
    fn run_of(&self, node: &Node) -> &[Block] {
        &self.blocks[node.start as usize..][..(node.len as usize).div_ceil(LANES)]
    }

    /// The records of a node's list, in order.
    fn listed(&self, node: &Node) -> impl Iterator<Item = u32> {
        let blocks = self.run_of(node);
        (0..node.len as usize).map(|i| blocks[i / LANES].id(i % LANES))
    }

    /// Enters a record in a node's list: level ascending, weight descending, a new record after its equals.
    fn list(&mut self, node: usize, id: u32, relative: DVec3, edge: f64, reach: f64) {
        let place = self.places[id as usize];
        let key = |p: &Place| (p.level, -p.weight);
        let Node { start, len, capacity, .. } = self.nodes[node];
        let (len, mut first) = (len as usize, start as usize);
        let (mut at, mut end) = (0, len);
        while at < end {
            let middle = at.midpoint(end);
            let other = self.blocks[first + middle / LANES].id(middle % LANES);
            if key(&self.places[other as usize]) <= key(&place) {
                at = middle + 1;
            } else {
                end = middle;
            }
        }
        if len == capacity as usize * LANES {
            let grown = (capacity * 2).max(1);
            let fresh = self.run(grown);
            self.blocks.copy_within(first..first + capacity as usize, fresh as usize);
            if capacity > 0 {
                let class = capacity.trailing_zeros() as usize;
                if self.vacant.len() <= class {
                    self.vacant.resize_with(class + 1, Vec::new);
                }
                self.vacant[class].push(start);
            }
            first = fresh as usize;
            self.nodes[node].start = fresh;
            self.nodes[node].capacity = grown;
        }
        for i in (at..len).rev() {
            let mark = self.blocks[first + i / LANES].mark(i % LANES);
            self.blocks[first + (i + 1) / LANES].set((i + 1) % LANES, mark);
        }
        let mark = Mark::new(relative, edge, Vec3::from_array(place.normal), reach, id);
        self.blocks[first + at / LANES].set(at % LANES, mark);
        self.nodes[node].len += 1;
        for block in &mut self.blocks[first + at / LANES..=first + len / LANES] {
            block.set_level(self.places[block.id(0) as usize].level);
        }
    }

    /// A run of vacant blocks, a power of two.
    fn run(&mut self, blocks: u32) -> u32 {
        if let Some(start) = self.vacant.get_mut(blocks.trailing_zeros() as usize).and_then(Vec::pop) {
            self.blocks[start as usize..(start + blocks) as usize].fill(Block::VACANT);
            return start;
        }
        let start = self.blocks.len();
        self.blocks.resize(start + blocks as usize, Block::VACANT);
        start as u32
    }

    /// Sums the records that qualify for a query.
    pub(crate) fn lookup<S: Sampler>(&self, limits: &Limits, sampler: &S, query: &Query<S::Origin>) -> Sum {
        let mut sum = Sum::EMPTY;
        let asked = Asked::new(query, limits);
        // Positions outside the cube are filed in its border cells and searched for there.
        let inside = query.position.clamp(self.corner, self.corner + self.edge);
        let search = Search { store: self, asked, inside, limits, sampler, query };
        search.node(0, self.corner, self.edge, &mut sum);
        sum
    }
}

impl Store {
    /// The records that [`Store::lookup`] sums, one by one: weights and answers. For statistics, not for speed.
    pub(crate) fn contributions<S: Sampler>(
        &self,
        limits: &Limits,
        sampler: &S,
        query: &Query<S::Origin>,
    ) -> Vec<(f32, Rgb)> {
        let asked = Asked::new(query, limits);
        let inside = query.position.clamp(self.corner, self.corner + self.edge);
        let (mut corner, mut edge, mut node) = (self.corner, self.edge, self.nodes[0]);
        let mut path = vec![(node, edge)];
        while node.children != 0 {
            edge *= 0.5;
            let middle = corner + edge;
            let upper = inside.cmpgt(middle);
            node = self.nodes[node.children as usize + upper.bitmask() as usize];
            corner = DVec3::select(upper, middle, corner);
            path.push((node, edge));
        }
        let mut found = Vec::new();
        let mut weight = 0.0;
        for (node, edge) in path.into_iter().rev() {
            if weight >= GOOD_ENOUGH && 0.5 * edge * limits.accuracy > limits.min_radius {
                break;
            }
            let Some(first) = self.listed(&node).next() else { continue };
            let angle = asked.angle_for(self.places[first as usize].level);
            for id in self.listed(&node) {
                let place = &self.places[id as usize];
                let deeper = place.level > asked.level;
                if deeper || place.level == asked.level && place.weight < asked.least_weight {
                    break;
                }
                let mut sum = Sum::EMPTY;
                let derived = &self.derived[id as usize];
                let light = || self.light(derived, id as usize, place.level, query);
                let own = accumulate(&asked, angle, place, (derived, light), sampler, query, &mut sum);
                if own > 0.0 {
                    weight += own;
                    found.extend(sum.answer().map(|light| (own, light.value)));
                }
            }
        }
        found
    }
}

struct Search<'a, S: Sampler> {
    store: &'a Store,
    asked: Asked,
    inside: DVec3,
    limits: &'a Limits,
    sampler: &'a S,
    query: &'a Query<S::Origin>,
}

impl<S: Sampler> Search<'_, S> {
    /// The child around the point first, then the node's own list unless that gave enough; returns the weight found.
    fn node(&self, index: usize, corner: DVec3, edge: f64, sum: &mut Sum) -> f32 {
        let node = self.store.nodes[index];
        let mut weight = 0.0;
        if node.children != 0 {
            let half = edge * 0.5;
            let middle = corner + half;
            let upper = self.inside.cmpgt(middle);
            let child = node.children as usize + upper.bitmask() as usize;
            let next = &self.store.nodes[child];
            if next.children != 0 || next.len != 0 {
                weight = self.node(child, DVec3::select(upper, middle, corner), half, sum);
                if weight >= GOOD_ENOUGH && half * self.limits.accuracy > self.limits.min_radius {
                    return weight;
                }
            }
        }
        if node.len == 0 { weight } else { weight + self.list(node, corner, edge, sum) }
    }

    fn list(&self, node: Node, corner: DVec3, edge: f64, sum: &mut Sum) -> f32 {
        let store = self.store;
        let blocks = store.run_of(&node);
        let angle = self.asked.angle_for(blocks[0].level());
        let probe = Probe::new(self.query.position - corner, edge, self.asked.normal, angle);
        let mut weight = 0.0;
        for block in blocks {
            if block.level() > self.asked.level {
                break;
            }
            for id in block.candidates(&probe) {
                let id = id as usize;
                let place = &store.places[id];
                let deeper = place.level > self.asked.level;
                if deeper || place.level == self.asked.level && place.weight < self.asked.least_weight {
                    return weight;
                }
                let derived = &store.derived[id];
                let light = || store.light(derived, id, place.level, self.query);
                weight += accumulate(&self.asked, angle, place, (derived, light), self.sampler, self.query, sum);
            }
        }
        weight
    }
}
