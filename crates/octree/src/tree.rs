//! The tree of an octree in memory: its nodes in pre-order, one word for an empty leaf or a branch and one word more
//! for each object of a full leaf. Sequential by nature, as the file is; a million triangles take some ten megabytes.

use ambit_scene::ObjectId;

/// Most objects a leaf can hold.
pub const MOST_IN_SET: usize = 8191;

/// Most objects a scene can number here: one bit of the four bytes is needed to tell volumes apart while building.
pub const MOST_OBJECTS: usize = 1 << 31;

/// Word of an empty leaf; the words 1 … [`MOST_IN_SET`] begin a full one.
pub(crate) const EMPTY: u32 = 0;

/// Word of a branch; its eight children follow.
pub(crate) const BRANCH: u32 = u32::MAX;

/// Deeper trees than this can not come from numbers in double precision: the edges of their cubes would be zero.
pub(crate) const DEEPEST: usize = 1200;

/// Nodes in pre-order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tree {
    pub(crate) words: Vec<u32>,
}

impl Default for Tree {
    fn default() -> Self {
        Self { words: vec![EMPTY] }
    }
}

/// One node, as [`Tree::nodes`] gives them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node<'a> {
    /// A leaf with nothing in it.
    Empty,
    /// A leaf with objects, ascending.
    Full(&'a [ObjectId]),
    /// The next eight subtrees are its children.
    Branch,
}

impl Tree {
    /// All nodes in pre-order, children 0 … 7 in turn.
    pub fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        let mut at = 0;
        std::iter::from_fn(move || {
            let node = node_at(&self.words, at)?;
            at += length(node);
            Some(node)
        })
    }
}

/// The node that begins at a word.
pub(crate) fn node_at(words: &[u32], at: usize) -> Option<Node<'_>> {
    Some(match *words.get(at)? {
        EMPTY => Node::Empty,
        BRANCH => Node::Branch,
        n => Node::Full(words.get(at + 1..at + 1 + n as usize)?),
    })
}

/// Words of the node itself.
pub(crate) fn length(node: Node<'_>) -> usize {
    match node {
        Node::Full(set) => 1 + set.len(),
        Node::Empty | Node::Branch => 1,
    }
}

/// Replaces the branch at word `at`, which is the last node that was written and has all its children, by one leaf if
/// the children are equal leaves.
pub(crate) fn merge_equal_children(words: &mut Vec<u32>, at: usize) {
    let children = &words[at + 1..];
    let Some(first) = node_at(children, 0) else { return };
    if first == Node::Branch || children.len() != 8 * length(first) {
        return;
    }
    let (leaf, rest) = children.split_at(length(first));
    if rest.chunks(leaf.len()).all(|other| other == leaf) {
        let end = at + 1 + leaf.len();
        words.copy_within(at + 1..end, at);
        words.truncate(end - 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push_leaf(words: &mut Vec<u32>, set: &[ObjectId]) {
        words.push(set.len() as u32);
        words.extend_from_slice(set);
    }

    #[test]
    fn equal_leaves_become_one() {
        let mut words = vec![BRANCH, BRANCH];
        for _ in 0..8 {
            push_leaf(&mut words, &[3, 5]);
        }
        merge_equal_children(&mut words, 1);
        assert_eq!(words, [BRANCH, 2, 3, 5]);
        let mut words = vec![BRANCH, 0, 0, 0, 0, 0, 0, 0, 0];
        merge_equal_children(&mut words, 0);
        assert_eq!(words, [EMPTY]);
    }

    #[test]
    fn different_leaves_stay() {
        let mut words = vec![BRANCH];
        for i in 0..8 {
            push_leaf(&mut words, &[3, 5 + i / 7]);
        }
        let before = words.clone();
        merge_equal_children(&mut words, 0);
        assert_eq!(words, before);
        let mut words = vec![BRANCH, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0];
        // As many words as eight leaves of one object would need are not eight such leaves.
        words.extend([1, 9, 1, 9, 1, 9]);
        let before = words.clone();
        merge_equal_children(&mut words, 0);
        assert_eq!(words, before);
    }

    #[test]
    fn nodes_come_in_order() {
        let tree = Tree { words: vec![BRANCH, 0, 2, 7, 9, 0, 0, 0, 0, 0, 1, 4] };
        let nodes: Vec<_> = tree.nodes().collect();
        assert_eq!(nodes.len(), 9);
        assert_eq!(nodes[2], Node::Full(&[7, 9]));
        assert_eq!(nodes[8], Node::Full(&[4]));
    }
}
