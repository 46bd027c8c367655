"""The comparison with real Radiance: see `run` beside this file, which starts it.

Checks, one line of the table each:
  NAME direct        picture without interreflection, nothing random: pixel by pixel
  NAME cached        picture with the irradiance cache: mean, and RMS error against a converged picture of Radiance's
  NAME sensors       irradiance at the scene's sensors: mean, and RMS error against converged values
  NAME octree        octrees of either side, frozen or not, read by both: the same answers
  NAME ambient       ambient files of either side, continued by the other
  NAME wavelength    the same by wavelength (-cs 9), plastics made spectral
  NAME lookamb       our lookamb and theirs print both sides' ambient files alike
  types TYPE         picture of fixtures/types/TYPE.rad, nothing random: means, and pixel by pixel
"""

import concurrent.futures
import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pictures
import primitives
import scenes
from scenes import ROOT, Programs

WORK = Path(os.environ["AMBIT_WORK"])
REFERENCES = WORK / "references"
SIZE = 48
BOXES = 12

# Nothing random: jitter off, sharp highlights, every shadow tested.
DIRECT = "-ab 0 -av .1 .1 .1 -dj 0 -pj 0 -ps 1 -ss 0 -st 1e-4 -dt 0 -dc 1 -ds .1 -u-".split()
CACHED = "-ab 2 -aa .2 -ar 32 -ad 128 -as 32 -dj 0 -pj 0 -ps 1 -ds .1 -lw 1e-4 -lr 6".split()
# Every hemisphere sampled anew: noisy in one pixel, not in a box of sixteen pixels, and exactly two bounces. Radiance's cache
# adds some of the light of later bounces; hence a mean between theirs and the converged one is good. Every shadow is
# tested: what -dt spares is guessed from the tests before, by each program in its own way.
CONVERGED = "-ab 2 -aa 0 -ad 36 -dj 0 -pj 0 -ps 1 -ds .1 -dt 0 -lw 1e-5 -lr 6".split()
# -ds divides lamps the less the less a ray weighs, and samples of hemispheres that are not kept weigh next to nothing: lamps
# are points there. Sensors are few enough for hemispheres that are kept, each where it stands; that is 2 % of them in places.
CONVERGED_SENSORS = "-ab 2 -aa 1e-4 -ar 0 -ad 512 -as 0 -dj 0 -ds .1 -dt 0 -lw 1e-5 -lr 6 -u-".split()
CACHED_SENSORS = "-ab 2 -aa .15 -ar 32 -ad 400 -as 100 -dj 0 -ds .1 -lw 1e-4 -lr 6 -u-".split()

# A converged picture that takes longer is given up; the cached pictures are then compared with each other.
PATIENCE = 120

# Runs of either side that are averaged where one fails.
SEEDS = 8
# Greatest relative difference of means.
MEAN = 0.01
# Ours may err by this much more than theirs: part of the error that both have, and what the noise of 12 x 12 boxes does.
WORSE, NOISE = 1.15, 0.004
# Where runs with other random numbers have been averaged, what exceeds these limits must do so by this many standard errors.
SIGMAS = 2


@dataclass
class Line:
    """One line of the table."""

    check: str
    verdict: str
    ours: str = ""
    theirs: str = ""
    note: str = ""


def percent(x):
    return f"{100 * x:.2f} %"


def folder(*parts):
    path = WORK.joinpath(*parts)
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir(parents=True)
    return path


def direct(scene, ours, theirs):
    check = f"{scene.name} direct"
    a, b = (pictures.read(scene.picture(s, folder(s.name, scene.name, "direct"), DIRECT, SIZE)) for s in (ours, theirs))
    if a.shape != b.shape:
        return Line(check, "FAILS", note=f"sizes {a.shape} and {b.shape}")
    # RGBE keeps 8 bits: one step of the exponent's largest channel is up to 1/128 of it, in either picture.
    step = np.maximum(a.max(axis=2), b.max(axis=2)) / 64
    differ = (np.abs(a - b).max(axis=2) > step + 1e-6 * b.mean()).mean()
    mean = abs(a.mean() / b.mean() - 1) if b.mean() > 0 else a.mean()
    good = differ <= 0.005 and mean <= 0.003
    note = f"{percent(differ)} of the pixels differ, means by {percent(mean)}"
    return Line(check, "agrees" if good else "FAILS", note=note)


