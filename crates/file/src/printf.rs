//! Numbers as C's `printf` writes them, which is how Radiance's headers, octree cubes, views and listings have them.

/// `%.{digits}g`: at most `digits` significant digits, trailing zeros removed, and an exponent of two digits or more
/// if the decimal exponent is below −4 or not below `digits`.
pub fn general(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return odd(x);
    }
    let digits = digits.max(1);
    // Rounding may carry into the next power of ten, so the exponent is taken from the rounded number.
    let scientific = format!("{:.*e}", digits - 1, x);
    let (mantissa, power) = parts(&scientific);
    if power < -4 || power >= digits as i32 {
        format!("{}e{}", trimmed(mantissa), signed(power))
    } else {
        trimmed(&format!("{:.*}", (digits as i32 - 1 - power) as usize, x)).to_owned()
    }
}

/// `%.{decimals}e`: one digit before the point and an exponent of two digits or more.
pub fn exponent(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return odd(x);
    }
    let scientific = format!("{x:.decimals$e}");
    let (mantissa, power) = parts(&scientific);
    format!("{mantissa}e{}", signed(power))
}

/// `%.{decimals}f`.
pub fn fixed(x: f64, decimals: usize) -> String {
    if x.is_finite() { format!("{x:.decimals$}") } else { odd(x) }
}

fn odd(x: f64) -> String {
    let sign = if x.is_sign_negative() { "-" } else { "" };
    format!("{sign}{}", if x.is_nan() { "nan" } else { "inf" })
}

fn parts(scientific: &str) -> (&str, i32) {
    let (mantissa, power) = scientific.split_once('e').expect("the standard library always writes an exponent");
    (mantissa, power.parse().expect("the standard library writes the exponent in decimal"))
}

fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

fn signed(power: i32) -> String {
    format!("{}{:02}", if power < 0 { '-' } else { '+' }, power.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn general_numbers_are_those_of_printf() {
        for (x, digits, text) in [
            (0.0, 12, "0"),
            (-0.0, 12, "-0"),
            (-1.00001, 12, "-1.00001"),
            (-9.999_999_999_84e-6, 12, "-9.99999999984e-06"),
            (123456789.0, 6, "1.23457e+08"),
            (999999.5, 6, "1e+06"),
            (999999.4, 6, "999999"),
            (0.0001, 6, "0.0001"),
            (0.00001, 6, "1e-05"),
            (0.1, 7, "0.1"),
            (2.0 / 3.0, 5, "0.66667"),
            (100.0, 3, "100"),
            (1e100, 6, "1e+100"),
            (f64::INFINITY, 6, "inf"),
            (f64::NEG_INFINITY, 6, "-inf"),
            (45.0, 0, "4e+01"),
        ] {
            assert_eq!(general(x, digits), text);
        }
    }

    #[test]
    fn exponents_have_two_digits() {
        assert_eq!(exponent(5.5866e-3, 4), "5.5866e-03");
        assert_eq!(exponent(0.0, 3), "0.000e+00");
        assert_eq!(exponent(-1.5e123, 1), "-1.5e+123");
        assert_eq!(exponent(f64::NAN, 1), "nan");
        assert_eq!(fixed(2.0, 6), "2.000000");
    }
}
