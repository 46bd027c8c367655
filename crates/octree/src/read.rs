//! Reading octree files.
//!
//! The layout: header; number of the format; cube; names of scene files; count of objects; tree; and, in frozen
//! octrees (those without names of scene files), the objects. Otherwise the scene files are read again.

use crate::error::{Instead, Problem};
use crate::format::{FileNode, OCTREE};
use crate::tree::{self, Tree};
use crate::{Cube, Error, frozen};
use ambit_base::Notify;
use ambit_file::{Cursor, Header, text_of};
use ambit_scene::{ObjectId, Reader, Runner, Scene};
use std::io::{BufRead, ErrorKind};

/// The value of `FORMAT=` in octrees.
pub(crate) const FORMAT: &str = "Radiance_octree";

/// What an octree file says apart from its tree.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Its header.
    pub header: Header,
    /// The root cube.
    pub cube: Cube,
    /// Names of scene files and commands, as given to the program that made the octree; none if it is frozen.
    pub scene_files: Vec<String>,
    /// Whether the objects are in the octree itself.
    pub frozen: bool,
    /// Number, in the scene they were loaded into, of the first object.
    pub first_object: ObjectId,
    /// Number of objects of every kind.
    pub object_count: usize,
}

impl Loaded {
    /// The numbers of the objects.
    pub fn objects(&self) -> std::ops::Range<ObjectId> {
        self.first_object..self.first_object + self.object_count as ObjectId
    }
}

/// Reads an octree for its objects. The tree is checked, and not kept: for those who sort the surfaces anew.
///
/// `name` is what errors call the file: its path, `standard input`, or the `!command` it came from. Scene files are
/// read as the octree names them, relative to the working directory, their commands run by `runner`. After an error
/// the scene is left with what was read before it.
pub fn read_scene(
    bytes: &[u8],
    name: &str,
    scene: &mut Scene,
    runner: &mut dyn Runner,
    notify: &dyn Notify,
) -> Result<Loaded, Error> {
    read(bytes, name, scene, runner, notify, None)
}

/// Reads an octree with its tree, whose object numbers are those of the scene.
pub fn read_octree(
    bytes: &[u8],
    name: &str,
    scene: &mut Scene,
    runner: &mut dyn Runner,
    notify: &dyn Notify,
) -> Result<(Loaded, Tree), Error> {
    let mut words = Vec::new();
    let loaded = read(bytes, name, scene, runner, notify, Some(&mut words))?;
    Ok((loaded, Tree { words }))
}

/// The cube alone: all that is needed of an octree to place an instance of it.
pub fn read_cube(input: &mut impl BufRead, name: &str) -> Result<Cube, Error> {
    let instead = match input.fill_buf() {
        Ok(bytes) => Instead::of(bytes),
        Err(e) if e.kind() == ErrorKind::IsADirectory => Instead::Directory,
        Err(source) => return Err(Error::Open { action: "cannot read octree file", name: name.to_owned(), source }),
    };
    let header = Header::read(input, name).map_err(|_| Problem::NotAnOctree(instead).of(name))?;
    check_format(&header, name)?;
    OCTREE.front_cube(input).map_err(|p| p.of(name))
}

fn header<'a>(bytes: &'a [u8], name: &str) -> Result<(Header, Cursor<'a>), Error> {
    let (header, start) = Header::parse(bytes, name).map_err(|_| Problem::NotAnOctree(Instead::of(bytes)).of(name))?;
    check_format(&header, name)?;
    Ok((header, Cursor::new(&bytes[start..])))
}

/// A file without `FORMAT=` may be an octree.
fn check_format(header: &Header, name: &str) -> Result<(), Error> {
    match header.format() {
        Some(format) if format != FORMAT => Err(Problem::NotAnOctree(Instead::Format(format.to_owned())).of(name)),
        _ => Ok(()),
    }
}

