"""Command lines of rpict: views, sizes, aspects, shifts, clipping, sequences, distances, colours, recovery."""

from case import Case, Step
from dice import text
from kinds.scene import build
from outputs import depths, nothing, picture, same, sequence

# Without anything random; every pixel is a ray.
EXACT = "-u- -ab 0 -dj 0 -dt 0 -dc 1 -ds 0 -ss 0 -st 1 -lr 5 -pj 0 -ps 1".split()
KINDS = ["plastic", "plastic", "metal", "glass", "plastic2", "mirror", "trans"]


def view(dice, odd=0.05, clip=True):
    """Options of a view of the middle, `clip` tells whether with -vo and -va; perhaps one that is no view."""
    kind = dice.choice("vvvlchas")
    origin = [float(f"{5 * c:.5g}") for c in dice.direction()]
    aim = [float(f"{-c / 5 + dice.uniform(-0.15, 0.15):.5g}") for c in origin]
    across = {"v": (20, 90), "l": (2, 8), "c": (30, 300), "h": (40, 180), "a": (40, 360), "s": (40, 300)}[kind]
    up = {"v": (20, 90), "l": (2, 8), "c": (20, 100), "h": (40, 180), "a": (40, 360), "s": (40, 300)}[kind]
    words = [f"-vt{kind}", "-vp", *origin, "-vd", *(c * dice.choice([1, 2]) for c in aim), "-vh", dice.real(*across, 3), "-vv", dice.real(*up, 3)]
    if dice.chance(0.5):
        words += ["-vu", *dice.direction()]
    if dice.chance(0.4):
        words += ["-vs", dice.choice([0.5, -0.5, dice.real(-1.5, 1.5, 3)])]
    if dice.chance(0.4):
        words += ["-vl", dice.choice([0.5, -0.5, dice.real(-1.5, 1.5, 3)])]
    if clip and dice.chance(0.6):
        words += dice.choice([["-vo", dice.real(0.5, 5, 3)], ["-va", dice.real(4, 9, 3)], ["-vo", dice.real(0.5, 5, 3), "-va", dice.real(4, 9, 3)]])
    if dice.chance(odd):
        words += dice.choice([["-vh", 0], ["-vv", 200], ["-vo", -1], ["-va", 0.1, "-vo", 0.2], ["-vd", 0, 0, 0], ["-vu", 0, 0, 0], ["-vtq"], ["-vtvv"], ["-vh", "x"]])
    return words


def make(dice):
    # Translucent things hide what lies beyond -va, which is a known difference; small lamps are drawn in another way.
    # Of small lamps that a view cuts Radiance draws nothing, and the distances of what it draws are those of other points.
    clip = dice.chance(0.5)
    model = build(dice, KINDS[:-1], spectra=False, lamps=["sun"] if clip else ["panel"])
    files = model.all_files()
    options = [*EXACT, *(["-w"] if dice.chance(0.5) else [])]
    options += ["-x", dice.choice([1, 5, 16, 17, dice.randint(2, 70)]), "-y", dice.choice([1, 9, 32, dice.randint(2, 70)])]
    options += dice.choice([[], [], ["-pa", 0], ["-pa", dice.real(0.3, 3, 3)], ["-pa", 1], ["-pa", -1]])
    options += dice.choice([[], [], [], ["-pXYZ"], ["-pRGB"], ["-pc", .7, .3, .2, .7, .14, .05, .31, .33], ["-pc", .64, .33, .29, .6, .15, .06, .3333, .3333]])
    if dice.chance(0.3):
        options += ["-av", *dice.colour()]
    # Of patterns on what refracts Radiance makes other colours by wavelength, a known difference.
    spectral = [["-cs", 9], ["-cs", 6, "-cw", 400, 700]] if "medium" not in model.traits else []
    options += dice.choice([*spectral, [], [], [], ["-i"], ["-dv-"], ["-bv-"], ["-t", 0], ["-me", 0.1, 0.05, 0.02], ["-ps", dice.choice([0, 2, 4, 20]), "-pt", 0]])
    if "-vu" not in options and dice.chance(0.15):
        files["a.vf"] = dice.choice(["rvu ", "VIEW= ", "# nothing\nrpict -x 3 ", "#?RADIANCE\n\tVIEW= -vtv\nVIEW= ", "foo ", "bin/rpict "]) + text(view(dice, clip=clip)) + dice.choice(["\n", "", "\n\n"])
        looking = ["-vf", "a.vf", *dice.choice([[], ["-vh", 30], ["-vtv"]])]
    else:
        looking = view(dice, clip=clip)
    octree = Step("oconv", ["-w", *dice.choice([[], ["-f"]]), "scene.rad"], "scene.oct", same, needed=True)
    return Case(files, [octree, *dice.choice([single, single, single, sequences, recover, odd])(dice, options, looking, files, clip)])


