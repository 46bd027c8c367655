//! From bound expressions to code.
//!
//! A call of a user's function is written in line with its arguments substituted, unless it is recursive, very deep or
//! the code already long; then it becomes a call of a subroutine. Either way an argument is evaluated in its caller's
//! environment when first used, and once at most, as the language demands:
//!
//! * an argument used once is written where it is used;
//! * one whose first use comes before all others is written there and kept in a slot of the frame;
//! * any other is a subroutine run at its first use;
//! * a bare name stands for itself, so that functions given as arguments are known when code is written: subroutines are
//!   made per function, number of arguments and names among them.
//!
//! Every piece of code runs at most once per frame, which is what makes slots sound.

use std::collections::HashMap;

use crate::builtin::Builtin;
use crate::channel::ChannelSet;
use crate::error::Fault;
use crate::expr::{Callee, Definition, Expr};
use crate::library::{Host, Library};
use crate::names::EntryId;
use crate::op::{Op, fused, resolve};
use crate::program::Program;

/// Names that only stand for other names are followed this far.
const ALIASES: u32 = 8;

/// Compiles an expression.
pub(crate) fn expression(library: &Library, root: &Expr) -> Program {
    let mut emitter = Emitter::new(library);
    let start = emitter.label();
    emitter.body(start, root, None, 0, Op::Halt);
    while let Some(pending) = emitter.bodies.pop() {
        emitter.subroutine(pending);
    }
    resolve(&mut emitter.code, &emitter.addresses);
    Program {
        code: emitter.code.into(),
        channels: emitter.channels,
        reals: emitter.reals,
        variables: library.names.count(),
        faults: emitter.faults.into(),
    }
}

/// The environment a function's body is written in.
#[derive(Clone)]
pub(crate) struct Environment {
    pub(crate) function: EntryId,
    pub(crate) bindings: Vec<usize>,
    pub(crate) caller: Option<usize>,
}

/// Where the value of a parameter comes from.
#[derive(Clone, Copy)]
pub(crate) enum Binding<'l> {
    /// Written where used: an expression and its environment.
    Inline(&'l Expr, Option<usize>),
    /// Written at its first use, which comes before the others, and kept.
    Once { expr: &'l Expr, environment: Option<usize>, slot: u32, done: bool },
    /// A subroutine.
    Lazy { slot: u32, label: u32 },
    /// An argument in the frame of a called subroutine.
    Argument(u32),
    /// A bare name.
    Name(EntryId),
}

/// How a subroutine gets one argument.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Shape {
    Passed,
    Name(EntryId),
}

/// A function with what is known of its arguments.
pub(crate) type Instance = (EntryId, Vec<Shape>);

/// A subroutine still to be written.
pub(crate) enum Pending {
    Variable(EntryId, u32),
    Instance(Instance, u32),
}

/// An argument of the frame now being written, still to be written itself.
pub(crate) struct Argument<'l> {
    pub(crate) expr: &'l Expr,
    pub(crate) environment: Option<usize>,
    pub(crate) label: u32,
}

/// What a variable that needs no memory stands for.
pub(crate) enum Simple {
    Number(f64),
    Channel(u32),
    Real { index: u32, slot: u32 },
}

pub(crate) struct Emitter<'l> {
    pub(crate) library: &'l Library,
    pub(crate) code: Vec<Op>,
    pub(crate) addresses: Vec<u32>,
    /// Where the last label was placed.
    joint: usize,
    pub(crate) environments: Vec<Environment>,
    pub(crate) bindings: Vec<Binding<'l>>,
    pub(crate) variables: HashMap<EntryId, u32>,
    pub(crate) instances: HashMap<Instance, u32>,
    pub(crate) bodies: Vec<Pending>,
    pub(crate) arguments: Vec<Argument<'l>>,
    /// Slots of the frame now being written.
    pub(crate) slots: u32,
    pub(crate) level: u32,
    pub(crate) channels: ChannelSet,
    pub(crate) reals: bool,
    pub(crate) faults: Vec<Fault>,
}

impl<'l> Emitter<'l> {
    fn new(library: &'l Library) -> Self {
        Self {
            library,
            code: Vec::new(),
            addresses: Vec::new(),
            joint: 0,
            environments: Vec::new(),
            bindings: Vec::new(),
            variables: HashMap::new(),
            instances: HashMap::new(),
            bodies: Vec::new(),
            arguments: Vec::new(),
            slots: 0,
            level: 0,
            channels: ChannelSet::EMPTY,
            reals: false,
            faults: Vec::new(),
        }
    }
    /// Writes the code of one frame: an expression, its end, and the arguments it passes.
    fn body(&mut self, label: u32, expr: &'l Expr, environment: Option<usize>, arguments: u32, end: Op) {
        self.place(label);
        let enter = self.code.len();
        self.op(Op::Enter(0));
        self.slots = arguments;
        self.value(expr, environment);
        self.op(end);
        while let Some(pending) = self.arguments.pop() {
            self.place(pending.label);
            self.value(pending.expr, pending.environment);
            self.op(Op::ReturnKeep);
        }
        self.code[enter] = Op::Enter(self.slots);
        if self.slots == 0 {
            self.addresses[label as usize] += 1;
        }
    }

