"""Random scenes and command lines, run by our programs and by real Radiance: see `run` beside this file, which starts it.

The same seed and kind always make the same case. Each case is a folder with input files; either side runs all its commands in
a copy of it. What agrees is removed again; what differs stays, with `again`, a script that runs the commands of one side.
"""

import argparse
import concurrent.futures
import os
import shutil
import sys
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "conformance")]

import case
import scenes
import shrink
from dice import Dice
from kinds import KINDS


def arguments():
    parser = argparse.ArgumentParser(prog="tests/random/run", description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="1..200", help="FIRST..LAST, or one number")
    parser.add_argument("--kind", action="append", choices=sorted(KINDS))
    parser.add_argument("--keep", type=Path, default=Path(os.environ["AMBIT_WORK"]))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--shrink", action="store_true", help="leave out of cases that differ what does not matter")
    parser.add_argument("--oracle", type=Path, required=True, help=argparse.SUPPRESS)
    return parser.parse_args()


def one(kind, seed, sides, keep, smaller):
    """The differences of one case, none if both sides agree."""
    folder = keep / f"{kind}-{seed}"
    shutil.rmtree(folder, ignore_errors=True)
    made = KINDS[kind](Dice(f"{kind} {seed}"))
    differences = case.compare(made, sides, folder)
    if differences and smaller:
        made, differences = shrink.shrink(made, sides, folder)
    if not differences:
        shutil.rmtree(folder)
    return differences


def main():
    given = arguments()
    first, _, last = given.seeds.partition("..")
    seeds = range(int(first), int(last or first) + 1)
    sides = scenes.sides(os.environ["AMBIT_TOOLS_DIR"], given.oracle)
    counts = {kind: [0, 0] for kind in given.kind or sorted(KINDS)}
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        running = {pool.submit(one, kind, seed, sides, given.keep, given.shrink): (kind, seed) for seed in seeds for kind in counts}
        for done in concurrent.futures.as_completed(running):
            kind, seed = running[done]
            try:
                differences = done.result()
            except Exception:
                # A fault of the test itself counts as a difference: it hides what the case would show.
                differences = traceback.format_exc().splitlines()[-3:]
            counts[kind][bool(differences)] += 1
            if differences:
                print(f"{kind} {seed} differs: {given.keep / f'{kind}-{seed}'}")
                print("".join(f"    {line}\n" for line in differences[:6]), end="", flush=True)
    for kind, (agree, differ) in counts.items():
        print(f"{kind}: {agree} agree, {differ} differ")
    sys.exit(1 if any(differ for _, differ in counts.values()) or not seeds else 0)


if __name__ == "__main__":
    main()
