"""Answers that hold noise: each ray is asked many times, and the means of both sides are held against their spread."""

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