    fn subroutine(&mut self, pending: Pending) {
        let library = self.library;
        match pending {
            Pending::Variable(entry, label) => {
                let end = Op::ReturnVariable(entry);
                match &library.names.entry(entry).definition {
                    Some(definition) if definition.parameters.is_none() => {
                        self.body(label, &definition.body, None, 0, end);
                    }
                    _ => {
                        self.place(label);
                        self.fault(Fault::UndefinedVariable(library.names.entry(entry).name.clone()));
                    }
                }
            }
            Pending::Instance((entry, shapes), label) => {
                let mut passed = 0;
                let mut bindings = Vec::new();
                for shape in shapes {
                    let binding = match shape {
                        Shape::Name(name) => Binding::Name(name),
                        Shape::Passed => {
                            passed += 1;
                            Binding::Argument(passed - 1)
                        }
                    };
                    bindings.push(self.bind(binding));
                }
                let Some(definition) = self.function(entry) else { return };
                let environment = self.environment(Environment { function: entry, bindings, caller: None });
                self.body(label, &definition.body, Some(environment), passed, Op::Return);
            }
        }
    }

    pub(crate) fn label(&mut self) -> u32 {
        self.addresses.push(0);
        self.addresses.len() as u32 - 1
    }

    /// The label stands for what is written next.
    pub(crate) fn place(&mut self, label: u32) {
        self.addresses[label as usize] = self.code.len() as u32;
        self.joint = self.code.len();
    }

    /// Writes an operation, into one with that before it if it can and if no jump leads between them.
    pub(crate) fn op(&mut self, op: Op) {
        if self.code.len() > self.joint
            && let Some(last) = self.code.last_mut()
            && let Some(one) = fused(*last, op)
        {
            *last = one;
        } else {
            self.code.push(op);
        }
    }

    pub(crate) fn slot(&mut self) -> u32 {
        self.slots += 1;
        self.slots - 1
    }

    pub(crate) fn fault(&mut self, fault: Fault) {
        self.op(Op::Fault(self.faults.len() as u32));
        self.faults.push(fault);
    }

