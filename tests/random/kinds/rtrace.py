"""Command lines of rtrace: fields, formats, limits, colours, filters and odd input."""

import re

import rays
from case import Case, Step
from kinds.scene import EXACT, build
from outputs import Values, nothing, same

FIELDS = "odvwlLcpnNsmMrxRX~"
# Printed for every ray of a tree; not n and N, which Radiance leaves to chance where rays meet the sky.
TREE = "odvwlLpsmMW"
# Known to differ: what lies behind translucent surfaces if rays have ends.
OPAQUE = ["plastic", "metal", "glass", "plastic2", "metal2", "ashik2", "mirror"]


def make(dice):
    outward = dice.choice("aafdc")
    fields = field(dice, outward)
    # Which blocked shadow rays a tree shows depends in Radiance on the rays before.
    tree = "t" in fields.lower()
    model = build(dice, OPAQUE, spectra=dice.chance(0.3), lamps=[] if tree else None)
    options, files = [*EXACT, "-st", "1" if "random" in model.traits else dice.choice(["0", "1"])], model.all_files()
    options += dice.choice([[], ["-lr", dice.choice([0, 1, 2, 5])], ["-lw", dice.choice(["0", ".1", ".5"])], ["-lr", "3", "-lw", ".05"]])
    if dice.chance(0.3):
        options += ["-av", *dice.colour()]
    options += dice.some(["-dv-", "-ld", "-ld+", "-bv-", "-w", "-u+", "-u", "-i-", "-I-", "-ld-"], 0.07)
    if dice.chance(0.3):
        options += ["-n", dice.choice([1, 2, 3])]
    colours, named = colour(dice, model)
    inward = dice.choice("aafd")
    irradiance = dice.chance(0.2)
    if "mixed" in model.traits:
        # Nor do both sides agree on where the light of nothing comes from, which rounding decides.
        fields = re.sub("[nlRX]", "", fields) or "v"
    if "-cs" in named:
        # What brings most is decided by three bins at a time, a known difference.
        fields = re.sub("[lRX]", "", fields) or "v"
    if "medium" in model.traits:
        fields = fields.replace("r", "").replace("x", "") or "v"
    if irradiance:
        options += [dice.choice(["-i", "-I", "-i+", "-I+"])]
        fields = "".join(f for f in fields if f not in "rxRX") or "v"
        if set(fields) <= set("odwLcpNsmM~"):
            fields += "v"
    if tree:
        options = [o for o in options if o not in ("-I", "-I+", "-i", "-i+")]
        options += filters(dice, model, files)
    seen = rays.at(dice, model, dice.choice([1, 7, 20, 40]))
    for at in range(len(seen)):
        if dice.chance(0.04):
            seen[at] = [*seen[at][:3], 0.0, 0.0, 0.0]
    pack = rays.packer(inward)
    sized = size(dice, options, len(seen))
    options += [f"-f{inward}{outward}" if inward != outward or dice.chance(0.5) else f"-f{inward}", f"-o{fields}"]
    if outward == inward == "a" and dice.chance(0.5):
        options = options[:-2] + options[-1:]
    options += dice.choice([[], ["-h"], ["-h-"], ["-h+"], ["-h", "-h"]])
    if dice.chance(0.15):
        options += ["-e", dice.choice(["K:.5", "errors.log", "f(x)=x*2"])]
    if dice.chance(0.1):
        files["more.opt"] = "-lw 1e-5\n\t-lr 4\n"
        options += ["@more.opt"]
    if dice.chance(0.1):
        options += odd(dice)
        fields = "vv" if options[-1] == "-ovv" else fields
    stdin = pack(seen) + tail(dice, inward)
    look = Values(fields, outward, colours, None if stdin != pack(seen) else seen, pack, sized)
    octree = Step("oconv", ["-w", "scene.rad"], "scene.oct", same, needed=True)
    steps = [octree, Step("rtrace", [*named, *options, "scene.oct"], "values", look, stdin)]
    if dice.chance(0.2):
        steps.append(Step("rtrace", [*options, "-defaults"], "defaults", nothing))
    return Case(files, steps)


