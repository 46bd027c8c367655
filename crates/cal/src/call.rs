//! Code for calls and parameters: which calls are written in line, and how their arguments reach the body.

use crate::builtin::Builtin;
use crate::channel::{Channel, ChannelSet};
use crate::emit::{Argument, Binding, Emitter, Environment, Instance, Pending, Shape};
use crate::error::Fault;
use crate::expr::{Callee, Definition, Expr};
use crate::flow::{leads, occurrences};
use crate::names::EntryId;
use crate::op::Op;
use crate::panel;

/// Operations after which calls are no longer written in line.
const INLINE_CODE: usize = 8192;
/// Operations after which a program is given up: only definitions made to do so get there.
const CODE: usize = 1 << 20;
/// Calls in line within each other.
const INLINE_DEPTH: u32 = 48;
/// Levels of recursion of the emitter after which it postpones what it can.
const LEVELS: u32 = 400;

impl<'l> Emitter<'l> {
    pub(crate) fn bind(&mut self, binding: Binding<'l>) -> usize {
        self.bindings.push(binding);
        self.bindings.len() - 1
    }

    pub(crate) fn environment(&mut self, environment: Environment) -> usize {
        self.environments.push(environment);
        self.environments.len() - 1
    }

    /// The library function an entry calls, if the user has not defined a function of that name.
    pub(crate) fn builtin(&self, entry: EntryId) -> Option<Builtin> {
        if self.function(entry).is_some() { None } else { self.library.names.entry(entry).builtin }
    }

