"""Random surfaces, light sources and surroundings."""

import math

from expressions import RAY
from modifiers import mixture, pattern, spectral

ANY = ["polygon", "polygon", "polygon", "sphere", "ring", "cylinder", "cone", "tube", "cup", "bubble"]


def frame(normal):
    """Two unit vectors across a normal."""
    x, y, z = normal
    helper = (1, 0, 0) if abs(x) < 0.6 else (0, 1, 0)
    u = [y * helper[2] - z * helper[1], z * helper[0] - x * helper[2], x * helper[1] - y * helper[0]]
    length = math.sqrt(sum(c * c for c in u))
    u = [c / length for c in u]
    return u, [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]]


def quadrilateral(centre, normal, width, height):
    """Corners of a rectangle around its centre."""
    u, v = frame(normal)
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return [float(f"{c + a * width * p + b * height * q:.9g}") for a, b in signs for c, p, q in zip(centre, u, v)]


def surface(dice, model, under, kinds=None, centre=None):
    kind = dice.choice(kinds or ANY)
    name = model.name("s")
    centre = centre or dice.point()
    axis = dice.direction()
    size = dice.real(0.3, 0.9)
    # What bends light to sources must cover its own centre.
    whole = under in model.traits
    if kind == "polygon":
        shape = "rectangle" if whole else dice.choice(["rectangle", "rectangle", "triangle", "odd"])
        if shape == "rectangle":
            corners = quadrilateral(centre, axis, size, dice.real(0.3, 0.9))
        else:
            u, v = frame(axis)
            angles = sorted(dice.uniform(0, 2 * math.pi) for _ in range(3 if shape == "triangle" else dice.randint(4, 8)))
            corners = []
            for angle in angles:
                r = size * (1 if shape == "triangle" else dice.uniform(0.4, 1))
                corners += [float(f"{c + r * (math.cos(angle) * p + math.sin(angle) * q):.12g}") for c, p, q in zip(centre, u, v)]
        model.add(under, kind, name, [], corners)
    elif kind in ("sphere", "bubble"):
        model.add(under, kind, name, [], [*centre, size * 0.7])
    elif kind == "ring":
        model.add(under, kind, name, [], [*centre, *axis, 0 if whole else dice.choice([0, size * 0.4]), size])
    else:
        ends = [[c - size * a for c, a in zip(centre, axis)], [c + size * a for c, a in zip(centre, axis)]]
        radii = [size * 0.3] if kind in ("cylinder", "tube") else [size * dice.real(0.1, 0.5), size * dice.choice([0, dice.real(0.1, 0.5)])]
        model.add(under, kind, name, [], [*ends[0], *ends[1], *radii])
    model.targets.append(centre)
    model.surfaces.append(name)
    return name


def light(dice, model, kinds=None, spectra=False):
    """A light source well outside of the other surfaces."""
    kind = dice.choice(kinds or ["sun", "sun", "sphere", "panel", "panel", "spot", "illum", "glow", "disk", "tube"])
    under = "void"
    # Radiance leaves the normals of distant sources to chance.
    model.ray = [name for name in RAY if kind not in ("sun", "point") or name[0] != "N"]
    if dice.chance(0.2):
        for _ in range(dice.choice([1, 1, 2, 3])):
            under = spectral(dice, model, under) if spectra else pattern(dice, model, under, ["brightfunc", "colorfunc", "brightdata"])
        if not spectra and dice.chance(0.2):
            other = pattern(dice, model, "void", ["brightfunc", "colorfunc"])
            under = mixture(dice, model, *dice.choice([[under, other], [under, "void"], ["void", under]]))
    model.ray = RAY
    colour = [c * dice.choice([10, 100]) for c in dice.colour(0.3, 1)]
    name, shape = model.name("l"), model.name("lamp")
    way = dice.direction()
    centre = [float(f"{4 * c:.6g}") for c in way]
    inward = [-c for c in way]
    if kind == "sun":
        model.add(under, "light", name, [], [c * 100 for c in colour])
        model.add(name, "source", shape, [], [*way, dice.choice([0.5, 2, 5])])
    elif kind == "point":
        # Within one cell of a table, nearly always.
        model.add(under, "light", name, [], [c * 1e6 for c in colour])
        model.add(name, "source", shape, [], [*way, 0.01])
    elif kind == "sphere":
        model.add(under, "light", name, [], colour)
        model.add(name, "sphere", shape, [], [*centre, 0.3])
    elif kind == "spot":
        model.add(under, "spotlight", name, [], [*(c * 10 for c in colour), dice.real(20, 120), *inward])
        model.add(name, *dice.choice([["sphere", shape, [], [*centre, 0.2]], ["polygon", shape, [], quadrilateral(centre, inward, 0.3, 0.2)]]))
    elif kind == "disk":
        model.add(under, "light", name, [], colour)
        model.add(name, "ring", shape, [], [*centre, *inward, 0, 0.4])
    elif kind == "tube":
        model.add(under, "light", name, [], colour)
        model.add(name, "cylinder", shape, [], [*centre, *(c + d for c, d in zip(centre, frame(way)[0])), 0.05])
    else:
        material = {"panel": "light", "illum": "illum", "glow": "glow"}[kind]
        more = [dice.choice([2, 3.9, 4.5, 6, 100])] if kind == "glow" else []
        alternate = [dice.choice([*model.materials, "void"])] if kind == "illum" and dice.chance(0.4) else []
        model.add(under, material, name, alternate, [*colour, *more])
        model.add(name, "polygon", shape, [], quadrilateral(centre, inward, dice.real(0.1, 0.8), dice.real(0.1, 0.8)))
    if dice.chance(0.3):
        model.targets.append(centre)
    model.lights.append(shape)


def surroundings(dice, model, spectra=False):
    """Glow all around, with a pattern by the direction, smooth so that rays hardly apart see the same."""
    under = model.name("p")
    model.add("void", "colorfunc", under, [f".5+.4*sin({dice.real(1, 3)}*D{axis}+{dice.real(0, 3)})" for axis in "xyz"] + ["."])
    if spectra:
        model.ray = [name for name in RAY if name[0] != "N"]
        under = spectral(dice, model, under)
        model.ray = RAY
    name = model.name("g")
    model.add(under, "glow", name, [], [*dice.colour(0.5, 2), dice.choice([0, 0, -1])])
    for way in dice.choice([[1], [1, -1]]):
        model.add(name, "source", model.name("sky"), [], [0, 0, way, 360 if way == 1 and dice.chance(0.5) else 180])
