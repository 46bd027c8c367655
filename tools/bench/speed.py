#!/usr/bin/env python3
"""How fast, how exact, how big: our programs and real Radiance in turns, on one thread.

usage: tools/bench/speed.py [--runs N] [--size N] [--out FILE.md] [NAME…]
  NAME   bundled scenes (room, cornell …), scenes of AMBIT_SCENES, or `memory`; default: room, memory

For each scene: the wall time of rpict, ours and theirs in turns, and the median of the ratios of the pairs; beside it
the RMS error of both against a converged picture of real Radiance (every hemisphere sampled anew), so that speed
bought with error shows. `room` also renders its second view with the first one's ambient file. `memory` renders one
million triangles and prints the greatest resident size and the time to the first pixel's end.

Needs numpy; real Radiance is installed below target/ as for the conformance suite. Nothing else should run meanwhile.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
subprocess.run([ROOT / "tests/conformance/install-oracle", TARGET / "oracle"], check=True)
PYTHON = TARGET / "oracle/venv/bin/python"
if Path(sys.prefix).resolve() != PYTHON.parents[1].resolve():
    os.execv(PYTHON, [str(PYTHON), *sys.argv])

sys.path.insert(0, str(ROOT / "tests/conformance"))
import pictures  # noqa: E402
import scenes  # noqa: E402

LIGHT = "-ab 2 -aa .15 -ar 64 -ad 512 -as 128 -ds .2 -dj .5".split()
PIXELS = "-ps 1 -pj 0".split()
CONVERGED = "-ab 2 -aa 0 -ad 9 -ds .1 -dj 0 -lw 1e-5 -ps 1 -pj 0".split()
BOXES = 32


def programs():
    """Our programs (built if need be) and theirs."""
    tools = os.environ.get("AMBIT_TOOLS_DIR")
    if tools is None:
        subprocess.run(["cargo", "build", "--quiet", "--release", "--locked", "-p", "ambit-tools", "--bins"], cwd=ROOT, check=True)
        tools = TARGET / "release"
    return scenes.sides(tools, TARGET / "oracle")


def timed(side, arguments, folder, out):
    """Wall seconds and greatest resident size in MB of one run of rpict."""
    # Radiance's rpict knows one thread only, and no option to say so.
    threads = ["-n", "1"] if side.folder != scenes.ORACLE_BIN.resolve() and side.name == "ours" else []
    start = time.perf_counter()
    with open(out, "wb") as file:
        child = subprocess.Popen([side.folder / "rpict", *threads, *map(str, arguments)], cwd=folder, env=side.environment(),
                                 stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.PIPE)
        message = child.stderr.read().decode("latin-1")
        _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        raise RuntimeError(f"{side.name} rpict: status {status}: {message.strip().splitlines()[:1]}")
    return time.perf_counter() - start, usage.ru_maxrss / 1024


class Outside:
    """A scene of AMBIT_SCENES, compiled by its own script; what the script tells rpict is caught and used again."""

    def __init__(self, name, script, theirs, work):
        self.name, self.folder = name, work
        catch = work / "catch"
        catch.write_text('#!/bin/sh\npwd > "$OUT/where"; for word do printf "%s\\n" "$word"; done > "$OUT/words"\n')
        catch.chmod(0o755)
        env = theirs.environment() | {"RTRACE": "true", "RPICT": str(catch), "OUT": str(work), "OPTS": "OPTIONS", "RES": "SIZE"}
        env["PATH"] = f"{theirs.folder}:{env['PATH']}"
        done = subprocess.run(["bash", str(script)], env=env, stdin=subprocess.DEVNULL, capture_output=True)
        if done.returncode != 0:
            raise RuntimeError(f"{script}: status {done.returncode}")
        self.words = (work / "words").read_text().splitlines()
        self.folder = Path((work / "where").read_text().strip())

    def arguments(self, options, size):
        words = []
        for word in self.words:
            words += options if word == "OPTIONS" else [str(size) if word == "SIZE" else word]
        return words


class Bundled:
    """A scene of fixtures/."""

    def __init__(self, scene, theirs, work):
        self.name, self.folder, self.views = scene.name, scene.folder, scene.views
        self.octree = scene.octree(theirs, work / "scene.oct")

    def arguments(self, options, size, view=0):
        return ["-vf", self.views[view], "-x", size, "-y", size, *options, self.octree]


def compare(scene, ours, theirs, runs, size, work):
    """One line of the table, and the paired times of the second view if the scene has one."""
    reference = work / "converged.hdr"
    timed(theirs, scene.arguments(CONVERGED, size), scene.folder, reference)
    reference = pictures.read(reference)
    boxes = min(BOXES, *reference.shape[:2])
    reference = pictures.boxes(reference, boxes)
    times, errors, second = {"ours": [], "theirs": []}, {}, {"ours": [], "theirs": []}
    for run in range(runs):
        # Whoever goes first changes from pair to pair.
        for side in (ours, theirs) if run % 2 else (theirs, ours):
            cache, out = work / f"{side.name}.amb", work / f"{side.name}.hdr"
            cache.unlink(missing_ok=True)
            options = [*LIGHT, *PIXELS, "-af", cache]
            times[side.name].append(timed(side, scene.arguments(options, size), scene.folder, out)[0])
            errors[side.name] = pictures.rms(pictures.boxes(pictures.read(out), boxes), reference)
            if len(getattr(scene, "views", [])) > 1:
                second[side.name].append(timed(side, scene.arguments(options, size, 1), scene.folder, out)[0])
    ratio = statistics.median(t / o for o, t in zip(times["ours"], times["theirs"]))
    middle = {name: statistics.median(t) for name, t in times.items()}
    line = (f"| {scene.name} | {middle['theirs']:.2f} s | {middle['ours']:.2f} s | **{ratio:.2f}** | "
            f"{100 * errors['theirs']:.2f} % | {100 * errors['ours']:.2f} % |")
    if second["ours"]:
        share = {n: statistics.median(b / a for a, b in zip(times[n], second[n])) for n in times}
        line += f"\n| {scene.name}, second view with the first's ambient file, share of the first's time | {share['theirs']:.1%} | {share['ours']:.1%} | | | |"
    return line


def memory(ours, theirs, work):
    """Greatest resident size of rpict on a terrain of one million triangles."""
    side = 708
    import math
    height = [[math.sin(x * .05) * math.cos(y * .043) * 8 + math.sin(x * .31 + y * .27) for x in range(side)] for y in range(side)]
    scene = work / "million.rad"
    with open(scene, "w") as file:
        file.write("void plastic m 0 0 5 .5 .5 .5 0 0\nvoid light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 .3 .4 .86 .5\n")
        for y in range(side - 1):
            for x in range(side - 1):
                a, b, c, d = ((i, j, height[j][i]) for i, j in ((x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)))
                for k, t in enumerate(((a, b, c), (a, c, d))):
                    file.write(f"m polygon t{x}.{y}.{k} 0 0 9 " + " ".join(f"{v:g}" for p in t for v in p) + "\n")
    theirs.run("oconv", ["-f", scene], work, out=work / "million.oct")
    view = f"-vp {side / 2} -200 300 -vd 0 .8 -.6 -vh 60 -vv 60 -ab 0 -ps 1 -x 512 -y 512".split()
    lines, base = [], {}
    for program in (theirs, ours):
        seconds, size = timed(program, [*view, work / "million.oct"], work, work / "million.hdr")
        base[program.name] = (seconds, size)
    count = 2 * (side - 1) ** 2
    for name, (seconds, size) in base.items():
        lines.append(f"| {count} triangles, {name} | {seconds:.2f} s | {size:.0f} MB | {size * 2 ** 20 / count:.0f} bytes a triangle |")
    return "| memory | time | greatest resident size | |\n|---|---|---|---|\n" + "\n".join(lines)


def main():
    words, options = sys.argv[1:], {"--runs": "5", "--size": "512", "--out": ""}
    for name in options:
        if name in words:
            at = words.index(name)
            options[name] = words[at + 1]
            del words[at:at + 2]
    ours, theirs = programs()
    bundled = {s.name: s for s in scenes.bundled()}
    outside = {s.name: s.script for s in scenes.outside()}
    lines, tail = ["| scene | theirs | ours | ratio | RMS error theirs | ours |", "|---|---|---|---|---|---|"], []
    for name in words or ["room", "memory"]:
        with tempfile.TemporaryDirectory() as folder:
            work = Path(folder)
            try:
                if name == "memory":
                    tail = ["", memory(ours, theirs, work)]
                    continue
                scene = Bundled(bundled[name], theirs, work) if name in bundled else Outside(name, outside[name], theirs, work)
                lines.append(compare(scene, ours, theirs, int(options["--runs"]), int(options["--size"]), work))
            except (RuntimeError, OSError, KeyError) as error:
                lines.append(f"| {name} | failed: {error} | | | | |")
        print(lines[-1], file=sys.stderr, flush=True)
    text = "\n".join([f"rpict on one thread, {' '.join(LIGHT)}, {options['--size']} pixels, median of {options['--runs']} pairs.", "", *lines, *tail])
    print(text)
    if options["--out"]:
        Path(options["--out"]).write_text(text + "\n")


main()
