//! Folding of constants while trees are bound. Answers function-files.md section 6.
//!
//! A non-constant subtrahend or divisor is a barrier: what stands left of it is one operand for the folding of what
//! follows, as it is in Radiance, where only nested sums and nested products are flattened.

use crate::error::{Problem, Warning};
use crate::expr::Expr;

/// Arithmetic on constants fails: the problem, and the warning that goes with it if any.
pub(crate) type Failure = (Problem, Option<Warning>);

/// Terms of a sum, or factors of a product, collected from left to right.
pub(crate) struct Chain {
    operands: Vec<(bool, Expr)>,
    /// Where the constant is that further ones combine with.
    constant: Option<usize>,
    /// Whether to fold at all.
    fold: bool,
}

impl Chain {
    pub(crate) fn new(fold: bool) -> Self {
        Self { operands: Vec::new(), constant: None, fold }
    }

    fn push(&mut self, inverse: bool, operand: Expr) {
        if inverse {
            self.constant = None;
        } else if matches!(operand, Expr::Number(_)) && self.fold {
            self.constant = Some(self.operands.len());
        }
        self.operands.push((inverse, operand));
    }

    fn constant(&mut self) -> Option<&mut f64> {
        match self.operands.get_mut(self.constant?) {
            Some((_, Expr::Number(value))) => Some(value),
            _ => None,
        }
    }

    /// The only operand so far, if it is a constant.
    fn only(&self) -> Option<f64> {
        match self.operands[..] {
            [(_, Expr::Number(value))] => Some(value),
            _ => None,
        }
    }

    /// One more term.
    pub(crate) fn add(&mut self, minus: bool, term: Expr) {
        match term {
            Expr::Number(value) if self.fold => {
                let value = if minus { -value } else { value };
                match self.constant() {
                    Some(sum) => *sum += value,
                    None => self.push(false, Expr::Number(value)),
                }
            }
            Expr::Sum(nested) if self.fold && !minus => {
                for operand in flatten(nested, Expr::Sum) {
                    if matches!(operand, Expr::Number(_)) {
                        self.add(false, operand);
                    } else {
                        self.push(false, operand);
                    }
                }
            }
            _ => self.push(minus, term),
        }
    }

    /// One more factor.
    pub(crate) fn multiply(&mut self, over: bool, factor: Expr) -> Result<(), Failure> {
        if !self.fold || self.operands.is_empty() {
            self.push(over, factor);
            return Ok(());
        }
        match (self.only(), factor) {
            (Some(left), Expr::Number(right)) => {
                if over && right == 0.0 {
                    return Err((Problem::BadConstant, Some(Warning::DivisionByZero)));
                }
                self.operands[0].1 = Expr::Number(if over { left / right } else { left * right });
            }
            (_, Expr::Number(right)) => {
                if over && right == 0.0 {
                    return Err((Problem::DivideByZeroConstant, None));
                }
                if right == 0.0 {
                    self.zero();
                    return Ok(());
                }
                let right = if over { 1.0 / right } else { right };
                match self.constant() {
                    Some(product) => *product *= right,
                    None => self.push(false, Expr::Number(right)),
                }
            }
            (Some(0.0), _) => {}
            (_, Expr::Product(nested)) if !over => {
                for operand in flatten(nested, Expr::Product) {
                    if matches!(operand, Expr::Number(_)) {
                        self.multiply(false, operand)?;
                    } else {
                        self.push(false, operand);
                    }
                }
            }
            (_, factor) => self.push(over, factor),
        }
        Ok(())
    }

    fn zero(&mut self) {
        self.operands.clear();
        self.push(false, Expr::Number(0.0));
    }

    pub(crate) fn sum(self) -> Expr {
        self.finish(Expr::Sum)
    }

    pub(crate) fn product(self) -> Expr {
        self.finish(Expr::Product)
    }

    fn finish(mut self, wrap: fn(Vec<(bool, Expr)>) -> Expr) -> Expr {
        match self.operands.pop() {
            Some((false, only)) if self.operands.is_empty() => only,
            Some(last) => {
                self.operands.push(last);
                wrap(self.operands)
            }
            None => Expr::Number(0.0),
        }
    }
}

/// Takes a nested chain of the same kind apart: what is left of its last barrier is one operand.
fn flatten(mut nested: Vec<(bool, Expr)>, wrap: fn(Vec<(bool, Expr)>) -> Expr) -> Vec<Expr> {
    let free = nested.iter().rposition(|(inverse, _)| *inverse).map_or(0, |at| at + 1);
    let tail = nested.split_off(free).into_iter().map(|(_, operand)| operand);
    if nested.is_empty() { tail.collect() } else { std::iter::once(wrap(nested)).chain(tail).collect() }
}

/// A power.
pub(crate) fn power(base: Expr, exponent: Expr, fold: bool) -> Expr {
    if fold {
        match (&base, &exponent) {
            (Expr::Number(x), Expr::Number(y)) => {
                let value = x.powf(*y);
                if value.is_finite() {
                    return Expr::Number(value);
                }
                // Left to rays, which may never come by it.
            }
            (Expr::Number(0.0), _) => return base,
            (Expr::Number(1.0), _) | (_, Expr::Number(0.0)) => return Expr::Number(1.0),
            (_, Expr::Number(1.0)) => return base,
            _ => {}
        }
    }
    Expr::Power(Box::new((base, exponent)))
}

/// A change of sign.
pub(crate) fn negative(value: Expr, fold: bool) -> Expr {
    match value {
        Expr::Number(value) if fold => Expr::Number(-value),
        _ => Expr::Negative(Box::new(value)),
    }
}
