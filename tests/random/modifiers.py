"""Random patterns, textures and mixtures of such. Each function adds one to a model, above what `under` names, and returns its
name."""

import struct

from dice import text
from expressions import within


def pattern(dice, model, under="void", kinds=None):
    kinds = kinds or ["brightfunc", "colorfunc", "brightdata", "colordata", "brighttext", "colortext", "colorpict"]
    kind = dice.choice(kinds)
    name = model.name("p")
    f = lambda low=0.2, high=1: within(dice, model.ray, low, high)
    move = dice.transform()
    if kind == "brightfunc":
        model.add(under, kind, name, [f(), model.helpers(), *move])
    elif kind == "colorfunc":
        model.add(under, kind, name, [f(), f(), f(), model.helpers(), *move])
    elif kind == "brightdata":
        file, axes = data(dice, model)
        model.add(under, kind, name, [dice.choice(["noop", "clip", "noneg", "sq"]), file, model.helpers(), *axes, *move])
    elif kind == "colordata":
        count = dice.randint(1, 3)
        files = [data(dice, model, count)[0] for _ in range(3)]
        axes = data(dice, model, count)[1]
        names = dice.choice([["red", "green", "blue"], ["clip_r", "clip_g", "clip_b"], ["noop"] * 3, ["red", "noop", "blue"]])
        model.add(under, kind, name, [*names, *files, model.helpers(), *axes, *move])
    elif kind == "colorpict":
        names = dice.choice([["red", "green", "blue"], ["clip_r", "clip_g", "clip_b"], ["grey"] * 3])
        model.add(under, kind, name, [*names, picture(dice, model), model.helpers(), *place(dice, model), *move])
    elif kind == "brighttext":
        colours = [dice.real(0.1, 1), dice.real(0.1, 1)]
        model.add(under, kind, name, lines(dice, model), [*frame(dice), *colours, *spacing(dice)])
    elif kind == "colortext":
        colours = [*dice.colour(), *dice.colour()]
        model.add(under, kind, name, lines(dice, model), [*frame(dice), *colours, *spacing(dice)])
    return name


def spectral(dice, model, under="void"):
    """A pattern that depends on the wavelength."""
    kind = dice.choice(["spectrum", "spectrum", "specfile", "specdata", "specpict"])
    name = model.name("s")
    # Where samples lie 200 nm apart Radiance takes them from beyond their array.
    low, high = dice.choice([(380, 780), (400, 700), (780, 380), (300, 900), (450, 600), (0, 900)])
    if kind == "spectrum":
        model.add(under, kind, name, [], [low, high, *dice.reals(dice.randint(6, 24), 0.1, 1)])
    elif kind == "specfile":
        count = dice.choice([6, 9, 41, 81])
        file = model.file("dat", f"1\n{low} {high} {count}\n" + "\n".join(text([v]) for v in dice.reals(count, 0.1, 1)) + "\n")
        model.add(under, kind, name, [file])
    elif kind == "specpict":
        model.add(under, kind, name, ["noop", spectral_picture(dice, model, low, high), model.helpers(), *place(dice, model), *dice.transform()])
    else:
        count = dice.choice([6, 9, 41])
        values = dice.reals(3 * count, 0.1, 1)
        file = model.file("dat", f"2\n0 1 3\n{low} {high} {count}\n" + text(values) + "\n")
        model.add(under, kind, name, ["noop", file, model.helpers(), within(dice, model.ray, 0, 1)])
    return name


def texture(dice, model, under="void", strength=0.3):
    kind = dice.choice(["texfunc", "texfunc", "texdata"])
    name = model.name("t")
    move = dice.transform()
    if kind == "texfunc":
        model.add(under, kind, name, [*(within(dice, model.places(), -strength, strength) for _ in range(3)), model.helpers(), *move])
    else:
        count = dice.randint(1, 3)
        files = [data(dice, model, count, -strength, strength)[0] for _ in range(3)]
        model.add(under, kind, name, ["red3", "green3", "blue3", *files, model.helpers(), *data(dice, model, count)[1], *move])
    return name


def mixture(dice, model, fore, back, under="void"):
    kind = dice.choice(["mixfunc", "mixfunc", "mixdata", "mixtext", "mixpict"])
    name = model.name("x")
    move = dice.transform()
    if kind == "mixfunc":
        model.add(under, kind, name, [fore, back, within(dice, model.ray, -0.2, 1.2), model.helpers(), *move])
    elif kind == "mixdata":
        file, axes = data(dice, model)
        model.add(under, kind, name, [fore, back, dice.choice(["noop", "clip"]), file, model.helpers(), *axes, *move])
    elif kind == "mixpict":
        model.add(under, kind, name, [fore, back, "grey", picture(dice, model), model.helpers(), *place(dice, model), *move])
    else:
        model.add(under, kind, name, [fore, back, *lines(dice, model)], [*frame(dice), *spacing(dice)])
    return name


