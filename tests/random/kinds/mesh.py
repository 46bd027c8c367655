"""obj2mesh and what it makes of random OBJ files, placed by mesh and frozen into octrees."""

import math

import rays
from case import Case, Step
from dice import text
from kinds.scene import EXACT
from model import Model
from modifiers import pattern
from outputs import Values, same
from surfaces import light


def make(dice):
    model = Model()
    names = ["red", "green"]
    for name in names:
        under = pattern(dice, model, "void", ["brightfunc", "colorpict", "brightdata"]) if dice.chance(0.3) else "void"
        model.add(under, dice.choice(["plastic", "metal"]), name, [], [*dice.colour(), dice.choice([0, 0.05]), 0])
    if dice.chance(0.3):
        model.add("void", "brightfunc", "uv", ["if(frac(3*Lu)-.5,.4+.3*Lv,1)", "."])
        model.add("uv", "plastic", "red", [], [*dice.colour(), 0, 0])
    materials = model.text()
    files = {**model.files, "materials.rad": materials, "thing.obj": thing(dice, [*names, "void", "unknown"] if dice.chance(0.2) else names)}
    words = dice.some(["-w"], 0.6)
    words += dice.choice([[], ["-n", dice.choice([1, 3, 30])]])
    words += dice.choice([[], ["-r", dice.choice([4, 100])]])
    words += dice.choice([["-a", "materials.rad"], ["-l", "materials.rad"], ["-a", "materials.rad"], []])
    out = dice.chance(0.5)
    compile_ = Step("obj2mesh", [*words, "thing.obj", *(["thing.rtm"] if out else [])], "out" if out else "thing.rtm", same, more={"thing.rtm": same} if out else {}, needed=True)
    scene = Model()
    light(dice, scene, ["sun", "sphere"])
    scene.add("void", "plastic", "cover", [], [0.5, 0.3, 0.2, 0, 0])
    placed = []
    for copy in range(dice.randint(1, 3)):
        # Apart from each other: which of two coincident triangles is hit is left to chance.
        placed.append(["thing.rtm", *dice.transform(), "-t", *dice.point(0.5)])
        scene.add(dice.choice(["void", "void", "cover"]), "mesh", f"mesh{copy}", placed[-1])
    files = {**files, **scene.files, "scene.rad": materials + scene.text()}
    steps = [compile_, Step("oconv", [*dice.some(["-w", "-f"], 0.5), "scene.rad"], "scene.oct", same, needed=True)]
    last = "scene.oct"
    if dice.chance(0.4):
        files["outer.rad"] = scene_lights(scene) + f"void instance inner {1 + len(move := dice.transform())} {text(['scene.oct', *move])} 0 0\n"
        steps.append(Step("oconv", [*dice.some(["-w", "-f"], 0.5), "outer.rad"], "outer.oct", same, needed=True))
        last = "outer.oct"
    scene.targets = [[0, 0, 0], [0.5, 0.5, 0.5]]
    seen = rays.at(dice, scene, 200, 0.8)
    pack = rays.packer("a")
    fields = dice.choice(["vLsN", "vLncm", "vpcM"])
    steps.append(Step("rtrace", [*EXACT, "-st", "0", "-h", f"-o{fields}", last], "values", Values(fields, "a", 3, seen, pack), pack(seen)))
    return Case(files, steps)


def scene_lights(scene):
    """The lights of a scene: its parts before the cover."""
    return "".join(scene.parts[:next(i for i, part in enumerate(scene.parts) if " cover" in part)]) + "\n"


def thing(dice, materials):
    """A patch of hills or some loose faces, with or without normals and texture coordinates."""
    lines = ["# made at random", dice.choice(["o thing", "g whole", "s 1", "mtllib none.mtl"])]
    size = dice.randint(2, 6)
    for y in range(size):
        for x in range(size):
            height = 0.3 * math.sin(2.1 * x + 1.3 * y + dice.uniform(0, 0.2))
            lines.append(f"v {x / (size - 1) * 2 - 1:.6g} {y / (size - 1) * 2 - 1:.6g} {height:.6g}")
            lines.append(f"vt {x / (size - 1):.6g} {y / (size - 1):.6g}")
            n = [dice.uniform(-0.3, 0.3), dice.uniform(-0.3, 0.3), 1]
            lines.append(f"vn {n[0]:.5g} {n[1]:.5g} 1")
    form = dice.choice(["{0}", "{0}/{0}", "{0}//{0}", "{0}/{0}/{0}"])
    total = size * size
    lines.append(f"usemtl {dice.choice(materials)}")
    for y in range(size - 1):
        for x in range(size - 1):
            a = y * size + x + 1
            corners = [a, a + 1, a + size + 1, a + size]
            if dice.chance(0.3):
                corners = [c - total - 1 for c in corners]
            split = dice.choice(["triangles", "triangles", "one"])
            faces = [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
            # Faces far from flat are cut otherwise, a known difference.
            faces = faces if split == "triangles" else faces[:1]
            for face in faces:
                lines.append("f " + " ".join(form.format(c) for c in face))
            if dice.chance(0.15):
                lines.append(dice.choice([f"usemtl {dice.choice(materials)}", f"g {dice.choice(materials)}", "s off", "l 1 2", ""]))
    if dice.chance(0.3):
        z = dice.real(0.5, 1)
        ring = sorted(dice.uniform(0, 6.28) for _ in range(dice.randint(3, 7)))
        for angle in ring:
            lines.append(f"v {math.cos(angle):.6g} {math.sin(angle):.6g} {z}")
        lines.append("f " + " ".join(str(i - len(ring)) for i in range(len(ring))))
    if dice.chance(0.1):
        lines.append(dice.choice(["f 1 2", "f 1 2 999", "v 1 2", "f 1 1 2", "f a b c", "v 1 2 x", "usemtl"]))
    return "\n".join(lines) + dice.choice(["\n", "", "\r\n"])
