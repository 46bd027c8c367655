//! Expressions on rays: contexts, the prelude, real arguments, messages (function-files.md 4, 11, 17.3).

use ambit_cal::{CHANNELS, Channel, ChannelSet, Context, Flag, Inputs, Library, Scratch};

/// The probe ray of the specification: it arrives at (8, .25, 0) on a horizontal surface.
fn probe() -> [f64; CHANNELS] {
    use Channel::{Dx, Dy, Dz, Ix, Jy, Kz, Nx, Ny, Nz, Px, Py, Pz, Rdot, S, T, Ts};
    let mut channels = [0.0; CHANNELS];
    for (channel, value) in [
        (Dx, 0.6),
        (Dy, 0.0),
        (Dz, -0.8),
        (Nx, 0.0),
        (Ny, 0.0),
        (Nz, 1.0),
        (Px, 8.0),
        (Py, 0.25),
        (Pz, 0.0),
        (T, 12.5),
        (Ts, 12.5),
        (Rdot, 0.8),
        (S, 1.0),
        (Ix, 1.0),
        (Jy, 1.0),
        (Kz, 1.0),
    ] {
        channels[channel as usize] = value;
    }
    channels
}

/// Values of expressions of one primitive, in the order given, and what its flag and warnings were.
fn values(
    library: &mut Library,
    file: &str,
    expressions: &[&str],
    reals: &[f64],
) -> Result<(Vec<f64>, Flag, Vec<String>), String> {
    let context = Context::of_file(file);
    let channels = probe();
    let mut scratch = Scratch::new();
    let mut results = Vec::new();
    let mut programs = Vec::new();
    for expression in expressions {
        programs.push(library.compile(expression, &context, "colorfunc \"pat\"").map_err(|error| error.to_string())?);
    }
    let mut pass = scratch.pass(Inputs { channels: &channels, reals });
    for program in &programs {
        results.push(pass.eval(program).map_err(|fault| fault.to_string())?);
    }
    let flag = pass.flag();
    Ok((results, flag, scratch.drain_warnings().map(|warning| warning.to_string()).collect()))
}

fn check(expressions: &[&str], reals: &[f64], expected: &[f64]) {
    let mut library = Library::renderer().unwrap();
    let (results, flag, warnings) = values(&mut library, ".", expressions, reals).unwrap();
    assert_eq!((flag, warnings), (Flag::Clear, vec![]), "{expressions:?}");
    for ((value, expected), expression) in results.iter().zip(expected).zip(expressions) {
        let close = (value - expected).abs() <= 2e-6 * expected.abs().max(1e-3);
        assert!(close, "{expression} = {value}, not {expected}");
    }
}

#[test]
fn channels_and_their_names_are_the_same() {
    check(&["Px", "Py", "Pz", "$1", "$7", "$11"], &[], &[8.0, 0.25, 0.0, 0.6, 8.0, 0.8]);
    check(&["T", "Ts", "Rdot", "Dx", "Dz", "Nz", "S", "Ix"], &[], &[12.5, 12.5, 0.8, 0.6, -0.8, 1.0, 1.0, 1.0]);
}

#[test]
fn programs_tell_what_they_read() {
    let mut library = Library::renderer().unwrap();
    let mut read = |text: &str| library.compile(text, &Context::GLOBAL, "").unwrap().channels();
    assert_eq!(read("Px+sin(Dz)*$2"), ChannelSet::of(&[Channel::Px, Channel::Dz, Channel::Dy]));
    assert_eq!(read("D(1)"), ChannelSet::of(&[Channel::Dx, Channel::Dy, Channel::Dz]));
    assert_eq!(read("3*PI"), ChannelSet::EMPTY);
    assert!(read("Idz").contains(Channel::RdotP) && read("CrP").intersects(ChannelSet::MATERIAL));
    assert_eq!(library.compile("3*PI", &Context::GLOBAL, "").unwrap().constant(), Some(3.0 * std::f64::consts::PI));
    assert!(library.compile("A1", &Context::GLOBAL, "").unwrap().reads_reals());
}

#[test]
fn real_arguments_are_found_by_number() {
    check(&["arg(2.6)", "arg(-3)", "A2", "AC", "arg(A1-4)"], &[5.0, 6.0, 7.0], &[7.0, 3.0, 6.0, 3.0, 5.0]);
    let mut library = Library::renderer().unwrap();
    let missing = values(&mut library, ".", &["A4"], &[5.0, 6.0, 7.0]).unwrap_err();
    assert_eq!(missing, "missing real argument 4");
}

