//! No text makes the reader, the compiler or the machine panic.

use ambit_cal::{CHANNELS, Context, Host, Inputs, Library, Scratch};
use proptest::prelude::*;

/// Reads a text as a file, then compiles and runs its names and itself as an expression.
fn exercise(text: &[u8]) {
    for host in [Host::Renderer, Host::Calculator, Host::Expression] {
        let mut library = match host {
            Host::Renderer => Library::renderer().unwrap(),
            _ => Library::new(host),
        };
        let loaded = library.load_file("a.cal", "a.cal", text);
        if let Err(error) = &loaded {
            assert!(!error.to_string().is_empty());
        }
        let context = Context::of_file("a.cal");
        let mut programs = Vec::new();
        for name in ["a", "b", "a(1)", "b(a)", "f(a,b)", "f(f,1)", "Px"] {
            programs.extend(library.compile(name, &context, "test"));
        }
        programs.extend(library.compile(&String::from_utf8_lossy(text), &context, "test"));
        programs.extend(library.outputs().into_iter().map(|(_, program)| program));
        let channels = [0.5; CHANNELS];
        let mut scratch = Scratch::new();
        let mut pass = scratch.pass(Inputs { channels: &channels, reals: &[1.0, 2.0] });
        for program in &programs {
            let _ = pass.eval(program);
        }
    }
}

/// Texts made of the language's own words, which get further than random bytes. Calls never nest two of the recursive
/// kind in one sum, so that nothing runs for ages.
fn words() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "a", "b", "f", "f(", "g(", "x", "y", "1", "0", ".5", "2e3", "+", "-", "*", "/", "^", "(", ")", ",", "=", ":",
        ";", "a=", "b:", "f(x,y)=", "f(x):", "g(x)=", "if(", "select(", "min(", "atan2(", "rand(", "noise3(", "arg(",
        "$1", "$0", "$3=", "Px", "A1", "PI", "CrP", "sin", "{", "}", " ", "\n", "`", "a`", "`b",
    ]);
    prop::collection::vec(word, 0..40).prop_map(|words| words.concat())
}

/// Well-formed expressions over these leaves and functions of one and of three arguments.
fn expression(
    leaves: &'static [&'static str],
    unary: &'static [&'static str],
    ternary: &'static [&'static str],
) -> impl Strategy<Value = String> {
    let leaf = prop::sample::select(leaves).prop_map(str::to_owned);
    leaf.prop_recursive(5, 40, 4, move |inner| {
        prop_oneof![
            (inner.clone(), prop::sample::select(&["+", "-", "*", "/", "^"][..]), inner.clone())
                .prop_map(|(a, operator, b)| format!("({a}{operator}{b})")),
            inner.clone().prop_map(|a| format!("-({a})")),
            (prop::sample::select(unary), inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            (prop::sample::select(ternary), inner.clone(), inner.clone(), inner)
                .prop_map(|(f, a, b, c)| format!("{f}({a},{b},{c})")),
        ]
    })
}

/// Expressions of variables and functions that [`exercise`]'s text defines.
fn defined() -> impl Strategy<Value = String> {
    let leaves = &["1", "0", ".25", "x", "y", "Px", "A2", "v", "w", "sin", "h"];
    expression(leaves, &["sin", "sqrt", "h", "rand", "x", "floor"], &["if", "select", "max", "g", "noise3"])
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bytes_never_panic(text in prop::collection::vec(any::<u8>(), 0..200)) {
        exercise(&text);
    }

    #[test]
    fn words_never_panic(text in words()) {
        exercise(text.as_bytes());
    }

    #[test]
    fn expressions_never_panic(g in defined(), h in defined(), v in defined(), w in defined(), a in defined()) {
        // h may call g but not itself twice, or it would run for ages.
        let (g, h) = (g.replace("h(", "sin(").replace("g(", "min("), h.replace("h(", "cos("));
        exercise(format!("g(x,y)=if(x,{g},y);h(x)={h};v={v};w={w};a={a};b=1;").as_bytes());
    }

    /// Folding changes no value beyond rounding: what a calculator makes a constant is evaluated step by step where
    /// nothing is folded.
    #[test]
    fn folding_changes_no_value(
        text in expression(&["1", "0", ".25", "3", "-2"], &["sin", "cos", "atan", "exp"], &["min", "max"]),
    ) {
        let text = text.replace("(-2", "((-2)").replace(",-2", ",(-2)").replace("--2", "2");
        let mut scratch = Scratch::new();
        let mut value = |host| {
            let program = Library::new(host).compile(&text, &Context::GLOBAL, "").ok()?;
            let value = scratch.pass(Inputs::default()).eval(&program).ok()?;
            (scratch.drain_warnings().count() == 0).then_some(value)
        };
        // Operands that vanish take their errors with them, and failed constants do not compile.
        if let (Some(plain), Some(folded)) = (value(Host::Expression), value(Host::Calculator)) {
            let close = (plain - folded).abs() <= 1e-9 * plain.abs().max(1.0);
            prop_assert!(close || plain == folded || !plain.is_finite(), "{text}: {plain} {folded}");
        }
    }
}
