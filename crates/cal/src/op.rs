//! The machine's operations.
//!
//! The machine has an accumulator and a stack below it. A *load* pushes the accumulator and puts its value there; an
//! operation with n operands pops n − 1. A subroutine is a load too: the first load of its code does the pushing. Jumps and subroutines name labels while code is written and addresses after
//! [`resolve`].

use crate::builtin::Builtin;

/// One operation; two words long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Op {
    /// Loads a number.
    Number(f64),
    /// Loads an input of the ray; a fault if there is no ray.
    Channel(u32),
    /// Loads a column of the record; 0 if it has fewer.
    Column(u32),
    /// Loads a run-time argument of the root function.
    Given(u32),
    /// Loads a real argument of the primitive through variable `slot`, whose first use clears the flag.
    Real {
        index: u32,
        slot: u32,
    },
    /// Loads an argument of the enclosing call, evaluating it where it was written if this is its first use.
    Argument(u32),
    /// Loads a value computed at most once in this frame, by the subroutine at `label`.
    Lazy {
        slot: u32,
        label: u32,
    },
    /// Loads a value [`Op::Keep`] kept.
    Kept(u32),
    /// Keeps the accumulator in a slot of the frame.
    Keep(u32),
    /// Loads a variable, computing it by the subroutine at `label` once per tick of the clock.
    Variable {
        slot: u32,
        label: u32,
    },

    Add,
    Subtract,
    Multiply,
    /// Accumulator (numerator) over popped (denominator).
    Divide,
    /// If the accumulator (a denominator) is 0: warn, leave 0 as the quotient and go to the label.
    Guard(u32),
    Negate,
    AddNumber(f64),
    MultiplyNumber(f64),
    /// Accumulator over a constant that is not 0.
    DivideNumber(f64),
    AddChannel(u32),
    SubtractChannel(u32),
    MultiplyChannel(u32),
    AddKept(u32),
    SubtractKept(u32),
    MultiplyKept(u32),
    /// Loads an input plus a number.
    ChannelPlus(u32, f64),
    /// Loads an input times a number.
    ChannelTimes(u32, f64),
    /// Loads the first input minus the second.
    ChannelMinusChannel(u32, u32),
    /// Loads the product of two inputs.
    ChannelTimesChannel(u32, u32),
    /// Accumulator (base) to the popped exponent. `clear`: the operands cannot have set the flag.
    Power {
        clear: bool,
    },
    /// Accumulator to a constant exponent.
    PowerNumber(f64),
    /// Accumulator squared.
    Square,

    /// Clears the error flag.
    Clear,
    /// A function of the accumulator.
    Unary {
        function: Builtin,
        clear: bool,
    },
    /// A function of its declared number of operands.
    Native {
        function: Builtin,
        clear: bool,
    },
    /// The least or greatest of so many operands.
    Extreme {
        max: bool,
        count: u32,
        clear: bool,
    },
    /// Pops the accumulator; goes to the label unless it was positive.
    Unless {
        label: u32,
        clear: bool,
    },
    /// Pops the selector k of `count` choices: goes on at the k-th of the jumps that follow; loads the count and goes to
    /// `end` for 0; loads 0 with a domain error and goes there for what is out of range.
    Select {
        count: u32,
        end: u32,
    },
    Jump(u32),
    /// End of a function whose value is the accumulator: fails if the flag is set or the value not finite.
    Finish(Builtin),

    /// Passes a number as the next argument of a call.
    PassNumber(f64),
    /// Passes the subroutine at a label, to be run in this frame when needed.
    PassLater(u32),
    /// Calls the subroutine at `label` with the last `count` arguments passed.
    Call {
        label: u32,
        count: u32,
    },
    /// Beginning of a subroutine with a frame of so many slots, arguments included.
    Enter(u32),
    /// End of a called subroutine.
    Return,
    /// End of an argument or lazy value: keeps it, then returns.
    ReturnKeep,
    /// End of a variable: keeps it, then returns.
    ReturnVariable(u32),
    /// End of the program.
    Halt,
    /// Stops with a fault of the program's list.
    Fault(u32),
}

/// One operation that does the same as these two in turn, if there is one.
pub(crate) fn fused(first: Op, second: Op) -> Option<Op> {
    Some(match (first, second) {
        (Op::Channel(a), Op::AddNumber(b)) | (Op::Number(b), Op::AddChannel(a)) => Op::ChannelPlus(a, b),
        (Op::Channel(a), Op::MultiplyNumber(b)) | (Op::Number(b), Op::MultiplyChannel(a)) => Op::ChannelTimes(a, b),
        (Op::Channel(a), Op::SubtractChannel(b)) => Op::ChannelMinusChannel(a, b),
        (Op::Channel(a), Op::MultiplyChannel(b)) => Op::ChannelTimesChannel(a, b),
        (Op::Kept(a), Op::Add) => Op::AddKept(a),
        (Op::Kept(a), Op::Subtract) => Op::SubtractKept(a),
        (Op::Kept(a), Op::Multiply) => Op::MultiplyKept(a),
        _ => return None,
    })
}

/// Replaces labels by the addresses they were placed at.
pub(crate) fn resolve(code: &mut [Op], addresses: &[u32]) {
    for op in code {
        match op {
            Op::Lazy { label, .. }
            | Op::Variable { label, .. }
            | Op::Guard(label)
            | Op::Unless { label, .. }
            | Op::Select { end: label, .. }
            | Op::Jump(label)
            | Op::PassLater(label)
            | Op::Call { label, .. } => *label = addresses[*label as usize],
            _ => {}
        }
    }
}
