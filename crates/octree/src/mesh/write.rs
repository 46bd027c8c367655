//! Writing compiled meshes, and what is in them in words.

use super::CompiledMesh;
use crate::format::{MESH, WIDTH};
use crate::tree::Node;
use crate::write::write_tree;
use crate::{Error, frozen};
use ambit_file::{Header, PortableWrite};
use std::fmt;
use std::io::Write;

/// The value of `FORMAT=` in meshes.
const FORMAT: &str = "Radiance_tmesh";

impl CompiledMesh {
    /// Writes the mesh. The header gets its `FORMAT` line, the last.
    pub fn write(&self, out: &mut impl Write, header: &Header) -> Result<(), Error> {
        frozen::check(&self.materials, 0..self.used)?;
        let mut write_all = || {
            let mut header = header.clone();
            header.push(format!("FORMAT={FORMAT}"));
            header.write(out)?;
            out.write_int(2, MESH.magic + WIDTH as i64)?;
            self.cube.to_text().iter().try_for_each(|text| out.write_string(text.as_bytes()))?;
            let (low, high) = (self.uv_low, self.uv_high);
            [low.x, high.x, low.y, high.y].into_iter().try_for_each(|x| out.write_float(x))?;
            write_tree(out, &self.tree)?;
            frozen::write(out, &self.materials, 0..self.used)?;
            self.store.write(out)?;
            out.flush()
        };
        write_all().map_err(Error::Write)
    }
}

/// What is in the mesh, in the words of Radiance's statistics.
impl fmt::Display for CompiledMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let c = self.store.counts();
        let share = |part: usize, all: usize| 100.0 * part as f64 / all.max(1) as f64;
        let (mut leaves, mut empty, mut members) = (0, 0, 0);
        for node in self.tree.nodes() {
            match node {
                Node::Empty => (leaves, empty) = (leaves + 1, empty + 1),
                Node::Full(set) => (leaves, members) = (leaves + 1, members + set.len()),
                Node::Branch => {}
            }
        }
        let triangles = c.local + c.joiners;
        writeln!(f, "Mesh statistics:\n\t{} materials", self.used)?;
        writeln!(f, "\t{} patches ({:.2} MBytes)", c.patches, c.bytes as f64 / f64::from(1 << 20))?;
        let (normals, uv) = (share(c.with_normals, c.vertices), share(c.with_uv, c.vertices));
        writeln!(f, "\t{} vertices ({normals:.1}% w/ normals, {uv:.1}% w/ uv)", c.vertices)?;
        let (local, joiner) = (share(c.local, triangles), share(c.joiners, triangles));
        writeln!(f, "\t{triangles} triangles ({local:.1}% local, {joiner:.1}% joiner)")?;
        let average = members as f64 / (leaves - empty).max(1) as f64;
        writeln!(f, "\t{leaves} leaves in octree ({:.1}% empty, {average:.2} avg. set size)", share(empty, leaves))
    }
}
