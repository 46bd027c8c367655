"""Scenes as users make them: surfaces, skies and lamps from Radiance's generators, by commands in scene files."""

import materials
import rays
from case import Case, Step
from dice import text
from expressions import expression
from kinds.scene import EXACT
from model import Model
from outputs import Values, nothing, same
from surfaces import light, surface


def make(dice):
    model = Model()
    steps = []
    sky(dice, model)
    for _ in range(dice.randint(1, 3)):
        body(dice, model)
    if dice.chance(0.6):
        lamp(dice, model, steps)
    elif dice.chance(0.5):
        light(dice, model, ["sphere", "panel", "spot"])
    surface(dice, model, materials.modifier(dice, model, ["plastic", "metal"]), ["polygon"])
    options = [*EXACT, "-st", "1" if "random" in model.traits else "0"]
    if dice.chance(0.3):
        options += ["-av", *dice.colour()]
    if dice.chance(0.2):
        options += ["-i"]
    fields = dice.choice(["v", "vLsm", "vN"])
    seen = rays.at(dice, model, 120, 0.5)
    pack = rays.packer("a")
    steps.append(Step("oconv", [*dice.some(["-f"], 0.3), "-w", "scene.rad"], "scene.oct", same, needed=True))
    look = Values(fields, "a", 3, seen, pack)
    steps.append(Step("rtrace", [*options, "-h", f"-o{fields}", "scene.oct"], "values", look, pack(seen)))
    return Case(model.all_files(), steps)


def command(dice, model, words, move=True):
    """A line that runs a generator, perhaps with its output moved."""
    line = "!" + text(words)
    moved = [word for word in dice.transform() if word]
    if move and moved:
        line += f" | xform {dice.choice(['', '', '-n moved ', '-a 2 -t .9 .3 .1 -i 1 '])}{text(moved)}"
    model.parts.append(f"\n{line}\n")


