//! From raw trees to bound expressions: names become entries in the order of the text, constants are folded.

use crate::channel::NUMBERED;
use crate::emit;
use crate::error::{Fault, Flag, Problem, Warning};
use crate::expr::{Callee, Expr};
use crate::fold::{Chain, Failure, negative, power};
use crate::library::{Host, Library};
use crate::names::{Context, EntryId};
use crate::parse::{Node, Raw};

/// Why binding failed, and the bytes of text left there.
pub(crate) type Trouble = (usize, Problem);

/// Binds the trees of one statement or expression.
pub(crate) struct Binder<'a> {
    pub(crate) library: &'a mut Library,
    pub(crate) context: &'a Context,
    /// Names of the parameters, if a function is being defined.
    pub(crate) parameters: &'a [String],
}

impl Binder<'_> {
    /// Binds a tree.
    pub(crate) fn tree(&mut self, raw: &Raw) -> Result<Expr, Trouble> {
        let fold = self.library.host.folds();
        match &raw.node {
            Node::Number(value) => Ok(Expr::Number(*value)),
            Node::Channel(number) => Ok(self.channel(*number)),
            Node::Name(word) => self.name(word, raw.left),
            Node::Call(word, list) => self.call(word, list, raw.left),
            Node::Negative(value) => Ok(negative(self.tree(value)?, fold)),
            Node::Sum(first, more) => {
                let mut chain = Chain::new(fold);
                chain.add(false, self.tree(first)?);
                for (minus, term) in more {
                    chain.add(*minus, self.tree(term)?);
                }
                Ok(chain.sum())
            }
            Node::Product(first, more) => {
                let mut chain = Chain::new(fold);
                let mut operand = (false, &**first);
                let mut more = more.iter();
                loop {
                    let (over, factor) = operand;
                    let bound = self.tree(factor)?;
                    chain.multiply(over, bound).map_err(|failure| self.failed(failure, factor.left))?;
                    match more.next() {
                        Some((over, factor)) => operand = (*over, factor),
                        None => return Ok(chain.product()),
                    }
                }
            }
            Node::Power(pair) => {
                let (base, exponent) = (self.tree(&pair.0)?, self.tree(&pair.1)?);
                Ok(power(base, exponent, fold))
            }
        }
    }

    fn failed(&mut self, (problem, warning): Failure, left: usize) -> Trouble {
        self.library.messages.extend(warning.map(|warning| warning.to_string()));
        (left, problem)
    }

    fn channel(&self, number: u32) -> Expr {
        match (self.library.host, number) {
            (_, 0) => Expr::IllegalChannel,
            (Host::Renderer, _) if number > NUMBERED => Expr::IllegalChannel,
            _ => Expr::Channel(number - 1),
        }
    }

    fn parameter(&self, word: &str) -> Option<u32> {
        self.parameters.iter().position(|parameter| parameter == word).map(|index| index as u32)
    }

    fn name(&mut self, word: &str, left: usize) -> Result<Expr, Trouble> {
        if let Some(index) = self.parameter(word) {
            return Ok(Expr::Parameter(index));
        }
        let entry = self.library.names.mentioned(word, self.context, self.library.host);
        match self.constant_variable(entry) {
            Some(value) => Ok(Expr::Number(value.map_err(|fault| constant_fault(fault, left))?)),
            None => Ok(Expr::Name(entry)),
        }
    }

    /// The value of a constant variable, where constants are folded.
    fn constant_variable(&mut self, entry: EntryId) -> Option<Result<f64, Fault>> {
        let definition = self.library.names.entry(entry).definition.as_ref()?;
        if !self.library.host.folds() || !definition.constant || definition.parameters.is_some() {
            return None;
        }
        let value = match (&definition.body, definition.value) {
            (Expr::Number(value), _) => return Some(Ok(*value)),
            (_, Some(value)) => return Some(Ok(value)),
            (body, None) => {
                let body = body.clone();
                match self.evaluate(&body) {
                    Ok(Constant::Value(value) | Constant::Wrong(value)) => value,
                    Ok(Constant::Valueless) => return None,
                    Err(fault) => return Some(Err(fault)),
                }
            }
        };
        if let Some(definition) = &mut self.library.names.entry_mut(entry).definition {
            definition.value = Some(value);
        }
        Some(Ok(value))
    }

    fn call(&mut self, word: &str, list: &[Raw], left: usize) -> Result<Expr, Trouble> {
        let callee = match self.parameter(word) {
            Some(index) => Callee::Parameter(index),
            None => Callee::Entry(self.library.names.mentioned(word, self.context, self.library.host)),
        };
        let list = list.iter().map(|argument| self.tree(argument)).collect::<Result<Vec<_>, _>>()?;
        let foldable = self.library.host.folds()
            && matches!(callee, Callee::Entry(entry) if self.is_constant_function(entry))
            && list.iter().all(|argument| match argument {
                Expr::Number(_) => true,
                Expr::Name(entry) => self.is_constant_function(*entry),
                _ => false,
            });
        let call = Expr::Call(callee, list);
        if !foldable {
            return Ok(call);
        }
        match self.evaluate(&call) {
            Ok(Constant::Value(value)) => Ok(Expr::Number(value)),
            Ok(Constant::Wrong(_)) => Err((left, Problem::BadConstant)),
            Ok(Constant::Valueless) => Ok(call),
            Err(fault) => Err(constant_fault(fault, left)),
        }
    }

    /// Whether a call of this name with constant arguments is a constant.
    fn is_constant_function(&self, entry: EntryId) -> bool {
        let entry = self.library.names.entry(entry);
        match &entry.definition {
            Some(definition) if definition.parameters.is_some() => definition.constant,
            _ => entry.builtin.is_some_and(crate::builtin::Builtin::is_pure),
        }
    }

    /// The value of an expression without a ray; warnings go to the library's messages, if it is to be one.
    fn evaluate(&mut self, expr: &Expr) -> Result<Constant, Fault> {
        let program = emit::expression(self.library, expr);
        let mut pass = self.library.scratch.constant_pass();
        let value = pass.eval(&program);
        let flag = pass.flag();
        let Library { scratch, messages, .. } = &mut *self.library;
        let warnings: Vec<Warning> = scratch.drain_warnings().collect();
        if value.is_ok() && flag != Flag::Clear && warnings.iter().all(Warning::is_of_value) {
            return Ok(Constant::Valueless);
        }
        messages.extend(warnings.iter().map(ToString::to_string));
        Ok(if flag == Flag::Clear { Constant::Value(value?) } else { Constant::Wrong(value?) })
    }
}