def single(dice, options, looking, files, clip):
    more = {}
    out = "picture.hdr"
    words = [*looking, *options]
    if clip and dice.chance(0.5):
        words, more["z.zbf"] = [*words, "-z", "z.zbf"], depths
    if dice.chance(0.2):
        words, more["out.hdr"], out = [*words, "-o", "out.hdr"], picture, "none"
    step = Step("rpict", [*words, "scene.oct"], out, same if out == "none" else picture, more=more)
    return [step, Step("getinfo", ["-d", *([out] if out != "none" else ["out.hdr"])], "size", same)]


def sequences(dice, options, looking, files, clip):
    """-S with views on standard input; pictures on standard output or in files."""
    lines = []
    # None without pixels, whose files Radiance leaves empty.
    options = [*options, "-x", dice.randint(10, 40), "-y", dice.randint(10, 40)]
    for _ in range(dice.randint(0, 4)):
        more = dice.choice([view(dice, 0, clip), ["-vp", *dice.point(6)], ["-vh", 30], ["-vs", 0.5], ["-vtl", "-vh", 4, "-vv", 3]])
        lines.append(dice.choice(["VIEW= ", "VIEW= ", "rvu ", "rpict ", "/bin/rview ", "nothing ", ""]) + text(more))
    first = dice.choice([1, 1, 3, 0])
    words = [*looking, *options, "-S", first]
    more = {}
    if dice.chance(0.6):
        pattern = dice.choice(["f%d.hdr", "frame%03d.hdr"])
        words += ["-o", pattern]
        more = {pattern % (first + n): picture for n in range(5)}
        if clip and dice.chance(0.5):
            words += ["-z", "z%02d.zbf"]
            more |= {f"z{first + n:02d}.zbf": depths for n in range(5)}
        if dice.chance(0.2):
            files[pattern % (first + 1)] = "kept"
            more[pattern % (first + 1)] = same
    step = Step("rpict", [*words, "scene.oct"], "pictures", same if more else sequence if first else picture, "\n".join([*lines, ""]).encode(), more)
    return [step]


def recover(dice, options, looking, files, _clip):
    """A picture that is there, whole or cut, and -r or -ro, with what is left of it."""
    # Large enough for cuts to spare the header; sources are not drawn into the first row that is computed.
    options = [*options, "-x", dice.randint(20, 60), "-y", dice.randint(20, 60), "-dv-"]
    words = [*looking, *options]
    first = Step("rpict", [*words, "scene.oct"], "first.hdr", picture, needed=True)
    cut = f"head -c {dice.choice(['-0', '-1', '-20', '20', '0'])} first.hdr > part.hdr; wc -c < part.hdr > /dev/null"
    cutting = Step("sh", ["-c", cut], "cut", same)
    again = dice.choice([
        Step("rpict", [*options, "-r", "part.hdr", "scene.oct"], "again.hdr", picture),
        Step("rpict", [*options, "-ro", "part.hdr", "scene.oct"], "none", same, more={"part.hdr": picture}),
        Step("rpict", [*words, "-ro", "part.hdr", "scene.oct"], "none", same, more={"part.hdr": picture}),
        Step("rpict", [*options, "-r", "part.hdr", "-o", "again.hdr", "scene.oct"], "none", same, more={"again.hdr": picture}),
    ])
    return [first, cutting, again]


def odd(dice, options, looking, files, _clip):
    """Command lines that are refused, or nearly."""
    words = [*looking, *options]
    spoil = dice.choice([["-x"], ["-pa", 1, "-x", 0], ["-pa", 1, "-y", 0], ["-pa", 1, "-x", -3], ["-pa", "x"], ["-o"], ["-S", 1, "-r", 2], ["-q"], ["-h"], ["-n", "x"], ["-vf", "none.vf"],
                         ["-r", "none.hdr"], ["-z", "none/z"], ["-o", "scene.rad"], ["-ab", 1.5], ["-lw", "1e"], ["-i+x"], ["-iy"], ["-pc", 1, 1, 1, 1, 1, 1, 1, 1],
                         ["-t", "1.5"], ["-cs", 2], ["-cw", 500, 500, "-cs", 9], ["-defaults"], ["-version"], ["-P", "x"], ["-ps", 17], ["-pd", 0], ["-pm", 0], ["$NOTSET"]])
    look = nothing if "-defaults" in spoil or "-version" in spoil else picture
    return [Step("rpict", [*words, *spoil, "scene.oct"], "picture.hdr", look)]
