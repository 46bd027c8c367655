"""Octrees byte by byte: odd geometry, options, freezing, adding to octrees, instances within instances, commands."""

import rays
from case import Case, Step
from dice import text
from kinds.scene import EXACT, build
from model import Model
from outputs import Values, same
from surfaces import surface


def make(dice):
    model = dice.choice([clutter, clutter, lambda dice: build(dice, ["plastic", "metal", "glass"])])(dice)
    files, steps, extra = model.all_files(), [], []
    if dice.chance(0.5):
        extra += instances(dice, files, steps)
    if dice.chance(0.15):
        files["scene.rad"] += oddity(dice)
    if extra:
        files["more.rad"] = "\n".join(extra) + "\n"
    operands = ["scene.rad", *(["more.rad"] if extra else [])]
    if dice.chance(0.15):
        operands = [f"!cat {' '.join(operands)}"]
    stdin = b""
    if dice.chance(0.1):
        stdin = files["scene.rad"].encode()
        operands = ["-", *operands[1:]]
    options = settings(dice) + (refused(dice) if dice.chance(0.1) else [])
    steps.append(Step("oconv", [*options, *operands], "scene.oct", same, stdin, needed=True))
    if dice.chance(0.3):
        other = Model()
        other.count = 1000
        surface(dice, other, "void", centre=dice.point(0.3))
        files["add.rad"] = "void plastic late 0 0 5 .3 .3 .3 0 0\n" + other.text().replace("void", "late", 1)
        steps.append(Step("oconv", [*settings(dice, box=False), "-i", "scene.oct", "add.rad"], "second.oct", same))
        model.targets += other.targets
    if dice.chance(0.2):
        steps.append(Step("oconv", ["-f", "-w", "-i", "scene.oct"], "frozen.oct", same))
    seen = rays.at(dice, model, 40, 0.3)
    pack = rays.packer("a")
    steps.append(Step("getinfo", ["-d", "scene.oct"], "size", same))
    octree = dice.choice([step.out for step in steps if step.out in ("scene.oct", "second.oct", "frozen.oct")])
    steps.append(Step("rtrace", [*EXACT, "-st", "0", "-h", "-ovLNs", octree], "values", Values("vLNs", "a", 3, seen, pack), pack(seen)))
    return Case(files, steps)


def settings(dice, box=True):
    words = dice.some(["-w", "-f"], 0.4)
    if dice.chance(0.4):
        # Few objects a cube take forever where surfaces cross, unless cubes end early.
        words += dice.choice([["-n", 1, "-r", 32], ["-n", 2, "-r", 64], ["-n", 5, "-r", 200], ["-n", 10], ["-n", 50]])
    elif dice.chance(0.3):
        words += ["-r", dice.choice([1, 2, 8, 64, 1000, 100000])]
    if box and dice.chance(0.2):
        words += ["-b", *dice.choice([[-10, -10, -10, 20], [-7.3, -8, -6.5, 16], [-1, -1, -1, 2]])]
    return words


def refused(dice):
    """Options that are refused, or nearly."""
    return dice.choice([["-q"], ["-n", 0], ["-n", -1], ["-r", 0], ["-r", -5], ["-r", 1.5], ["-b", 0, 0, 0, 0], ["-b", 0, 0, 0, -2], ["-i"],
                        ["-i", "none.oct"], ["-i", "scene.rad"], ["-w", "-w"], ["-fw"], ["-f", "-f"], ["none.rad"], ["-b", -5, -5, -5, 10, "-b", -9, -9, -9, 18], ["-N", 3]])