def odd(dice):
    """Options that are refused, or nearly."""
    return dice.choice([["-q"], ["-n", "x"], ["-n", 0], ["-x"], ["-x", -2], ["-y", -2], ["-x", 0, "-y", 3], ["-y", "x"], ["-fz"], ["-faq"], ["-f"], ["-o"], ["-oq"], ["-ovv"], ["-ot"],
                        ["-oz"], ["-h+", "-h-"], ["-hx"], ["-lw", -0.1], ["-lw", 2], ["-lr", "x"], ["-ab", -1], ["-ab", "1e"], ["-av", 1, 1], ["-av", -1, 0, 2],
                        ["-aw", 5], ["-ad", 0], ["-as", -3], ["-aa", -1], ["-ar", 0], ["-dt", 2], ["-dc", -1], ["-dj", 2], ["-ds", -0.2], ["-dr", -1], ["-dp", 0], ["-ss", -1], ["-st", 2],
                        ["-i", "-I"], ["-I", "-i"], ["-ld", "-i"], ["-pc", 1, 2], ["-cs", 2], ["-cs", 2000], ["-cs", 0], ["-cw", 500], ["-cw", 500, 500], ["-co"], ["-co", "-pY"], ["-pY", "-cs", 9], ["-me", -1, 0, 0],
                        ["-ma", 2, 2, 2], ["-mg", 1.5], ["-ms", -1], ["-te", "a", "-ti", "b"], ["-tE", "none"], ["-ae", "a", "-ai", "b"], ["-aE", "none"], ["-af"], ["-t", 5], ["-e", "none/e"],
                        ["-w+"], ["-uu"], ["-bv", "-bv"], ["-am", 3], ["@none"], ["$NONE"], ["-dvx"], ["-u", "1"], ["more.oct"], ["-vp", 0, 0, 0]])


def field(dice, outward):
    if outward == "c" and dice.chance(0.9):
        return dice.choice("vvrx")
    if outward == "a" and dice.chance(0.2):
        # Binary ones have tabs between numbers and can not be taken apart. The tree's shadow rays are in another order, and blocked ones are printed, or not, by what was learnt before.
        return "".join(dice.sample("ovL~", 2)) * dice.choice([0, 1]) + "t" + "".join(dice.sample(TREE, dice.randint(1, 5)))
    return "".join(dice.choice(FIELDS) for _ in range(dice.randint(1, 8)))


def colour(dice, model):
    """Numbers that a colour has, and options that say so."""
    kind = dice.choice(["rgb"] * 5 + ["space", "bins", "bins", "split"])
    if kind == "space":
        words, count = dice.choice([(["-pXYZ"], 3), (["-pY"], 1), (["-pS"], 1), (["-pM"], 1), (["-pA"], 1), (["-pRGB"], 3),
                                    (["-pc", ".7", ".3", ".2", ".7", ".14", ".05", ".31", ".33"], 3)])
        return count, words
    if kind in ("bins", "split") and "medium" in model.traits:
        return 3, []
    if kind == "bins":
        bins = dice.choice([4, 5, 8, 12, 24])
        wide = dice.choice([[], ["-cw", "400", "700"], ["-cw", "780", "380"], ["-cw", "350", "900"]])
        return bins, ["-cs", bins, *wide, dice.choice(["-co", "-co+"])]
    if kind == "split":
        return 3, dice.choice([["-cs", 9], ["-cs", "3", "-co+"], ["-cs", 18, "-cw", "380", "780"]])
    return 3, []


def filters(dice, model, files):
    """What is left out of trees."""
    names = [*model.materials, "nothing"]
    kind = dice.choice(["-te", "-ti", "-tE", "-tI", "", ""])
    if kind in ("-te", "-ti"):
        return [w for _ in range(dice.randint(1, 2)) for w in (kind, dice.choice(names))]
    if kind:
        files["names.txt"] = "\n".join(dice.some(names, 0.6)) + "\n"
        return [kind, "names.txt"]
    return []


def size(dice, options, count):
    """-x and -y; whether a resolution line comes."""
    kind = dice.choice(["none", "none", "x", "y", "both", "more"])
    if kind == "x":
        options += ["-x", dice.choice([1, 4])]
    if kind == "y":
        options += ["-y", dice.randint(1, count)]
    if kind == "both":
        options += ["-x", dice.choice([1, 3, max(1, count // 2)]), "-y", 2]
    if kind == "more":
        options += ["-x", count, "-y", 2]
    return kind in ("both", "more")


def tail(dice, inward):
    """What comes after the last ray."""
    if dice.chance(0.8):
        return b""
    if inward == "a":
        return dice.choice(["1 2 3", "# end\n1 2 3 4 5 6\n", "1 2 3 4 5 x\n", "1,2,3,4,5,6\n", "1 2 3 4 5 6 7", "\r\n", "nan 0 0 0 0 1\n", '"1" 2 3 4 5 6\n']).encode()
    return b"\0" * dice.choice([1, 7, 20])
