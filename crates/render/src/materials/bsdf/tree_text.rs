//! The text of tensor trees: nested braces around numbers.

use super::numbers::Numbers;
use super::tree::{Node, Tree, check_depth};

/// What is wrong with the text of a tree, in Radiance's words where it has any.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Problem {
    #[error("Missing '{{' in tensor tree")]
    Opening,
    #[error("Missing '}}' in tensor tree")]
    Closing,
    #[error("Illegal value count in tensor tree")]
    Count,
    #[error("Bad number in tensor tree")]
    Number,
    #[error("Tensor tree is nested too deeply")]
    TooDeep,
    #[error("Extra characters at end of ScatteringData")]
    Extra,
}

/// Reads a tree; negative values become 0.
pub(super) fn parse(text: &str, rank: usize) -> Result<Tree, (Problem, usize)> {
    let mut reader = Reader { text: Numbers::new(text), tree: Tree { rank, nodes: Vec::new(), values: Vec::new() } };
    reader.tree.nodes.push(Node::Branch { first: 0 });
    reader.node(0, 0)?;
    if reader.text.peek().is_some() {
        return Err(reader.at(Problem::Extra));
    }
    Ok(reader.tree)
}

struct Reader<'t> {
    text: Numbers<'t>,
    tree: Tree,
}

impl Reader<'_> {
    fn at(&self, problem: Problem) -> (Problem, usize) {
        (problem, self.text.offset())
    }

    /// Reads `{ … }` into the slot `slot`.
    fn node(&mut self, slot: usize, level: u32) -> Result<(), (Problem, usize)> {
        if !self.text.take(b'{') {
            return Err(self.at(Problem::Opening));
        }
        if self.text.peek() == Some(b'{') {
            check_depth(level + 1, 0).map_err(|p| self.at(p))?;
            let count = 1 << self.tree.rank;
            let first = self.tree.nodes.len();
            self.tree.nodes.resize(first + count, Node::Branch { first: 0 });
            self.tree.nodes[slot] = Node::Branch { first };
            for child in 0..count {
                self.node(first + child, level + 1)?;
            }
        } else {
            let first = self.tree.values.len();
            while let Some(c) = self.text.peek() {
                if c == b'}' {
                    break;
                }
                match self.text.next_number() {
                    Some(v) => self.tree.values.push(v),
                    None if c == b'{' => return Err(self.at(Problem::Closing)),
                    None => return Err(self.at(Problem::Number)),
                }
            }
            let count = self.tree.values.len() - first;
            let bits = count.max(1).ilog2() / self.tree.rank as u32;
            if count != 1usize << (bits as usize * self.tree.rank) {
                return Err(self.at(Problem::Count));
            }
            check_depth(level, bits).map_err(|p| self.at(p))?;
            self.tree.nodes[slot] = Node::Grid { bits, first };
        }
        if self.text.take(b'}') { Ok(()) } else { Err(self.at(Problem::Closing)) }
    }
}
