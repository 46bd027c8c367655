//! The parts that octree and mesh files share: the number they begin with, the cube and the tree.

use crate::Cube;
use crate::error::{Instead, Problem};
use crate::tree::{DEEPEST, MOST_IN_SET};
use ambit_file::Cursor;
use std::io::{BufRead, Read};

/// Bytes of object numbers in files that we write.
pub(crate) const WIDTH: usize = 4;

/// Longest object numbers that can be read.
const WIDEST: i64 = 8;

/// What the problems are called in one kind of file.
pub(crate) struct Wording {
    pub(crate) magic: i64,
    pub(crate) incompatible: Problem,
    /// What is wrong if even the magic number is missing.
    pub(crate) no_magic: Problem,
    pub(crate) truncated: Problem,
    pub(crate) damaged: Problem,
}

/// Magic number and cube take no more bytes than this: each text is shorter than 512.
const LONGEST_FRONT: u64 = 2 + 4 * 512;

/// Octrees begin with 283 and the width of their object numbers.
pub(crate) const OCTREE: Wording = Wording {
    magic: 283,
    incompatible: Problem::IncompatibleOctree(Instead::Unknown),
    no_magic: Problem::TruncatedOctree,
    truncated: Problem::TruncatedOctree,
    damaged: Problem::DamagedOctree,
};

/// Meshes begin with 319 and the width of their object numbers.
pub(crate) const MESH: Wording = Wording {
    magic: 319,
    incompatible: Problem::IncompatibleMesh,
    no_magic: Problem::IncompatibleMesh,
    truncated: Problem::TruncatedMesh,
    damaged: Problem::DamagedMesh,
};

impl Wording {
    /// The width of object numbers, from the first two bytes.
    pub(crate) fn width(&self, input: &mut Cursor<'_>) -> Result<usize, Problem> {
        let magic = input.int(2).ok_or_else(|| self.no_magic.clone())?;
        let width = magic - self.magic;
        if (1..=WIDEST).contains(&width) { Ok(width as usize) } else { Err(self.incompatible.clone()) }
    }

    /// Four texts.
    pub(crate) fn cube(&self, input: &mut Cursor<'_>) -> Result<Cube, Problem> {
        let mut text = || input.string().ok_or_else(|| self.truncated.clone());
        let numbers = [text()?, text()?, text()?, text()?];
        Cube::from_text(numbers).ok_or_else(|| self.damaged.clone())
    }

    /// Magic number and cube of a stream, of which no more is read than that takes.
    pub(crate) fn front_cube(&self, input: &mut impl BufRead) -> Result<Cube, Problem> {
        let mut front = Vec::new();
        // A stream that fails has ended, as far as a file format is concerned.
        _ = input.take(LONGEST_FRONT).read_to_end(&mut front);
        let mut front = Cursor::new(&front);
        self.width(&mut front)?;
        self.cube(&mut front)
    }

    /// All nodes in pre-order, each given to `take`; objects are numbered as in the file.
    pub(crate) fn tree(
        &self,
        input: &mut Cursor<'_>,
        width: usize,
        mut take: impl FnMut(FileNode<'_>) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let truncated = || self.truncated.clone();
        // How many children are left to be read on each level.
        let mut pending = vec![1u8];
        let mut set = Vec::new();
        while let Some(left) = pending.last_mut() {
            if *left == 0 {
                pending.pop();
                continue;
            }
            *left -= 1;
            match input.byte().ok_or_else(truncated)? {
                0 => take(FileNode::Leaf(&[]))?,
                1 => {
                    let count = input.int(width).ok_or_else(truncated)?;
                    if count < 0 || count > MOST_IN_SET as i64 {
                        return Err(Problem::BadSet);
                    }
                    set.clear();
                    for _ in 0..count {
                        let id = input.int(width).ok_or_else(truncated)?;
                        set.push(u32::try_from(id).map_err(|_| self.damaged.clone())?);
                    }
                    if !set.is_sorted_by(|a, b| a < b) {
                        set.sort_unstable();
                        set.dedup();
                    }
                    take(FileNode::Leaf(&set))?;
                }
                2 => {
                    if pending.len() > DEEPEST {
                        return Err(self.damaged.clone());
                    }
                    take(FileNode::Branch)?;
                    pending.push(8);
                }
                _ => return Err(self.damaged.clone()),
            }
        }
        Ok(())
    }
}

/// A node as read.
pub(crate) enum FileNode<'a> {
    /// Objects, ascending; none for an empty leaf.
    Leaf(&'a [u32]),
    /// Eight children follow.
    Branch,
}
