"""A scene in the making: text, files beside it, and points that rays should aim at."""

from dice import text
from expressions import HELPERS, RAY

FONT = """# A few letters.
32 0
33 4 100 0 150 0 150 255 100 255
97 4 20 0 230 0 230 150 20 150
98 7 20 0 20 255 70 255 70 150 230 150 230 0 20 0
99 3 200 20 20 80 200 140
72 12 10 0 60 0 60 100 190 100 190 0 240 0 240 250 190 250 190 150 60 150 60 250 10 250
101 6 30 0 220 0 220 40 80 40 80 160 30 160
108 4 90 0 140 0 140 255 90 255
111 10 20 0 220 0 220 150 20 150 20 0 70 40 70 110 170 110 170 40 70 40
100 4 40 0 200 0 200 250 150 130
120 4 20 0 120 80 220 0 120 160
65 3 10 0 240 0 125 250
66 4 30 10 220 10 200 240 30 240
67 5 220 20 40 20 40 230 220 230 90 120
"""
# Of texdata, which hands the three values to each.
MORE = "red3(a,b,c) = a; green3(a,b,c) = b; blue3(a,b,c) = c;\n"


class Model:
    def __init__(self):
        self.files, self.parts, self.targets, self.count = {}, [], [], 0
        # Names of sources, for mist, and materials by name, for antimatter, aliases and -te.
        self.lights, self.materials, self.surfaces = [], [], []
        # What patterns and textures may depend on.
        self.ray = RAY
        # Set where something may only be compared with some options.
        self.traits = set()

    def places(self):
        """What depends on the place alone."""
        return [name for name in self.ray if name[0] in "PN"]

    def name(self, kind):
        self.count += 1
        return f"{kind}{self.count}"

    def add(self, under, kind, name, strings=(), reals=()):
        """A primitive; strings with blanks are quoted."""
        words = [f'"{w}"' if isinstance(w, str) and (" " in w or not w) else w for w in strings]
        self.parts.append(f"\n{under} {kind} {name}\n{len(words)} {text(words)}\n0\n{len(reals)} {text(reals)}\n")
        return name

    def file(self, suffix, content):
        name = self.name("f") + "." + suffix
        self.files[name] = content
        return name

    def helpers(self):
        self.files["helpers.cal"] = HELPERS + MORE
        return "helpers.cal"

    def font(self):
        self.files["letters.fnt"] = FONT
        return "letters.fnt"

    def text(self):
        return "".join(self.parts)

    def all_files(self, name="scene.rad"):
        return {**self.files, name: self.text()}
