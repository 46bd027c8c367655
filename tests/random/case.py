"""One case: files, and commands over them, which both sides run; and how what they made is compared."""

import shlex
import subprocess
from dataclasses import dataclass, field

import outputs

# Commands are small: whatever takes longer hangs.
PATIENCE = 120


@dataclass
class Step:
    """One command. Its standard output goes to the file `out`, which is compared by what `look` (of outputs.py) says."""

    program: str
    words: list
    out: str
    look: object
    stdin: bytes = b""
    # Files that it writes besides, with how each is compared.
    more: dict = field(default_factory=dict)
    # Options that tell our random numbers from one another; Radiance's has its clock for that.
    ours: list = field(default_factory=list)
    # Later steps make no sense if this one fails, on both sides.
    needed: bool = False


@dataclass
class Case:
    files: dict
    steps: list


@dataclass
class Ran:
    status: int
    errors: str


def _run(step, at, side, folder):
    # Helpers (xform, getinfo) are Radiance's on either side: they are no part of what is compared.
    program = side.folder / step.program
    path = str(program) if program.exists() else step.program
    words = [str(word) for word in (step.words if side.name == "theirs" else [*step.ours, *step.words])]
    (folder / f"stdin-{at}").write_bytes(step.stdin)
    with open(folder / step.out, "wb") as out, open(folder / f"stdin-{at}", "rb") as stdin:
        try:
            done = subprocess.run([path, *words], cwd=folder, env=side.environment(helpers()), stdin=stdin, stdout=out,
                                  stderr=subprocess.PIPE, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            return Ran(-1000, "takes too long")
    return Ran(done.returncode, done.stderr.decode("latin-1"))


def helpers():
    import scenes
    return scenes.ORACLE_BIN


def again(case):
    """A script that runs the commands of one side: its programs must come first on PATH."""
    lines = ["#!/bin/sh -x", "cd \"$(dirname \"$0\")\""]
    for at, step in enumerate(case.steps):
        lines.append(f"{shlex.join([step.program, *map(str, step.words)])} < stdin-{at} > {step.out}")
    return "\n".join(lines) + "\n"


def compare(case, sides, folder):
    """Runs the case in FOLDER/ours and FOLDER/theirs and returns what differs, a line each."""
    for side in sides:
        home = folder / side.name
        home.mkdir(parents=True)
        for name, content in case.files.items():
            (home / name).parent.mkdir(parents=True, exist_ok=True)
            (home / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        (home / "again").write_text(again(case))
    differences = []
    for at, step in enumerate(case.steps):
        ours, theirs = (_run(step, at, side, folder / side.name) for side in sides)
        for side, ran in zip(sides, (ours, theirs)):
            (folder / side.name / f"stderr-{at}").write_text(ran.errors)
        where = f"{step.program} (step {at})"
        if theirs.status < 0:
            # A signal: Radiance crashed, and tells nothing.
            if ours.status < 0:
                differences.append(f"{where}: both crash")
            return differences
        if ours.status != theirs.status:
            said = [ran.errors.strip().splitlines()[:1] for ran in (ours, theirs)]
            return [*differences, f"{where}: status {ours.status} and {theirs.status}: {said[0]} and {said[1]}"]
        if theirs.status == 0:
            for name, look in {step.out: step.look, **step.more}.items():
                pair = [folder / side.name / name for side in sides]
                differences += [f"{where}: {line}" for line in _files(name, pair, look, step, at, sides, folder)]
        elif step.needed:
            return differences
        if differences:
            return differences
    return differences


def _files(name, pair, look, step, at, sides, folder):
    there = [path.exists() for path in pair]
    if there[0] != there[1]:
        return [f"{name}: only {'ours' if there[0] else 'theirs'} is there"]
    if not there[0]:
        return []
    found = look(*(path.read_bytes() for path in pair))
    if found and isinstance(look, outputs.Values) and look.rays:
        found = look.apart_from_edges(found, lambda stdin: _nearby(step, stdin, at, sides[1], folder))
    return [f"{name}: {line}" for line in found]


def _nearby(step, stdin, at, theirs, folder):
    """What Radiance answers to other rays."""
    other = Step(step.program, step.words, "nearby.out", None, stdin)
    _run(other, f"{at}-nearby", theirs, folder / theirs.name)
    return (folder / theirs.name / "nearby.out").read_bytes()
