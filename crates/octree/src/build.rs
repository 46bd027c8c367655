//! Building the tree: objects are handed down from cube to cube, and a cube with more than so many of them is divided
//! until it is small.
//!
//! The tree is the one that comes of inserting the objects one by one: a leaf of h half edge that holds a set T takes
//! one more object if |T| is below the limit, if h is below the resolution, or if the cube is wholly inside the new
//! volume; otherwise it is divided and its members and the new object are handed to the children — surfaces first,
//! then the volumes that the cube is not inside of, then the others. Here each cube sees all its arrivals at once, in
//! the order they would have come in, so that every object is tested once a cube and subtrees can be built in parallel.

use crate::overlap::{Octants, Relation};
use crate::tree::{self, BRANCH, DEEPEST, EMPTY, MOST_IN_SET, Node, Tree};
use crate::{Cube, Geometry};
use ambit_base::EPSILON;
use ambit_scene::{ObjectId, Scene};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// When cubes are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most objects in a cube that can still be divided (`-n`).
    pub objects: i64,
    /// How many of the smallest cubes make an edge of the root (`-r`).
    pub resolution: i64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { objects: 6, resolution: 16384 }
    }
}

/// Why a tree could not be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// More objects in the smallest cube than a file can store.
    #[error("set overflow in addobject ({name})")]
    SetOverflow {
        /// Identifier of the object that was one too many.
        name: String,
    },
    /// The resolution is so fine that cubes are divided forever.
    #[error("resolution limit too high: more than {objects} surfaces meet in a point")]
    TooDeep {
        /// The limit of objects in a cube.
        objects: i64,
    },
}

/// With the resolution limits that make sense no cube is divided more often than this: 2³¹ and the 2⁸ that crowded
/// cubes are granted on top.
const MOST_DIVISIONS: usize = 40;

/// Cubes with more arrivals than this have their children built in parallel.
const PARALLEL_ABOVE: usize = 4096;

/// Marks, in lists of arrivals, a volume that the cube is wholly inside of.
const INSIDE: u32 = 1 << 31;

/// Builds the tree of the objects of `geometry` in a cube.
pub fn build(scene: &Scene, geometry: &Geometry, cube: Cube, limits: Limits) -> Result<Tree, BuildError> {
    Ok(extend(scene, geometry, cube, limits, &Tree::default(), &Geometry::starting_at(0))?.tree)
}

/// A tree that grew.
#[derive(Clone, Debug)]
pub struct Extended {
    /// With all objects, old and new.
    pub tree: Tree,
    /// Those of the old ones that had to be looked at, because their cubes were divided; ascending.
    pub moved: Vec<ObjectId>,
}

/// Inserts the objects of `geometry` into a tree of other, earlier objects; `present` has the geometry of those.
pub fn extend(
    scene: &Scene,
    geometry: &Geometry,
    cube: Cube,
    limits: Limits,
    tree: &Tree,
    present: &Geometry,
) -> Result<Extended, BuildError> {
    let smallest = cube.edge / limits.resolution as f64 - EPSILON;
    let builder = Builder { scene, geometry, present, limits, smallest, moved: Mutex::default() };
    let mut arrivals: Vec<u32> = geometry.placed().collect();
    arrivals = arrivals.iter().filter_map(|&a| builder.test(&cube, a)).collect();
    let mut out = Vec::with_capacity(tree.words.len());
    let mut old = Old { words: &tree.words, at: 0 };
    builder.place(&cube, Some(&mut old), &mut arrivals, 0, 0, &mut out)?;
    out.shrink_to_fit();
    let mut moved = builder.moved.into_inner().unwrap_or_else(PoisonError::into_inner);
    moved.sort_unstable();
    moved.dedup();
    Ok(Extended { tree: Tree { words: out }, moved })
}

/// A place in the tree that is being extended.
struct Old<'a> {
    words: &'a [u32],
    at: usize,
}