#[test]
fn the_prelude_has_radiances_values() {
    check(&["mod(-7,3)", "tri(3,2)", "frac(-1.25)"], &[], &[2.0, 1.0, 0.75]);
    check(
        &["hermite(1,2,.5,-1,.25)", "bezier(1,4,2,0,.25)", "bspline(1,4,2,0,.25)"],
        &[],
        &[1.273438, 2.390625, 3.148438],
    );
    check(&["unif2norm(.975)", "nrand(2)", "erf(.5)", "erf(.5)+erfc(.5)"], &[], &[1.960395, 0.6196862, 0.5204999, 1.0]);
    check(
        &["turbulence(.1,.2,.3,.25)", "turbulencex(.1,.2,.3,.25)", "fade(1,.5,2)"],
        &[],
        &[0.3867973, -1.777058, 0.6],
    );
    check(&["and(1,-2)", "or(-1,-2)", "xor(1,1)"], &[], &[-2.0, -2.0, -1.0]);
    check(&["Exp(-101)", "Sqrt(-4)", "Acos(2)"], &[], &[0.0, 0.0, 0.0]);
    check(&["grey(.1,.2,.3)", "clip(2)", "noneg(-2)"], &[], &[0.1799737, 1.0, 0.0]);
    check(&["cross(2,D,N)", "dot(D,N)", "D(3)"], &[], &[-0.6, -0.8, -0.8]);
    check(&["U", "V"], &[], &[8.0, 0.25]);
    check(&["DEGREE*180", "FTINY", "sgn(-3)", "sgn(0)", "abs(-2)"], &[], &[std::f64::consts::PI, 1e-7, -1.0, 0.0, 2.0]);
    check(&["linterp(.25,2,4)", "inside(1,2,4)", "inside(1,5,4)", "not(1)"], &[], &[2.5, 2.0, -1.0, -1.0]);
    check(&["red(1,2,3)", "green(1,-2,3)", "clip_b(1,2,3)", "clipgrey(9,9,9)"], &[], &[1.0, 0.0, 1.0, 1.0]);
    check(&["Atan2(0,0)", "Atan2(1,-1)", "bound(1,0,2)", "bound(1,3,2)"], &[], &[0.0, 2.35619449, 1.0, 2.0]);
    check(&["turbulencey(.1,.2,.3,2)", "unif2norm(.5)"], &[], &[0.0, -1.01e-7]);
}

#[test]
fn the_preludes_frames_follow_the_surface() {
    let mut library = Library::renderer().unwrap();
    let mut value = |expression: &str, set: &[(Channel, f64)], reals: &[f64]| {
        let program = library.compile(expression, &Context::GLOBAL, "").unwrap();
        let mut channels = [0.0; CHANNELS];
        for (channel, value) in set {
            channels[*channel as usize] = *value;
        }
        Scratch::new().pass(Inputs { channels: &channels, reals }).eval(&program).unwrap()
    };
    // The probe through `-rx 90`.
    let upright = [(Channel::Px, 8.0), (Channel::Pz, -0.25), (Channel::Ny, 1.0)];
    assert_eq!((value("U", &upright, &[]), value("V", &upright, &[])), (-8.0, -0.25));
    // A BRTDfunc on a floor with up vector (.3,.5,.7), ray (.6,.1,-.8): what rtrace printed.
    let n = 1.01_f64.sqrt();
    let (x, y, z) = ((Channel::Dx, 0.6 / n), (Channel::Dy, 0.1 / n), (Channel::Dz, -0.8 / n));
    let floor = [x, y, z, (Channel::NzP, 1.0), (Channel::RdotP, 0.8 / n)];
    let reals = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.5, 0.7];
    for (expression, printed) in [
        ("Idx+2", 1.607511),
        ("Idy+2", 1.539252),
        ("Idz", 0.7960297),
        ("Ldx(1,2,3)+5", 7.229482),
        ("Ldy(1,2,3)+5", 4.828501),
        ("Ldz(1,2,3)", 3.0),
    ] {
        let value = value(expression, &floor, &reals);
        assert!((value - printed).abs() < 1e-6, "{expression} = {value}, not {printed}");
    }
}

#[test]
fn programs_and_scratches_go_to_other_threads() {
    fn shared<T: Send + Sync>(_: &T) {}
    let program = Library::renderer().unwrap().compile("U*A1", &Context::GLOBAL, "").unwrap();
    shared(&program);
    shared(&Scratch::new());
}

