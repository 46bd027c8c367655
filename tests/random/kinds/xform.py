"""Commands that transform files: every type of primitive, options, arrays, folders, pipes, commands within files."""

from case import Case, Step
from outputs import same

SURFACES = {"sphere": 4, "bubble": 4, "cone": 8, "cup": 8, "cylinder": 7, "tube": 7, "ring": 8, "source": 4}
# Types whose strings a transform may end, with the least numbers of strings and reals.
MOVED = {
    "texfunc": (4, 0), "texdata": (8, 0), "brightfunc": (2, 0), "brightdata": (4, 0), "colorfunc": (4, 0), "colordata": (8, 0),
    "colorpict": (7, 0), "specfunc": (2, 2), "specdata": (4, 0), "specpict": (5, 0), "mixfunc": (4, 0), "mixdata": (6, 0),
    "mixpict": (7, 0), "plasfunc": (2, 4), "metfunc": (2, 4), "transfunc": (2, 6), "plasdata": (4, 4), "metdata": (4, 4),
    "transdata": (4, 6), "BRTDfunc": (10, 9), "WGMDfunc": (13, 9), "BSDF": (6, 0), "aBSDF": (5, 0), "prism1": (5, 0), "prism2": (9, 0),
    "plastic2": (4, 6), "metal2": (4, 6), "trans2": (4, 8), "ashik2": (4, 8),
}
KEPT = {
    "plastic": (0, 5), "metal": (0, 5), "trans": (0, 7), "glass": (0, 3), "mirror": (0, 3), "light": (0, 3), "illum": (0, 3), "antimatter": (1, 0),
    "spectrum": (0, 5), "specfile": (1, 0), "glow": (0, 4), "spotlight": (0, 7), "dielectric": (0, 5), "interface": (0, 8), "mist": (0, 7),
    "brighttext": (3, 11), "colortext": (2, 15), "mixtext": (4, 9),
}


def make(dice):
    files = {"base.rad": "void plastic m0 0 0 5 .5 .5 .5 0 0\nvoid light m1 0 0 3 1 1 1\n"}
    folder = dice.choice(["", "", "./", "parts/", "parts/deep/"])
    files[folder + "a.rad"] = primitives(dice)
    files["parts/b.rad"] = primitives(dice)
    if dice.chance(0.4):
        inner = dice.choice(["!xform {} b.rad\n", "!cat b.rad | xform {}\n", "!cat b.rad\n", "! xform {} 'b.rad'\n#\n", "!xform {} b.rad b.rad\n"])
        files["parts/c.rad"] = primitives(dice, 2) + inner.format(" ".join(options(dice))) + primitives(dice, 2)
    names = list(files)[1:]
    lines = []
    for _ in range(dice.randint(1, 3)):
        words = " ".join(options(dice))
        name = dice.choice(names)
        lines.append("!" + dice.choice([
            f"xform {words} {name}", f"xform {words} {name}", f' xform {words} "{name}"', f"cat {name} | xform {words}", f"xform {words} < {name}",
            f"xform {words} {name} {dice.choice(names)}", f"xform {words} \\\n\t{name}", f"cat {name}|xform -n q|xform {words}"]))
    if dice.chance(0.05):
        lines.append(dice.choice(["!xform missing.rad", "!xform -q a.rad", "!xform", "!xform -t 1 2 parts/b.rad", "!xform -m", "!xform -s 0 parts/b.rad"]))
    files["scene.rad"] = "\n".join(lines) + "\n"
    return Case(files, [Step("oconv", ["-f", "-w", "base.rad", "scene.rad"], "scene.oct", same)])


def number(dice):
    return dice.choice([0, 1, -1, 0.5, 90, 45, -0.25, dice.uniform(-3, 3), dice.uniform(-3, 3), dice.uniform(-1e-6, 1e-6), dice.uniform(-1e4, 1e4)])


def operations(dice, most=4):
    words = []
    for _ in range(dice.randint(0, most)):
        words += dice.choice([
            ["-t", *(number(dice) for _ in range(3))], ["-r" + dice.choice("xyz"), dice.choice([90, 30, -45, 180, dice.uniform(-360, 360)])],
            ["-s", dice.choice([2, 0.1, -1, 0.0254, dice.uniform(0.5, 3)])], ["-m" + dice.choice("xyz")], ["-i", dice.choice([1, 2, 3, 0])]])
    return words


def options(dice):
    words = []
    if dice.chance(0.3):
        words += ["-n", dice.choice(["n", "left.side", "x_1"])]
    if dice.chance(0.2):
        words += ["-m", dice.choice(["m0", "m1", "void"])]
    if dice.chance(0.2):
        words.append("-I")
    if dice.chance(0.1):
        words.append("-e")
    words += operations(dice)
    for _ in range(dice.choice([0, 0, 1, 1, 2])):
        words += ["-a", dice.randint(1, 4), *operations(dice, 2)]
        if dice.chance(0.3):
            words += ["-i", 1, *operations(dice, 2)]
    return [str(word) for word in words]


def primitives(dice, most=6):
    return "".join(primitive(dice, at) for at in range(dice.randint(1, most)))


def primitive(dice, at):
    reals = lambda count: " ".join(str(number(dice)) for _ in range(count))
    shares = lambda count: " ".join(str(dice.choice([0, 1, dice.random()])) for _ in range(count))
    modifier = dice.choice(["m0", "m1", "void"])
    match dice.choice(["surface", "surface", "polygon", "moved", "kept", "alias"]):
        case "surface":
            kind = dice.choice(list(SURFACES))
            numbers = [number(dice) for _ in range(SURFACES[kind])]
            radii = {"sphere": [3], "bubble": [3], "cone": [6, 7], "cup": [6, 7], "cylinder": [6], "tube": [6], "ring": [6, 7]}.get(kind, [])
            for k in radii:
                numbers[k] = dice.uniform(0.1, 2)
            if kind == "source":
                numbers[3] = 5
            return f"{modifier} {kind} s{at}\n0 0 {len(numbers)} {' '.join(map(str, numbers))}\n"
        case "polygon":
            x, y, z = (number(dice) for _ in range(3))
            return f"{modifier} polygon \"p {at}\" 0 0 9 {x} {y} {z} {x + 1} {y} {z} {x + 1} {y + dice.uniform(0.5, 3)} {z + 1}\n"
        case "moved":
            kind = dice.choice(list(MOVED))
            strings, count = MOVED[kind]
            more = [*map(str, operations(dice, 2))] if dice.chance(0.3) else []
            words = [*(f"w{k}" for k in range(strings)), *more]
            return f"{modifier} {kind} k{at}\n{len(words)} {' '.join(words)}\n0\n{count} {shares(count)}\n"
        case "kept":
            kind = dice.choice(list(KEPT))
            strings, count = KEPT[kind]
            words = [dice.choice(["w", "a>b", "'two words'"]) for _ in range(strings)]
            numbers = reals(count) if kind in ("brighttext", "colortext", "mixtext", "spotlight", "spectrum") else shares(count)
            return f"# a comment\n{modifier} {kind} k{at}\n{strings} {' '.join(words)}\n0\n{count} {numbers}\n"
    return dice.choice([f"inherit alias k{at} m0\n", f"m1 alias k{at} m0\n", f"void alias k{at} m1\n"])