    /// What a parameter is bound to; `None` if the call gives too few arguments.
    pub(crate) fn binding(&self, parameter: u32, environment: Option<usize>) -> Option<Binding<'l>> {
        let id = self.environments[environment?].bindings.get(parameter as usize)?;
        Some(self.bindings[*id])
    }

    /// Writes code that loads a parameter's value.
    pub(crate) fn parameter(&mut self, index: u32, environment: Option<usize>) {
        let Some(within) = environment else { return self.fault(Fault::NoRay) };
        let Some(id) = self.environments[within].bindings.get(index as usize).copied() else {
            let function = self.environments[within].function;
            return self.fault(Fault::TooFewArguments(self.library.names.entry(function).name.clone()));
        };
        match self.bindings[id] {
            Binding::Name(entry) => self.variable(entry),
            Binding::Argument(slot) => self.op(Op::Argument(slot)),
            Binding::Lazy { slot, label } => self.op(Op::Lazy { slot, label }),
            Binding::Once { slot, done: true, .. } => self.op(Op::Kept(slot)),
            Binding::Once { expr, environment, slot, .. } if self.level < LEVELS => {
                self.value(expr, environment);
                self.op(Op::Keep(slot));
                self.bindings[id] = Binding::Once { expr, environment, slot, done: true };
            }
            Binding::Inline(expr, environment) if self.level < LEVELS => self.value(expr, environment),
            Binding::Once { expr, environment, .. } | Binding::Inline(expr, environment) => {
                self.bindings[id] = self.postpone(expr, environment);
                self.parameter(index, Some(within));
            }
        }
    }

    /// Makes an argument a subroutine of this frame.
    fn postpone(&mut self, expr: &'l Expr, environment: Option<usize>) -> Binding<'l> {
        let (slot, label) = (self.slot(), self.label());
        self.arguments.push(Argument { expr, environment, label });
        Binding::Lazy { slot, label }
    }

    /// Writes a call.
    pub(crate) fn call(&mut self, callee: Callee, list: &'l [Expr], environment: Option<usize>) {
        let entry = match callee {
            Callee::Entry(entry) => entry,
            Callee::Parameter(index) => match self.binding(index, environment) {
                Some(Binding::Name(entry)) => entry,
                other => {
                    let function = environment.map_or(0, |within| self.environments[within].function);
                    let name = self.library.names.entry(function).name.clone();
                    let fault = if other.is_none() { Fault::TooFewArguments(name) } else { Fault::NotAFunction(name) };
                    return self.fault(fault);
                }
            },
        };
        if self.code.len() > CODE {
            self.fault(Fault::TooDeep);
        } else if let Some(definition) = self.function(entry) {
            self.user(entry, definition, list, environment);
        } else if let Some(builtin) = self.builtin(entry) {
            self.library_call(builtin, list, environment);
        } else {
            self.fault(Fault::UndefinedFunction(self.library.names.entry(entry).name.clone()));
        }
    }

    fn user(&mut self, entry: EntryId, definition: &'l Definition, list: &'l [Expr], environment: Option<usize>) {
        let count = definition.parameters.unwrap_or(0).min(list.len() as u32);
        let list = &list[..count as usize];
        if self.may_inline(entry, environment) {
            let mut bindings = Vec::with_capacity(list.len());
            for (index, argument) in (0..count).zip(list) {
                let id = self.argument(argument, environment, &definition.body, index);
                bindings.push(id);
            }
            let within = self.environment(Environment { function: entry, bindings, caller: environment });
            self.value(&definition.body, Some(within));
            return;
        }
        let mut shapes = Vec::with_capacity(list.len());
        let mut passed = 0;
        for argument in list {
            let bound = match argument {
                Expr::Name(name) => Some(Binding::Name(*name)),
                Expr::Parameter(index) => self.binding(*index, environment),
                _ => None,
            };
            if let Some(Binding::Name(name)) = bound {
                shapes.push(Shape::Name(name));
                continue;
            }
            shapes.push(Shape::Passed);
            passed += 1;
            if let Expr::Number(value) = argument {
                self.op(Op::PassNumber(*value));
            } else {
                let label = self.label();
                self.arguments.push(Argument { expr: argument, environment, label });
                self.op(Op::PassLater(label));
            }
        }
        let label = self.instance((entry, shapes));
        self.op(Op::Call { label, count: passed });
    }

    fn instance(&mut self, key: Instance) -> u32 {
        if let Some(label) = self.instances.get(&key) {
            return *label;
        }
        let label = self.label();
        self.instances.insert(key.clone(), label);
        self.bodies.push(Pending::Instance(key, label));
        label
    }

    fn may_inline(&self, entry: EntryId, environment: Option<usize>) -> bool {
        if self.code.len() > INLINE_CODE || self.level > LEVELS {
            return false;
        }
        let mut depth = 0;
        let mut within = environment;
        while let Some(id) = within {
            let environment = &self.environments[id];
            if environment.function == entry || depth > INLINE_DEPTH {
                return false;
            }
            depth += 1;
            within = environment.caller;
        }
        true
    }

    /// Chooses how an argument reaches the body of a function written in line.
    fn argument(
        &mut self,
        mut argument: &'l Expr,
        mut environment: Option<usize>,
        body: &'l Expr,
        parameter: u32,
    ) -> usize {
        // An argument that is merely a parameter of the caller stands for what that is bound to.
        while let Expr::Parameter(index) = argument {
            let bound = environment.and_then(|within| self.environments[within].bindings.get(*index as usize).copied());
            match bound.map(|id| (id, self.bindings[id])) {
                Some((_, Binding::Inline(expr, within))) => (argument, environment) = (expr, within),
                Some((id, _)) => return id,
                None => return self.bind(Binding::Inline(argument, environment)),
            }
        }
        let binding = match argument {
            Expr::Name(entry) => Binding::Name(*entry),
            Expr::Number(_) | Expr::Channel(_) | Expr::Given(_) => Binding::Inline(argument, environment),
            _ if occurrences(body, parameter) <= 1 => Binding::Inline(argument, environment),
            _ if leads(body, parameter, &|callee| self.builtin_of(callee)) => {
                Binding::Once { expr: argument, environment, slot: self.slot(), done: false }
            }
            _ => self.postpone(argument, environment),
        };
        self.bind(binding)
    }

    fn builtin_of(&self, callee: Callee) -> Option<Builtin> {
        match callee {
            Callee::Entry(entry) => self.builtin(entry),
            Callee::Parameter(_) => None,
        }
    }

    fn library_call(&mut self, function: Builtin, list: &'l [Expr], environment: Option<usize>) {
        match function {
            Builtin::If => return self.choice(list, environment),
            Builtin::Select => return self.select(list, environment),
            Builtin::Arg | Builtin::SourceCorr | Builtin::PrismValue => self.reals = true,
            _ => {}
        }
        if matches!(function, Builtin::SourceCorr | Builtin::SourceTheta | Builtin::SourcePhi) {
            use Channel::{Dx, Dy, Dz, Px, Py, Pz, Rdot, Ts};
            self.channels = self.channels.union(ChannelSet::of(&[Dx, Dy, Dz, Px, Py, Pz, Rdot, Ts]));
        }
        if function == Builtin::PrismValue {
            self.channels = self.channels.union(panel::inputs());
        }
        let variadic = matches!(function, Builtin::Min | Builtin::Max);
        let arity = if variadic { list.len() } else { function.arity() as usize };
        if list.len() < arity {
            return self.fault(Fault::TooFewArguments(function.name().into()));
        }
        let list = &list[..arity];
        let clear = list.iter().all(|argument| self.is_calm(argument, environment));
        if !clear {
            self.op(Op::Clear);
        }
        if function == Builtin::Atan2 {
            // The second argument goes first, and so lies deeper.
            self.value(&list[1], environment);
            self.value(&list[0], environment);
        } else {
            for argument in list {
                self.value(argument, environment);
            }
        }
        self.op(match arity {
            _ if variadic => Op::Extreme { max: function == Builtin::Max, count: arity as u32, clear },
            1 => Op::Unary { function, clear },
            _ => Op::Native { function, clear },
        });
    }

    /// `if(c,a,b)`.
    fn choice(&mut self, list: &'l [Expr], environment: Option<usize>) {
        let clear = self.is_calm(&list[0], environment);
        let harmless = clear && list.len() >= 3 && list[1..3].iter().all(|branch| self.is_finite(branch, environment));
        if !clear {
            self.op(Op::Clear);
        }
        self.value(&list[0], environment);
        let (otherwise, end) = (self.label(), self.label());
        self.op(Op::Unless { label: otherwise, clear });
        self.branch(list.get(1), Builtin::If, environment);
        self.op(Op::Jump(end));
        self.place(otherwise);
        self.branch(list.get(2), Builtin::If, environment);
        self.place(end);
        if !harmless {
            self.op(Op::Finish(Builtin::If));
        }
    }

    fn branch(&mut self, argument: Option<&'l Expr>, function: Builtin, environment: Option<usize>) {
        match argument {
            Some(argument) => self.value(argument, environment),
            None => self.fault(Fault::TooFewArguments(function.name().into())),
        }
    }

    /// `select(i,a1,…)`: a table of jumps follows the operation.
    fn select(&mut self, list: &'l [Expr], environment: Option<usize>) {
        let choices = &list[1..];
        self.op(Op::Clear);
        self.value(&list[0], environment);
        let end = self.label();
        self.op(Op::Select { count: choices.len() as u32, end });
        let labels: Vec<u32> = choices.iter().map(|_| self.label()).collect();
        self.code.extend(labels.iter().map(|label| Op::Jump(*label)));
        for (label, choice) in labels.into_iter().zip(choices) {
            self.place(label);
            self.value(choice, environment);
            self.op(Op::Jump(end));
        }
        self.place(end);
        self.op(Op::Finish(Builtin::Select));
    }
}
