"""Comparison of what both sides wrote: octrees, headers, pictures, depths, and the values of rtrace. Every function takes the bytes
of ours and of theirs and returns the differences, a line each."""

import re
import struct

import numpy as np

import pictures

# Relative difference of values that hold no noise. Radiance's colours are of single precision.
TOLERANCE = 1e-3
# Directions and normals have no scale of their own, nor have points near the origin.
LEAST = {"d": 1e-4, "n": 1e-4, "N": 1e-4, "o": 1e-5, "p": 1e-4, "c": 1e-4}
# A pixel differs if it is off by this much of the picture's mean, and so may this share of them: edges fall either way.
PIXEL, SHARE = 0.01, 0.004


def same(ours, theirs):
    """Byte by byte."""
    if ours == theirs:
        return []
    at = next((i for i, (a, b) in enumerate(zip(ours, theirs)) if a != b), min(len(ours), len(theirs)))
    return [f"{len(ours)} and {len(theirs)} bytes, the first difference at {at}: {ours[at:at + 24]!r} and {theirs[at:at + 24]!r}"]


def nothing(_ours, _theirs):
    """What neither tells anything new nor has to agree."""
    return []


def split(data):
    """Lines of the information header and where the data begin; no lines if there is no header."""
    if not data.startswith(b"#?"):
        return [], 0
    end = data.index(b"\n\n")
    return data[:end].decode("latin-1").split("\n"), end + 2


def headers(ours, theirs):
    """Line by line but for the clock and the program's version."""
    a, b = ([_plain(line) for line in lines] for lines in (ours, theirs))
    if a == b:
        return []
    only = [[line for line in x if line not in y][:3] for x, y in ((a, b), (b, a))]
    return [f"headers: {only[0]} and {only[1]}" if only != [[], []] else f"order of header lines: {a} and {b}"]


def _plain(line):
    # Blanks behind FORMAT= align the data, which Values looks at.
    return re.sub(r"^(CAPDATE=|GMT=|SOFTWARE=).*", r"\1", line).rstrip()


def sequence(ours, theirs):
    """Pictures one behind the other on standard output."""
    parts = [re.split(rb"(?=FRAME=\d+\n)", data) for data in (ours, theirs)]
    if len(parts[0]) != len(parts[1]):
        return [f"{len(parts[0])} and {len(parts[1])} pictures"]
    first = [part.pop(0) for part in parts]
    # The first one's header begins before its FRAME line.
    pairs = zip(*parts)
    found = headers(*(f.decode("latin-1").split("\n") for f in first))
    for a, b in pairs:
        found += picture(b"#?\n" + a, b"#?\n" + b)
    return found


def picture(ours, theirs):
    """Header, size and pixels of a picture without noise."""
    (lines, at), (other, at2) = split(ours), split(theirs)
    found = headers(lines, other)
    sizes = [data[i:data.find(b"\n", i)] for data, i in ((ours, at), (theirs, at2))]
    if sizes[0] != sizes[1]:
        return [*found, f"sizes {sizes[0]} and {sizes[1]}"]
    a, b = (_pixels(data, i) for data, i in ((ours, at), (theirs, at2)))
    return found + compare_pixels(a, b)


def pixels(data):
    """The pixels of a picture in a file."""
    return _pixels(data, split(data)[1])


def _pixels(data, at):
    end = data.index(b"\n", at) + 1
    _, height, _, width = data[at:end].split()
    rows = np.zeros((int(height), int(width), 4), np.uint8)
    at = end
    for row in rows:
        at = pictures.row(data, at, row)
    if at != len(data):
        raise ValueError(f"{len(data) - at} bytes too many in a picture")
    scale = np.where(rows[..., 3:] > 0, np.ldexp(1.0, rows[..., 3:].astype(int) - 136), 0)
    return (rows[..., :3] + 0.5) * scale


def compare_pixels(a, b):
    if not a.size:
        return []
    # RGBE keeps 8 bits: one step of the exponent's largest channel is up to 1/128 of it, in either picture.
    step = np.maximum(a.max(axis=2), b.max(axis=2)) / 64
    off = np.abs(a - b).max(axis=2) > PIXEL * b.mean() + step
    # Radiance draws no small sources into the topmost row.
    off[0] = False
    if off.sum() <= max(1, SHARE * off.size):
        return []
    y, x = np.argwhere(off)[0]
    return [f"{off.sum()} of {off.size} pixels differ, row {y} column {x}: {a[y, x]} and {b[y, x]}; means {a.mean():.5g} and {b.mean():.5g}"]


def depths(ours, theirs):
    """Files of distances, a float a pixel."""
    if len(ours) != len(theirs):
        return [f"{len(ours)} and {len(theirs)} bytes of distances"]
    a, b = (np.frombuffer(data, np.float32).astype(float) for data in (ours, theirs))
    off = np.abs(a - b) > TOLERANCE * np.abs(b)
    if off.sum() <= max(1, SHARE * off.size):
        return []
    at = np.argwhere(off)[0][0]
    return [f"{off.sum()} of {off.size} distances differ, at {at}: {a[at]:g} and {b[at]:g}"]