def clutter(dice):
    """Many surfaces, some degenerate, coincident, tiny or along the cube's walls."""
    model = Model()
    for _ in range(2):
        model.materials.append(model.add("void", "plastic", model.name("m"), [], [*dice.colour(), 0, 0]))
    for _ in range(dice.choice([0, 1, 3, 10, 40, 120])):
        kind = dice.choice(["any", "any", "any", "grid", "odd", "twice"])
        under = dice.choice([*model.materials, "void"])
        name = model.name("s")
        if kind == "any":
            surface(dice, model, under)
        elif kind == "grid":
            x, y, z = (dice.randint(-2, 2) for _ in range(3))
            a, b = dice.choice([(1, 1), (2, 1), (0.5, 4)])
            model.add(under, "polygon", name, [], dice.choice([
                [x, y, z, x + a, y, z, x + a, y + b, z, x, y + b, z], [x, y, z, x, y + a, z, x, y + a, z + b, x, y, z + b],
                [x, y, z, x + a, y, z + b, x + a, y + 1, z + b], [x, y, z, x + a, y, z, x + a, y, z + b, x, y, z + b, x, y, z]]))
        elif kind == "odd":
            x, y, z = dice.point()
            kind, numbers = dice.choice([
                ("sphere", [x, y, z, -0.3]), ("sphere", [x, y, z, 0]), ("bubble", [x, y, z, -0.2]), ("cone", [x, y, z, x, y, z + 1, 0.2, 0.2]),
                ("cone", [x, y, z, x, y, z, 0.2, 0.1]), ("cone", [x, y, z, x + 1, y, z, -0.2, -0.1]), ("cone", [x, y, z, x + 1, y, z, -0.2, 0.1]),
                ("cup", [x, y, z, x + 1, y, z, 0, 0]), ("cylinder", [x, y, z, x, y + 1, z, -0.1]), ("tube", [x, y, z, x, y + 1, z, 0]),
                ("ring", [x, y, z, 0, 0, 2, 0.5, 0.2]), ("ring", [x, y, z, 0, 0, 0, 0.5, 0.2]), ("ring", [x, y, z, 1, 1, 0, 0.3, 0.3]), ("ring", [x, y, z, 0, 1, 0, -0.3, 0.3]),
                ("polygon", [x, y, z, x + 1, y, z, x + 2, y, z]), ("polygon", [x, y, z, x + 1, y, z, x + 1, y + 1, z + 0.3, x, y + 1, z]),
                ("polygon", [x, y, z, x + 1, y + 1, z, x + 1, y, z, x, y + 1, z]), ("sphere", [x, y, z, 1e-5]), ("sphere", [0, 0, 0, 3]),
                ("source", [0, 0, 1, 180])])
            model.add(under, kind, name, [], numbers)
        elif len(model.parts) > 3:
            model.parts.append(model.parts[-1])
    return model


def instances(dice, files, steps):
    """Octrees of parts, perhaps of parts of parts, and lines that place them."""
    lines, inside = [], ""
    for depth in range(dice.randint(1, 3)):
        part = Model()
        part.count = 2000 + 100 * depth
        name = part.add("void", "plastic", part.name("m"), [], [*dice.colour(), 0, 0])
        for _ in range(dice.randint(1, 4)):
            surface(dice, part, name)
        files[f"part{depth}.rad"] = part.text() + inside
        octree = f"part{depth}.oct"
        steps.append(Step("oconv", [*settings(dice, False), f"part{depth}.rad"], octree, same, needed=True))
        under = dice.choice(["void", "void", "late"])
        inside = "\nvoid plastic late 0 0 5 .6 .2 .3 0 0\n" if under == "late" else ""
        for copy in range(dice.randint(1, 2)):
            words = [octree, *dice.transform()]
            inside += f"\n{under} instance i{depth}.{copy}\n{len(words)} {text(words)}\n0\n0\n"
    lines.append(inside)
    if dice.chance(0.4):
        files["placed.rad"] = inside
        move = text([w for w in dice.transform() if True])
        lines = [f"!xform -n again {move} placed.rad", *dice.choice([[], [inside]])]
    if dice.chance(0.15):
        lines.append(dice.choice(["void instance bad 1 none.oct 0 0", "void instance bad 1 scene.rad 0 0", "void instance bad 0 0 0", "void instance bad 3 part0.oct -s 0 0 0",
                                  "void instance bad 3 part0.oct -a 2 0 0", "void mesh bad 1 part0.oct 0 0"]))
    return lines


def oddity(dice):
    """Text that is refused, or nearly."""
    return "\n" + dice.choice([
        "nobody sphere x 0 0 4 0 0 0 1", "void nothing x 0 0 0", "void sphere x 0 0 3 0 0 0", "void sphere x 0 0 4 0 0 0 1e", "void sphere x 0 1 1 4 0 0 0 1",
        "void sphere x 0 0 4 0 0 0", "# comment without end", "void polygon x 0 0 6 0 0 0 1 1 1", "!echo void sphere cmd 0 0 4 0 0 0 .5", "!false", "!exit 3",
        "void alias a nobody", "void sphere 'a b' 0 0 4 0 0 0 .25", 'void sphere "" 0 0 4 0 0 0 .25', "inherit sphere x 0 0 4 0 0 0 1", "void sphere x 0 0 +4 0 0 0 +.5e0",
        "void sphere x 2 surplus words 0 4 0 0 0 .7", "void plastic void 0 0 5 1 1 1 0 0", "void ring x 0 0 7 0 0 0 0 0 1 1", "!printf 'void sphere c 0 0 4 1 1 1 .3' \\\n  #end",
        "void sphere x 0 0 4 0 0 0 1e400", "void sphere x 0 0 4 nan 0 0 1", "void sphere x 0 0 -1", "void plastic p 1 surplus 0 5 1 1 1 0 0 p sphere y 0 0 4 0 0 0 .3"]) + "\n"
