"""Random expressions of the function-file language, finite for all finite arguments, and files of definitions."""

# What a ray tells. T is left out where nothing should depend on the eye.
RAY = ["Px", "Py", "Pz", "Nx", "Ny", "Nz", "Dx", "Dy", "Dz", "Rdot"]
# Continuous, so that rays close by get answers close by; names of one argument.
SMOOTH = ["sin", "cos", "atan", "abs", "sq1", "clip", "noneg", "erf", "ssqrt", "slog", "sexp"]
STEPS = ["floor", "ceil", "sgn", "frac", "rand", "not"]
# Not of the library: helpers that keep what may fail within its range.
HELPERS = "sq1(x) = x*x; ssqrt(x) = sqrt(abs(x)); slog(x) = log(1+abs(x)); sexp(x) = exp(bound(-5,x,2));\n"


def expression(dice, names, depth=3, functions=()):
    """An expression of these names; `functions` are pairs of a name and its number of arguments."""
    if depth <= 0 or dice.chance(0.12):
        return _leaf(dice, names)
    inner = lambda less=1: expression(dice, names, depth - less, functions)
    kind = dice.choice(["sum", "sum", "product", "product", "ratio", "power", "smooth", "smooth", "step", "pick", "blend", "call", "noise", "sign"])
    if kind == "sum":
        return f"{inner()}{dice.choice(['+', '-', ' + ', ' - '])}({inner()})"
    if kind == "product":
        return f"({inner()}){dice.choice(['*', ' * '])}({inner()})"
    if kind == "ratio":
        return f"({inner()})/(1.5+sq1({inner()}))"
    if kind == "power":
        return dice.choice([f"({inner()})^2", f"(.1+abs({inner()}))^{dice.real(-1, 2, 2)}", f"-({inner()})^2", f"2^clip({inner()})^2"])
    if kind == "smooth":
        return f"{dice.choice(SMOOTH)}({inner()})"
    if kind == "step":
        return f"{dice.choice(STEPS)}({inner()})"
    if kind == "pick":
        cases = [inner(2) for _ in range(dice.randint(2, 4))]
        return dice.choice([
            f"if({inner()},{cases[0]},{cases[1]})",
            f"select(bound(1,{inner()},{len(cases)}),{','.join(cases)})",
            f"{dice.choice(['min', 'max'])}({','.join(cases)})",
            f"{dice.choice(['and', 'or', 'xor'])}({cases[0]},{cases[1]})",
        ])
    if kind == "blend":
        a, b, c, d, e = (inner(2) for _ in range(5))
        return dice.choice([
            f"linterp({a},{b},{c})", f"hermite({a},{b},{c},{d},clip({e}))", f"bezier({a},{b},{c},{d},clip({e}))",
            f"bspline({a},{b},{c},{d},clip({e}))", f"mod({a},{dice.real(0.3, 2, 2)})", f"tri({a},{dice.real(0.3, 2, 2)})",
            f"fade({a},{b},abs({c}))", f"bound(-1,{a},{dice.real(0, 1, 2)})", f"inside(-1,{a},1)", f"atan2({a},1.5+sq1({b}))",
            f"Acos({a})", f"Asin({a})", f"Atan2({a},{b})", f"Sqrt({a})", f"Exp({a}-3)", f"grey({a},{b},{c})", f"clipgrey({a},{b},{c})",
        ])
    if kind == "call" and functions:
        name, count = dice.choice(functions)
        return f"{name}({','.join(inner(2) for _ in range(count))})"
    if kind == "noise":
        name = dice.choice(["noise3", "noise3x", "noise3y", "noise3z", "fnoise3", "noise3a", "turbulence"])
        more = f",{dice.real(0.1, 0.6, 2)}" if name == "turbulence" else ""
        return f"{name}({','.join(inner(2) for _ in range(3))}{more})"
    return f"{dice.choice(['-', '+'])}{_leaf(dice, names)}" if dice.chance(0.5) else _leaf(dice, names)


def _leaf(dice, names):
    if names and dice.chance(0.7):
        return dice.choice(names)
    return dice.choice(["PI", "DEGREE", ".5", "1.", "2", "1e-1", f"{dice.real(0, 3, 3):g}"])


def within(dice, names, low, high, depth=2, functions=()):
    """An expression whose values lie between two limits, touching neither."""
    text = expression(dice, names, depth, functions)
    return f"{(low + high) / 2:.4g}+{(high - low) / 2:.4g}*sin({text})".replace(" ", "")


def definitions(dice, names, count):
    """Text of a file of `count` definitions; the names of its variables, and of its functions with their numbers of arguments."""
    lines, variables, functions = ["{ Made at random { in nested comments }. }", HELPERS], [], []
    for at in range(count):
        kind = dice.choice(["variable", "variable", "function", "constant", "passed", "recursive"])
        if kind == "variable":
            lines.append(f"v{at} = {expression(dice, [*names, *variables], 3, functions)};")
            variables.append(f"v{at}")
        elif kind == "constant":
            lines.append(f"c{at} : {expression(dice, [], 2)};")
            variables.append(f"c{at}")
        elif kind == "function":
            arguments = dice.choice([["x"], ["x", "y"], ["a", "b", "c"], ["sin", "x"]])
            body = expression(dice, [a for a in arguments if a != "sin"] + dice.some(names, 0.2), 3, functions if "sin" not in arguments else ())
            if "sin" in arguments and "sin(" in body:
                continue
            sign = ":" if not any(name in body for name in [*names, "v"]) and dice.chance(0.5) else "="
            lines.append(f"f{at}({','.join(arguments)}) {sign} {body};")
            functions.append((f"f{at}", len(arguments)))
        elif kind == "passed":
            lines.append(f"g{at}(f,x) = f(x)+f({expression(dice, ['x'], 1)});")
            lines.append(f"v{at} = g{at}({dice.choice(['sin', 'sq1', 'floor', 'abs'])},{expression(dice, names, 1)});")
            variables.append(f"v{at}")
        else:
            lines.append(f"r{at}(n,x) = if(n-.5, .5*x+.5*r{at}(n-1,{expression(dice, ['x'], 1)}), x);")
            lines.append(f"v{at} = r{at}({dice.randint(0, 4)},{expression(dice, names, 1)});")
            variables.append(f"v{at}")
    return "\n".join(lines) + "\n", variables, functions
