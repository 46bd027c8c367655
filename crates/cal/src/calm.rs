//! Which expressions cannot fail, so that code need not look at the error flag.

use crate::builtin::Builtin;
use crate::emit::{Binding, Emitter, Simple};
use crate::expr::{Callee, Expr};

/// Nodes looked at before giving up: substituted arguments may be met many times over.
const EFFORT: u32 = 60;

/// What is known of an evaluation. (Inputs and real arguments are finite.)
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Nature {
    /// Nothing.
    Unknown,
    /// It cannot set the flag, but may overflow.
    Calm,
    /// Nor that.
    Finite,
}

impl<'l> Emitter<'l> {
    /// Whether evaluating `expr` cannot set the error flag.
    pub(crate) fn is_calm(&self, expr: &'l Expr, environment: Option<usize>) -> bool {
        self.calm(expr, environment, &mut EFFORT.clone()) >= Nature::Calm
    }

    /// Whether, besides, its value is finite.
    pub(crate) fn is_finite(&self, expr: &'l Expr, environment: Option<usize>) -> bool {
        self.calm(expr, environment, &mut EFFORT.clone()) == Nature::Finite
    }

    fn calm(&self, expr: &'l Expr, environment: Option<usize>, effort: &mut u32) -> Nature {
        if *effort == 0 {
            return Nature::Unknown;
        }
        *effort -= 1;
        match expr {
            Expr::Number(value) if value.is_finite() => Nature::Finite,
            Expr::Number(_) | Expr::Given(_) => Nature::Calm,
            Expr::Channel(_) | Expr::IllegalChannel => Nature::Finite,
            Expr::Name(entry) => match self.simple(*entry) {
                Some(Simple::Number(value)) if !value.is_finite() => Nature::Calm,
                Some(_) => Nature::Finite,
                None => Nature::Unknown,
            },
            Expr::Negative(value) => self.calm(value, environment, effort),
            Expr::Sum(list) | Expr::Product(list) => {
                let quotient = matches!(expr, Expr::Product(_));
                let each = list.iter().map(|(inverse, operand)| match operand {
                    _ if !(*inverse && quotient) => self.calm(operand, environment, effort),
                    Expr::Number(divisor) if *divisor != 0.0 => Nature::Calm,
                    _ => Nature::Unknown,
                });
                each.min().unwrap_or(Nature::Finite).min(Nature::Calm)
            }
            Expr::Power(_) | Expr::Call(Callee::Parameter(_), _) => Nature::Unknown,
            Expr::Call(Callee::Entry(entry), list) => {
                let Some(function) = self.builtin(*entry) else { return Nature::Unknown };
                let mut operands = list.iter().map(|argument| self.calm(argument, environment, effort));
                let fine = match function {
                    Builtin::If => {
                        list.len() >= 3
                            && operands.next().is_some_and(|condition| condition >= Nature::Calm)
                            && operands.take(2).all(|branch| branch == Nature::Finite)
                    }
                    Builtin::Floor | Builtin::Ceil | Builtin::Sin | Builtin::Cos | Builtin::Atan | Builtin::Atan2 => {
                        operands.all(|operand| operand == Nature::Finite)
                    }
                    Builtin::Min | Builtin::Max => operands.all(|operand| operand == Nature::Finite),
                    _ => false,
                };
                if fine { Nature::Finite } else { Nature::Unknown }
            }
            Expr::Parameter(index) => match self.binding(*index, environment) {
                Some(Binding::Once { done: true, .. }) => Nature::Calm,
                Some(Binding::Inline(Expr::Parameter(_), _)) => Nature::Unknown,
                Some(Binding::Inline(expr, environment) | Binding::Once { expr, environment, .. }) => {
                    self.calm(expr, environment, effort)
                }
                _ => Nature::Unknown,
            },
        }
    }
}
