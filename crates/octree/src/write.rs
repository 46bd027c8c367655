//! Writing octree files, byte for byte as Radiance 6 does: object numbers of four bytes.

use crate::format::{OCTREE, WIDTH};
use crate::read::FORMAT;
use crate::tree::{Node, Tree};
use crate::{Cube, Error, frozen};
use ambit_file::{Header, PortableWrite, bytes_of};
use ambit_scene::Scene;
use std::io::{self, Write};

/// Where readers find the objects.
#[derive(Clone, Copy, Debug)]
pub enum Objects<'a> {
    /// In these files and commands.
    InFiles {
        /// Their names, in the order in which they were read.
        names: &'a [String],
        /// How many objects they define.
        count: usize,
    },
    /// In the octree itself: everything in this scene.
    Frozen(&'a Scene),
}

/// Writes an octree. The header gets its `FORMAT` line, the last.
pub fn write(
    out: &mut impl Write,
    header: &Header,
    cube: &Cube,
    objects: Objects<'_>,
    tree: &Tree,
) -> Result<(), Error> {
    let count = match objects {
        Objects::InFiles { count, .. } => count,
        Objects::Frozen(scene) => {
            frozen::check(scene, scene.ids())?;
            scene.len()
        }
    };
    let mut write_all = || {
        let mut header = header.clone();
        header.push(format!("FORMAT={FORMAT}"));
        header.write(out)?;
        out.write_int(2, OCTREE.magic + WIDTH as i64)?;
        for text in cube.to_text() {
            out.write_string(text.as_bytes())?;
        }
        if let Objects::InFiles { names, .. } = objects {
            names.iter().try_for_each(|name| out.write_string(&bytes_of(name)))?;
        }
        out.write_string(b"")?;
        out.write_int(WIDTH, count as i64)?;
        write_tree(out, tree)?;
        if let Objects::Frozen(scene) = objects {
            frozen::write(out, scene, scene.ids())?;
        }
        out.flush()
    };
    write_all().map_err(Error::Write)
}

pub(crate) fn write_tree(out: &mut impl Write, tree: &Tree) -> io::Result<()> {
    for node in tree.nodes() {
        match node {
            Node::Empty => out.write_all(&[0])?,
            Node::Full(set) => {
                out.write_all(&[1])?;
                out.write_int(WIDTH, set.len() as i64)?;
                set.iter().try_for_each(|&id| out.write_int(WIDTH, id as i64))?;
            }
            Node::Branch => out.write_all(&[2])?,
        }
    }
    Ok(())
}
