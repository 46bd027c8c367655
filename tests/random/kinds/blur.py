"""Depth of field and motion blur: pixels hold noise, so the same picture is made many times."""

from case import Case, Step
from dice import text
from kinds.rpict import view
from kinds.scene import build
from outputs import nothing, same
from samples import Pictures

# Runs, pictures of each, pixels across.
RUNS, FRAMES, SIZE = 16, 24, 24
OPTIONS = "-w- -u+ -ab 0 -dj 0 -dt 0 -dc 1 -ds 0 -ss 0 -st 1 -lr 5 -ps 1".split()


def make(dice):
    # Lamps are seen by samples alone if pictures are blurred.
    model = build(dice, ["plastic", "metal", "glass", "plastic"], lamps=["sun", "panel"])
    looking = [*view(dice, 0), "-x", SIZE, "-y", SIZE, "-pa", dice.choice([0, 0, 1])]
    options = [*OPTIONS, "-pj", dice.choice([0, 0.67, 1])]
    kind = dice.choice(["lens", "motion", "both"])
    if kind != "motion" and "-vtl" not in looking:
        # All rays of a parallel view start at one point in Radiance, a known difference.
        options += ["-pd", dice.choice([0.05, 0.3, 1])]
    at = looking.index("-vp") + 1
    moved = [c + dice.uniform(-0.3, 0.3) for c in looking[at:at + 3]]
    turned = [c + dice.uniform(-0.03, 0.03) for c in looking[at + 4:at + 7]]
    there, back = ["-vp", *looking[at:at + 3], "-vd", *looking[at + 4:at + 7]], dice.choice([["-vp", *moved], ["-vp", *moved, "-vd", *turned], ["-vd", *turned]])
    if kind != "lens":
        options += ["-pm", dice.choice([0.3, 1])]
    # To and fro, so that all pictures of either kind blur the same motion.
    stdin = "".join(f"VIEW= {text(words)}\n" for words in [back, there] * (FRAMES // 2)).encode()
    name = "pictures{}"
    steps = [Step("oconv", ["-w", "scene.rad"], "scene.oct", same, needed=True)]
    # Radiance's numbers change from picture to picture, and with the second; ours only from run to run.
    steps += [Step("rpict", [*looking, *options, "-S", 2, "scene.oct"], name.format(n), nothing, stdin, ours=["--seed", n], needed=True) for n in range(RUNS)]
    steps.append(Step("cat", [name.format(n) for n in range(RUNS)], "all", Pictures()))
    return Case(model.all_files(), steps)
