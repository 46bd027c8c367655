//! The language's deterministic "random" numbers.

/// The hash's own constants: e and π/4 cut after fourteen digits or so, whose missing digits would change every value.
#[expect(clippy::approx_constant, reason = "the digits that are missing matter")]
const NEARLY_E: f64 = 2.71828182845904;
const NEARLY_QUARTER_PI: f64 = 0.785398163397447;

/// `rand(x)` of function-files.md 7.1: a hash of x in [0, 1).
pub fn rand(x: f64) -> f64 {
    let x = x * (1.0 / (1.0 + x * x) + NEARLY_E);
    let x = x + NEARLY_QUARTER_PI - x.floor();
    let x = 1e5 / x;
    x - x.floor()
}

#[cfg(test)]
mod tests {
    use super::rand;

    #[test]
    fn values_are_those_radiance_prints() {
        for (x, value) in [
            (0.0, 0.954473516),
            (1.0, 0.35008306),
            (0.5, 0.234347013),
            (-1.0, 0.471918535),
            (12345.678, 0.231398127),
            (1e15, 0.0),
            (2.0, 0.732379808),
        ] {
            assert!((rand(x) - value).abs() < 1e-9, "rand({x}) = {}", rand(x));
        }
    }
}
