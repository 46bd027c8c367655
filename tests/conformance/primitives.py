"""One scene for each primitive type, fixtures/types/TYPE.rad, rendered by both sides without anything random."""

from dataclasses import dataclass

import numpy as np

import pictures
from scenes import ROOT

FOLDER = ROOT / "fixtures" / "types"
# Scenes that the others are made of.
PARTS = {"stage", "show", "part"}
SIZE = 64
OPTIONS = "-ab 0 -av .1 .1 .1 -dj 0 -pj 0 -ps 1 -ss 0 -st 1e-4 -dt 0 -dc 1 -ds .1 -dr 2 -lr 8 -lw 1e-4 -u-".split()
# These types sample light at random, whatever -ss says: their highlights are compared without (-st 1), and once more,
# as TYPE_sampled, with them.
EXACT = {"BSDF": "-st 1", "aBSDF": "-st 1", "ashik2": "-st 1", "mist": "-ms .02"}
# Of -ss above 1 Radiance makes black spots: see known-differences.md.
SAMPLED = {"BSDF": "-ss 1", "aBSDF": "-ss 1", "ashik2": "-ss 1"}
# Radiance draws the wavelengths of these at random, too.
NOISY = {"specfunc"}
SAMPLED_SIZE, BOXES = 192, 8

# Greatest relative difference of means.
MEAN = 0.01
# A pixel differs if it is off by this much of the picture's mean, and so may this share of them: edges fall either way.
PIXEL, SHARE = 0.02, 0.005
# Where light is sampled, boxes of 24 x 24 pixels are compared instead: noise is left of what differs.
NOISY_PIXEL = 0.04


def types():
    """The 59 types by name, and those that are compared once more."""
    return sorted([p.stem for p in FOLDER.glob("*.rad") if p.stem not in PARTS] + [f"{kind}_sampled" for kind in SAMPLED])


@dataclass
class Comparison:
    """Two pictures of one scene."""

    ours: float
    theirs: float
    differ: float
    agrees: bool

    def note(self):
        return f"means by {100 * abs(self.ours / self.theirs - 1):.2f} %, {100 * self.differ:.2f} % of the pixels differ"


def compare(kind, ours, theirs, work):
    """Renders fixtures/types/KIND.rad with both sides into the folder `work`."""
    a, b = (_render(kind, side, work) for side in (ours, theirs))
    mean = abs(a.mean() / b.mean() - 1)
    if kind in NOISY or kind.endswith("_sampled"):
        boxes = [pictures.boxes(p, BOXES) for p in (a, b)]
        off = np.abs(boxes[0] - boxes[1]).max(axis=2) > NOISY_PIXEL * b.mean()
    else:
        # RGBE keeps 8 bits: one step of the exponent's largest channel is up to 1/128 of it, in either picture.
        step = np.maximum(a.max(axis=2), b.max(axis=2)) / 64
        off = np.abs(a - b).max(axis=2) > PIXEL * b.mean() + step
    differ = float(off.mean())
    return Comparison(a.mean(), b.mean(), differ, bool(mean <= MEAN and differ <= SHARE))


def _render(kind, side, work):
    octree, out = work / f"{kind}-{side.name}.oct", work / f"{kind}-{side.name}.hdr"
    scene = kind.removesuffix("_sampled")
    own = EXACT.get(kind, "") if scene == kind else SAMPLED[scene]
    size = SIZE if scene == kind and kind not in NOISY else SAMPLED_SIZE
    side.run("oconv", ["-w", f"{scene}.rad"], FOLDER, out=octree)
    arguments = ["-w", "-vf", "types.vf", "-x", size, "-y", size, *OPTIONS, *own.split(), octree]
    side.run("rpict", arguments, FOLDER, out=out)
    return pictures.read(out)
