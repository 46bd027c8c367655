"""Random choices in the words of scene files and command lines."""

import math
import random


class Dice(random.Random):
    """All choices of a case come from one of these: the same seed makes the same case."""

    def chance(self, share):
        return self.random() < share

    def real(self, low, high, digits=4):
        return float(f"{self.uniform(low, high):.{digits}g}")

    def reals(self, count, low, high):
        return [self.real(low, high) for _ in range(count)]

    def colour(self, low=0.05, high=0.95):
        """Three channels; grey now and then, one of them black or white now and then."""
        if self.chance(0.2):
            return [self.real(low, high)] * 3
        channels = self.reals(3, low, high)
        if self.chance(0.1):
            channels[self.randrange(3)] = self.choice([0, 1])
        return channels

    def direction(self):
        """Unit vector; along an axis now and then, where ties are."""
        if self.chance(0.15):
            axis = [0.0, 0.0, 0.0]
            axis[self.randrange(3)] = self.choice([-1.0, 1.0])
            return axis
        while True:
            v = [self.uniform(-1, 1) for _ in range(3)]
            length = math.sqrt(sum(c * c for c in v))
            if 0.1 < length < 1:
                return [float(f"{c / length:.6g}") for c in v]

    def point(self, size=1.5):
        return self.reals(3, -size, size)

    def some(self, items, share):
        """Each of the items with this probability, in order."""
        return [item for item in items if self.chance(share)]

    def transform(self, scale=True):
        """Words of a transform, perhaps none."""
        words = []
        for _ in range(self.choice([0, 0, 1, 1, 2, 3])):
            kind = self.choice(["-t", "-rx", "-ry", "-rz", "-mx", "-my", "-mz", "-i"] + ["-s"] * scale)
            if kind == "-t":
                words += [kind, *self.reals(3, -1, 1)]
            elif kind.startswith("-r"):
                words += [kind, self.choice([90, 180, self.real(-180, 180)])]
            elif kind == "-s":
                words += [kind, self.choice([2, 0.5, self.real(0.4, 2)])]
            elif kind == "-i":
                words += [kind, self.choice([1, 2])]
            else:
                words += [kind]
        return words


def text(words):
    """Words of a command line or a scene file with blanks between."""
    return " ".join(word if isinstance(word, str) else f"{word:.12g}" for word in words)
