//! Definitions, functions and folding, as `rcalc` has them, on the record 3 4 5 (function-files.md 17.2 and 6).

use std::fmt::Write;

use ambit_cal::{Host, Inputs, Library, Scratch};

/// The outputs of a program on some records, and its messages; or the message it ends with.
fn run(text: &str, records: &[&[f64]]) -> Result<(Vec<Vec<f64>>, Vec<String>), String> {
    let mut library = Library::new(Host::Calculator);
    library.define(text).map_err(|error| error.to_string())?;
    let programs = library.outputs();
    let mut messages: Vec<String> = library.drain_messages().collect();
    let mut scratch = Scratch::with_history();
    let mut lines = Vec::new();
    for record in records {
        let mut pass = scratch.pass(Inputs { channels: record, reals: &[] });
        let line: Result<Vec<f64>, _> = programs.iter().map(|(_, program)| pass.eval(program)).collect();
        lines.push(line.map_err(|fault| fault.to_string())?);
    }
    messages.extend(scratch.drain_warnings().map(|warning| warning.to_string()));
    Ok((lines, messages))
}

fn check(text: &str, expected: &[f64], messages: &[&str]) {
    let (lines, printed) = run(text, &[&[3.0, 4.0, 5.0]]).unwrap_or_else(|message| panic!("{text}: {message}"));
    let close =
        |(value, expected): (&f64, &f64)| value == expected || (value - expected).abs() <= 1e-8 * expected.abs();
    assert!(lines[0].len() == expected.len() && lines[0].iter().zip(expected).all(close), "{text}: {:?}", lines[0]);
    assert_eq!(printed, messages, "{text}");
}

fn fails(text: &str, message: &str) {
    assert_eq!(run(text, &[&[3.0, 4.0, 5.0]]).unwrap_err(), message, "{text}");
}

#[test]
fn programs_print_what_rcalc_prints() {
    for (text, values) in [
        ("x=2;$1=-x^2", &[4.0][..]),
        ("f(x)=if(x-.5,x*f(x-1),1);$1=f(10)", &[3628800.0]),
        ("f(g,x)=g(x);$1=f(sin,1)", &[0.841470985]),
        ("rep(f,n,x)=if(n-.5,rep(f,n-1,f(x)),x);inc(x)=x+1;$1=rep(inc,5,10)", &[15.0]),
        ("sum(f,i,n)=if(i-n-.5,0,f(i)+sum(f,i+1,n));q(x)=x*x;$1=sum(q,1,10)", &[385.0]),
        ("u(i)=select(i,1,2);d(v,w)=v(1)*w(1)+v(2)*w(2);$1=d(u,in)", &[11.0]),
        ("f(x,y)=x*2;$1=f(3)", &[6.0]),
        ("f(x)=x;f=3;$1=f", &[3.0]),
        ("f(sin)=sin(1);$1=f(cos)", &[0.540302306]),
        ("a(m,n)=if(m-.5,if(n-.5,a(m-1,a(m,n-1)),a(m-1,1)),n+1);$1=a(2,3)", &[9.0]),
        ("x=3;$1=x;x=4", &[4.0]),
        ("y=x*2;x=$1;$1=y", &[6.0]),
        ("rand=3;$1=rand;$2=rand(2)", &[3.0, 0.732379808]),
        ("$1=0/$1;$2=0^$1;$3=$1^0;$4=$1^1", &[0.0, 0.0, 1.0, 3.0]),
        ("$1=in(0);$2=in(2);$3=in(9)", &[3.0, 4.0, 0.0]),
        ("$1=$1-$2-$3;$2=$1/$2/$3;$3=$1-($2-$3);$4=$1^2^.5", &[-6.0, 0.15, 4.0, 4.72880439]),
        ("$3=1;$1=2", &[2.0, 1.0]),
        ("$1=1;$1=2", &[2.0]),
        ("x`=5;$1=`x", &[5.0]),
        ("big(a)=select(a,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15);$1=big(15);$2=big(0)", &[15.0, 15.0]),
        ("f(x)=x;f(x)=x+1;$1=f(1)", &[2.0]),
        ("a:3;f(a)=a+1;$1=f(4)", &[5.0]),
        ("f(x,x)=x;$1=f(1,2)", &[1.0]),
        ("$1=2+-$1", &[-1.0]),
        ("$1=PI;;", &[std::f64::consts::PI]),
        ("f(x):x*$1;$1=f(2)", &[0.0]),
        ("$1=$7", &[0.0]),
    ] {
        check(text, values, &[]);
    }
}

#[test]
fn redefinitions_are_noticed() {
    check("x:3;$1=x;x:4", &[3.0], &["x: constant redefined"]);
    check("x:3;x=4;$1=x", &[4.0], &["x: constant redefined"]);
    check("x=3;x:4;$1=x", &[4.0], &[]);
    check("x:3;x:3;$1=x", &[3.0], &[]);
    check("f(x):x;f(x):x;$1=f($1)", &[3.0], &[]);
    check("x:$1;$1=x", &[0.0], &["x: assigned non-constant value"]);
    check("$1=sin($1);sin(x)=2*x", &[6.0], &["sin: definition hides library function"]);
    check("$1=sin(1);sin(x)=2*x;$2=sin(1)", &[0.841470985, 2.0], &["sin: definition hides library function"]);
}

