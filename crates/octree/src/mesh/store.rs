//! The patches of a mesh that is being made: vertices as they are met, triangles where their vertices are.

use crate::error::Problem;
use ambit_file::PortableWrite;
use std::collections::HashMap;
use std::io::{self, Write};

/// Vertices of a patch; a number in it fits a byte.
const MOST_VERTICES: usize = 256;
const MOST_LOCAL: usize = 512;
const MOST_JOINERS: usize = 256;

/// Patches whose numbers fit the numbers of triangles.
const MOST_PATCHES: usize = 1 << 22;

/// Where, among the numbers of a patch's triangles, those of each kind begin.
const SINGLES_FROM: u32 = 512;
const DOUBLES_FROM: u32 = 768;

/// A vertex as stored: fractions of the cube, the code of its normal and fractions of the texture coordinates' range,
/// the latter two 0 where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: [u32; 3],
    pub(super) normal: u32,
    pub(super) uv: [u32; 2],
}

/// A vertex: patch and number in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    patch: u32,
    index: u8,
}

impl Place {
    fn global(self) -> u32 {
        self.patch << 8 | u32::from(self.index)
    }
}

#[derive(Debug, Default)]
struct Patch {
    corners: Vec<Corner>,
    local: Vec<([u8; 3], i16)>,
    /// One corner elsewhere.
    singles: Vec<(u32, [u8; 2], i16)>,
    /// Two corners elsewhere.
    doubles: Vec<([u32; 2], u8, i16)>,
}

/// The patches so far.
#[derive(Debug, Default)]
pub(super) struct Store {
    patches: Vec<Patch>,
    known: HashMap<Corner, Place>,
}

impl Store {
    /// Stores a triangle and gives its number.
    pub(super) fn add(&mut self, corners: [Corner; 3], material: i16) -> Result<u32, Problem> {
        let [a, b, c] = corners;
        let mut v = [self.place(a)?, self.place(b)?, self.place(c)?];
        let same = v[0].patch == v[1].patch && v[1].patch == v[2].patch;
        if same && self.patches[v[0].patch as usize].local.len() < MOST_LOCAL {
            let list = &mut self.patches[v[0].patch as usize].local;
            list.push((v.map(|p| p.index), material));
            return Ok(number(v[0].patch, 0, list.len()));
        }
        if !same {
            // The corner that is in another patch than the other two goes first.
            if v[0].patch == v[1].patch {
                v.rotate_right(1);
            } else if v[0].patch == v[2].patch {
                v.rotate_left(1);
            }
        }
        if v[1].patch == v[2].patch && self.patches[v[1].patch as usize].singles.len() < MOST_JOINERS {
            let list = &mut self.patches[v[1].patch as usize].singles;
            list.push((v[0].global(), [v[1].index, v[2].index], material));
            return Ok(number(v[1].patch, SINGLES_FROM, list.len()));
        }
        let load = |p: &Place| self.patches[p.patch as usize].doubles.len();
        let least = (0..3).min_by_key(|&i| load(&v[i])).unwrap_or_default();
        v.rotate_left(least);
        let list = &mut self.patches[v[0].patch as usize].doubles;
        if list.len() >= MOST_JOINERS {
            return Err(Problem::PatchCount("double joiner triangles"));
        }
        list.push(([v[1].global(), v[2].global()], v[0].index, material));
        Ok(number(v[0].patch, DOUBLES_FROM, list.len()))
    }

    fn place(&mut self, corner: Corner) -> Result<Place, Problem> {
        if let Some(&place) = self.known.get(&corner) {
            return Ok(place);
        }
        if self.patches.last().is_none_or(|p| p.corners.len() == MOST_VERTICES) {
            if self.patches.len() == MOST_PATCHES {
                return Err(Problem::MeshTooLarge);
            }
            self.patches.push(Patch::default());
        }
        let patch = self.patches.len() - 1;
        let corners = &mut self.patches[patch].corners;
        corners.push(corner);
        let place = Place { patch: patch as u32, index: (corners.len() - 1) as u8 };
        self.known.insert(corner, place);
        Ok(place)
    }

    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_int(4, self.patches.len() as i64)?;
        self.patches.iter().try_for_each(|p| p.write(out))
    }

    /// Counts for statistics.
    pub(super) fn counts(&self) -> Counts {
        let mut counts = Counts { patches: self.patches.len(), ..Counts::default() };
        for p in &self.patches {
            counts.bytes += p.bytes();
            counts.vertices += p.corners.len();
            counts.with_normals += p.corners.iter().filter(|c| c.normal != 0).count();
            counts.with_uv += p.corners.iter().filter(|c| c.uv[0] != 0).count();
            counts.local += p.local.len();
            counts.joiners += p.singles.len() + p.doubles.len();
        }
        counts
    }
}

/// What there is in a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) patches: usize,
    pub(super) bytes: usize,
    pub(super) vertices: usize,
    pub(super) with_normals: usize,
    pub(super) with_uv: usize,
    pub(super) local: usize,
    pub(super) joiners: usize,
}

/// The number of the last triangle of a list.
fn number(patch: u32, from: u32, length: usize) -> u32 {
    patch << 10 | (from + length as u32 - 1)
}

impl Patch {
    fn has_normals(&self) -> bool {
        self.corners.iter().any(|c| c.normal != 0)
    }

    fn has_uv(&self) -> bool {
        self.corners.iter().any(|c| c.uv[0] != 0)
    }

    /// The material of all local triangles, if it is one.
    fn material(&self) -> Option<i16> {
        let Some(&(_, first)) = self.local.first() else { return Some(0) };
        self.local.iter().all(|t| t.1 == first).then_some(first)
    }

    /// Memory that it takes.
    fn bytes(&self) -> usize {
        let vertex = 12 + 4 * usize::from(self.has_normals()) + 8 * usize::from(self.has_uv());
        let local = 3 + 2 * usize::from(self.material().is_none());
        vertex * self.corners.len() + local * self.local.len() + 8 * self.singles.len() + 12 * self.doubles.len()
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let (normals, uv) = (self.has_normals(), self.has_uv());
        out.write_int(1, 1 + 2 * i64::from(normals) + 4 * i64::from(uv))?;
        out.write_int(2, self.corners.len() as i64)?;
        let corners = || self.corners.iter();
        corners().flat_map(|c| c.position).try_for_each(|x| out.write_all(&x.to_be_bytes()))?;
        if normals {
            corners().try_for_each(|c| out.write_all(&c.normal.to_be_bytes()))?;
        }
        if uv {
            corners().flat_map(|c| c.uv).try_for_each(|x| out.write_all(&x.to_be_bytes()))?;
        }
        out.write_int(2, self.local.len() as i64)?;
        self.local.iter().try_for_each(|t| out.write_all(&t.0))?;
        if let Some(material) = self.material() {
            out.write_int(2, 1)?;
            out.write_int(2, i64::from(material))?;
        } else {
            out.write_int(2, self.local.len() as i64)?;
            self.local.iter().try_for_each(|t| out.write_int(2, i64::from(t.1)))?;
        }
        out.write_int(2, self.singles.len() as i64)?;
        for (a, rest, material) in &self.singles {
            out.write_all(&a.to_be_bytes())?;
            out.write_all(rest)?;
            out.write_int(2, i64::from(*material))?;
        }
        out.write_int(2, self.doubles.len() as i64)?;
        for (pair, c, material) in &self.doubles {
            pair.iter().try_for_each(|x| out.write_all(&x.to_be_bytes()))?;
            out.write_all(&[*c])?;
            out.write_int(2, i64::from(*material))?;
        }
        Ok(())
    }
}
