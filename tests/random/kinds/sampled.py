"""Scenes with noise: highlights, interreflection without a cache, mist and BSDFs, each ray many times over."""

import materials
import rays
from case import Case, Step
from kinds import bsdf
from kinds.scene import build
from model import Model
from outputs import same
from samples import Means
from surfaces import light, surface, surroundings

TIMES = 1200
KINDS = ["plastic", "metal", "trans", "plastic2", "metal2", "trans2", "ashik2", "WGMDfunc", "plasfunc", "transfunc", "BRTDfunc", "glass"]


def make(dice):
    kind = dice.choice(["highlights", "bounces", "mist", "bsdf", "glass"])
    model = {"highlights": open_scene, "bounces": open_scene, "mist": misty, "bsdf": glazed, "glass": mist_in_glass}[kind](dice)
    files = model.all_files()
    options = ["-w-", "-u+", "-dt", "0", "-dc", "1", "-ds", "0", "-dj", dice.choice([0, 0, 0.7]), "-ss", "1", "-st", "0", "-lr", "5", "-lw", "1e-5"]
    if kind == "bounces":
        options += ["-ab", dice.choice([1, 2]), "-aa", "0", "-as", "0", "-ad", dice.choice([1, 4, 16])]
        options += chosen(dice, model, files)
    if kind in ("mist", "glass"):
        options += ["-ms", dice.choice([0.05, 0.2])]
        options += ["-me", *dice.reals(3, 0, 0.1), "-ma", *dice.reals(3, 0, 1), "-mg", dice.real(0, 0.9)] if dice.chance(0.5) else []
    if dice.chance(0.3):
        options += ["-av", *dice.colour()]
    seen = rays.at(dice, model, 6, 0.2)
    stdin = rays.packer("a")([ray for ray in seen for _ in range(TIMES)])
    octree = Step("oconv", ["-w", "scene.rad"], "scene.oct", same, needed=True)
    return Case(files, [octree, Step("rtrace", [*options, "-h", "-ov", "scene.oct"], "values", Means(TIMES), stdin)])


def chosen(dice, model, files):
    """Materials whose surfaces interreflect, or do not."""
    kind = dice.choice(["-ae", "-ai", "-aE", "-aI", "", ""])
    names = dice.some([*model.materials, "nothing"], 0.5)
    if kind in ("-ae", "-ai"):
        return [word for name in names for word in (kind, name)]
    if kind:
        files["names.txt"] = "\n".join(names) + "\n"
        return [kind, "names.txt"]
    return []


def open_scene(dice):
    return build(dice, KINDS)


def misty(dice):
    """A ball of mist, perhaps one in another, among opaque things, with lamps that it names."""
    model = Model()
    if dice.chance(0.5):
        surroundings(dice, model)
    for _ in range(dice.randint(1, 2)):
        light(dice, model, ["sun", "sphere", "panel", "spot"])
    for _ in range(2):
        surface(dice, model, materials.modifier(dice, model, ["plastic", "metal"]))
    nested = dice.chance(0.5)
    for size in [1.5, 0.8][:1 + nested]:
        under = materials.pattern(dice, model) if dice.chance(0.2) else "void"
        numbers = [*dice.reals(3, 0, 0.8), *dice.reals(3, 0, 1), dice.real(0, 0.8)][:dice.choice([3, 6, 7])]
        # Where mists within each other name lamps, rays of one hit change what the others find, in Radiance.
        lamps = dice.some(model.lights, 0.8) if not nested else []
        name = model.add(under, "mist", model.name("m"), lamps, numbers)
        model.add(name, "sphere", model.name("s"), [], [*dice.point(0.3), size])
    return model


def mist_in_glass(dice):
    """Mist in a pane or a ball of glass, or glass in a mist."""
    model = Model()
    surroundings(dice, model)
    light(dice, model, ["sun", "panel"])
    surface(dice, model, materials.modifier(dice, model, ["plastic"]))
    mist = model.add("void", "mist", model.name("m"), dice.some(model.lights, 0.5), [*dice.reals(3, 0, 0.6), *dice.reals(3, 0, 1), dice.real(0, 0.8)])
    glass = materials.material(dice, model, "void", ["glass", "dielectric"])
    centre = dice.point(0.3)
    for under, size in dice.choice([[(glass, 1.2), (mist, 1.0)], [(mist, 1.2), (glass, 0.8)]]):
        model.add(under, "sphere", model.name("s"), [], [*centre, size])
    model.targets = [centre]
    return model


def glazed(dice):
    """BSDFs of random tables."""
    model = Model()
    surroundings(dice, model)
    bsdf.glazing(dice, model)
    return model
