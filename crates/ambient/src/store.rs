//! The octree of records, independent of surfaces.
//!
//! A record's size class is the depth at which cells have two to four times its reach (Ward, Rubinstein, Clear 1988). It
//! is listed in every cell of that depth that its reach touches, so that a look-up follows one path from the root to a
//! leaf and reads one list a level.
//!
//! Everything lies in flat arrays: the lists are runs of columns that are compared several records at a time; what
//! passes is tested on the record itself, and its value read last.

use crate::entry::{Entry, light_of};
use crate::light::Light;
use crate::lookup::{Asked, Sum, accumulate};
use crate::params::Limits;
use crate::record::Record;
use crate::sampler::{Query, Sampler};
use crate::sieve::{Block, LANES, Mark, Probe};
use ambit_base::{DVec3, Rgb, Vec3};

/// Weight from which the records of smaller cells suffice and longer-reaching ones are not searched.
const GOOD_ENOUGH: f32 = 0.05;
/// Weight from which a hemisphere sample needs no further records. Records beyond it smooth what the eye sees; of deeper
/// questions hundreds make one value, and a record or two each leave its error as it is, in rooms and boxes.
pub(crate) const ENOUGH: f32 = 0.25;
/// The weight from which a question of a level needs no further records.
fn enough(level: u8) -> f32 {
    if level == 0 { f32::INFINITY } else { ENOUGH }
}

/// The least edge of a record's cells, in its reaches. With 1 the lists are shorter, but more than twice the memory is read,
/// and memory is what look-ups wait for; with 4 more is compared than is saved.
const CELL: f64 = 2.0;
/// Depth at which insertion stops whatever the radius: below it cells differ by less than the rounding of coordinates.
const MAX_DEPTH: u32 = 48;
/// Relative margin for the rounding of a position plus its reach.
const MARGIN: f64 = 1e-9;
/// Records nearer than this fraction of their reach, with equal level, weight and normal, are duplicates.
const DUPLICATE: f64 = 1e-4;

#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// Index of the first of eight children; 0: none (the root is nobody's child).
    children: u32,
    /// 0 at the root.
    depth: u32,
    /// The node's list: its first block and how many records it has.
    start: u32,
    len: u32,
}

impl Node {
    /// How many blocks its list can grow to where it is.
    fn capacity(&self) -> u32 {
        if self.len == 0 { 0 } else { self.len.div_ceil(LANES as u32).next_power_of_two() }
    }
}

