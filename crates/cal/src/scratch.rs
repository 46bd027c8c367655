//! What changes while programs run: one scratch a thread, one pass for each primitive at each ray.

use crate::error::{Fault, Flag, Warning};
use crate::panel;
use crate::program::Program;
use crate::run::run;

/// Warnings kept until they are drained; further ones are dropped, as they would repeat.
const WARNINGS: usize = 16;

/// What a program is evaluated on, borrowed from the caller.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inputs<'a> {
    /// Values in function coordinates, indexed by [`Channel`](crate::Channel); those outside
    /// [`Program::channels`] are not read. (For calculators: the columns of the record.)
    pub channels: &'a [f64],
    /// The real arguments of the primitive: `arg(1)`, `arg(2)`, …
    pub reals: &'a [f64],
}

/// A place in a frame: an argument or a value kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    /// Where the code of the value begins; [`DONE`] once `value` holds it, [`UNSET`] before.
    pub(crate) code: u32,
    /// The frame that code runs in.
    pub(crate) frame: u32,
    pub(crate) value: f64,
}

pub(crate) const DONE: u32 = u32::MAX;
pub(crate) const UNSET: Slot = Slot { code: 0, frame: 0, value: 0.0 };

/// Where to go on after a subroutine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Return {
    pub(crate) address: u32,
    pub(crate) frame: u32,
    /// The slot that awaits the value, if one does.
    pub(crate) slot: u32,
}

/// A variable's last value, and when it was computed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Remembered {
    pub(crate) stamp: u64,
    pub(crate) value: f64,
}

/// The memory that evaluation works in. Nothing is allocated once it has grown to what the programs need.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Operands below the accumulator.
    pub(crate) stack: Vec<f64>,
    pub(crate) state: State,
}

/// All of it but the stack.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    pub(crate) slots: Vec<Slot>,
    pub(crate) returns: Vec<Return>,
    pub(crate) variables: Vec<Remembered>,
    pub(crate) clock: u64,
    pub(crate) flag: Flag,
    pub(crate) history: bool,
    /// What `fprism_val` found last, once it is used.
    pub(crate) panel: Option<Box<panel::Answer>>,
    warnings: Vec<Warning>,
}

impl State {
    #[cold]
    pub(crate) fn warn(&mut self, warning: Warning) {
        if self.warnings.len() < WARNINGS {
            self.warnings.push(warning);
        }
    }
}

impl Scratch {
    /// An empty scratch. A variable that refers to itself reads 0, so that values do not depend on what was evaluated
    /// before.
    pub fn new() -> Self {
        Self::default()
    }

    /// A scratch in which a variable that refers to itself reads its value of the pass before (`n = n + 1` counts
    /// passes), as in Radiance's single-threaded programs.
    pub fn with_history() -> Self {
        Self { state: State { history: true, ..State::default() }, ..Self::default() }
    }

    /// Begins the evaluation of one primitive on one ray: the clock ticks, so that variables are computed anew, once
    /// each, and the error flag is cleared.
    pub fn pass<'a>(&'a mut self, inputs: Inputs<'a>) -> Pass<'a> {
        self.state.clock += 1;
        self.state.flag = Flag::Clear;
        Pass { scratch: self, inputs, constant: false }
    }

    /// As [`Self::pass`] where there is no ray: reading one is a fault.
    pub(crate) fn constant_pass(&mut self) -> Pass<'_> {
        self.state.clock += 1;
        self.state.flag = Flag::Clear;
        Pass { scratch: self, inputs: Inputs::default(), constant: true }
    }

    /// The warnings since the last call, in order.
    pub fn drain_warnings(&mut self) -> impl Iterator<Item = Warning> + '_ {
        self.state.warnings.drain(..)
    }
}

/// One primitive on one ray: its programs share the values of variables.
#[derive(Debug)]
pub struct Pass<'a> {
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) inputs: Inputs<'a>,
    /// There is no ray and no primitive.
    pub(crate) constant: bool,
}

impl Pass<'_> {
    /// The value of an expression. Failed operations count as 0, warn and leave a [`Flag`]; sums and products may
    /// overflow to infinities without notice, as in Radiance, so check what you use.
    pub fn eval(&mut self, program: &Program) -> Result<f64, Fault> {
        run(program, &[], self)
    }

    /// The value of a function at these arguments; [`Library::function`](crate::Library::function) made the program
    /// for as many (missing ones count as 0).
    pub fn call(&mut self, function: &Program, arguments: &[f64]) -> Result<f64, Fault> {
        run(function, arguments, self)
    }

    /// What the last operation that touches the error flag left. Radiance's patterns, textures and mixtures have no
    /// effect on a ray if it is set after all their expressions.
    pub fn flag(&self) -> Flag {
        self.scratch.state.flag
    }
}