fn read(
    bytes: &[u8],
    name: &str,
    scene: &mut Scene,
    runner: &mut dyn Runner,
    notify: &dyn Notify,
    mut keep: Option<&mut Vec<u32>>,
) -> Result<Loaded, Error> {
    let wrong = |p: Problem| p.of(name);
    let (header, mut input) = header(bytes, name)?;
    let width = OCTREE.width(&mut input).map_err(|p| match p {
        // Scene files whose first line is followed by an empty one pass for headers.
        Problem::IncompatibleOctree(_) => wrong(Problem::IncompatibleOctree(Instead::of(bytes))),
        other => wrong(other),
    })?;
    let cube = OCTREE.cube(&mut input).map_err(wrong)?;
    let truncated = || Problem::TruncatedOctree.of(name);
    let mut scene_files = Vec::new();
    loop {
        let word = input.string().ok_or_else(truncated)?;
        if word.is_empty() {
            break;
        }
        scene_files.push(text_of(word).into_owned());
    }
    let stored_count = input.int(width).ok_or_else(truncated)?;
    let first = scene.len();
    let mut listed = Listed::default();
    OCTREE
        .tree(&mut input, width, |node| {
            match node {
                FileNode::Leaf(set) => {
                    listed.add(set);
                    if let Some(words) = keep.as_deref_mut() {
                        words.push(set.len() as u32);
                        // Numbers that overflow are found to be stray below.
                        words.extend(set.iter().map(|id| id.saturating_add(first as u32)));
                    }
                }
                FileNode::Branch => {
                    if let Some(words) = keep.as_deref_mut() {
                        words.push(tree::BRANCH);
                    }
                }
            }
            Ok(())
        })
        .map_err(wrong)?;
    let frozen = scene_files.is_empty();
    // Made of nothing, and not even frozen: there is no table of types either.
    let bare = frozen && stored_count == 0 && input.is_at_end();
    if frozen && !bare {
        frozen::read(&mut input, width, name, scene, notify)?;
    } else if !frozen {
        let mut reader = Reader::new(scene, notify, runner);
        scene_files.iter().try_for_each(|file| reader.read(file))?;
        if (scene.len() - first) as i64 != stored_count {
            return Err(wrong(Problem::BadCount));
        }
    }
    let object_count = scene.len() - first;
    listed.check(scene, first, object_count).map_err(wrong)?;
    Ok(Loaded { header, cube, scene_files, frozen, first_object: first as ObjectId, object_count })
}

/// Which objects a tree lists: one bit each, so that a large tree need not be kept to be checked.
#[derive(Default)]
struct Listed {
    bits: Vec<u64>,
    /// The highest number, if there is any.
    last: Option<u32>,
}

/// Higher numbers than this are not noted one by one: no file that we could hold has so many objects.
const MOST_NOTED: u32 = 1 << 28;

impl Listed {
    fn add(&mut self, set: &[u32]) {
        let Some(&last) = set.last() else { return };
        if self.last.is_none_or(|l| l < last) {
            self.last = Some(last);
            let words = (last.min(MOST_NOTED) / 64 + 1) as usize;
            if self.bits.len() < words {
                self.bits.resize(words, 0);
            }
        }
        for id in set.iter().filter(|id| **id < MOST_NOTED) {
            self.bits[(id / 64) as usize] |= 1 << (id % 64);
        }
    }

    /// Only surfaces and volumes that exist may be listed.
    fn check(&self, scene: &Scene, first: usize, count: usize) -> Result<(), Problem> {
        if let Some(object) = self.last.filter(|l| *l as usize >= count) {
            return Err(Problem::StrayObject { object, count });
        }
        let listed = |i: usize| self.bits.get(i / 64).is_some_and(|w| w >> (i % 64) & 1 != 0);
        let modifier = (0..count).any(|i| listed(i) && scene.object((first + i) as ObjectId).kind.is_modifier());
        if modifier { Err(Problem::ModifierInTree) } else { Ok(()) }
    }
}
