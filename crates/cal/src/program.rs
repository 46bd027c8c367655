//! Compiled expressions and functions.

use crate::channel::ChannelSet;
use crate::error::Fault;
use crate::op::Op;

/// An expression, or a function to be called with arguments given at run time, ready to run on any thread.
///
/// A program holds the definitions as they were when it was compiled; compile after all files are loaded. It runs with
/// the values a [`Scratch`](crate::Scratch) remembers for the variables of its library, so one scratch serves the
/// programs of one library.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) code: Box<[Op]>,
    pub(crate) channels: ChannelSet,
    pub(crate) reals: bool,
    /// Length of the variables' memory it needs.
    pub(crate) variables: u32,
    pub(crate) faults: Box<[Fault]>,
}

impl Program {
    /// The inputs it may read; the others need no values.
    pub fn channels(&self) -> ChannelSet {
        self.channels
    }

    /// Whether it may read the primitive's real arguments.
    pub fn reads_reals(&self) -> bool {
        self.reals
    }

    /// Its value, if it is a number that depends on nothing.
    pub fn constant(&self) -> Option<f64> {
        match self.code[..] {
            [Op::Enter(0), Op::Number(value), Op::Halt] => Some(value),
            _ => None,
        }
    }
}
