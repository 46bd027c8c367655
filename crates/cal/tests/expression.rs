//! Single expressions, as `ev` evaluates them: grammar, library functions, the error flag (function-files.md 17.1).

use ambit_cal::{Context, Host, Inputs, Library, Scratch};

/// The value of an expression and its warnings, or the message it ends with.
fn ev(expression: &str) -> Result<(f64, Vec<String>), String> {
    let mut library = Library::new(Host::Expression);
    let program = library.compile(expression, &Context::GLOBAL, "").map_err(|error| error.to_string())?;
    let mut scratch = Scratch::new();
    let value = scratch.pass(Inputs::default()).eval(&program).map_err(|fault| fault.to_string())?;
    Ok((value, scratch.drain_warnings().map(|warning| warning.to_string()).collect()))
}

fn check(expression: &str, expected: f64, warnings: &[&str]) {
    let (value, printed) = ev(expression).unwrap_or_else(|message| panic!("{expression}: {message}"));
    let close = value == expected || (value - expected).abs() <= 1e-8 * expected.abs();
    assert!(close, "{expression} = {value}, not {expected}");
    assert_eq!(printed, warnings, "{expression}");
}

#[test]
fn operators_bind_as_they_should() {
    for (expression, value) in [
        ("-2^2", 4.0),
        ("2^-2^2", 16.0),
        ("2^-2", 0.25),
        ("2^3^2", 512.0),
        ("2*3/4*5", 7.5),
        ("2*-3", -6.0),
        ("2--3", 5.0),
        ("2^+3", 8.0),
        ("8-4-2", 2.0),
        ("8/4/2", 1.0),
        ("12/(2*3)", 2.0),
        ("1+{a{b}c}2", 3.0),
        ("1.", 1.0),
        ("1e400", f64::INFINITY),
        ("1e308*10", f64::INFINITY),
        ("0^0", 1.0),
        ("\t( 1 \r\n+ 2 ) ", 3.0),
    ] {
        check(expression, value, &[]);
    }
}

#[test]
fn library_functions_give_their_values() {
    for (expression, value) in [
        ("if(0,1,2)", 2.0),
        ("if(1e-300,1,2)", 1.0),
        ("if(1,2)", 2.0),
        ("if(1,2,3,4)", 2.0),
        ("if ( 1 , 2 , 3 )", 2.0),
        ("select(0,5,6,7)", 3.0),
        ("select(1.5,5,6,7)", 6.0),
        ("select(.49,5,6)", 2.0),
        ("select(.5,5,6)", 5.0),
        ("select(-.5,5,6)", 2.0),
        ("select(3,5,6,7)", 7.0),
        ("min(3,1,2)", 1.0),
        ("max(3,1,4,2)", 4.0),
        ("min(3)", 3.0),
        ("floor(-1.5)", -2.0),
        ("ceil(-1.5)", -1.0),
        ("atan2(1,-1)", 2.35619449),
        ("atan2(0,0)", 0.0),
        ("atan2(0,-1)", std::f64::consts::PI),
        ("atan2(-0,-1)", -std::f64::consts::PI),
        ("log10(1000)", 3.0),
        ("acos(-1)+asin(1)+atan(1)", std::f64::consts::PI * 1.75),
        ("exp(log(5))+sqrt(9)+sin(0)+cos(0)+tan(0)", 9.0),
        ("rand(0)", 0.954473516),
        ("rand(12345.678)", 0.231398127),
        ("rand(1e15)", 0.0),
    ] {
        check(expression, value, &[]);
    }
}

