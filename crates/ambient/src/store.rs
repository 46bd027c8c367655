//! The octree of records: independent of surfaces, a record in the one cell whose edge is one to two times its reach.
//!
//! Everything lies in flat arrays. A node's records are contiguous, split in the part every comparison reads (one cache
//! line) and the part only records that qualify are asked for.

use crate::lookup::{Asked, Sum, accumulate};
use crate::params::Limits;
use crate::record::Record;
use crate::sampler::{Query, Sampler};
use ambit_base::DVec3;

/// Weight from which the records of smaller cells suffice and longer-reaching ones are not searched.
const GOOD_ENOUGH: f32 = 0.05;
/// Depth at which insertion stops whatever the radius: below it cells differ by less than the rounding of coordinates.
const MAX_DEPTH: u32 = 48;
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
pub(crate) struct Derived {
    pub(crate) gradient: [f32; 2],
    pub(crate) rotation: [f32; 2],
    pub(crate) value: [f32; 3],
    pub(crate) corral: u32,
}

impl Place {
    const VACANT: Self = Self {
        position: [0.0; 3],
        normal: [0.0; 3],
        u: [0.0; 3],
        inverse_radii: [0.0; 2],
        weight: 0.0,
        level: 0,
        corralled: 0,
    };

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
    const VACANT: Self = Self { gradient: [0.0; 2], rotation: [0.0; 2], value: [0.0; 3], corral: 0 };

    fn of(record: &Record) -> Self {
        Self {
            gradient: record.gradient,
            rotation: record.rotation,
            value: record.value.to_array(),
            corral: record.corral,
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// Index of the first of eight children; 0: none (the root is nobody's child).
    children: u32,
    /// The node's records in the arrays of the store.
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
    /// Segments given up by lists that grew: entry k holds the starts of those of 2^k records.
    vacant: Vec<Vec<u32>>,
}

impl Store {
    /// An empty tree over the cube with the given low corner and edge.
    pub(crate) fn new(corner: DVec3, edge: f64) -> Self {
        Self { corner, edge, nodes: vec![Node::default()], places: Vec::new(), derived: Vec::new(), vacant: Vec::new() }
    }

    /// An empty tree over the same cube.
    pub(crate) fn emptied(&self) -> Self {
        Self::new(self.corner, self.edge)
    }

    /// Files a record in the cell of its reach. False if an equal one is there already.
    pub(crate) fn insert(&mut self, record: &Record, accuracy: f64) -> bool {
        let reach = f64::from(record.radii[1]) * accuracy;
        let (mut edge, mut corner, mut node) = (self.edge, self.corner, 0usize);
        let mut depth = 0;
        while edge * 0.5 > reach && depth < MAX_DEPTH {
            edge *= 0.5;
            depth += 1;
            let middle = corner + edge;
            let upper = record.position.cmpgt(middle);
            corner = DVec3::select(upper, middle, corner);
            if self.nodes[node].children == 0 {
                self.nodes[node].children = self.nodes.len() as u32;
                self.nodes.resize(self.nodes.len() + 8, Node::default());
            }
            node = self.nodes[node].children as usize + upper.bitmask() as usize;
        }
        let Node { start, len, .. } = self.nodes[node];
        let place = Place::of(record);
        let list = &self.places[start as usize..(start + len) as usize];
        let close = DUPLICATE * accuracy * f64::from(record.radii[0]);
        let duplicate = |p: &Place| {
            p.level == place.level
                && p.weight == place.weight
                && p.normal == place.normal
                && (DVec3::from_array(p.position) - record.position).length_squared() < close * close
        };
        if list.iter().any(duplicate) {
            return false;
        }
        // Level ascending, weight descending, a new record before its equals.
        let at = list.partition_point(|p| (p.level, -p.weight) < (place.level, -place.weight));
        self.put(node, at, place, Derived::of(record));
        true
    }

    fn put(&mut self, node: usize, at: usize, place: Place, derived: Derived) {
        let Node { start, len, capacity, .. } = self.nodes[node];
        if len == capacity {
            let grown = (capacity * 2).max(1);
            let fresh = self.segment(grown);
            let (from, to) = (start as usize, fresh as usize);
            self.places.copy_within(from..from + len as usize, to);
            self.derived.copy_within(from..from + len as usize, to);
            if capacity > 0 {
                let class = capacity.trailing_zeros() as usize;
                if self.vacant.len() <= class {
                    self.vacant.resize_with(class + 1, Vec::new);
                }
                self.vacant[class].push(start);
            }
            self.nodes[node].start = fresh;
            self.nodes[node].capacity = grown;
        }
        let first = self.nodes[node].start as usize;
        let end = first + len as usize;
        self.places.copy_within(first + at..end, first + at + 1);
        self.derived.copy_within(first + at..end, first + at + 1);
        self.places[first + at] = place;
        self.derived[first + at] = derived;
        self.nodes[node].len += 1;
    }

    /// Room for `capacity` records, a power of two.
    fn segment(&mut self, capacity: u32) -> u32 {
        if let Some(start) = self.vacant.get_mut(capacity.trailing_zeros() as usize).and_then(Vec::pop) {
            return start;
        }
        let start = self.places.len();
        self.places.resize(start + capacity as usize, Place::VACANT);
        self.derived.resize(start + capacity as usize, Derived::VACANT);
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

struct Search<'a, S: Sampler> {
    store: &'a Store,
    asked: Asked,
    inside: DVec3,
    limits: &'a Limits,
    sampler: &'a S,
    query: &'a Query<S::Origin>,
}

impl<S: Sampler> Search<'_, S> {
    /// Children first, then the node's own list unless the children gave enough; returns the weight found.
    fn node(&self, index: usize, corner: DVec3, edge: f64, sum: &mut Sum) -> f32 {
        let node = self.store.nodes[index];
        let mut weight = 0.0;
        if node.children != 0 {
            let half = edge * 0.5;
            let middle = corner + half;
            // A child is entered if the point lies in its cube grown by its own edge on every side.
            let within = |low: DVec3| (self.inside.cmpge(low - half) & self.inside.cmple(low + 2.0 * half)).bitmask();
            let (lower, upper) = (within(corner), within(middle));
            for k in 0..8u32 {
                // Per axis, the lower or the upper half must be within reach.
                if (k & upper) | (!k & lower & 7) != 7 {
                    continue;
                }
                let child = node.children as usize + k as usize;
                let next = self.store.nodes[child];
                if next.children != 0 || next.len != 0 {
                    let low = DVec3::new(
                        if k & 1 != 0 { middle.x } else { corner.x },
                        if k & 2 != 0 { middle.y } else { corner.y },
                        if k & 4 != 0 { middle.z } else { corner.z },
                    );
                    weight += self.node(child, low, half, sum);
                }
            }
            if weight >= GOOD_ENOUGH && half * self.limits.accuracy > self.limits.min_radius {
                return weight;
            }
        }
        weight + self.list(node, sum)
    }

    fn list(&self, node: Node, sum: &mut Sum) -> f32 {
        let range = node.start as usize..(node.start + node.len) as usize;
        let (places, derived) = (&self.store.places[range.clone()], &self.store.derived[range]);
        let Some(first) = places.first() else { return 0.0 };
        let angle = self.asked.angle_for(first.level);
        let mut weight = 0.0;
        for (place, derived) in places.iter().zip(derived) {
            let deeper = place.level > self.asked.level;
            if deeper || place.level == self.asked.level && place.weight < self.asked.least_weight {
                break;
            }
            weight += accumulate(&self.asked, angle, place, derived, self.sampler, self.query, sum);
        }
        weight
    }
}