def data(dice, model, count=None, low=0.1, high=1.0):
    """A data file and expressions of its coordinates, some of them beyond its ends."""
    count = count or dice.choice([1, 1, 2, 2, 3, 4, 5, 6])
    head, sizes, axes = [str(count)], [], []
    for _ in range(count):
        size = dice.randint(2, 6 if count < 4 else 3)
        first, last = dice.choice([(0.0, 1.0), (-1.0, 1.0), (1.0, 0.0), (dice.real(-2, 0), dice.real(0.5, 3))])
        if dice.chance(0.25):
            steps = sorted(dice.sample(range(100), size), reverse=first > last)
            head.append(f"0 0 {size} " + text([min(first, last) + abs(last - first) * s / 99 for s in steps]))
        else:
            head.append(f"{text([first, last])} {size}")
        sizes.append(size)
        reach = abs(last - first) * dice.choice([0, 0, 0.1, 0.5])
        axes.append(within(dice, model.places(), min(first, last) - reach, max(first, last) + reach))
    total = 1
    for size in sizes:
        total *= size
    values = "\n".join(text([v]) for v in dice.reals(total, low, high))
    return model.file("dat", "\n".join(head) + "\n# values\n" + values + "\n"), axes


def picture(dice, model):
    """A small picture of any orientation."""
    width, height = dice.randint(1, 7), dice.randint(1, 7)
    y, x = dice.choice("+-"), dice.choice("+-")
    size = dice.choice([f"{y}Y {height} {x}X {width}", f"{x}X {width} {y}Y {height}"])
    more = dice.choice(["", "", "EXPOSURE=2.5\n", "PIXASPECT=1.5\n", "PIXASPECT=.7\nPIXASPECT=.9\n"])
    head = f"#?RADIANCE\n{more}FORMAT=32-bit_rle_rgbe\n\n{size}\n".encode()
    pixels = b"".join(struct.pack("4B", dice.randint(100, 255), dice.randint(20, 255), dice.randint(2, 255), 128) for _ in range(width * height))
    return model.file("hdr", head + pixels)


def spectral_picture(dice, model, low, high):
    """A small picture of spectra; of the wavelengths only the ends count."""
    width, height, count = dice.randint(1, 5), dice.randint(1, 5), dice.choice([6, 9, 20])
    low, high = max(low, high), max(min(low, high), 1)
    head = f"#?RADIANCE\nNCOMP={count}\nWAVELENGTH_SPLITS= {low} 588 480 {high}\nFORMAT=Radiance_spectra\n\n-Y {height} +X {width}\n".encode()
    pixels = b"".join(bytes([*(dice.randint(10, 255) for _ in range(count)), 128]) for _ in range(width * height))
    return model.file("hsr", head + pixels)


def place(dice, model):
    """Expressions of the coordinates within a picture; U and V follow from the normal."""
    return dice.choice([["frac(Px)", "frac(Py)"], ["U", "V"] if "Nx" in model.ray else ["Dx", "Dy"], [within(dice, model.places(), -0.2, 1.2) for _ in range(2)]])


def lines(dice, model):
    """Font and text, in place or in a file."""
    words = ["ab", "Hello", "c d  e", "x", "AAA BB C", "!?"]
    font = model.font()
    if dice.chance(0.4):
        return [font, model.file("txt", "\n".join(dice.choice([*words, ""]) for _ in range(3)) + "\n")]
    return [font, ".", *(dice.choice(words) for _ in range(dice.randint(1, 3)))]


def frame(dice):
    """Origin, rightward and downward motion of text."""
    size = dice.real(0.1, 0.4)
    slant = dice.real(-0.1, 0.1)
    return dice.choice([
        [-1, 1, 0, size, slant, 0, slant, -1.5 * size, 0],
        [-1, 0, 1, size, 0, slant, 0, slant, -1.5 * size],
        [*dice.point(1), *(size * c for c in dice.direction()), *(size * c for c in dice.direction())],
    ])


def spacing(dice):
    return dice.choice([[], [], [0], [dice.real(0.05, 0.5)], [dice.real(-0.5, -0.05)]])
