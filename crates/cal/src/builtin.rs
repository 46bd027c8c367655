//! The table of built-in functions. Answers function-files.md section 7.

use crate::library::Host;

/// A built-in function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Builtin {
    If,
    Select,
    Min,
    Max,
    Floor,
    Ceil,
    Sqrt,
    Exp,
    Log,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Rand,
    Erf,
    Erfc,
    Noise3,
    Noise3x,
    Noise3y,
    Noise3z,
    Fnoise3,
    Arg,
    SourceCorr,
    SourceTheta,
    SourcePhi,
    PrismValue,
    In,
}

/// Where a function exists.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Where {
    Everywhere,
    Renderer,
    Calculator,
}

use Builtin as B;
use Where::{Calculator, Everywhere, Renderer};

/// Function, name, arguments it declares, where it exists. In the order of the enumeration.
const TABLE: [(Builtin, &str, u32, Where); 31] = [
    (B::If, "if", 3, Everywhere),
    (B::Select, "select", 1, Everywhere),
    (B::Min, "min", 1, Everywhere),
    (B::Max, "max", 1, Everywhere),
    (B::Floor, "floor", 1, Everywhere),
    (B::Ceil, "ceil", 1, Everywhere),
    (B::Sqrt, "sqrt", 1, Everywhere),
    (B::Exp, "exp", 1, Everywhere),
    (B::Log, "log", 1, Everywhere),
    (B::Log10, "log10", 1, Everywhere),
    (B::Sin, "sin", 1, Everywhere),
    (B::Cos, "cos", 1, Everywhere),
    (B::Tan, "tan", 1, Everywhere),
    (B::Asin, "asin", 1, Everywhere),
    (B::Acos, "acos", 1, Everywhere),
    (B::Atan, "atan", 1, Everywhere),
    (B::Atan2, "atan2", 2, Everywhere),
    (B::Rand, "rand", 1, Everywhere),
    (B::Erf, "erf", 1, Renderer),
    (B::Erfc, "erfc", 1, Renderer),
    (B::Noise3, "noise3", 3, Renderer),
    (B::Noise3x, "noise3x", 3, Renderer),
    (B::Noise3y, "noise3y", 3, Renderer),
    (B::Noise3z, "noise3z", 3, Renderer),
    (B::Fnoise3, "fnoise3", 3, Renderer),
    (B::Arg, "arg", 1, Renderer),
    (B::SourceCorr, "source_corr", 2, Renderer),
    (B::SourceTheta, "source_theta", 1, Renderer),
    (B::SourcePhi, "source_phi", 1, Renderer),
    (B::PrismValue, "fprism_val", 3, Renderer),
    (B::In, "in", 1, Calculator),
];

impl Builtin {
    /// The function of this name that `host` has.
    pub(crate) fn named(name: &str, host: Host) -> Option<Self> {
        let (builtin, .., place) = TABLE.iter().find(|row| row.1 == name)?;
        let there = match place {
            Everywhere => true,
            Renderer => host == Host::Renderer,
            Calculator => host == Host::Calculator,
        };
        there.then_some(*builtin)
    }

    pub(crate) fn name(self) -> &'static str {
        TABLE[self as usize].1
    }

    /// The number of arguments it declares, which is also the least it needs (but for `if`, which needs them one by
    /// one).
    pub(crate) fn arity(self) -> u32 {
        TABLE[self as usize].2
    }

    /// Whether a call with constant arguments is a constant.
    pub(crate) fn is_pure(self) -> bool {
        !matches!(self, B::Arg | B::SourceCorr | B::SourceTheta | B::SourcePhi | B::PrismValue | B::In)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_at_their_functions() {
        for (at, (builtin, name, ..)) in TABLE.iter().enumerate() {
            assert_eq!(*builtin as usize, at, "{name}");
        }
    }

    #[test]
    fn hosts_have_their_own() {
        assert_eq!(Builtin::named("noise3", Host::Renderer), Some(B::Noise3));
        assert_eq!(Builtin::named("noise3", Host::Calculator), None);
        assert_eq!(Builtin::named("in", Host::Calculator), Some(B::In));
        assert_eq!(Builtin::named("in", Host::Renderer), None);
    }
}
