"""Random materials. Each function adds one to a model below the modifier `under` and returns its name."""

from expressions import within
from modifiers import data, mixture, pattern, spectral, texture

EVERYDAY = ["plastic", "plastic", "metal", "trans", "glass", "plastic2", "metal2", "trans2", "ashik2"]
FUNCTIONS = ["plasfunc", "metfunc", "transfunc", "plasdata", "metdata", "transdata", "BRTDfunc", "WGMDfunc"]
BENDING = ["dielectric", "interface", "mirror", "prism1", "prism2"]
# What a function of the direction to a light returns.
LIGHT_ARGUMENTS = ["lx", "ly", "lz"]


def chain(dice, model, spectra=False):
    """Patterns, textures and mixtures of these, one above the other."""
    under = "void"
    for _ in range(dice.choice([0, 0, 1, 1, 2])):
        kind = dice.choice(["pattern", "pattern", "texture", "mixture", "alias"] + ["spectral"] * 3 * spectra)
        if kind == "pattern":
            under = pattern(dice, model, under)
        elif kind == "texture":
            under = texture(dice, model, under)
        elif kind == "spectral":
            under = spectral(dice, model, under)
        elif kind == "mixture":
            sides = [pattern(dice, model), texture(dice, model)]
            dice.shuffle(sides)
            under = mixture(dice, model, *dice.choice([sides, [sides[0], "void"], ["void", sides[1]]]), under)
        elif under != "void":
            name = model.name("a")
            model.parts.append(f"\n{dice.choice(['inherit', 'void'])} alias {name} {under}\n")
            under = name
    return under


def material(dice, model, under="void", kinds=None):
    kinds = kinds or EVERYDAY + FUNCTIONS + BENDING
    kind = dice.choice(kinds)
    name = model.name("m")
    model.materials.append(name)
    rough = dice.choice([0, 0, dice.real(0.02, 0.3)])
    spec = dice.choice([0, dice.real(0.01, 0.2)])
    both = [dice.real(0.03, 0.3), dice.real(0.03, 0.3)]
    up = lambda: [*(within(dice, model.places(), -1, 1, 1) if dice.chance(0.3) else f"{c:.4g}" for c in dice.direction()), model.helpers(), *dice.transform()]
    thin = lambda: [dice.real(0, 1), dice.real(0, 1)]
    if kind == "plastic":
        model.add(under, kind, name, [], [*dice.colour(), spec, rough])
    elif kind == "metal":
        model.add(under, kind, name, [], [*dice.colour(0.3), dice.choice([1, dice.real(0.3, 0.95)]), rough])
    elif kind == "trans":
        model.add(under, kind, name, [], [*dice.colour(), spec, rough, *thin()])
    elif kind == "glass":
        model.add(under, kind, name, [], [*dice.colour(0.4, 0.99), *dice.choice([[], [dice.real(1.1, 1.9)]])])
    elif kind in ("plastic2", "metal2"):
        model.add(under, kind, name, up(), [*dice.colour(), dice.real(0.02, 0.9), *both])
    elif kind == "trans2":
        model.add(under, kind, name, up(), [*dice.colour(), spec, *both, *thin()])
    elif kind == "ashik2":
        # Radiance samples its highlight at random, whatever -ss says.
        model.traits.add("random")
        model.add(under, kind, name, up(), [*dice.colour(0.1, 0.4), *dice.colour(0.1, 0.4), dice.real(5, 200), dice.real(5, 200)])
    elif kind == "dielectric":
        model.traits.add("medium")
        model.add(under, kind, name, [], [*dice.colour(0.5, 1), dice.real(1.05, 1.9), dice.choice([0, 0, dice.real(-20, 20)])])
    elif kind == "interface":
        model.traits.add("medium")
        model.add(under, kind, name, [], [*dice.colour(0.5, 1), dice.real(1.1, 1.9), *dice.colour(0.5, 1), dice.real(1.1, 1.9)])
    elif kind == "mirror":
        # What is seen in the place of the mirror, or void: sources are mirrored, nothing else is seen.
        others = [m for m in model.materials[:-1] if m not in model.traits]
        model.add(under, kind, name, dice.choice([[], [], [dice.choice([*others, "void"])]]), dice.colour(0.4, 0.95))
    elif kind in ("prism1", "prism2"):
        model.traits.add(name)
        expressions = [w for _ in range(1 if kind == "prism1" else 2) for w in [within(dice, model.ray, 0.2, 0.8, 1), *bent(dice)]]
        model.add(under, kind, name, [*expressions, model.helpers()])
    else:
        programmed(dice, model, under, kind, name)
    return name


