"""Scenes of all kinds of surfaces, materials, patterns and lights, seen along single rays without noise."""

import re

import materials
import rays
from case import Case, Step
from model import Model
from outputs import TOLERANCE, Values, same
from surfaces import light, surface, surroundings

# Nothing random: sharp highlights, every shadow tested, lights as points.
EXACT = "-w- -u- -ab 0 -dj 0 -dt 0 -dc 1 -ds 0 -ss 0 -lr 7 -lw 1e-6".split()
# These stand for volumes: what bounds them must be closed.
SOLID = ["dielectric", "interface"]


def build(dice, kinds=None, spectra=False, lamps=None, model=None, sky=True):
    model = model or Model()
    if sky and dice.chance(0.8):
        surroundings(dice, model, spectra)
    for _ in range(dice.randint(2, 5)):
        if dice.chance(0.15):
            solid(dice, model)
            continue
        under = materials.modifier(dice, model, kinds or [k for k in materials.EVERYDAY + materials.FUNCTIONS + materials.BENDING if k not in SOLID], spectra)
        for _ in range(dice.randint(1, 3)):
            surface(dice, model, under)
    if dice.chance(0.15):
        antimatter(dice, model)
    for _ in range(dice.randint(1, 3) if lamps != [] else 0):
        light(dice, model, lamps, spectra)
    return model


def solid(dice, model):
    """A ball of something that refracts, perhaps one within another."""
    centre = dice.point()
    for size in [0.6, 0.4][:dice.randint(1, 2)]:
        name = materials.material(dice, model, materials.chain(dice, model), SOLID)
        model.add(name, "sphere", model.name("s"), [], [*centre, size])
    model.targets.append(centre)


def antimatter(dice, model):
    """A body with a cut, perhaps a cut within the cut."""
    centre = dice.point()
    body = materials.material(dice, model, kinds=["plastic", "metal"])
    inner = materials.material(dice, model, kinds=["plastic", "metal"])
    first, second = model.name("n"), model.name("n")
    model.add("void", "antimatter", first, dice.choice([[body], [inner, body], ["void", body], [inner, body, "void"]]))
    shift = lambda size: [c + dice.uniform(-size, size) for c in centre]
    surface_at(model, body, centre, 0.7)
    surface_at(model, first, shift(0.5), 0.5)
    if dice.chance(0.4):
        model.add("void", "antimatter", second, [body, inner])
        surface_at(model, second, shift(0.5), 0.3)
        surface_at(model, inner, shift(0.4), 0.4)
    model.targets.append(centre)


def surface_at(model, under, centre, size):
    model.add(under, "sphere", model.name("s"), [], [*centre, size])


def make(dice):
    spectra = dice.chance(0.2)
    model = build(dice, spectra=spectra)
    options = [*EXACT, "-st", "1" if "random" in model.traits else dice.choice(["0", "1", ".1"]), "-dr", dice.choice([0, 1, 2])]
    if dice.chance(0.4):
        options += ["-av", *dice.colour()]
    if dice.chance(0.1):
        options += ["-bv-"]
    if dice.chance(0.15):
        options += ["-i"]
    if dice.chance(0.1):
        options += ["-me", *dice.reals(3, 0, 0.2)]
        model.traits.add("medium")
    colours, bins, more = 3, 3, []
    if spectra and dice.chance(0.6):
        # Patterns of what bends light turn to red, green and blue in Radiance, a known difference.
        bins = 3 if "medium" in model.traits else dice.choice([3, 4, 6, 9, 13, 20, 24])
        options += ["-cs", bins, *dice.choice([[], ["-cw", 380, 780], ["-cw", 700, 400], ["-cw", 360, 830]])]
        if bins > 3 and dice.chance(0.6):
            options, colours = [*options, "-co+"], bins
        elif dice.chance(0.5):
            more, colours = dice.choice([(["-pXYZ"], 3), (["-pY"], 1), (["-pS"], 1), (["-pM"], 1), (["-pA"], 1)])
    fields = dice.choice(["v", "vLsn", "vlpN", "rxRX", "vsmM"])
    # Normals of mixed materials are a known difference.
    if "mixed" in model.traits:
        # Nor do both sides agree on where the light of nothing comes from, which rounding decides.
        fields = re.sub("[nlRX]", "", fields)
    # Which part brings most is decided by three bins at a time.
    if colours > 3 or bins > 3:
        fields = re.sub("[lRX]", "", fields)
    # So is mirrored light in a medium.
    if "r" in fields and ("-i" in options or "medium" in model.traits):
        fields = "vL"
    seen = rays.at(dice, model, 100, 0.4)
    pack = rays.packer("a")
    octree = Step("oconv", ["-w", "scene.rad"], "scene.oct", same, needed=True)
    # At each boundary of a medium Radiance loses up to 4e-4 of a spectrum, more of a narrow one: a known difference.
    look = Values(fields, "a", colours, seen, pack, tolerance=4e-3 if spectra and "medium" in model.traits else TOLERANCE)
    trace = Step("rtrace", [*options, *more, "-h", f"-o{fields}", "scene.oct"], "values", look, pack(seen))
    return Case(model.all_files(), [octree, trace])