#[test]
fn near_field_functions_have_radiances_values() {
    let reals = [3.0, 4.0, 5.0, 6.0];
    check(&["source_corr(2,1)", "source_theta(0)", "source_phi(360)"], &reals, &[7.5, 143.1301, 180.0]);
    check(&["source_corr(2,2)", "source_corr(2,3)", "source_corr(2,4)"], &reals, &[0.1764706, 0.5357143, 0.2720706]);
    check(
        &["source_phi(180)", "source_phi(90)", "source_corr(2,0)", "source_corr(-2,9)"],
        &reals,
        &[180.0, 0.0, 6.0, 0.0],
    );
    let mut library = Library::renderer().unwrap();
    let missing = values(&mut library, ".", &["source_corr(2,4)"], &[1.0, 2.0]).unwrap_err();
    assert_eq!(missing, "missing real argument(s)");
    assert!(values(&mut library, ".", &["source_corr(2,5)"], &reals).unwrap_err().contains("source_corr"));
    assert!(values(&mut library, ".", &["source_phi(45)"], &reals).unwrap_err().contains("source_phi"));
    assert_eq!(values(&mut library, ".", &["fprism_val(1,1,1)"], &reals).unwrap_err(), "missing real argument 5");
}

#[test]
fn only_the_last_error_counts_for_the_primitive() {
    let mut library = Library::renderer().unwrap();
    // Blue, green, red: the order in which Radiance evaluates a colorfunc.
    let (colour, flag, warnings) = values(&mut library, ".", &["3", "2", "1/(Px-8)"], &[]).unwrap();
    assert_eq!((colour, flag, warnings), (vec![3.0, 2.0, 0.0], Flag::Range, vec!["Division by zero".to_owned()]));
    let (colour, flag, _) = values(&mut library, ".", &["3", "1/(Px-8)", "sin(Px)"], &[]).unwrap();
    assert_eq!((colour, flag), (vec![3.0, 0.0, 8.0_f64.sin()], Flag::Clear));
    // The first use of A1 calls arg(), which clears the flag; later uses find the value.
    let (_, flag, _) = values(&mut library, ".", &["1/(Px-8)*A1"], &[1.0]).unwrap();
    assert_eq!(flag, Flag::Clear);
    let (_, flag, _) = values(&mut library, ".", &["A1", "1/(Px-8)*A1"], &[1.0]).unwrap();
    assert_eq!(flag, Flag::Range);
    let (_, flag, warnings) = values(&mut library, ".", &["noise3(1/(Px-8),sin(Px),1)"], &[]).unwrap();
    assert_eq!((flag, warnings.len()), (Flag::Clear, 1));
    let (_, flag, warnings) = values(&mut library, ".", &["noise3(sin(Px),1,1/(Px-8))"], &[]).unwrap();
    assert_eq!((flag, warnings.len()), (Flag::Range, 2));
}

#[test]
fn a_file_binds_names_in_its_own_order() {
    let mut library = Library::renderer().unwrap();
    let text = b"first=sq(3); sq(x)=x+1; second=sq(3); third=`sq(3);";
    library.load_file("sq.cal", "./sq.cal", text).unwrap();
    let (results, ..) = values(&mut library, "sq.cal", &["first", "second", "third"], &[]).unwrap();
    assert_eq!(results, [9.0, 4.0, 4.0]);
    assert!(library.is_loaded("sq") && library.is_loaded("sq.CAL") && !library.is_loaded("./sq.cal"));
    let (results, ..) = values(&mut library, ".", &["sq(3)", "second`sq"], &[]).unwrap();
    assert_eq!(results, [9.0, 4.0]);
    let undefined = values(&mut library, ".", &["second"], &[]).unwrap_err();
    assert_eq!(undefined, "second: undefined variable");
    library.load_file("g.cal", "g.cal", b"shared`=7; own=shared+later; later=1;").unwrap();
    let (results, ..) = values(&mut library, ".", &["shared", "own`g"], &[]).unwrap();
    assert_eq!(results, [7.0, 8.0]);
}