def runs(side, first, count, get):
    """What get(options) returns in runs `first` to `count`: the first with fixed random numbers, then with others each."""
    def one(run):
        if run == 0:
            return get([])
        if side.name == "ours":
            return get(["--seed", str(run)])
        # Radiance takes its seed from the clock, in seconds: runs within one second would be the same.
        time.sleep(1.05)
        return get(["-u+"])
    return [one(run) for run in range(first, count)]


def judge(check, ours, theirs, reference):
    """Verdict over arrays of ours, and of theirs, one a run; the mean may lie between theirs and the converged one."""
    a, b = np.mean(ours, axis=0), np.mean(theirs, axis=0)
    if not np.isfinite(a).all():
        return Line(check, "FAILS", note="not finite")
    if reference is None:
        error = abs(a.mean() / b.mean() - 1)
        good = error <= 2 * MEAN
        return Line(check, "agrees" if good else "FAILS", note=f"no converged one; means differ by {percent(error)}, RMS {percent(pictures.rms(a, b))}")
    ends = sorted([b.mean(), reference.mean()])
    outside = max(ends[0] - a.mean(), a.mean() - ends[1], 0) / reference.mean()
    means = [[one.mean() / reference.mean() - 1 for one in side] for side in (ours, theirs)]
    errors = [[pictures.rms(one, reference) for one in side] for side in (ours, theirs)]
    mine, other = map(np.mean, errors)
    noise = lambda sides: SIGMAS * float(np.hypot(*map(standard_error, sides)))
    good = outside <= MEAN + noise(means) and mine <= WORSE * other + NOISE + noise(errors)
    def show(means, errors):
        spread = lambda values: f" ± {percent(standard_error(values))}" if len(values) > 1 else ""
        return f"mean {100 * np.mean(means):+.2f} %{spread(means)}, RMS {percent(np.mean(errors))}{spread(errors)}"
    note = f"{len(ours)} and {len(theirs)} runs" if len(ours) > 1 else ""
    return Line(check, "agrees" if good else "FAILS", *map(show, means, errors), note)


def standard_error(values):
    """Of the mean of one value a run; none is known of a single run."""
    return float(np.std(values, ddof=1)) / len(values) ** 0.5 if len(values) > 1 else 0.0


def converged(name, make):
    """The array that make() returns, kept from run to run; None if it takes too long."""
    path = REFERENCES / (name.replace("/", "-") + ".npy")
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            result = make()
        except subprocess.TimeoutExpired:
            result = np.zeros(0)
        np.save(path, result)
    result = np.load(path)
    return result if result.size else None


def random(check, ours, theirs, reference, get, count):
    """Judges what get(side, options) returns in `count` runs of either side."""
    a, b = (runs(side, 0, count, lambda more, side=side: get(side, more)) for side in (ours, theirs))
    line = judge(check, a, b, reference)
    if line.verdict == "FAILS" and count < SEEDS:
        # One run's mean scatters by more than the limit in small pictures of few records: several tell.
        a += runs(ours, count, SEEDS, lambda more: get(ours, more))
        b += runs(theirs, count, SEEDS, lambda more: get(theirs, more))
        line = judge(check, a, b, reference)
    return line


def cached(scene, ours, theirs, count=1):
    check = f"{scene.name} cached"
    get = lambda side, kind, options, patience: pictures.boxes(
        pictures.read(scene.picture(side, folder(side.name, scene.name, kind), options, SIZE, patience)), BOXES)
    reference = converged(check, lambda: get(theirs, "converged", CONVERGED, PATIENCE))
    return random(check, ours, theirs, reference, lambda side, more: get(side, "cached", [*CACHED, *more], 600), count)


def numbers(text):
    return np.array([[float(w) for w in line.split()] for line in text.decode().splitlines()])


