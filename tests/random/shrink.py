"""Makes a case that differs smaller: primitives, rays and options are left out as long as it still differs."""

import copy
import shutil

import case as cases
from outputs import Values

# What keeps noise out stays.
KEPT = ("-o", "-f", "-h", "-x", "-y", "-u", "-ss", "-st", "-dj", "-dt", "-dc", "-ds", "-ab", "-lr", "-lw", "-pj", "-ps")
# Options with numbers, which go together.
WITH = {"-vp": 3, "-vd": 3, "-vu": 3, "-av": 3, "-me": 3, "-ma": 3, "-pc": 8, "-cw": 2, "-b": 4}


def shrink(case, sides, folder):
    """The smallest case found that differs, left in the folder, and its differences."""
    def differs(candidate):
        shutil.rmtree(folder, ignore_errors=True)
        return cases.compare(candidate, sides, folder)
    found = differs(case)
    if not found:
        return case, found
    progress = True
    while progress:
        progress = False
        for candidate in candidates(case, found):
            now = differs(candidate)
            # Another kind of difference, as of scenes that lack what the rest needs, is another case.
            if now and ("status" in str(now[0])) == ("status" in str(found[0])):
                case, found, progress = candidate, now, True
                break
    return case, differs(case)


def candidates(case, found):
    """Cases that lack a part, the large parts first."""
    for at, step in enumerate(case.steps):
        if isinstance(step.look, Values) and step.look.rays and len(step.look.rays) > 1:
            yield from (_with(case, at, rays=rays) for rays in fewer(step.look, found))
    for name in [n for n in case.files if n.endswith(".rad")]:
        parts = case.files[name].split("\n\n")
        size = len(parts) // 2
        while size:
            for start in range(0, len(parts), size):
                left = parts[:start] + parts[start + size:]
                yield _with(case, None, files={name: "\n\n".join(left)})
            size //= 2
    for at, step in enumerate(case.steps):
        word = 0
        while word < len(step.words):
            option = str(step.words[word])
            more = WITH.get(option, 0)
            if not more and word + 1 < len(step.words) and str(step.words[word + 1])[:1] in "0123456789.":
                more = 1
            if step.program in ("rpict", "rtrace", "oconv") and option.startswith("-") and not option[1:2].isdigit() and not option.startswith(KEPT):
                yield _with(case, at, words=step.words[:word] + step.words[word + more + 1:])
            word += 1 + more
    for at in range(len(case.steps) - 1, -1, -1):
        if not case.steps[at].needed and len(case.steps) > 1:
            smaller = copy.copy(case)
            smaller.steps = case.steps[:at] + case.steps[at + 1:]
            yield smaller


def fewer(look, found):
    """Parts of the rays: the first that differs, or, where a ray prints many lines, either half."""
    first = next((d for d in found if "ray " in str(d)), None)
    if look.tree or first is None:
        half = len(look.rays) // 2
        yield look.rays[:half]
        yield look.rays[half:]
    else:
        yield [look.rays[int(str(first).split("ray ")[1].split(":")[0])]]


def _with(case, at, files=None, rays=None, words=None):
    smaller = copy.copy(case)
    smaller.files = {**case.files, **(files or {})}
    smaller.steps = list(case.steps)
    if at is not None:
        step = smaller.steps[at] = copy.copy(case.steps[at])
        if words is not None:
            step.words = words
        if rays is not None:
            step.look = copy.copy(step.look)
            step.look.rays = rays
            step.stdin = step.look.pack(rays)
    return smaller