#[test]
fn undefined_names_are_shown_qualified() {
    let mut library = Library::renderer().unwrap();
    library.load_file("k4.cal", "./k4.cal", b"w=3;").unwrap();
    assert_eq!(values(&mut library, "k4.cal", &["q"], &[]).unwrap_err(), "q`k4: undefined variable");
    assert_eq!(values(&mut library, "k4.cal", &["w`x"], &[]).unwrap_err(), "w`x`k4: undefined variable");
    assert_eq!(values(&mut library, "k4.cal", &["zz(1)"], &[]).unwrap_err(), "zz`k4(): undefined function");
    assert_eq!(values(&mut library, ".", &["$28"], &[]).unwrap_err(), "illegal channel number");
    assert_eq!(values(&mut library, ".", &["if(1,2,$28)"], &[]).unwrap().0, [2.0]);
}

#[test]
fn bad_files_and_arguments_are_shown_with_place_line_and_caret() {
    let mut library = Library::renderer().unwrap();
    let mut load = |text: &str| library.load_file(text, "./bad.cal", text.as_bytes()).unwrap_err();
    let error = load("a=1;\nb=2 3;\n");
    assert_eq!((error.line, error.column), (2, 5));
    assert_eq!(error.to_string(), "./bad.cal, line 2:\nb=2 3;\n    ^ ';' expected");
    for (text, message) in [
        ("{ c }\nx(a) = a +\n  (a;\n", "./bad.cal, line 3:\n  (a;\n    ^ ')' expected"),
        ("a=(1\n", "./bad.cal, line 1:\na=(1\n    ^ ')' expected"),
        ("a=1;{ xx\n bb\n", "./bad.cal, line 2:\n bb\n   ^ '}' expected"),
        ("$1=3;", "./bad.cal, line 1:\n$1=3;\n^ illegal variable name"),
        ("v : 1/0; w=3;", "./bad.cal, line 1:\nv : 1/0; w=3;\n       ^ bad constant expression"),
        (
            "f(x):x*Px; v=f(2);",
            "./bad.cal, line 1:\nf(x):x*Px; v=f(2);\n                 ^ ray parameter used in constant expression",
        ),
        ("f(x):x*arg(1); v=f(2);", "bad call to arg(n) - illegal constant in .cal file?"),
    ] {
        assert_eq!(load(text).to_string(), message);
    }
    let mut compile = |text: &str| values(&mut library, ".", &[text], &[]).unwrap_err();
    assert_eq!(compile("1+"), "colorfunc \"pat\":\n1+\n ^ unexpected character");
    assert_eq!(compile("1 + )"), "colorfunc \"pat\":\n1 + )\n    ^ unexpected character");
    assert_eq!(compile("Px/0"), "colorfunc \"pat\":\nPx/0\n   ^ divide by zero constant");
}

/// Radiance goes on with a value that is none; only a ray that comes by it notices.
#[test]
fn constants_without_a_value_are_left_to_rays() {
    for text in
        ["sqrt(-1)", "log(0)", "asin(2)", "exp(1000)", "0^(-1)", "(-1)^.5", "floor(sqrt(-1))", "root(-1)", "c", "-d"]
    {
        let mut library = Library::renderer().unwrap();
        let file = format!("c:log(-2);d:c*2;root(x):sqrt(x);f={text};g=if(1,2,{text});h:{text};i=h;");
        library.load_file("v.cal", "./v.cal", file.as_bytes()).unwrap();
        assert_eq!(library.drain_messages().count(), 0, "{text}");
        let (numbers, flag, warnings) = values(&mut library, "v.cal", &["g"], &[]).unwrap();
        assert_eq!((&numbers[..], flag, warnings.len()), (&[2.0][..], Flag::Clear, 0), "{text}");
        for bad in ["f", "i"] {
            let (_, flag, warnings) = values(&mut library, "v.cal", &[bad], &[]).unwrap();
            assert!(flag != Flag::Clear && !warnings.is_empty(), "{text}: {flag:?} {warnings:?}");
        }
    }
}

#[test]
fn constants_that_need_a_ray_are_refused_where_used() {
    let mut library = Library::renderer().unwrap();
    library.load_file("k.cal", "./k.cal", b"k : Px;").unwrap();
    assert_eq!(library.drain_messages().collect::<Vec<_>>(), ["k`k: assigned non-constant value"]);
    let message = values(&mut library, "k.cal", &["k"], &[]).unwrap_err();
    assert_eq!(message, "colorfunc \"pat\":\nk\n^ ray parameter used in constant expression");
}

