//! What can go wrong: in the text (a [`CompileError`]), fatally while evaluating (a [`Fault`]), or in the arithmetic of
//! one evaluation (a [`Warning`], which substitutes 0 and leaves a [`Flag`]).

use crate::builtin::Builtin;
use std::fmt;
use std::sync::Arc;

/// What is wrong with a text. Displayed in Radiance's words.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// Something the grammar does not allow here.
    #[error("unexpected character")]
    UnexpectedCharacter,
    /// One particular token was needed.
    #[error("{0} expected")]
    Expected(&'static str),
    /// A definition must begin with a name.
    #[error("illegal variable name")]
    IllegalVariableName,
    /// Parameters are plain names.
    #[error("illegal parameter name")]
    IllegalParameterName,
    /// A decimal point without digits.
    #[error("badly formed number")]
    BadNumber,
    /// `e` without digits.
    #[error("missing exponent")]
    MissingExponent,
    /// More levels of parentheses and calls than are supported.
    #[error("expression nested deeper than {0} levels")]
    TooDeep(u32),
    /// Arithmetic on constants fails.
    #[error("bad constant expression")]
    BadConstant,
    /// A divisor is the constant 0.
    #[error("divide by zero constant")]
    DivideByZeroConstant,
    /// A constant's value would depend on a ray.
    #[error("ray parameter used in constant expression")]
    RayInConstant,
    /// Evaluating a constant ended in a fault; Radiance gives no place for these.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// A text that does not compile: where, and why.
///
/// Displays as Radiance does: a line with the place (if there is one), the line of text, and blanks up to the offending
/// character followed by `^` and the reason; a [`Problem::Fault`] is the bare reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompileError {
    /// File, or description of the scene primitive; empty for command-line definitions.
    pub place: String,
    /// Line in the file from 1; 0 if the text is not a file.
    pub line: u32,
    /// Column of the offending character from 1, in bytes.
    pub column: u32,
    /// The line of text (all of it for texts that are not files).
    pub source_line: String,
    /// Why.
    pub problem: Problem,
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Problem::Fault(fault) = &self.problem {
            return fault.fmt(f);
        }
        if self.line > 0 {
            writeln!(f, "{}, line {}:", self.place, self.line)?;
        } else if !self.place.is_empty() {
            writeln!(f, "{}:", self.place)?;
        }
        let blanks = self.column.saturating_sub(1) as usize;
        write!(f, "{}\n{:blanks$}^ {}", self.source_line, "", self.problem)
    }
}

impl std::error::Error for CompileError {}

/// Why an evaluation cannot go on; the run ends. Displayed in Radiance's words.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// A name that is no variable was used as one.
    #[error("{0}: undefined variable")]
    UndefinedVariable(Arc<str>),
    /// A name that is no function was called.
    #[error("{0}(): undefined function")]
    UndefinedFunction(Arc<str>),
    /// The function needed an argument that the call does not give.
    #[error("{0}(): too few arguments")]
    TooFewArguments(Arc<str>),
    /// The function called one of its parameters, which is no function.
    #[error("{0}(): argument not a function")]
    NotAFunction(Arc<str>),
    /// `$n` with an n that does not exist.
    #[error("illegal channel number")]
    IllegalChannel,
    /// Something about the ray was asked for where there is none.
    #[error("ray parameter used in constant expression")]
    NoRay,
    /// The primitive's real arguments were asked for where there is no primitive.
    #[error("bad call to arg(n) - illegal constant in .cal file?")]
    NoReals,
    /// The primitive has fewer real arguments; the caller adds `for TYPE "name"`.
    #[error("missing real argument {0}")]
    MissingReal(u64),
    /// Not enough real arguments for `source_corr`; the caller adds `for TYPE "name"`.
    #[error("missing real argument(s)")]
    MissingReals,
    /// A mode or symmetry the source functions do not know.
    #[error("illegal {what} {value} in {function}()")]
    IllegalMode {
        /// The function.
        function: &'static str,
        /// Which of its arguments.
        what: &'static str,
        /// What it was.
        value: i64,
    },
    /// Calls nest without end.
    #[error("function calls nested too deep")]
    TooDeep,
    /// A built-in function this implementation lacks.
    #[error("{0}(): function not supported")]
    Unsupported(&'static str),
}

/// What the last arithmetic operation that touches the error flag left there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Flag {
    /// No error.
    #[default]
    Clear,
    /// An argument outside a function's domain.
    Domain,
    /// A result that no finite number can hold, or a division by zero.
    Range,
}

/// A failed operation, whose value was taken as 0. Displayed in Radiance's words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Warning {
    /// A divisor was 0.
    #[error("Division by zero")]
    DivisionByZero,
    /// A power has no finite value.
    #[error("Illegal power")]
    IllegalPower,
    /// A library function was given arguments outside its domain, or one of them failed so.
    #[error("{0}(): domain error")]
    Domain(&'static str),
    /// A library function has no finite value, or one of its arguments failed so.
    #[error("{0}(): range error")]
    Range(&'static str),
}

impl Warning {
    /// True if the operation was carried out, and what came out is no finite number.
    pub(crate) fn is_of_value(&self) -> bool {
        match self {
            Self::DivisionByZero => false,
            Self::IllegalPower => true,
            Self::Domain(name) | Self::Range(name) => *name != Builtin::Select.name(),
        }
    }
}