class Values:
    """Output of rtrace: `fields` is the word after -o, `form` the letter of the output format, `colours` numbers a colour has."""

    def __init__(self, fields, form="a", colours=3, rays=None, pack=None, sized=False, tolerance=TOLERANCE):
        self.fields, self.form, self.colours, self.rays, self.pack, self.sized = fields, form, colours, rays, pack, sized
        self.pair, self.tolerance = None, tolerance
        tree = re.search("[tT]", fields)
        self.tree = bool(tree) and fields[-1] not in "tT"
        self.letters = [f for f in fields if f not in "tT"]

    def __call__(self, ours, theirs):
        found, bodies = [], []
        (lines, at), (other, at2) = split(ours), split(theirs)
        found += headers(lines, other)
        for data, i in ((ours, at), (theirs, at2)):
            if lines and self.form in "fd" and i % {"f": 4, "d": 8}[self.form]:
                found.append(f"data begin at {i}")
            if self.sized:
                end = data.find(b"\n", i) + 1
                bodies.append((data[i:end], data[end:]))
            else:
                bodies.append((b"", data[i:]))
        if bodies[0][0] != bodies[1][0]:
            found.append(f"sizes {bodies[0][0]} and {bodies[1][0]}")
        a, b = (self.records(body) for _, body in bodies)
        self.pair = (a, b)
        if len(a) != len(b):
            return [*found, f"{len(a)} and {len(b)} records"]
        differ = [i for i, (x, y) in enumerate(zip(a, b)) if not self.agree(x, y)]
        return found + [Difference(i, a[i], b[i]) for i in differ]

    def records(self, body):
        """A list of (letter, numbers or name) for each ray."""
        if self.form == "a":
            return [self._line(line) for line in body.decode("latin-1").split("\n")[:-1]]
        if self.form == "c":
            width = self.colours + 1
            pixels = np.frombuffer(body[:len(body) // width * width], np.uint8).reshape(-1, width)
            scale = np.ldexp(1.0, pixels[:, -1].astype(int) - 136) * (pixels[:, -1] > 0)
            return [[("8", list(p))] for p in (pixels[:, :-1] + 0.5) * scale[:, None]]
        records, at, size = [], 0, {"f": 4, "d": 8}[self.form]
        while at < len(body):
            record = []
            for letter in self.letters:
                if letter in "smM~":
                    end = body.index(b"\t", at)
                    record.append((letter, body[at:end].decode("latin-1")))
                    at = end + 1
                else:
                    count = self.count(letter)
                    record.append((letter, list(struct.unpack_from(f"={count}{self.form}", body, at))))
                    at += count * size
            records.append(record)
        return records

    def _line(self, line):
        cells = line.split("\t")
        if self.tree:
            return [("?", [_number(cell)]) if _is_number(cell) else ("s", cell) for cell in cells]
        record, at = [], 0
        for letter in self.letters:
            if letter in "smM~":
                record.append((letter, cells[at] if at < len(cells) else "missing"))
                at += 1
            else:
                record.append((letter, [_number(cell) for cell in cells[at:at + self.count(letter)]]))
                at += self.count(letter)
        return [*record, ("s", "\t".join(cells[at:]))]

    def count(self, letter):
        return {"o": 3, "d": 3, "p": 3, "n": 3, "N": 3, "c": 2}.get(letter, self.colours if letter in "vVWrx" else 1)

    def agree(self, a, b):
        return len(a) == len(b) and all(self._field(*pair) for pair in zip(a, b))

    def _field(self, one, other):
        (letter, a), (_, b) = one, other
        if isinstance(a, str) or isinstance(b, str):
            return a == b
        if len(a) != len(b):
            return False
        a, b = np.array(a), np.array(b)
        if not a.size or not np.isfinite(b).all():
            return True
        scale = max(np.abs(b).max(), np.abs(a).max(), 1e-30) if np.isfinite(a).all() else 1
        step = 1 / 64 if letter == "8" else self.tolerance
        least = LEAST.get(letter, 1e-7) if letter != "?" else 1e-4
        return bool((np.abs(a - b) <= step * scale + least).all())

    def apart_from_edges(self, found, answers):
        """Leaves out rays along edges: those where Radiance answers as differently to rays close by. `answers` runs it."""
        rays = [d for d in found if isinstance(d, Difference) and d.at < len(self.rays)]
        for seed in range(6):
            if not rays:
                break
            shift = np.random.default_rng(seed).uniform(-1, 1, (len(self.rays), 6)) * 3e-6
            moved = [list(np.array(ray) + s * bool(any(ray[3:]))) for ray, s in zip(self.rays, shift)]
            here = {d.at for d in rays}
            near = self(answers(self.pack([m if i in here else r for i, (m, r) in enumerate(zip(moved, self.rays))])), b"")
            del near
            others = self.pair[0]
            edges = [d for d in rays if d.at < len(others) and not self.agree(others[d.at], d.theirs)]
            found = [d for d in found if d not in edges]
            rays = [d for d in rays if d not in edges]
        return found


class Difference:
    """One ray that both sides answer differently."""

    def __init__(self, at, ours, theirs):
        self.at, self.ours, self.theirs = at, ours, theirs

    def __str__(self):
        apart = [(a, b) for a, b in zip(self.ours, self.theirs) if a != b]
        show = lambda f: f"{f[0]}={f[1]}" if isinstance(f[1], str) else f"{f[0]}=" + " ".join(f"{x:.6g}" for x in f[1])
        return f"ray {self.at}: " + "; ".join(f"{show(a)} and {show(b)}" for a, b in apart[:3])


def _is_number(word):
    return bool(re.fullmatch(r"[-+]?(\d+\.?\d*(e[-+]?\d+)?|inf|nan)", word))


def _number(word):
    return float(word) if _is_number(word) else float("nan")
