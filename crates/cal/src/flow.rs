//! How a function's body uses a parameter, which decides how its argument is passed when the call is inlined.

use crate::builtin::Builtin;
use crate::expr::{Callee, Expr};

/// How often `parameter` appears as a value.
pub(crate) fn occurrences(body: &Expr, parameter: u32) -> u32 {
    match body {
        Expr::Parameter(index) => u32::from(*index == parameter),
        Expr::Call(_, list) => list.iter().map(|argument| occurrences(argument, parameter)).sum(),
        Expr::Negative(value) => occurrences(value, parameter),
        Expr::Sum(list) | Expr::Product(list) => list.iter().map(|(_, operand)| occurrences(operand, parameter)).sum(),
        Expr::Power(pair) => occurrences(&pair.0, parameter) + occurrences(&pair.1, parameter),
        Expr::Number(_) | Expr::Channel(_) | Expr::IllegalChannel | Expr::Given(_) | Expr::Name(_) => 0,
    }
}

/// What evaluating an expression does first to a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum First {
    /// Never mentions it.
    Absent,
    /// Evaluates it, whatever happens.
    Certain,
    /// Mentions it first where it may or may not be evaluated.
    Uncertain,
}

/// Whether every evaluation of `body` evaluates `parameter` before anything that may evaluate it conditionally, so that
/// all its other uses find it evaluated. `builtin` tells which built-in function a callee is, if it is one.
pub(crate) fn leads(body: &Expr, parameter: u32, builtin: &dyn Fn(Callee) -> Option<Builtin>) -> bool {
    first(body, parameter, builtin) == First::Certain
}

fn first(expr: &Expr, parameter: u32, builtin: &dyn Fn(Callee) -> Option<Builtin>) -> First {
    let look = |expr: &Expr| first(expr, parameter, builtin);
    // In the order of evaluation: all certain, or only the first of them.
    let all = |list: &mut dyn Iterator<Item = &Expr>| list.map(look).find(|seen| *seen != First::Absent);
    let only_first = |list: &mut dyn Iterator<Item = &Expr>| {
        let seen = list.next().map_or(First::Absent, look);
        if seen == First::Absent {
            list.map(look).find(|seen| *seen != First::Absent).map(|_| First::Uncertain)
        } else {
            Some(seen)
        }
    };
    let seen = match expr {
        Expr::Parameter(index) => Some(if *index == parameter { First::Certain } else { First::Absent }),
        Expr::Negative(value) => Some(look(value)),
        Expr::Sum(list) => all(&mut list.iter().map(|(_, operand)| operand)),
        Expr::Power(pair) => all(&mut [&pair.1, &pair.0].into_iter()),
        Expr::Product(list) => match list.iter().rposition(|(over, _)| *over) {
            None => all(&mut list.iter().map(|(_, operand)| operand)),
            // The last divisor comes first; if it is 0 nothing else may be evaluated.
            Some(at) => {
                only_first(&mut std::iter::once(at).chain((0..list.len()).filter(|k| *k != at)).map(|k| &list[k].1))
            }
        },
        Expr::Call(callee, list) => match builtin(*callee) {
            Some(Builtin::If | Builtin::Select) => only_first(&mut list.iter()),
            Some(Builtin::Atan2) => all(&mut list.iter().take(2).rev()),
            Some(Builtin::Min | Builtin::Max) => all(&mut list.iter()),
            Some(function) => all(&mut list.iter().take(function.arity() as usize)),
            None if list.iter().any(|argument| look(argument) != First::Absent) => Some(First::Uncertain),
            None => None,
        },
        Expr::Number(_) | Expr::Channel(_) | Expr::IllegalChannel | Expr::Given(_) | Expr::Name(_) => None,
    };
    seen.unwrap_or(First::Absent)
}