def body(dice, model):
    under = materials.modifier(dice, model, ["plastic", "metal", "glass", "trans", "plastic2"])
    name = model.name("b")
    wave = lambda argument, low, high: f"'{(low + high) / 2:.4g}+{(high - low) / 2:.4g}*sin({dice.real(1, 6)}*{argument}+{dice.real(0, 3)})'"
    kind = dice.choice(["box", "rev", "surf", "worm", "prism", "blinds", "clock", "sign"])
    if kind == "box":
        more = dice.choice([[], [], ["-r", 0.1], ["-b", 0.08], ["-i"], ["-r", 0.12, "-n", 3], ["-r", 0.12, "-n", 3, "-s"]])
        command(dice, model, ["genbox", under, name, *dice.reals(3, 0.5, 1.5), *more])
    elif kind == "rev":
        command(dice, model, ["genrev", under, name, dice.choice(["t", "'2*t-1'", "'sin(3*t)'"]), wave("t", 0.2, 0.6), dice.randint(1, 12), *dice.choice([[], ["-s"]])])
    elif kind == "surf":
        height = f"'.4*sin({expression(dice, ['s', 't'], 2)})'".replace(" ", "")
        command(dice, model, ["gensurf", under, name, "'2*s-1'", dice.choice(["'2*t-1'", "'2*t-1+.3*s'"]), wave("(s+t)", -0.3, 0.3) if dice.chance(0.6) else height.replace("Px", "s"),
                              dice.randint(1, 8), dice.randint(1, 8), *dice.choice([[], ["-s"], ["-s"]])])
    elif kind == "worm":
        command(dice, model, ["genworm", under, name, "'cos(3*t)'", "'sin(3*t)'", "t", wave("t", 0.05, 0.3), dice.randint(2, 9)])
    elif kind == "prism":
        corners = dice.choice([[0, 0, 1, 0, 1, 1, 0, 1], [0, 0, 1, 0.2, 0.5, 1.2], [0, 0, 1.2, 0, 1.2, 0.4, 0.4, 0.4, 0.4, 1, 0, 1]])
        command(dice, model, ["genprism", under, name, len(corners) // 2, *corners, "-l", 0, dice.choice([0, 0.2]), dice.choice([0.6, -0.6]), *dice.choice([[], ["-c"], ["-e"], ["-r", 0.05]])])
    elif kind == "blinds":
        command(dice, model, ["genblinds", under, name, 0.2, 1.5, 1.2, dice.randint(3, 9), dice.real(-80, 80), *dice.choice([[], ["-r", 0.3], ["+r", 0.3]])])
    elif kind == "clock":
        model.add("void", "plastic", "face", [], [0.8, 0.8, 0.7, 0, 0]), model.add("void", "metal", "case", [], [0.5, 0.4, 0.3, 0.8, 0])
        command(dice, model, ["genclock", "-f", "face", "-c", "case", "-n", name, f"{dice.randint(1, 12)}:{dice.randint(10, 59)}"])
    else:
        model.parts.append(f"\n!genbox {under} {name} 1 .7 .2 | xform -a {dice.randint(2, 4)} -t .4 .5 .3 -rz {dice.real(5, 60)} -i 1 -s .6 -mx\n")
    model.targets.append([0.3, 0.3, 0.3])


def sky(dice, model):
    """A sky and a ground, or none. Skies of spectra (genssky) take minutes to make."""
    month, day, hour = dice.randint(1, 12), dice.randint(1, 28), dice.real(9, 15, 3)
    place = ["-a", dice.real(-60, 60, 3), "-o", dice.real(-100, 100, 3)]
    kind = dice.choice(["gensky", "gensky", "gendaylit", "gendaylit", "none"])
    if kind == "none":
        return
    if kind == "gensky":
        command(dice, model, [kind, month, day, hour, *place, dice.choice(["+s", "-s", "-c", "+i", "-i", "-u"]), "-g", dice.real(0.05, 0.4), "-t", dice.real(1.5, 5)], False)
    else:
        much = dice.choice([["-W", dice.real(0, 900), dice.real(20, 300)], ["-P", dice.real(1, 7), dice.real(0.05, 0.3)], ["-G", dice.real(0, 600), dice.real(20, 300)]])
        command(dice, model, [kind, month, day, hour, *place, *much, *dice.some(["-s", "-w"], 0.3)], False)
    model.add("skyfunc", "glow", "skyglow", [], dice.choice([[1, 1, 1, 0], [0.9, 0.9, 1.15, 0]]))
    model.add("skyglow", "source", "sky", [], [0, 0, 1, 180])
    model.add("skyfunc", "glow", "groundglow", [], [1.4, 0.9, 0.6, 0])
    model.add("groundglow", "source", "ground", [], [0, 0, -1, 180])


def lamp(dice, model, steps):
    """A luminaire of a random distribution of light, by ies2rad."""
    vertical = dice.choice([[0, 45, 90], [0, 15, 30, 45, 60, 75, 90], [0, 30, 90, 120, 180], [90, 120, 150, 180]])
    horizontal = dice.choice([[0], [0, 45, 90], [0, 90, 180], [0, 60, 120, 180], [0, 90, 180, 270, 360]])
    candelas = "\n".join(text(dice.reals(len(vertical), 100, 2000)) for _ in horizontal)
    size = dice.choice([[0, 0, 0], [0.3, 0.2, 0], [-0.3, -0.3, 0], [0.3, 0.3, 0.2], [1, 0.1, 0.1], [-0.2, -0.2, 0.4]])
    model.files["lamp.ies"] = "\n".join([
        "IESNA:LM-63-1995", "[TEST] random", "[LUMCAT] none", "TILT=NONE",
        text([1, 1000, dice.choice([1, 2.5]), len(vertical), len(horizontal), dice.choice([1, 1, 2]), 2, *size]), "1 1 50", text(vertical), text(horizontal), candelas, ""])
    options = dice.choice([[], ["-c", 1, 0.8, 0.6], ["-m", 1.5], ["-i", 0.3]])
    steps.append(Step("ies2rad", [*options, "-o", "lamp", "lamp.ies"], "none", nothing, needed=True))
    place = text(dice.reals(3, -1, 1))
    model.parts.append(f"\n!xform {dice.choice(['', '-rx 20', '-ry -35 -rz 30', '-rx 180'])} -t {place} -t 0 0 2.5 lamp.rad\n")