#[test]
fn failed_operations_count_as_zero_and_spoil_what_encloses_them() {
    let zero = "Division by zero";
    check("1+1/0", 1.0, &[zero]);
    check("1/0+sin(1)", 0.841470985, &[zero]);
    check("cos(1/0)", 0.0, &[zero, "cos(): range error"]);
    check("floor(1/0)", 0.0, &[zero, "floor(): range error"]);
    check("rand(1/0)", 0.0, &[zero, "rand(): range error"]);
    check("1/(1/0)", 0.0, &[zero, zero]);
    check("(1/0)*(1/0)", 0.0, &[zero, zero]);
    check("select(4,5,6,7)", 0.0, &["select(): domain error"]);
    check("select(4,5,6,7)+1", 1.0, &["select(): domain error"]);
    check("cos(select(9,1))", 0.0, &["select(): domain error", "cos(): domain error"]);
    check("select(1/0,1,2,3)", 0.0, &[zero, "select(): range error"]);
    check("select(1,1/0)", 0.0, &[zero, "select(): range error"]);
    check("if(1/0,1,2)", 0.0, &[zero, "if(): range error"]);
    check("if(1,1/0,2)", 0.0, &[zero, "if(): range error"]);
    check("if(1/0+sin(1)-1,1,2)", 2.0, &[zero]);
    check("min(1/0,sin(1))", 0.0, &[zero]);
    check("min(sin(1),1/0)", 0.0, &[zero, "min(): range error"]);
    check("max(5,1/0)", 0.0, &[zero, "max(): range error"]);
    check("atan2(1/0,sin(1))", 0.0, &[zero, "atan2(): range error"]);
    check("atan2(sin(1),1/0)", std::f64::consts::FRAC_PI_2, &[zero]);
    check("(1/0)^sin(1)", 0.0, &[zero, "Illegal power"]);
    check("sin(1)^(1/0)", 1.0, &[zero]);
    check("2^3^(1/0)", 0.0, &[zero, "Illegal power", "Illegal power"]);
}

#[test]
fn values_that_no_number_holds_are_errors() {
    check("sqrt(-1)", 0.0, &["sqrt(): domain error"]);
    check("log(0)", 0.0, &["log(): range error"]);
    check("exp(1000)", 0.0, &["exp(): range error"]);
    check("exp(-1000)", 0.0, &[]);
    check("(-8)^(1/3)", 0.0, &["Illegal power"]);
    check("(-8)^(sin(1)/sin(1)/3)", 0.0, &["Illegal power"]);
    check("0^-1", 0.0, &["Illegal power"]);
    check("sin(1e400)", 0.0, &["sin(): domain error"]);
    check("cos(sqrt(-1))", 0.0, &["sqrt(): domain error", "cos(): domain error"]);
    check("atan2(sin(1),sqrt(-1))", std::f64::consts::FRAC_PI_2, &["sqrt(): domain error"]);
    check("atan2(sqrt(-1),sin(1))", 0.0, &["sqrt(): domain error", "atan2(): domain error"]);
}

#[test]
fn bad_text_is_shown_with_a_caret() {
    for (expression, message) in [
        ("--3", "--3\n ^ unexpected character"),
        ("-+3", "-+3\n ^ unexpected character"),
        ("1{a}2", "1{a}2\n    ^ unexpected character"),
        (".", ".\n^ badly formed number"),
        ("1e", "1e\n ^ missing exponent"),
        ("x", "x\n^ '(' expected"),
        ("sin 3", "sin 3\n    ^ '(' expected"),
        ("min()", "min()\n    ^ unexpected character"),
        ("3 4", "3 4\n  ^ unexpected character"),
        ("{", "{\n^ '}' expected"),
        ("1 }", "1 }\n  ^ unexpected character"),
        ("f(", "f(\n ^ unexpected character"),
        ("(1", "(1\n ^ ')' expected"),
        ("1+", "1+\n ^ unexpected character"),
        ("", "\n^ unexpected character"),
        (" ", " \n^ unexpected character"),
        ("if(1,2,3)(4)", "if(1,2,3)(4)\n         ^ unexpected character"),
        ("$1", "$1\n^ unexpected character"),
    ] {
        assert_eq!(ev(expression).unwrap_err(), message);
    }
}

#[test]
fn what_is_missing_ends_the_run() {
    for (expression, message) in [
        ("if(0,2)", "if(): too few arguments"),
        ("atan2(1)", "atan2(): too few arguments"),
        ("foo(1)", "foo(): undefined function"),
        ("a`b(1)", "a`b(): undefined function"),
        ("noise3(1,2,3)", "noise3(): undefined function"),
    ] {
        assert_eq!(ev(expression).unwrap_err(), message, "{expression}");
    }
}
