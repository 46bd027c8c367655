"""Random rays at a model, and how they are written."""

import struct

from dice import text


def at(dice, model, count, spread=0.5, above=False):
    """Rays from all around, or from above, at the model's targets, and some that may hit nothing."""
    found = []
    for _ in range(count):
        target = dice.choice(model.targets or [[0, 0, 0]])
        target = [c + dice.uniform(-spread, spread) for c in target]
        away = dice.real(1.5, 8)
        way = dice.direction()
        way = [*way[:2], abs(way[2]) + 0.05] if above else way
        origin = [float(f"{c + away * d:.9g}") for c, d in zip(target, way)]
        length = dice.choice([1.0, 1.0, 0.3, 2.7])
        found.append([*origin, *(float(f"{length * (t - o) / away:.9g}") for t, o in zip(target, origin))])
    return found


def packer(letter):
    """A function from rays to bytes in an input format."""
    if letter == "a":
        return lambda rays: "".join(text(f"{x:.12g}" for x in ray) + "\n" for ray in rays).encode()
    return lambda rays: b"".join(struct.pack(f"=6{letter}", *ray) for ray in rays)