def sensors(scene, ours, theirs, count=1):
    check = f"{scene.name} sensors"
    rays = scene.sensors.read_bytes()
    def get(side, options, patience=600):
        octree = scene.octree(side, folder(side.name, scene.name, "sensors") / "scene.oct")
        return numbers(side.run("rtrace", ["-h", "-I", *options, octree], scene.folder, rays, timeout=patience))
    reference = converged(check, lambda: get(theirs, CONVERGED_SENSORS, PATIENCE))
    return random(check, ours, theirs, reference, lambda side, more: get(side, [*CACHED_SENSORS, *more]), count)


def octree(scene, ours, theirs):
    check, work = f"{scene.name} octree", folder("exchange", scene.name, "octree")
    rays = scene.sensors.read_bytes()
    worst = 0.0
    for frozen in (True, False):
        files = {side.name: scene.octree(side, work / f"{side.name}{frozen}.oct", frozen) for side in (ours, theirs)}
        for reader in (ours, theirs):
            answers = []
            for path in files.values():
                out = reader.run("rtrace", ["-h", "-I", *"-ab 0 -dj 0 -dt 0 -ds .1 -u-".split(), path], scene.folder, rays)
                answers.append(numbers(out))
            a, b = answers
            if a.shape != b.shape:
                return Line(check, "FAILS", note=f"{reader.name} answers {a.shape} and {b.shape}")
            worst = max(worst, float((np.abs(a - b) / (np.abs(b) + 1e-3 * b.mean())).max()))
    return Line(check, "agrees" if worst <= 1e-4 else "FAILS", note=f"largest difference {percent(worst)}")


def records(side, path):
    return numbers(side.run("lookamb", ["-h", "-d", path], path.parent))


def ambient(scene, ours, theirs, kind="ambient", more=(), octree=None):
    """Each side makes a file; the other continues it: it must use the records and add hardly any."""
    check, work = f"{scene.name} {kind}", folder("exchange", scene.name, kind)
    view, lines, good = scene.folder / scene.views[0], [], True
    octrees = {s.name: (octree or scene.octree)(s, work / f"{s.name}.oct") for s in (ours, theirs)}
    def render(side, file, out):
        arguments = ["-vf", view, "-x", SIZE, "-y", SIZE, *CACHED, *more, "-af", file, octrees[side.name]]
        side.run("rpict", arguments, scene.folder, out=work / out)
        return pictures.read(work / out)
    for maker, user in ((ours, theirs), (theirs, ours)):
        file = work / f"{maker.name}.amb"
        render(maker, file, f"{maker.name}-made.hdr")
        before = len(records(theirs, file))
        shutil.copy(file, work / "again.amb")
        again = render(maker, work / "again.amb", "again.hdr")
        own = len(records(theirs, work / "again.amb")) / before - 1
        used = render(user, file, f"{user.name}-used.hdr")
        added = len(records(theirs, file)) / before - 1
        mean = used.mean() / again.mean() - 1
        # Whoever continues may add what the maker itself adds in a second run, and a little; the picture is the same.
        good &= added <= own + 0.10 and abs(mean) <= MEAN and before > 20
        lines.append(f"{user.name} continue {maker.name}: {before} records, {percent(added)} more (itself {percent(own)}), mean {100 * mean:+.2f} %")
    return Line(check, "agrees" if good else "FAILS", note="; ".join(lines))


def wavelength(scene, ours, theirs):
    tint = "void spectrum tint 0 0 8 400 700 .5 .7 .9 1 1 .8\n"
    text = tint + "\n".join((scene.folder / file).read_text() for file in scene.files)
    def octree(side, out):
        tinted = out.with_suffix(".rad")
        tinted.write_text(re.sub(r"^void\s+plastic\b", "tint plastic", text, flags=re.M))
        side.run("oconv", ["-f", "-w", tinted], scene.folder, out=out)
        return out
    return ambient(scene, ours, theirs, "wavelength", ["-cs", 9], octree)