#[test]
fn redefinitions_are_noticed_in_files() {
    let mut library = Library::renderer().unwrap();
    library.load_file("k7.cal", "./k7.cal", b"x=3;x=4;sin(x)=2*x;").unwrap();
    assert_eq!(library.drain_messages().collect::<Vec<_>>(), ["x`k7: redefined"]);
    assert_eq!(values(&mut library, "k7.cal", &["x", "sin(1)"], &[]).unwrap().0, [4.0, 2.0]);
    library.load_file("k8.cal", "./k8.cal", b"x:3;x:4;w=sin(3);`sin(x)=2*x").unwrap();
    assert_eq!(library.drain_messages().collect::<Vec<_>>(), ["x`k8: constant redefined"]);
    let (results, ..) = values(&mut library, "k8.cal", &["w", "sin(1)"], &[]).unwrap();
    assert_eq!(results, [3.0_f64.sin(), 2.0]);
}

#[test]
fn functions_are_called_with_values_given_at_run_time() {
    let mut library = Library::renderer().unwrap();
    library.define("rf(x,y,z,o)=arg(5)*o+z*z*Ts; two(a,b)=a;").unwrap();
    let brdf = library.function("rf", 4, &Context::GLOBAL);
    assert_eq!(library.parameters("rf", &Context::GLOBAL), Some(4));
    assert_eq!(library.parameters("noop", &Context::of_file("some.cal")), Some(1));
    assert_eq!(library.parameters("min", &Context::GLOBAL), Some(1));
    assert_eq!(library.parameters("nothing", &Context::GLOBAL), None);
    let short = library.function("rf", 3, &Context::GLOBAL);
    let none = library.function("2*3", 1, &Context::GLOBAL);
    let sine = library.function("sin", 1, &Context::GLOBAL);
    let channels = probe();
    let mut scratch = Scratch::new();
    let mut pass = scratch.pass(Inputs { channels: &channels, reals: &[0.5, 0.4, 0.3, 0.2, 7.0] });
    assert_eq!(pass.call(&brdf, &[0.0, 0.0, 0.5, 0.01]).unwrap(), 7.0 * 0.01 + 0.25 * 12.5);
    assert_eq!(pass.call(&brdf, &[0.0, 0.0, 1.0, 0.0]).unwrap(), 12.5);
    assert_eq!(pass.call(&sine, &[1.0]).unwrap(), 1.0_f64.sin());
    assert_eq!(pass.call(&short, &[0.0; 3]).unwrap_err().to_string(), "rf(): too few arguments");
    assert_eq!(pass.call(&none, &[0.0]).unwrap_err().to_string(), "2*3(): undefined function");
}

#[test]
fn variables_are_computed_once_a_pass_and_anew_in_the_next() {
    let mut library = Library::renderer().unwrap();
    library.load_file("n.cal", "n.cal", b"n=n+1; v=1/(Px-8); w=v+v;").unwrap();
    let context = Context::of_file("n.cal");
    let n = library.compile("n", &context, "").unwrap();
    let w = library.compile("w+v", &context, "").unwrap();
    let channels = probe();
    let inputs = Inputs { channels: &channels, reals: &[] };
    // Three rays through two patterns of the same file, as a chain evaluates them: 1·2, 3·4, 5·6.
    let mut scratch = Scratch::with_history();
    let mut next = || scratch.pass(inputs).eval(&n).unwrap();
    let products: Vec<f64> = (0..3).map(|_| next() * next()).collect();
    assert_eq!(products, [2.0, 12.0, 30.0]);
    // Without a history values do not depend on what came before.
    let mut scratch = Scratch::new();
    for _ in 0..3 {
        let mut pass = scratch.pass(inputs);
        assert_eq!((pass.eval(&n).unwrap(), pass.eval(&n).unwrap()), (1.0, 1.0));
        pass.eval(&w).unwrap();
        pass.eval(&w).unwrap();
        assert_eq!(scratch.drain_warnings().count(), 1, "v is computed once");
    }
}

#[test]
fn what_materials_set_is_found_in_any_context() {
    let mut library = Library::renderer().unwrap();
    library.load_file("m.cal", "m.cal", b"mine=CrP+NxP+DzA; CgP=5; green=CgP;").unwrap();
    let context = Context::of_file("m.cal");
    let program = library.compile("mine", &context, "").unwrap();
    assert_eq!(program.channels(), ChannelSet::of(&[Channel::CrP, Channel::NxP, Channel::DzA]));
    assert_eq!(library.compile("green", &context, "").unwrap().channels(), ChannelSet::EMPTY);
}