#[test]
fn programs_fail_as_in_rcalc() {
    fails("f(x,y)=x*y;$1=f(3)", "f(): too few arguments");
    fails("f(x)=x+1;f(x,y)=x+y;$1=f(3)", "f(): too few arguments");
    fails("f(x)=x;f=3;$1=f(5)", "f(): undefined function");
    fails("f(g,x)=g(x);$1=f(2,3)", "f(): argument not a function");
    fails("f(g)=g(1);x=4;$1=f(x)", "x(): undefined function");
    fails("f(g)=g(1);x:4;$1=f(x)", "f(): argument not a function");
    fails("f(g)=g;$1=f(sin)", "sin: undefined variable");
    fails("f(x):x+1;$1=f(sin)", "sin: undefined variable");
    fails("$1=rand", "rand: undefined variable");
    fails("y:x*3;$1=y;x:2", "x: undefined variable");
    fails("$1=$0", "illegal channel number");
    fails("$1=1e5x", "$1=1e5x\n      ^ ';' expected");
    fails("$1=1;\n $2=3 4", "$1=1;\n $2=3 4\n            ^ ';' expected");
    fails("x=2;x(3)=4", "x=2;x(3)=4\n      ^ illegal parameter name");
    fails("f(n)=f(n+1);$1=f(1)", "function calls nested too deep");
}

#[test]
fn constants_are_folded_while_reading() {
    fails("$1=1/0", "$1=1/0\n     ^ bad constant expression");
    fails("$1=$1/0", "$1=$1/0\n      ^ divide by zero constant");
    fails("$1=$1*1*(1/0)", "$1=$1*1*(1/0)\n            ^ bad constant expression");
    fails("$1=if(1,2,$1/0)", "$1=if(1,2,$1/0)\n              ^ divide by zero constant");
    fails("$1=select(9,1,2)", "$1=select(9,1,2)\n               ^ bad constant expression");
    // Operands that vanish take their errors with them.
    check("$1=0*x(3)", &[0.0], &[]);
    check("$1=1^$1+1^(1/$7)", &[2.0], &[]);
    // Constants of nested sums and products are combined, which shows where they would overflow or cancel.
    for (text, value) in [
        ("$1=(($1+1)+1e20)-1e20", 3.0),
        ("$1=1e20+$1-1e20", 3.0),
        ("$1=($1+1e20)+($2-1e20)", 7.0),
        ("$1=-($1+1e20)+1e20", 0.0),
        ("$1=$1-($2+1e20)+1e20", 0.0),
        ("$1=1e20-$1-1e20", 0.0),
        ("$1=1e20*$1*1e300*1e-300", f64::INFINITY),
        ("$1=$1*1e300*1e-300*1e300*1e-300", 3.0),
        ("$1=($1*1e300)*($2*1e-300)", 12.0),
        ("x=$1*1e300;$1=x*1e300*1e-300", 3e300),
        ("$1=floor(.3/.1)", 2.0),
        ("$1=floor($1/10/.1)", 3.0),
    ] {
        check(text, &[value], &[]);
    }
}

#[test]
fn a_variable_that_refers_to_itself_sees_its_last_value() {
    let (lines, _) = run("a=a+$1;$1=a", &[&[1.0], &[2.0], &[3.0]]).unwrap();
    assert_eq!(lines, [[1.0], [3.0], [6.0]]);
    let (lines, _) = run("a=b+1;b=a*10;$1=a", &[&[0.0], &[0.0]]).unwrap();
    assert_eq!(lines[0], [1.0], "mutual recursion ends");
}

#[test]
fn deep_recursion_needs_no_stack() {
    check("f(n)=if(n-.5,1+f(n-1),0);$1=f(30000)", &[30000.0], &[]);
    check("f(n,x)=if(n-.5,f(n-1,x+n),x);$1=f(20000,0)", &[200010000.0], &[]);
}

#[test]
fn arguments_are_evaluated_when_needed_and_once() {
    // Were they evaluated early, the division would warn; were they evaluated twice, it would warn twice.
    check("f(a,b)=if(a,1,b);$1=f(1,1/($1-3))", &[1.0], &[]);
    check("f(a)=a+a*a;$1=f(1/($1-3))", &[0.0], &["Division by zero"]);
    check("g(a)=a+a;f(c,a)=c*a+g(a);$1=f($1,1/($1-3))", &[0.0], &["Division by zero"]);
    check("g(a)=select(1,a)+a;f(c,a)=c+g(a);$1=f($1,rand($1)*3)", &[4.9101551], &[]);
    let spoilt = &["Division by zero", "if(): range error"][..];
    check("f(c,a)=if(c,a,2*a)+a;$1=f($1,1/($1-3))", &[0.0], spoilt);
    check("g(a)=a+a;f(c,a)=if(c,g(a),0);$1=f($1,1/($1-3))", &[0.0], spoilt);
    check(
        "f(n,a)=if(n-.5,f(n-1,a)+a,a);$1=f(1,1/($1-3))",
        &[0.0],
        &["Division by zero", "if(): range error", "if(): range error"],
    );
    check("f(a,b,c,d,e,f,g,h,i,j,k,l)=k+l+k;$1=f(1,2,3,4,5,6,7,8,9,10,$1,$2)", &[10.0], &[]);
}

#[test]
fn many_calls_within_each_other_compile_to_bounded_code() {
    let mut text = String::from("f0(x)=x+1;");
    for k in 1..40 {
        write!(text, "f{k}(x)=if(x,f{}(x)-f{}(x+1),x);", k - 1, k - 1).unwrap();
    }
    check(&format!("{text}$1=f39(-$1)"), &[-3.0], &[]);
    // Each level selects one of the two calls, so only the size of the code could explode.
    let mut text = String::from("g0(x)=x+1;");
    for k in 1..60 {
        write!(text, "g{k}(x)=if(x-$1,g{}(x-1),g{}(x+1));", k - 1, k - 1).unwrap();
    }
    let (lines, _) = run(&format!("{text}$1=g59(0)"), &[&[3.0]]).unwrap();
    assert_eq!(lines[0], [4.0]);
}