impl Library {
    /// True if nothing that an expression names can change: a number, or what has none for good.
    pub(crate) fn is_settled(&self, expr: &Expr) -> bool {
        let all = |operands: &[(bool, Expr)]| operands.iter().all(|(_, operand)| self.is_settled(operand));
        let constant = |entry: EntryId| self.names.entry(entry).definition.as_ref().map(|d| d.constant);
        match expr {
            Expr::Number(_) => true,
            Expr::Channel(_)
            | Expr::IllegalChannel
            | Expr::Given(_)
            | Expr::Parameter(_)
            | Expr::Call(Callee::Parameter(_), _) => false,
            Expr::Name(entry) => constant(*entry) == Some(true),
            Expr::Call(Callee::Entry(entry), list) => {
                let pure = || self.names.entry(*entry).builtin.is_some_and(crate::builtin::Builtin::is_pure);
                constant(*entry).unwrap_or_else(pure) && list.iter().all(|argument| self.is_settled(argument))
            }
            Expr::Negative(value) => self.is_settled(value),
            Expr::Sum(operands) | Expr::Product(operands) => all(operands),
            Expr::Power(pair) => self.is_settled(&pair.0) && self.is_settled(&pair.1),
        }
    }
}

/// What becomes of a constant expression.
enum Constant {
    /// A number.
    Value(f64),
    /// A number that stands for an operation that failed.
    Wrong(f64),
    /// No finite number, of a library function or a power: Radiance goes on with none, and it is left to rays, whether
    /// they come by it and what they make of that.
    Valueless,
}

fn constant_fault(fault: Fault, left: usize) -> Trouble {
    match fault {
        Fault::NoRay => (left, Problem::RayInConstant),
        fault => (left, Problem::Fault(fault)),
    }
}
