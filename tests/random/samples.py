"""Answers that hold noise: each ray is asked many times, and the means of both sides are held against their spread."""

import re

import numpy as np

import outputs

# Standard errors that means may lie apart. A run holds thousands of means, and samples of highlights have long tails.
SIGMAS = 6
# What is no noise: the share that means may differ by besides.
SHARE = 0.004
# Answers are averaged in groups first, whose means have shorter tails.
GROUPS = 20


class Means:
    """Output of rtrace -h -ov to rays that are repeated, `times` each in a row."""

    # Nothing lies on edges that noise does not cover.
    rays = None

    def __init__(self, times, colours=3):
        self.times, self.colours = times, colours

    def __call__(self, ours, theirs):
        _, a = outputs.split(ours)
        _, b = outputs.split(theirs)
        a, b = (self._groups(data[at:]) for data, at in ((ours, a), (theirs, b)))
        if a.shape != b.shape:
            return [f"{a.shape} and {b.shape} values"]
        (m, e), (n, f) = ((x.mean(axis=1), x.std(axis=1, ddof=1) / GROUPS ** 0.5) for x in (a, b))
        limit = SIGMAS * np.hypot(e, f) + SHARE * np.abs(n) + 1e-7
        found = []
        for ray in np.argwhere((np.abs(m - n) > limit).any(axis=1))[:, 0]:
            show = lambda mean, error: " ".join(f"{x:.5g} ± {y:.2g}" for x, y in zip(mean, error))
            found.append(f"ray {ray}: {show(m[ray], e[ray])} and {show(n[ray], f[ray])}")
        return found

    def _groups(self, body):
        """Means of groups of answers: ray x group x colour."""
        values = np.array([float(word) for word in body.split()])
        return values.reshape(-1, GROUPS, self.times // GROUPS, self.colours).mean(axis=2)


class Pictures:
    """Sequences of pictures of two views in turn, one behind the other: the means of each pixel."""

    # Nothing to ask again.
    rays = None

    def __call__(self, ours, theirs):
        found = []
        for turn in (0, 1):
            a, b = (self._pixels(data, turn) for data in (ours, theirs))
            if a.shape[1:] != b.shape[1:]:
                return [f"{a.shape[1:]} and {b.shape[1:]} pixels"]
            (m, e), (n, f) = ((x.mean(axis=0), x.std(axis=0, ddof=min(1, len(x) - 1)) / len(x) ** 0.5) for x in (a, b))
            # Where few samples meet something the spread is often too small: neighbours share theirs.
            spread = _smoothed(np.hypot(e, f))
            off = (np.abs(m - n) > SIGMAS * spread + outputs.PIXEL * n.mean()).any(axis=2)
            # Radiance draws no small sources into the topmost row.
            off[0] = False
            if off.sum() > max(1, outputs.SHARE * off.size):
                y, x = np.argwhere(off)[0]
                found.append(f"{off.sum()} of {off.size} pixels differ, row {y} column {x}: {m[y, x]} and {n[y, x]} ± {spread[y, x]}")
        return found

    def _pixels(self, data, turn):
        """The different ones of every other picture; some are made twice with the same numbers."""
        parts = re.split(rb"FRAME=(\d+)\n", data)
        pictures = [outputs.pixels(b"#?\n" + part.split(b"#?RADIANCE\n")[0]) for number, part in zip(parts[1::2], parts[2::2]) if int(number) % 2 == turn]
        return np.unique(np.array(pictures), axis=0)


def _smoothed(errors):
    """Root mean square of each pixel and its eight neighbours."""
    padded = np.pad(errors ** 2, ((1, 1), (1, 1), (0, 0)), "edge")
    rows, columns = errors.shape[:2]
    return np.sqrt(sum(padded[y:y + rows, x:x + columns] for y in range(3) for x in range(3)) / 9)
