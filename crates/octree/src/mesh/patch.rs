//! A patch of a mesh: up to 256 vertices, the triangles among them, and those that join it to other patches.

use crate::error::Problem;
use ambit_file::Cursor;

/// Flags that say what vertices have.
const POSITIONS: i64 = 1;
const NORMALS: i64 = 2;
const UV: i64 = 4;

const MOST_VERTICES: usize = 256;
const MOST_LOCAL: usize = 512;
const MOST_JOINERS: usize = 256;

/// Bytes of each record.
const POSITION_BYTES: usize = 12;
const NORMAL_BYTES: usize = 4;
const UV_BYTES: usize = 8;
const LOCAL_BYTES: usize = 3;
const SINGLE_BYTES: usize = 8;
const DOUBLE_BYTES: usize = 11;

/// A patch as it stands in the file.
pub(super) struct Patch<'a> {
    positions: &'a [u8],
    pub(super) normals: Option<&'a [u8]>,
    pub(super) uv: Option<&'a [u8]>,
    local: &'a [u8],
    /// One material for all local triangles, or one each.
    materials: &'a [u8],
    single_joiners: &'a [u8],
    double_joiners: &'a [u8],
}

/// How many corners of a triangle are in other patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TriangleKind {
    Local,
    SingleJoiner,
    DoubleJoiner,
}

impl TriangleKind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::SingleJoiner => "j1",
            Self::DoubleJoiner => "j2",
        }
    }

    pub(super) fn local_index(self) -> &'static str {
        if self == Self::Local { "index" } else { "local index" }
    }
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reference {
    /// Index of a vertex in the patch.
    Local(u8),
    /// 256 times the number of another patch plus the index of a vertex in it.
    Global(u32),
}

/// A triangle, with its material as an index into those of the mesh; −1 is none.
pub(super) struct Triangle {
    pub(super) kind: TriangleKind,
    pub(super) corners: [Reference; 3],
    pub(super) material: i64,
}

impl<'a> Patch<'a> {
    pub(super) fn read(input: &mut Cursor<'a>) -> Result<Self, Problem> {
        let flags = input.int(1).ok_or(Problem::TruncatedMesh)?;
        if flags & POSITIONS == 0 || flags & !(POSITIONS | NORMALS | UV) != 0 {
            return Err(Problem::PatchFlags);
        }
        let vertices = count(input, 1, MOST_VERTICES, "patch vertices")?;
        let positions = take(input, vertices * POSITION_BYTES)?;
        let normals = if flags & NORMALS == 0 { None } else { Some(take(input, vertices * NORMAL_BYTES)?) };
        let uv = if flags & UV == 0 { None } else { Some(take(input, vertices * UV_BYTES)?) };
        let locals = count(input, 0, MOST_LOCAL, "local triangles")?;
        let local = take(input, locals * LOCAL_BYTES)?;
        // One index follows unless the count tells of several.
        let materials = match input.int(2).ok_or(Problem::TruncatedMesh)? {
            ..=1 => take(input, 2)?,
            _ => take(input, 2 * locals)?,
        };
        let singles = count(input, 0, MOST_JOINERS, "joiner triangles")?;
        let single_joiners = take(input, singles * SINGLE_BYTES)?;
        let doubles = count(input, 0, MOST_JOINERS, "double joiner triangles")?;
        let double_joiners = take(input, doubles * DOUBLE_BYTES)?;
        Ok(Self { positions, normals, uv, local, materials, single_joiners, double_joiners })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.positions.len() / POSITION_BYTES
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.local.len() / LOCAL_BYTES
            + self.single_joiners.len() / SINGLE_BYTES
            + self.double_joiners.len() / DOUBLE_BYTES
    }

    /// Positions as fractions of the cube.
    pub(super) fn positions(&self) -> impl Iterator<Item = [u32; 3]> {
        self.positions.as_chunks::<POSITION_BYTES>().0.iter().map(words)
    }

    /// Direction codes of all vertices, 0 for none.
    pub(super) fn normals(&self) -> impl Iterator<Item = u32> {
        let codes = self.normals.unwrap_or_default().as_chunks::<NORMAL_BYTES>().0.iter();
        let missing = self.vertex_count() - codes.len();
        codes.map(|&b| u32::from_be_bytes(b)).chain(std::iter::repeat_n(0, missing))
    }

    /// Texture coordinates of all vertices as fractions of their range, 0 for none.
    pub(super) fn uv(&self) -> impl Iterator<Item = [u32; 2]> {
        let pairs = self.uv.unwrap_or_default().as_chunks::<UV_BYTES>().0.iter();
        let missing = self.vertex_count() - pairs.len();
        pairs.map(words).chain(std::iter::repeat_n([0; 2], missing))
    }

    /// The local triangles, then those with one corner elsewhere, then those with two.
    pub(super) fn triangles(&self) -> impl Iterator<Item = Triangle> {
        let materials = self.materials.as_chunks::<2>().0;
        let shared = materials.len() == 1;
        let local = self.local.as_chunks::<LOCAL_BYTES>().0.iter().enumerate();
        let local = local.map(move |(i, corners)| Triangle {
            kind: TriangleKind::Local,
            corners: corners.map(Reference::Local),
            material: material(materials[if shared { 0 } else { i }]),
        });
        let single = self.single_joiners.as_chunks::<SINGLE_BYTES>().0.iter();
        let single = single.map(|&[a0, a1, a2, a3, b, c, m0, m1]| Triangle {
            kind: TriangleKind::SingleJoiner,
            corners: [global([a0, a1, a2, a3]), Reference::Local(b), Reference::Local(c)],
            material: material([m0, m1]),
        });
        let double = self.double_joiners.as_chunks::<DOUBLE_BYTES>().0.iter();
        let double = double.map(|&[a0, a1, a2, a3, b0, b1, b2, b3, c, m0, m1]| Triangle {
            kind: TriangleKind::DoubleJoiner,
            corners: [global([a0, a1, a2, a3]), global([b0, b1, b2, b3]), Reference::Local(c)],
            material: material([m0, m1]),
        });
        local.chain(single).chain(double)
    }
}

fn take<'a>(input: &mut Cursor<'a>, n: usize) -> Result<&'a [u8], Problem> {
    input.take(n).ok_or(Problem::TruncatedMesh)
}

fn count(input: &mut Cursor<'_>, least: usize, most: usize, what: &'static str) -> Result<usize, Problem> {
    let n = input.int(2).ok_or(Problem::TruncatedMesh)?;
    usize::try_from(n).ok().filter(|n| (least..=most).contains(n)).ok_or(Problem::PatchCount(what))
}

fn words<const BYTES: usize, const N: usize>(bytes: &[u8; BYTES]) -> [u32; N] {
    let (chunks, _) = bytes.as_chunks::<4>();
    std::array::from_fn(|i| u32::from_be_bytes(chunks[i]))
}

fn global(bytes: [u8; 4]) -> Reference {
    Reference::Global(u32::from_be_bytes(bytes))
}

fn material(bytes: [u8; 2]) -> i64 {
    i16::from_be_bytes(bytes) as i64
}