impl<'a> Old<'a> {
    /// The node here; moves on to what follows it in pre-order.
    fn next(&mut self) -> Node<'a> {
        let node = tree::node_at(self.words, self.at).unwrap_or(Node::Empty);
        self.at += tree::length(node);
        node
    }

    /// Copies the subtree here and moves behind it.
    fn copy(&mut self, out: &mut Vec<u32>) {
        let start = self.at;
        let mut pending = 1usize;
        while pending > 0 {
            pending -= 1;
            if self.next() == Node::Branch {
                pending += 8;
            }
        }
        out.extend_from_slice(self.words.get(start..self.at).unwrap_or(&[EMPTY]));
    }
}

struct Builder<'a> {
    scene: &'a Scene,
    geometry: &'a Geometry,
    present: &'a Geometry,
    limits: Limits,
    /// Half edges below this are not divided.
    smallest: f64,
    /// Members of old leaves that were divided.
    moved: Mutex<Vec<ObjectId>>,
}

/// What the objects of a leaf come to.
enum Fate {
    Leaf,
    /// Divided; with volumes about, the children's arrivals are in another order, given here.
    Divide(Option<Vec<u32>>),
}

impl Builder<'_> {
    /// Handles a cube: its subtree is appended to `out`. The objects that meet it are `stack[start..]`, in the order
    /// in which they arrive; the stack is left as long as it was or shorter.
    fn place(
        &self,
        cube: &Cube,
        old: Option<&mut Old<'_>>,
        stack: &mut Vec<u32>,
        start: usize,
        depth: usize,
        out: &mut Vec<u32>,
    ) -> Result<(), BuildError> {
        let mut old = old;
        let mut present: &[ObjectId] = &[];
        if let Some(o) = old.as_deref_mut() {
            if stack.len() == start {
                o.copy(out);
                return Ok(());
            }
            match o.next() {
                Node::Branch => return self.divide(cube, old, stack, start, depth, out),
                Node::Full(set) => present = set,
                Node::Empty => {}
            }
        }
        match self.fate(cube, present, &stack[start..])? {
            Fate::Leaf => {
                let from = out.len();
                out.push((present.len() + stack.len() - start) as u32);
                out.extend_from_slice(present);
                out.extend(stack[start..].iter().map(|id| id & !INSIDE));
                if self.has_volumes() {
                    out[from + 1..].sort_unstable();
                }
                Ok(())
            }
            Fate::Divide(order) => {
                if depth >= MOST_DIVISIONS {
                    return Err(BuildError::TooDeep { objects: self.limits.objects });
                }
                if !present.is_empty() {
                    self.moved.lock().unwrap_or_else(PoisonError::into_inner).extend(present);
                }
                if let Some(order) = order {
                    stack.truncate(start);
                    stack.extend(order);
                }
                self.divide(cube, None, stack, start, depth, out)
            }
        }
    }

    /// Hands the arrivals to the children of a cube.
    fn divide(
        &self,
        cube: &Cube,
        mut old: Option<&mut Old<'_>>,
        stack: &mut Vec<u32>,
        start: usize,
        depth: usize,
        out: &mut Vec<u32>,
    ) -> Result<(), BuildError> {
        // Reading a tree has its own limit, so this only ends the division of new cubes.
        if depth > DEEPEST {
            return Err(BuildError::TooDeep { objects: self.limits.objects });
        }
        let branch = out.len();
        out.push(BRANCH);
        let masks = self.masks(cube, &stack[start..]);
        if old.is_none() && stack.len() - start > PARALLEL_ABOVE {
            let arrivals = &stack[start..];
            let children: Vec<Vec<u32>> = (0..8)
                .into_par_iter()
                .map(|number| {
                    let part = cube.child(number);
                    let mut own: Vec<u32> =
                        (0..arrivals.len()).filter_map(|i| self.handed(arrivals[i], masks[i], number, &part)).collect();
                    let mut words = Vec::new();
                    self.place(&part, None, &mut own, 0, depth + 1, &mut words)?;
                    Ok(words)
                })
                .collect::<Result<_, _>>()?;
            for child in children {
                out.extend_from_slice(&child);
            }
        } else {
            let end = stack.len();
            for number in 0..8 {
                let part = cube.child(number);
                for i in start..end {
                    if let Some(arrival) = self.handed(stack[i], masks[i - start], number, &part) {
                        stack.push(arrival);
                    }
                }
                self.place(&part, old.as_deref_mut(), stack, end, depth + 1, out)?;
                stack.truncate(end);
            }
        }
        tree::merge_equal_children(out, branch);
        Ok(())
    }

    /// Which children each of the arrivals meets, one bit a child.
    fn masks(&self, cube: &Cube, arrivals: &[u32]) -> Vec<u8> {
        let octants = Octants::new(cube);
        let mask = |&arrival: &u32| {
            let id = arrival & !INSIDE;
            self.owner(id).children(self.scene, id, cube, &octants, self.smallest)
        };
        if arrivals.len() > PARALLEL_ABOVE {
            arrivals.par_iter().with_min_len(PARALLEL_ABOVE / 8).map(mask).collect()
        } else {
            arrivals.iter().map(mask).collect()
        }
    }

    /// What a child is handed of an arrival, given the children that it meets.
    #[inline]
    fn handed(&self, arrival: u32, mask: u8, number: usize, child: &Cube) -> Option<u32> {
        let id = arrival & !INSIDE;
        if mask >> number & 1 == 0 {
            None
        } else if self.has_volumes() && self.owner(id).is_volume(id) {
            self.test(child, arrival)
        } else {
            Some(id)
        }
    }

    fn test(&self, cube: &Cube, arrival: u32) -> Option<u32> {
        let id = arrival & !INSIDE;
        match self.relation(id, cube) {
            Relation::Miss => None,
            Relation::Hit => Some(id),
            Relation::Inside => Some(id | INSIDE),
        }
    }

    fn relation(&self, id: ObjectId, cube: &Cube) -> Relation {
        self.owner(id).relation(self.scene, id, cube, self.smallest)
    }

    #[inline]
    fn owner(&self, id: ObjectId) -> &Geometry {
        if id < self.geometry.first() { self.present } else { self.geometry }
    }

    fn has_volumes(&self) -> bool {
        self.geometry.has_volumes() || self.present.has_volumes()
    }

    /// Decides between leaf and branch for a cube without children, as insertion one by one would.
    fn fate(&self, cube: &Cube, present: &[ObjectId], arrivals: &[u32]) -> Result<Fate, BuildError> {
        let half = cube.edge * 0.5;
        for (i, &arrival) in arrivals.iter().enumerate() {
            let count = present.len() + i;
            let smallest = if count == MOST_IN_SET { self.smallest / 256.0 } else { self.smallest };
            let joins = count == 0 || arrival & INSIDE != 0 || (count as i64) < self.limits.objects || half < smallest;
            if !joins {
                return Ok(Fate::Divide(self.order(cube, present, arrivals, i)));
            }
            if count == MOST_IN_SET {
                let name = self.scene.name(arrival & !INSIDE).into_owned();
                return Err(BuildError::SetOverflow { name });
            }
        }
        Ok(Fate::Leaf)
    }

    /// The order in which the children see the objects of a cube that arrival `last` divides; none if it is that of
    /// the arrivals themselves.
    fn order(&self, cube: &Cube, present: &[ObjectId], arrivals: &[u32], last: usize) -> Option<Vec<u32>> {
        if !self.has_volumes() {
            return (!present.is_empty()).then(|| [present, arrivals].concat());
        }
        let mut members: Vec<u32> = [present, &arrivals[..last]].concat();
        members.sort_unstable_by_key(|a| a & !INSIDE);
        let mut order = Vec::with_capacity(members.len() + arrivals.len() - last);
        let (mut across, mut inside) = (Vec::new(), Vec::new());
        for a in members {
            let id = a & !INSIDE;
            if !self.owner(id).is_volume(id) {
                order.push(id);
            } else if self.relation(id, cube) == Relation::Inside {
                inside.push(id);
            } else {
                across.push(id);
            }
        }
        order.push(arrivals[last]);
        order.extend(across);
        order.extend(inside);
        order.extend_from_slice(&arrivals[last + 1..]);
        Some(order)
    }
}

#[cfg(test)]
mod tests;
