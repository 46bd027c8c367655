//! `--error`: settings are chosen for an error that is asked for.

use crate::common::Carries;
use crate::failure::Failure;
use crate::rendering::Rendering;
use crate::table::{Place, Row};
use ambit_file::real;

/// The row of `--error`.
pub(crate) fn goal_row<S: Carries<Rendering>>() -> Row<S> {
    let act = |s: &mut S, value: String, _: &dyn crate::Outside| {
        s.part().goal = Some(goal(&value)?);
        Ok(())
    };
    let help = "choose -aa -ad -as -ar -ds -dt, but for those that are given, so that the RMS error relative to the mean is \
                likely to stay below this (5% or .05), by computing a small part beforehand; say what was chosen and what \
                error is expected of it";
    Row::new("-error", Place::Word(act), help).values("ERROR")
}

/// An error as `5%` or `.05`.
fn goal(text: &str) -> Result<f64, Failure> {
    let value = match text.strip_suffix('%') {
        Some(percent) => real(percent).map(|p| p / 100.0),
        None => real(text),
    };
    let fits = |x: &f64| *x > 0.0 && *x <= 1.0;
    let bad = || format!("--error {text} is no error above 0 and up to 100 % (expected something like 5% or .05)");
    value.filter(fits).ok_or_else(|| Failure::user(bad()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_fractions_or_percentages() {
        for (text, value) in [("5%", 0.05), (".05", 0.05), ("100%", 1.0), ("1", 1.0), ("1e-2", 0.01), ("12.5%", 0.125)]
        {
            assert!((goal(text).unwrap() - value).abs() < 1e-12, "{text}");
        }
        for text in ["0", "0%", "-3%", "x", "%", "101%", "5", "nan", "inf%", "5%%", "5 %"] {
            let failure = goal(text).unwrap_err();
            assert!(failure.text.contains(text) && failure.text.contains("expected"), "{}", failure.text);
        }
    }
}