/// The octree.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    corner: DVec3,
    edge: f64,
    nodes: Vec<Node>,
    entries: Vec<Entry>,
    /// What records answer in further passes, so many a record.
    further: Vec<Light>,
    further_passes: usize,
    /// Bounces are told apart.
    apart: bool,
    /// The lists, each a run of blocks.
    blocks: Vec<Block>,
    /// True if a record lies where it was listed with a larger reach.
    shrunk: bool,
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
            entries: Vec::new(),
            further: Vec::new(),
            further_passes: usize::from(passes.max(1)) - 1,
            apart,
            blocks: Vec::new(),
            shrunk: false,
            vacant: Vec::new(),
        }
    }

    /// An empty tree over the same cube.
    pub(crate) fn emptied(&self) -> Self {
        Self::new(self.corner, self.edge, self.further_passes as u8 + 1, self.apart)
    }

    /// Files a record in the cells of its reach. False if an equal one is there already.
    pub(crate) fn insert(&mut self, record: &Record, limits: &Limits, found: bool) -> bool {
        let entry = Entry::of(record, self.apart, found);
        let reach = f64::from(record.radii[1]) * limits.used(record.level);
        let (mut edge, mut depth) = (self.edge, 0u32);
        while edge * 0.5 > CELL * reach && depth < MAX_DEPTH {
            edge *= 0.5;
            depth += 1;
        }
        if self.is_duplicate(record, &entry, depth, limits.accuracy) {
            return false;
        }
        let id = self.entries.len() as u32;
        self.entries.push(entry);
        self.further.extend((0..self.further_passes).map(|k| light_of(record, k as u8 + 1, self.apart)));
        // The margin covers the rounding of what is added to the position.
        let margin = DVec3::splat(reach * (1.0 + MARGIN) + self.edge * MARGIN);
        let last = (1u64 << depth) - 1;
        let corner = self.corner;
        let cell = |p: DVec3| self.finest(p).map(|c| c >> (MAX_DEPTH - depth));
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
                    let corner = self.corner_of([x, y, z], edge);
                    self.list(node, id, record.position - corner, edge, reach);
                }
            }
        }
        true
    }

    /// Lowers the radii of a record, the so-manieth inserted. It stays listed where it was: a little to search, nothing wrong.
    pub(crate) fn shrink(&mut self, id: u32, radii: [f32; 2]) {
        self.entries[id as usize].inverse_radii = radii.map(f32::recip);
        self.shrunk = true;
    }

    /// What a record answers at its own place.
    #[inline]
    fn light<O>(&self, id: usize, query: &Query<O>) -> Light {
        let entry = &self.entries[id];
        match query.pass {
            0 => entry.light(query.level),
            pass => {
                let light = self.further[id * self.further_passes + usize::from(pass) - 1];
                light.deeper(query.level - entry.level)
            }
        }
    }

    /// True if the cell at `depth` around a record lists one like it; any cell, where records may lie in larger ones.
    fn is_duplicate(&self, record: &Record, entry: &Entry, depth: u32, accuracy: f64) -> bool {
        let finest = self.finest(record.position);
        let close = DUPLICATE * accuracy * f64::from(record.radii[0]);
        let like = |id: u32| {
            let e = &self.entries[id as usize];
            e.level == entry.level
                && e.weight == entry.weight
                && e.normal == entry.normal
                && (DVec3::from_array(e.position) - record.position).length_squared() < close * close
        };
        self.around(finest).map(|n| &self.nodes[n]).filter(|n| n.depth == depth || self.shrunk).any(|node| {
            let (corner, edge) = self.cell_around(finest, node.depth);
            let probe = Probe::new(record.position - corner, edge, Vec3::from_array(entry.normal), 0.0);
            self.run_of(node).iter().flat_map(|block| block.candidates(&probe)).any(like)
        })
    }

    /// The cell of the finest grid in which a place lies; outside the cube one at its border.
    #[inline]
    fn finest(&self, place: DVec3) -> [u64; 3] {
        const CELLS: i64 = 1 << MAX_DEPTH;
        let cells = (place - self.corner) * (CELLS as f64 / self.edge);
        cells.to_array().map(|c| (c as i64).clamp(0, CELLS - 1) as u64)
    }

    /// Low corner of a cell, given by its coordinates in a grid of cells with such an edge.
    #[inline]
    fn corner_of(&self, cell: [u64; 3], edge: f64) -> DVec3 {
        self.corner + DVec3::from_array(cell.map(|c| c as f64)) * edge
    }

    /// Low corner and edge of the cell at `depth` around one of the finest grid.
    #[inline]
    fn cell_around(&self, finest: [u64; 3], depth: u32) -> (DVec3, f64) {
        let edge = self.edge / (1u64 << depth) as f64;
        (self.corner_of(finest.map(|c| c >> (MAX_DEPTH - depth)), edge), edge)
    }

    /// The nodes around a cell of the finest grid, from the root down.
    #[inline]
    fn around(&self, finest: [u64; 3]) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(0), move |&node| {
            let Node { children, depth, .. } = self.nodes[node];
            let half = |axis: usize| (finest[axis] >> (MAX_DEPTH - 1 - depth) & 1) as usize;
            (children != 0).then(|| children as usize + (half(0) | half(1) << 1 | half(2) << 2))
        })
    }

    /// The node of a cell, given by its coordinates in a grid of 2^depth cells a side; made if need be.
    fn cell(&mut self, at: [u64; 3], depth: u32) -> usize {
        let mut node = 0usize;
        for level in (0..depth).rev() {
            if self.nodes[node].children == 0 {
                self.nodes[node].children = self.nodes.len() as u32;
                let child = Node { depth: self.nodes[node].depth + 1, ..Node::default() };
                self.nodes.resize(self.nodes.len() + 8, child);
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

    /// Enters a record in a node's list: level ascending, weight descending, a new record after its equals.
    fn list(&mut self, node: usize, id: u32, relative: DVec3, edge: f64, reach: f64) {
        let entry = self.entries[id as usize];
        let key = |e: &Entry| (e.level, -e.weight);
        let Node { start, len, .. } = self.nodes[node];
        let capacity = self.nodes[node].capacity();
        let (len, mut first) = (len as usize, start as usize);
        let (mut at, mut end) = (0, len);
        while at < end {
            let middle = at.midpoint(end);
            let other = self.blocks[first + middle / LANES].id(middle % LANES);
            if key(&self.entries[other as usize]) <= key(&entry) {
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
        }
        for i in (at..len).rev() {
            let mark = self.blocks[first + i / LANES].mark(i % LANES);
            self.blocks[first + (i + 1) / LANES].set((i + 1) % LANES, mark);
        }
        let mark = Mark::new(relative, edge, Vec3::from_array(entry.normal), reach, id);
        self.blocks[first + at / LANES].set(at % LANES, mark);
        self.nodes[node].len += 1;
        for block in &mut self.blocks[first + at / LANES..=first + len / LANES] {
            block.set_level(self.entries[block.id(0) as usize].level);
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
        self.search(limits, query, enough(query.level), |asked, angle, id| {
            accumulate(asked, angle, &self.entries[id], || self.light(id, query), sampler, query, &mut sum)
        });
        sum
    }

    /// The records that [`Store::lookup`] takes for a query, one by one: weights and answers. For statistics, not for speed.
    pub(crate) fn contributions<S: Sampler>(
        &self,
        limits: &Limits,
        sampler: &S,
        query: &Query<S::Origin>,
    ) -> Vec<(f32, Rgb)> {
        let mut found = Vec::new();
        self.search(limits, query, enough(query.level), |asked, angle, id| {
            let mut sum = Sum::EMPTY;
            let own = accumulate(asked, angle, &self.entries[id], || self.light(id, query), sampler, query, &mut sum);
            found.extend(sum.smoothed().map(|light| (sum.smooth, light.value)));
            own
        });
        found
    }

    /// Offers the records that may qualify for a query to `take`, which returns what they weigh: those of the smallest
    /// cells first, until they have given `enough` or longer-reaching ones would add little.
    #[inline]
    fn search<O>(
        &self,
        limits: &Limits,
        query: &Query<O>,
        enough: f32,
        mut take: impl FnMut(&Asked, f32, usize) -> f32,
    ) {
        let asked = Asked::new(query, limits);
        let finest = self.finest(query.position);
        let mut filled = [0u32; MAX_DEPTH as usize + 1];
        let mut count = 0;
        for node in self.around(finest).filter(|&n| self.nodes[n].len > 0) {
            filled[count] = node as u32;
            count += 1;
        }
        let mut weight = 0.0;
        for &node in filled[..count].iter().rev() {
            let node = &self.nodes[node as usize];
            let (corner, edge) = self.cell_around(finest, node.depth);
            if weight >= GOOD_ENOUGH && 0.5 / CELL * edge * limits.accuracy > limits.min_radius {
                break;
            }
            let blocks = self.run_of(node);
            let angle = asked.angle_for(blocks[0].level());
            let probe = Probe::new(query.position - corner, edge, asked.normal, angle);
            'list: for block in blocks {
                if block.level() > asked.level {
                    break;
                }
                for id in block.candidates(&probe) {
                    let Entry { level, weight: own, .. } = self.entries[id as usize];
                    if level > asked.level || level == asked.level && own < asked.least_weight {
                        break 'list;
                    }
                    weight += take(&asked, angle, id as usize);
                    if weight >= enough {
                        return;
                    }
                }
            }
        }
    }
}