def lookamb(scene, ours, theirs):
    check, work = f"{scene.name} lookamb", folder("exchange", scene.name, "lookamb")
    for maker in (ours, theirs):
        file = work / f"{maker.name}.amb"
        arguments = ["-h", "-I", *"-ab 1 -aa .2 -ar 32 -ad 64".split(), "-af", file, scene.octree(maker, work / "s.oct")]
        maker.run("rtrace", arguments, scene.folder, scene.sensors.read_bytes())
        for flags in (["-h"], ["-h", "-d"]):
            a, b = (side.run("lookamb", [*flags, file], work).decode().split() for side in (ours, theirs))
            if len(a) != len(b) or not b:
                return Line(check, "FAILS", note=f"{maker.name}' file {flags}: {len(a)} and {len(b)} words")
            for x, y in zip(a, b):
                # The last digit may be rounded either way.
                if x != y and (re.search("[a-z:]", x.lower().replace("e", "")) or abs(float(x) - float(y)) > 2e-6 * (1 + abs(float(y)))):
                    return Line(check, "FAILS", note=f"{maker.name}' file {flags}: `{x}` and `{y}`")
    return Line(check, "agrees")


def one_type(kind, ours, theirs):
    work = WORK / "types"
    work.mkdir(parents=True, exist_ok=True)
    found = primitives.compare(kind, ours, theirs, work)
    show = lambda mean: f"mean {mean:.5f}"
    return Line(f"types {kind}", "agrees" if found.agrees else "FAILS", show(found.ours), show(found.theirs), found.note())


def known_differences():
    """Checks that known-differences.md lists: lines `| NAME check | reason |`."""
    path = ROOT / "known-differences.md"
    text = path.read_text() if path.exists() else ""
    return {m[1]: m[2] for m in re.finditer(r"^\| `(\S+ \w+)` \| (.+?) \|$", text, re.M)}


def option(words, name, default):
    """Takes an option and its value out of the words."""
    if name not in words:
        return default
    at = words.index(name)
    value = type(default)(words[at + 1])
    del words[at:at + 2]
    return value


def main():
    words = sys.argv[1:]
    minutes, count = option(words, "--minutes", 20.0), option(words, "--runs", 1)
    ours, theirs = scenes.sides(os.environ["AMBIT_TOOLS_DIR"], WORK.parent / "oracle")
    bundled, outside = scenes.bundled(), scenes.outside()
    jobs = [(f, s) for s in bundled for f in (octree, lookamb, direct, sensors, cached)]
    jobs += [(ambient, s) for s in bundled if s.name in ("room", "cornell", "optics")]
    jobs += [(wavelength, s) for s in bundled if s.name in ("room", "cornell")]
    jobs += [(direct, s) for s in outside] + [(cached, s) for s in outside]
    jobs += [(one_type, kind) for kind in primitives.types()]
    name = lambda job: f"types {job[1]}" if job[0] is one_type else f"{job[1].name} {job[0].__name__}"
    jobs = [j for j in jobs if not words or any(name(j).startswith(w) for w in words)]
    known, end = known_differences(), time.monotonic() + 60 * minutes

    def one(job):
        if time.monotonic() > end:
            return Line(name(job), "not reached")
        start = time.monotonic()
        try:
            more = {"count": count} if job[0] in (cached, sensors) else {}
            line = job[0](job[1], ours, theirs, **more)
        except (RuntimeError, ValueError, OSError, subprocess.TimeoutExpired) as error:
            line = Line(name(job), "FAILS", note=str(error)[:160])
        if line.verdict == "FAILS" and line.check in known:
            line.verdict = "known"
        elif line.check in known:
            line.note += " (agrees: take it off known-differences.md)"
        print(f"{line.verdict:12}{line.check:38}{line.ours} {line.theirs} {line.note}  [{time.monotonic() - start:.0f} s]", flush=True)
        return line

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        table = list(pool.map(one, jobs))
    counts = {v: sum(l.verdict == v for l in table) for v in ("agrees", "known", "FAILS", "not reached")}
    text = "| check | verdict | ours | theirs | |\n|---|---|---|---|---|\n"
    text += "".join(f"| {l.check} | {l.verdict} | {l.ours} | {l.theirs} | {l.note} |\n" for l in table)
    (WORK / "table.md").write_text(text)
    print("conformance: " + ", ".join(f"{n} {v}" for v, n in counts.items()) + f"; table in {WORK / 'table.md'}")
    sys.exit(1 if counts["FAILS"] or not table else 0)


if __name__ == "__main__":
    main()
