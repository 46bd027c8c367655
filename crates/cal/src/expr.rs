//! Bound expressions: names are entries, parameters positions, constants folded.

use crate::names::EntryId;

/// What a call calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Callee {
    Entry(EntryId),
    /// A parameter of the enclosing function, by position.
    Parameter(u32),
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expr {
    Number(f64),
    /// An input, by index.
    Channel(u32),
    /// `$n` with an n that does not exist: a fault when evaluated.
    IllegalChannel,
    /// A value given at run time, by position (the root call of a function's program).
    Given(u32),
    /// A bare name: a variable, or as an argument possibly a function.
    Name(EntryId),
    Parameter(u32),
    Call(Callee, Vec<Expr>),
    Negative(Box<Expr>),
    /// (subtracted, term), evaluated from left to right; the first is never subtracted.
    Sum(Vec<(bool, Expr)>),
    /// (divided by, factor), left to right; the first is never a divisor.
    Product(Vec<(bool, Expr)>),
    /// Base and exponent.
    Power(Box<(Expr, Expr)>),
}

/// What a name stands for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Definition {
    /// Defined with `:`.
    pub(crate) constant: bool,
    /// Number of parameters of a function; `None` for a variable.
    pub(crate) parameters: Option<u32>,
    pub(crate) body: Expr,
    /// The value of a constant variable, once computed.
    pub(crate) value: Option<f64>,
}

impl Definition {
    pub(crate) fn variable(body: Expr) -> Self {
        Self { constant: false, parameters: None, body, value: None }
    }

    /// Whether two definitions say the same; a computed value is no part of that.
    pub(crate) fn same(&self, other: &Self) -> bool {
        self.constant == other.constant && self.parameters == other.parameters && self.body == other.body
    }
}