    /// The user's function of this name, which hides a library function.
    pub(crate) fn function(&self, entry: EntryId) -> Option<&'l Definition> {
        self.library.names.entry(entry).definition.as_ref().filter(|definition| definition.parameters.is_some())
    }

    /// Writes code that loads the value of `expr`.
    pub(crate) fn value(&mut self, expr: &'l Expr, environment: Option<usize>) {
        self.level += 1;
        match expr {
            Expr::Number(value) => self.op(Op::Number(*value)),
            Expr::Channel(index) => self.channel(*index),
            Expr::IllegalChannel => self.fault(Fault::IllegalChannel),
            Expr::Given(index) => self.op(Op::Given(*index)),
            Expr::Name(entry) => self.variable(*entry),
            Expr::Parameter(index) => self.parameter(*index, environment),
            Expr::Call(callee, list) => self.call(*callee, list, environment),
            Expr::Negative(value) => {
                self.value(value, environment);
                self.op(Op::Negate);
            }
            Expr::Sum(list) => self.sum(list, environment),
            Expr::Product(list) => self.product(list, environment),
            Expr::Power(pair) => self.power(&pair.0, &pair.1, environment),
        }
        self.level -= 1;
    }

    fn channel(&mut self, index: u32) {
        if self.library.host == Host::Calculator {
            self.op(Op::Column(index));
        } else {
            self.channels.insert(index);
            self.op(Op::Channel(index));
        }
    }

    /// Follows a name to something that needs no memory.
    pub(crate) fn simple(&self, mut entry: EntryId) -> Option<Simple> {
        for _ in 0..ALIASES {
            let definition = self.library.names.entry(entry).definition.as_ref()?;
            if definition.parameters.is_some() {
                return None;
            }
            match &definition.body {
                Expr::Number(value) => return Some(Simple::Number(*value)),
                Expr::Channel(index) => return Some(Simple::Channel(*index)),
                Expr::Name(next) => entry = *next,
                Expr::Call(Callee::Entry(function), list) if self.builtin(*function) == Some(Builtin::Arg) => {
                    return match list[..] {
                        [Expr::Number(index)] if (0.5..1e6).contains(&index) => {
                            Some(Simple::Real { index: (index + 0.5) as u32, slot: entry })
                        }
                        _ => None,
                    };
                }
                _ => return None,
            }
        }
        None
    }

    pub(crate) fn variable(&mut self, entry: EntryId) {
        match self.simple(entry) {
            Some(Simple::Number(value)) => self.op(Op::Number(value)),
            Some(Simple::Channel(index)) => self.channel(index),
            Some(Simple::Real { index, slot }) => {
                self.reals = true;
                self.op(Op::Real { index, slot });
            }
            None => {
                let known = self.variables.get(&entry).copied();
                let label = known.unwrap_or_else(|| {
                    let label = self.label();
                    self.variables.insert(entry, label);
                    self.bodies.push(Pending::Variable(entry, label));
                    label
                });
                self.op(Op::Variable { slot: entry, label });
            }
        }
    }

    fn sum(&mut self, list: &'l [(bool, Expr)], environment: Option<usize>) {
        for (at, (minus, term)) in list.iter().enumerate() {
            let fused = if at == 0 { None } else { self.leaf(term, environment) };
            match fused {
                Some(Op::Number(value)) => self.op(Op::AddNumber(if *minus { -value } else { value })),
                Some(Op::Channel(index)) => {
                    self.channels.insert(index);
                    self.op(if *minus { Op::SubtractChannel(index) } else { Op::AddChannel(index) });
                }
                _ => {
                    self.value(term, environment);
                    if at > 0 {
                        self.op(if *minus { Op::Subtract } else { Op::Add });
                    }
                }
            }
        }
    }

    /// Divisors are evaluated before what they divide, from the last to the first: a product a/b*c/d is ((a/b)·c)/d.
    fn product(&mut self, list: &'l [(bool, Expr)], environment: Option<usize>) {
        let mut guards = Vec::new();
        for (_, divisor) in list.iter().rev().filter(|(over, _)| *over) {
            if self.safe_divisor(divisor, environment).is_none() {
                self.value(divisor, environment);
                let label = self.label();
                self.op(Op::Guard(label));
                guards.push(label);
            }
        }
        for (at, (over, factor)) in list.iter().enumerate() {
            if *over {
                if let Some(value) = self.safe_divisor(factor, environment) {
                    self.op(Op::DivideNumber(value));
                } else {
                    self.op(Op::Divide);
                    let label = guards.pop().expect("one guard was made for each unsafe divisor");
                    self.place(label);
                }
                continue;
            }
            let fused = if at == 0 { None } else { self.leaf(factor, environment) };
            match fused {
                Some(Op::Number(value)) => self.op(Op::MultiplyNumber(value)),
                Some(Op::Channel(index)) => {
                    self.channels.insert(index);
                    self.op(Op::MultiplyChannel(index));
                }
                _ => {
                    self.value(factor, environment);
                    if at > 0 {
                        self.op(Op::Multiply);
                    }
                }
            }
        }
    }

    /// The divisor's value, if it is a number other than 0.
    fn safe_divisor(&self, divisor: &'l Expr, environment: Option<usize>) -> Option<f64> {
        match self.leaf(divisor, environment) {
            Some(Op::Number(value)) if value != 0.0 => Some(value),
            _ => None,
        }
    }

    /// The load that an operand amounts to, if it is a number or a channel.
    fn leaf(&self, expr: &'l Expr, environment: Option<usize>) -> Option<Op> {
        match expr {
            Expr::Number(value) => Some(Op::Number(*value)),
            Expr::Channel(index) if self.library.host == Host::Renderer => Some(Op::Channel(*index)),
            Expr::Name(entry) => match self.simple(*entry)? {
                Simple::Number(value) => Some(Op::Number(value)),
                Simple::Channel(index) if self.library.host == Host::Renderer => Some(Op::Channel(index)),
                _ => None,
            },
            Expr::Parameter(index) => match self.binding(*index, environment)? {
                Binding::Inline(Expr::Parameter(_), _) => None,
                Binding::Inline(expr, environment) => self.leaf(expr, environment),
                _ => None,
            },
            _ => None,
        }
    }

    fn power(&mut self, base: &'l Expr, exponent: &'l Expr, environment: Option<usize>) {
        if let Some(Op::Number(exponent)) = self.leaf(exponent, environment)
            && self.is_calm(base, environment)
        {
            self.value(base, environment);
            self.op(if exponent == 2.0 { Op::Square } else { Op::PowerNumber(exponent) });
            return;
        }
        let clear = self.is_calm(base, environment) && self.is_calm(exponent, environment);
        if !clear {
            self.op(Op::Clear);
        }
        self.value(exponent, environment);
        self.value(base, environment);
        self.op(Op::Power { clear });
    }
}