def bent(dice):
    return [f"Dx+{dice.real(-0.3, 0.3)}", f"Dy+{dice.real(-0.3, 0.3)}", dice.choice(["Dz", "-Dz"])]


def programmed(dice, model, under, kind, name):
    """Materials whose lobes are functions or data."""
    arguments = [*LIGHT_ARGUMENTS, *dice.some([*model.ray, "NxP", "NyP", "RdotP", "CrP"], 0.1)]
    lobe = lambda high=0.5: within(dice, arguments, 0, high)
    file = model.file("cal", f"include : 1;\nf1(lx,ly,lz,o) = {lobe()};\nf2(lx,ly,lz,o) = {lobe()};\nf3(lx,ly,lz,o) = {lobe()};\n"
                             f"d1(v,lx,ly,lz,o) = v*({lobe(1)});\nx1(lx,ly,lz,o) = lx;\nx2(lx,ly,lz,o) = ly;\nx3(lx,ly,lz,o) = {lobe(1)};\n"
                             + helper_definitions())
    move = dice.transform()
    share = [dice.real(0, 0.5)]
    more = dice.reals(dice.choice([0, 0, 2]), 0, 1)
    if kind in ("plasfunc", "metfunc"):
        model.add(under, kind, name, ["f1", file, *move], [*dice.colour(), *share, *more])
    elif kind == "transfunc":
        model.add(under, kind, name, ["f1", file, *move], [*dice.colour(), *share, dice.real(0, 1), dice.real(0, 1), *more])
    elif kind in ("plasdata", "metdata", "transdata"):
        count = dice.randint(1, 3)
        table, _ = data(dice, model, count)
        both = [dice.real(0, 1), dice.real(0, 1)] if kind == "transdata" else []
        model.add(under, kind, name, ["d1", table, file, *["x1", "x2", "x3"][:count], *move], [*dice.colour(), *share, *both, *more])
    elif kind == "BRTDfunc":
        coefficient = lambda: dice.choice(["0", within(dice, model.ray, 0, 0.4, 1), ".2"])
        lobes = dice.choice([["0", "0", "0"], ["f1", "f2", "f3"], ["f1", "f1", "0"]])
        model.add(under, kind, name, [*(coefficient() for _ in range(6)), *lobes, file, *move], [*dice.reals(9, 0, 0.4), *more])
    elif kind == "WGMDfunc":
        part = lambda: [dice.choice(["void", "inherit"]), dice.choice(["0", ".2", within(dice, model.ray, 0.05, 0.3, 1)]), *(dice.choice(["0", ".1", ".2"]) for _ in range(2))]
        model.add(under, kind, name, [*part(), *part(), dice.choice(["void", "inherit"]), *(f"{c:.4g}" for c in dice.direction()), file, *move], [*dice.reals(9, 0, 0.3), *more])


def helper_definitions():
    from expressions import HELPERS
    return HELPERS


def mixed(dice, model, kinds, spectra, depth):
    """A mixture of two materials, or of mixtures of such."""
    one = lambda: mixed(dice, model, kinds, spectra, depth - 1) if depth and dice.chance(0.6) else material(dice, model, chain(dice, model, spectra), kinds)
    sides = [one(), one()]
    return mixture(dice, model, *dice.choice([sides, sides, [sides[0], "void"], ["void", sides[0]]]))


def modifier(dice, model, kinds=None, spectra=False):
    """Something to put surfaces under: a material with what is above and below it, or a mixture of two."""
    if dice.chance(0.15):
        model.traits.add("mixed")
        return mixed(dice, model, kinds, spectra, dice.choice([0, 0, 1, 2]))
    made = material(dice, model, chain(dice, model, spectra), kinds)
    if dice.chance(0.1):
        name = model.name("a")
        model.parts.append(f"\n{dice.choice(['inherit', 'void'])} alias {name} {made}\n")
        made = covered(model, made, name)
    if dice.chance(0.2):
        made = covered(model, made, dice.choice([pattern, texture])(dice, model, made))
    return made


def covered(model, under, name):
    """What stands for a material shares its traits."""
    if under in model.traits:
        model.traits.add(name)
    return name
