//! Nodes of the tree, eight children each, and the words that name a child, a leaf or a surface.

/// Children of a node.
pub(crate) const WIDTH: usize = 8;

/// Boxes of up to eight children, one array for each of min x, max x, min y, max y, min z, max z, and what they hold.
/// Empty places have boxes that no ray meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) planes: [[f32; WIDTH]; 6],
    pub(crate) child: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        child: [u32::MAX; WIDTH],
    };
}

/// A child is a leaf if this bit is set, else the index of a node.
pub(crate) const LEAF: u32 = 1 << 31;

// Kinds of surfaces, in the order in which the builder numbers them.

/// Blocks of triangles.
pub(crate) const TRIANGLES: u32 = 0;
/// Blocks of convex quadrilaterals.
pub(crate) const QUADS: u32 = 1;
/// Everything else, one to a leaf.
pub(crate) const ITEMS: u32 = 2;

/// Bits of a leaf's index, below those of its kind.
const INDEX_BITS: u32 = 27;

/// Blocks (or items) that a tree can have of each kind.
pub(crate) const MOST_LEAVES: usize = 1 << INDEX_BITS;

/// Names a leaf.
pub(crate) fn leaf(kind: u32, index: u32) -> u32 {
    LEAF | kind << INDEX_BITS | index
}

/// Kind of a leaf.
#[inline]
pub(crate) fn kind(leaf: u32) -> u32 {
    leaf >> INDEX_BITS & 3
}

/// Index of a leaf among those of its kind.
#[inline]
pub(crate) fn index(leaf: u32) -> usize {
    (leaf & (MOST_LEAVES as u32 - 1)) as usize
}

/// No surface.
pub(crate) const NOWHERE: u32 = u32::MAX;

/// Bits of a surface's number among those of its kind.
const NUMBER_BITS: u32 = 29;

/// Names one surface: its kind and number.
#[inline]
pub(crate) fn place(kind: u32, number: u32) -> u32 {
    kind << NUMBER_BITS | number
}

/// Kind and number of a surface.
#[inline]
pub(crate) fn split(place: u32) -> (u32, usize) {
    (place >> NUMBER_BITS, (place & ((1 << NUMBER_BITS) - 1)) as usize)
}
