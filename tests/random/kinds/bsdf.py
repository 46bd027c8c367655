"""BSDF files: matrices of several bases, tensor trees, parts that are missing, colours; seen, lit from either side and sampled."""

import rays
from case import Case, Step
from expressions import within
from kinds.scene import EXACT
from model import Model
from modifiers import pattern, texture
from outputs import Values, same
from surfaces import light, surroundings, surface

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement><FileType>BSDF</FileType><Optical><Layer><Material><Name>Random</Name><Thickness unit="Meter">0.01</Thickness></Material>
<DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>{bases}</DataDefinition>
"""
BASES = {"LBNL/Klems Quarter": 41, "LBNL/Klems Half": 77, "LBNL/Klems Full": 145}
OWN = [("Three", [(0, 40, 1), (40, 90, 2)]), ("Nine", [(0, 20, 1), (20, 60, 4), (60, 90, 4)]), ("One", [(0, 90, 1)])]
DIRECTIONS = ["Reflection Back", "Reflection Front", "Transmission Back", "Transmission Front"]


def matrix_file(dice, peak=False):
    name, rings = dice.choice(OWN)
    if peak or dice.chance(0.4):
        basis, size, bases = *dice.choice(list(BASES.items())), ""
    else:
        basis, size = name, sum(n for _, _, n in rings)
        bounds = "<ThetaBounds><LowerTheta>{}</LowerTheta><UpperTheta>{}</UpperTheta></ThetaBounds>"
        blocks = "".join(f"<AngleBasisBlock><nPhis>{n}</nPhis>{bounds.format(a, b)}</AngleBasisBlock>" for a, b, n in rings)
        bases = f"<AngleBasis><AngleBasisName>{basis}</AngleBasisName>{blocks}</AngleBasis>"
    parts = [HEAD.format(structure=dice.choice(["Columns", "Rows"]), bases=bases)]
    colours = dice.choice([["Visible"], ["Visible"], ["Visible", "CIE-X", "CIE-Z"], ["Visible", "Solar"]])
    directions = dice.some(DIRECTIONS, 0.6) or DIRECTIONS[:1]
    tables = {}
    for wavelength in colours:
        for direction in directions:
            values = tables.setdefault(direction, table(dice, size, peak and direction[0] == "T"))
            tint = 1 if wavelength == "Visible" else dice.uniform(0.9, 1.1)
            numbers = "\n".join(dice.choice([" ", ", "]).join(f"{v * tint:.5f}" for v in row) for row in values)
            parts.append(f"<WavelengthData><Wavelength unit=\"Integral\">{wavelength}</Wavelength><WavelengthDataBlock>"
                         f"<WavelengthDataDirection>{direction}</WavelengthDataDirection><ColumnAngleBasis>{basis}</ColumnAngleBasis>"
                         f"<RowAngleBasis>{basis}</RowAngleBasis><ScatteringData>\n{numbers}\n</ScatteringData></WavelengthDataBlock></WavelengthData>\n")
    return "".join(parts) + "</Layer></Optical></WindowElement>\n"


def table(dice, size, peak):
    """Rows of cells that scatter less than all light, some directions none; or little, and a peak straight on."""
    if peak:
        straight = dice.uniform(0.2, 0.7) * size / 3.1416
        return [[straight if i == j else dice.uniform(0.02, 0.05) for i in range(size)] for j in range(size)]
    values = [dice.uniform(0.02, 0.12) * dice.choice([1, 1, 1, 2, 0]) for _ in range(size)]
    return [[v * dice.uniform(0.8, 1.2) for v in values] for _ in range(size)]


def tree_file(dice):
    rank = dice.choice([3, 4])
    directions = dice.some(DIRECTIONS, 0.6) or DIRECTIONS[:1]
    if rank == 3 and any(d.startswith("T") for d in directions):
        # Radiance can not turn these around to tell what is transmitted the other way.
        directions = [d for d in directions if d.startswith("R")] + DIRECTIONS[2:]
    parts = [HEAD.format(structure=f"TensorTree{rank}", bases="")]
    for direction in directions:
        parts.append(f"<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock><WavelengthDataDirection>{direction}</WavelengthDataDirection>"
                     f"<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>\n{node(dice, rank, 2)}\n</ScatteringData></WavelengthDataBlock></WavelengthData>\n")
    return "".join(parts) + "</Layer></Optical></WindowElement>\n"


def node(dice, rank, depth):
    if depth and dice.chance(0.4 if depth == 2 else 0.15):
        return "{" + "\n".join(node(dice, rank, depth - 1) for _ in range(1 << rank)) + "}"
    count = 1 << rank * dice.choice([0, 1] if rank == 4 else [0, 1, 2])
    return "{" + dice.choice([" ", ", "]).join(f"{dice.uniform(0.02, 0.25):.4f}" for _ in range(count)) + "}"


def glazing(dice, model):
    """Adds surfaces of a random BSDF, a floor and lamps to a model."""
    under = dice.choice(["void", "void", "pattern", "texture"])
    if under != "void":
        under = {"pattern": pattern, "texture": texture}[under](dice, model)
    kind = dice.choice(["BSDF", "BSDF", "aBSDF"])
    # Where tables are noise all over, which cells are a peak differs; so does it near borders of cells, a debt.
    file = model.file("xml", matrix_file(dice, peak=True) if kind == "aBSDF" else dice.choice([matrix_file, tree_file])(dice))
    up = [f"{c:.4g}" for c in dice.direction()] if under != "void" or dice.chance(0.7) else [within(dice, ["Px", "Py", "Pz"], -1, 1, 1) for _ in range(3)]
    thickness = [dice.choice(["0", "0", "0", ".1", "-.1"])] if kind == "BSDF" else []
    move = [] if under != "void" else dice.transform()
    name = model.add(under, kind, model.name("m"), [*thickness, file, *up, model.helpers(), *move], dice.reals(dice.choice([0, 0, 3, 6, 9]), 0, 0.3))
    model.add("void", "plastic", "floor", [], [0.5, 0.4, 0.3, 0, 0])
    for _ in range(dice.randint(1, 3)):
        surface(dice, model, name, ["polygon", "polygon", "sphere", "ring"])
    surface(dice, model, "floor", ["polygon"])
    for _ in range(dice.randint(1, 2)):
        light(dice, model, ["point"])


def make(dice):
    model = Model()
    if dice.chance(0.6):
        surroundings(dice, model)
    glazing(dice, model)
    options = [*EXACT, "-st", "1"] + (["-av", *dice.colour()] if dice.chance(0.5) else []) + (["-bv-"] if dice.chance(0.1) else [])
    seen = rays.at(dice, model, 120, 0.3)
    pack = rays.packer("a")
    # Radiance rounds the colours of matrices to steps of 1/410 in u' and v', up or down at random, which can change a channel by
    # 4 %; and it multiplies each cell by a factor of up to 1 ± 3e-4.
    tolerance = 0.04 if any("CIE-X" in text for text in model.files.values() if isinstance(text, str)) else 0.002
    trace = Step("rtrace", [*options, "-h", "-ovLs", "scene.oct"], "values", Values("vLs", "a", 3, seen, pack, tolerance=tolerance), pack(seen))
    return Case(model.all_files(), [Step("oconv", ["-w", "scene.rad"], "scene.oct", same, needed=True), trace])
