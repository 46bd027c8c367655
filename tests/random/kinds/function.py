"""Files of functions and expressions, each shown as the radiance of a wall."""

import rays
from case import Case, Step
from expressions import RAY, definitions, expression
from model import Model
from outputs import Values, same

WALLS = 6


def make(dice):
    model = Model()
    names = [*RAY, *dice.some(["arg(1)", "A2", "AC", "T", "Tx", "Iy", "Kz", "S", "U", "V", "NxP", "Ts"], 0.15)]
    names = [n for n in names if n not in ("NxP", "Ts")]
    for wall in range(WALLS):
        text, variables, functions = definitions(dice, names, dice.randint(3, 9))
        file = model.file("cal", text)
        value = lambda: f"2+sin({expression(dice, [*names, *variables], 3, functions)})"
        arguments = dice.reals(dice.randint(2, 5), -1, 1)
        move = dice.transform()
        kind = dice.choice(["colorfunc", "brightfunc"])
        model.add("void", kind, f"p{wall}", [*(value() for _ in range(3 if kind == "colorfunc" else 1)), file, *move], arguments)
        if dice.chance(0.3):
            model.add(f"p{wall}", "texfunc", f"t{wall}", ["Nx*.1", value(), ".3", file], arguments)
        model.add(f"p{wall}", "glow", f"g{wall}", [], [1, 1, 1, 0])
        z = dice.real(-1, 1)
        model.add(f"g{wall}", "polygon", f"w{wall}", [], [2 * wall, 0, z, 2 * wall + 1, 0, z, 2 * wall + 1, 1, z + dice.choice([0, 0.3]), 2 * wall, 1, z + 0.01])
        model.targets.append([2 * wall + 0.5, 0.5, z])
    seen = rays.at(dice, model, 80, 0.3, above=True)
    pack = rays.packer("d")
    trace = Step("rtrace", ["-w-", "-h", "-fda", "-ovs", "-ab", "0", "scene.oct"], "values", Values("vs", "a", 3, seen, pack), pack(seen))
    return Case(model.all_files(), [Step("oconv", ["-w", "scene.rad"], "scene.oct", same, needed=True), trace])
