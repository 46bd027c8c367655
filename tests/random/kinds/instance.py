"""Instances of scenes of all kinds, within instances, moved, turned, mirrored and scaled, beside meshes, under patterns and textures of their own."""

import re

import materials
import rays
from case import Case, Step
from dice import text
from kinds.scene import EXACT, build
from model import Model
from modifiers import pattern, texture
from outputs import Values, same
from surfaces import light, surface, surroundings


def make(dice):
    outer, steps, files = Model(), [], {}
    surroundings(dice, outer)
    for _ in range(dice.randint(1, 2)):
        light(dice, outer, ["sun", "panel", "spot", "sphere"])
    inside, targets, traits = "", [], set()
    for depth in range(dice.choice([1, 1, 2])):
        part = Model()
        # Names and files of all parts are apart from each other.
        part.count = 1000 * (depth + 1)
        build(dice, lamps=[], model=part, sky=False)
        files |= {**part.files, f"part{depth}.rad": part.text() + inside}
        traits |= part.traits
        steps.append(Step("oconv", [*dice.some(["-f"], 0.4), "-w", f"part{depth}.rad"], f"part{depth}.oct", same, needed=True))
        inside, placed = "", Model()
        placed.count = 5000 + 100 * depth
        targets = []
        for copy in range(dice.randint(1, 3)):
            move = [*dice.transform(), "-t", *dice.point(1.5)]
            words = [f"part{depth}.oct", *move]
            inside += f"\n{cover(dice, placed)} instance i{depth}.{copy}\n{len(words)} {text(words)}\n0\n0\n"
            targets.append(move[-3:])
        inside = placed.text() + inside
        files |= placed.files
        traits |= placed.traits
    for _ in range(dice.choice([0, 0, 1])):
        surface(dice, outer, materials.modifier(dice, outer, ["plastic", "glass", "metal"]))
        traits |= outer.traits
    outer.targets = [*targets, *targets, *outer.targets]
    files |= {**outer.files, "scene.rad": outer.text() + inside}
    steps.append(Step("oconv", [*dice.some(["-f"], 0.3), "-w", "scene.rad"], "scene.oct", same, needed=True))
    fields = dice.choice(["v", "vLs", "vlpNn", "vsmM"])
    if "mixed" in traits:
        fields = re.sub("[nlRX]", "", fields)
    seen = rays.at(dice, outer, 150, 0.5)
    pack = rays.packer("a")
    options = [*EXACT, "-st", "1" if "random" in traits else "0", *dice.choice([[], ["-av", *dice.colour()]]), *dice.choice([[], [], ["-i"]])]
    steps.append(Step("rtrace", [*options, "-h", f"-o{fields}", "scene.oct"], "values", Values(fields, "a", 3, seen, pack), pack(seen)))
    return Case(files, steps)


def cover(dice, model):
    """What stands for the materials of an instance, or is put over them; often nothing."""
    kind = dice.choice(["void", "void", "void", "material", "pattern", "texture"])
    if kind == "material":
        return materials.modifier(dice, model, ["plastic", "metal", "glass", "trans"])
    if kind == "void":
        return "void"
    return {"pattern": pattern, "texture": texture}[kind](dice, model)
