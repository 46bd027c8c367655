"""The scenes that are compared: the bundled ones and those of the folder AMBIT_SCENES."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Programs:
    """One side: a folder with oconv, rpict, rtrace and lookamb, and where auxiliary files are found."""

    name: str
    folder: Path
    raypath: str | None

    def environment(self, helpers=None):
        """The caller's environment with this side's library; tools of the folder `helpers` (gensky, xform …) come first on
        the path."""
        env = {k: v for k, v in os.environ.items() if k != "RAYPATH"}
        if self.raypath is not None:
            env["RAYPATH"] = self.raypath
        if helpers is not None:
            env["PATH"] = f"{helpers}:{env['PATH']}"
        return env

    def run(self, program, arguments, folder, stdin=b"", out=None, timeout=600):
        """Runs a program, returns its standard output (or leaves it in the file `out`)."""
        command = [str(self.folder / program), *[str(a) for a in arguments]]
        done = subprocess.run(command, cwd=folder, env=self.environment(), input=stdin, capture_output=True, timeout=timeout)
        if done.returncode != 0:
            message = done.stderr.decode("latin-1").strip().splitlines()
            raise RuntimeError(f"{self.name} {program}: status {done.returncode}: {message[0] if message else ''}")
        if out is not None:
            Path(out).write_bytes(done.stdout)
        return done.stdout


@dataclass
class Bundled:
    """A scene of fixtures/list.tsv."""

    name: str
    files: list
    views: list
    sensors: Path

    @property
    def folder(self):
        return ROOT / "fixtures" / self.name

    def octree(self, side, out, frozen=True):
        flags = ["-f", "-w"] if frozen else ["-w"]
        side.run("oconv", [*flags, *self.files], self.folder, out=out)
        return out

    def picture(self, side, work, options, size, timeout=600):
        octree = self.octree(side, work / "scene.oct")
        arguments = ["-vf", self.views[0], "-x", size, "-y", size, *options, octree]
        side.run("rpict", arguments, self.folder, out=work / "pic.hdr", timeout=timeout)
        return work / "pic.hdr"


@dataclass
class Outside:
    """A scene of AMBIT_SCENES: its render.sh makes scene.oct and pic.hdr with the programs it is told."""

    name: str
    script: Path

    def picture(self, side, work, options, size, timeout=600):
        # A script may use helpers of the oracle's by name.
        env = side.environment(ORACLE_BIN)
        env |= {p.upper(): str(side.folder / p) for p in ("oconv", "rpict")}
        # The scripts' sensor runs have options of their own: the pictures are what is compared.
        env |= {"RTRACE": "true", "OUT": str(work), "RES": str(size), "OPTS": " ".join(options)}
        log = open(work / "log", "wb")
        done = subprocess.run(["timeout", str(timeout), "bash", str(self.script)], env=env, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        if done.returncode == 124:
            raise subprocess.TimeoutExpired("render.sh", timeout)
        if done.returncode != 0:
            lines = [l for l in (work / "log").read_text("latin-1").splitlines() if "warning" not in l]
            raise RuntimeError(f"{side.name}: render.sh: status {done.returncode}: {lines[0] if lines else ''}")
        return work / "pic.hdr"

    def caught(self, theirs, work):
        """Its folder, its octree, compiled by `theirs`, and what its script tells rpict but for size and options."""
        catch = work / "catch"
        catch.write_text('#!/bin/sh\npwd > "$OUT/where"; for word do printf "%s\\n" "$word"; done > "$OUT/words"\n')
        catch.chmod(0o755)
        env = theirs.environment(theirs.folder) | {"OCONV": str(theirs.folder / "oconv"), "RPICT": str(catch), "RTRACE": "true"}
        env |= {"OUT": str(work), "OPTS": "OPTIONS", "RES": "SIZE"}
        done = subprocess.run(["bash", str(self.script)], env=env, stdin=subprocess.DEVNULL, capture_output=True)
        if done.returncode != 0 or not (work / "words").exists():
            raise RuntimeError(f"{self.script}: status {done.returncode}")
        *words, octree = (work / "words").read_text().splitlines()
        words = [w for w in words if w != "OPTIONS"]
        for at in [i for i, w in enumerate(words) if w == "SIZE"][::-1]:
            del words[at - 1:at + 1]
        return Path((work / "where").read_text().strip()), octree, words


ORACLE_BIN = None


def sides(tools, oracle):
    """Our programs in the folder `tools`, and real Radiance that install-oracle put below the folder `oracle`."""
    global ORACLE_BIN
    home = Path((oracle / "home").read_text().strip())
    ORACLE_BIN = home / "bin"
    # Some outside scenes name library files that are no longer part of Radiance.
    old = Path(os.environ.get("AMBIT_SCENES") or "/nonexistent") / "../oracle/lib"
    more = f":{old.resolve()}" if old.is_dir() else ""
    theirs = Programs("theirs", ORACLE_BIN, f".:{home / 'lib'}{more}")
    # Ours bring their library along; if real Radiance stands in for them, it needs its own.
    tools = Path(tools).resolve()
    ours = theirs.raypath if tools == ORACLE_BIN.resolve() else f".{more}" if more else None
    return Programs("ours", tools, ours), theirs


def bundled():
    """All bundled scenes."""
    lines = (ROOT / "fixtures" / "list.tsv").read_text().splitlines()
    cells = [line.split("\t") for line in lines if not line.startswith("#")]
    return [Bundled(n, f.split(), v.split(), ROOT / "fixtures" / n / s) for n, f, v, s in cells]


def outside():
    """All scenes of AMBIT_SCENES."""
    folder = os.environ.get("AMBIT_SCENES")
    if not folder:
        return []
    scripts = sorted(Path(folder).resolve().rglob("render.sh"))
    return [Outside(str(s.parent.relative_to(Path(folder).resolve())), s) for s in scripts]
