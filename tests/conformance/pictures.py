"""Reading Radiance pictures and comparing them. No program of either side is involved."""

import numpy as np


def read(path):
    """The picture as an array height x width x 3 of radiance (exposure undone); only -Y +X pictures."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"\n\n")
    exposure = 1.0
    for line in data[:end].decode("latin-1").splitlines():
        if line.startswith("EXPOSURE="):
            exposure *= float(line.split("=")[1])
        if line.startswith("FORMAT=") and "rgbe" not in line:
            raise ValueError(f"{path}: not an RGBE picture")
    start = data.index(b"\n", end + 2) + 1
    sign_y, height, sign_x, width = data[end + 2:start].split()
    if (sign_y, sign_x) != (b"-Y", b"+X"):
        raise ValueError(f"{path}: orientation {sign_y} {sign_x}")
    height, width = int(height), int(width)
    rows = np.zeros((height, width, 4), np.uint8)
    at = start
    for y in range(height):
        at = row(data, at, rows[y])
    if at != len(data):
        raise ValueError(f"{path}: {len(data) - at} bytes too many")
    scale = np.where(rows[..., 3:] > 0, np.ldexp(1.0, rows[..., 3:].astype(int) - 136), 0)
    return (rows[..., :3] + 0.5) * scale / exposure


def row(data, at, row):
    """Decodes the line that begins at byte `at` into the array `row` of bytes, and returns where the next one begins."""
    width = len(row)
    if not (8 <= width <= 0x7fff and data[at:at + 2] == b"\x02\x02"):
        row[:] = np.frombuffer(data, np.uint8, width * 4, at).reshape(width, 4)
        if ((row[:, :3] == 1).all(axis=1)).any():
            raise ValueError("old run-length form")
        return at + 4 * width
    at += 4
    for channel in range(4):
        x = 0
        while x < width:
            count = data[at]
            if count > 128:
                row[x:x + count - 128, channel] = data[at + 1]
                x, at = x + count - 128, at + 2
            else:
                row[x:x + count, channel] = np.frombuffer(data, np.uint8, count, at + 1)
                x, at = x + count, at + 1 + count
    return at


def boxes(picture, side):
    """Means over side x side boxes."""
    height, width, _ = picture.shape
    rows = np.arange(min(side, height) + 1) * height // min(side, height)
    columns = np.arange(min(side, width) + 1) * width // min(side, width)
    sums = np.add.reduceat(np.add.reduceat(picture, rows[:-1], 0), columns[:-1], 1)
    return sums / (np.diff(rows)[:, None] * np.diff(columns)[None, :])[..., None]


def rms(test, reference):
    """Root mean square of the difference, relative to the mean."""
    return float(np.sqrt(((test - reference) ** 2).mean()) / reference.mean())
