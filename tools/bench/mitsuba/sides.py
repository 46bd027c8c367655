"""Both programs at one scene: Mitsuba's is made of our .rad file, with the same view."""

import os
import resource
import subprocess
import sys
import time

import mitsuba
import numpy


def scene_of(file):
    """Materials and polygons of a .rad file: {name: (kind, colour)} and [(material, points)]."""
    words = iter(" ".join(line.split("#")[0] for line in file.read_text().splitlines()).split())
    materials, polygons = {}, []
    for modifier in words:
        kind, name = next(words), next(words)
        strings, integers, reals = ([next(words) for _ in range(int(next(words)))] for _ in range(3))
        reals = [float(w) for w in reals]
        if kind == "polygon":
            polygons.append((modifier, [reals[i:i + 3] for i in range(0, len(reals), 3)]))
        elif modifier == "void" and (kind in ("light", "glow") or kind == "plastic" and reals[3] == 0):
            materials[name] = (kind, reals[:3])
        else:
            sys.exit(f"{file}: {kind} {name}: only matte plastic, light, glow and polygons are taken")
    return materials, polygons


def ply(polygons):
    """The text of a mesh: each polygon, convex here, as a fan."""
    points = [p for points in polygons for p in points]
    faces, start = [], 0
    for polygon in polygons:
        faces += [(start, start + i, start + i + 1) for i in range(1, len(polygon) - 1)]
        start += len(polygon)
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    return head + "".join("%.9g %.9g %.9g\n" % tuple(p) for p in points) + "".join("3 %d %d %d\n" % f for f in faces)


class Mitsuba:
    """The scene and its path tracer."""

    def __init__(self, file, view, size, sampler, work):
        materials, self.polygons = scene_of(file)
        self.size, self.work, self.sampler = size, work, sampler
        words = view.read_text().split()
        number = lambda name, n: [float(w) for w in words[words.index(name) + 1:][:n]]
        origin, direction, up = (number(w, 3) for w in ("-vp", "-vd", "-vu"))
        if "-vtv" not in words or number("-vh", 1) != number("-vv", 1):
            sys.exit(f"{view}: only square perspectives are taken")
        target = [o + d for o, d in zip(origin, direction)]
        self.look = {"to_world": mitsuba.ScalarTransform4f().look_at(origin=origin, target=target, up=up), "fov": number("-vh", 1)[0], "fov_axis": "x"}
        rgb = lambda colour: {"type": "rgb", "value": colour}
        self.looks = {}
        for name, (kind, colour) in materials.items():
            # Radiance's lamps reflect nothing and shine from their front; its walls have two sides.
            matte = {"type": "diffuse", "reflectance": rgb(colour if kind == "plastic" else [0, 0, 0])}
            self.looks[name] = {"bsdf": {"type": "twosided", "bsdf": matte}}
            if kind != "plastic":
                self.looks[name]["emitter"] = {"type": "area", "radiance": rgb(colour)}
        self.scene = self.load({name: [p for m, p in self.polygons if m == name] for name in materials}, lambda name: self.looks[name], size)

    def load(self, meshes, look, size):
        film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb", "component_format": "float32", "rfilter": {"type": "box"}}
        scene = {"type": "scene", "sensor": {"type": "perspective", "film": film, "sampler": {"type": self.sampler}, **self.look}}
        for name, polygons in meshes.items():
            file = self.work / f"{name}.ply"
            file.write_text(ply(polygons))
            scene[f"mesh-{name}"] = {"type": "ply", "filename": str(file), "face_normals": True, **look(name)}
        return mitsuba.load_dict(scene)

    def render(self, spp, seed):
        """Picture, seconds, and seconds of processors."""
        integrator = mitsuba.load_dict({"type": "path", "max_depth": -1})
        wall, cpu = time.perf_counter(), time.process_time()
        picture = numpy.array(mitsuba.render(self.scene, integrator=integrator, spp=spp, seed=seed))
        return picture, time.perf_counter() - wall, time.process_time() - cpu

    def edges(self, fine=4):
        """Which pixels more than one polygon is seen in, or in a neighbour of."""
        scene = self.load({str(i): [p] for i, (_, p) in enumerate(self.polygons)}, lambda i: self.looks[self.polygons[int(i)][0]], fine * self.size)
        integrator = mitsuba.load_dict({"type": "aov", "aovs": "index:shape_index"})
        seen = numpy.array(mitsuba.render(scene, integrator=integrator, spp=1))[:, :, -1].reshape(self.size, fine, self.size, fine)
        return wider(seen.min(axis=(1, 3)) != seen.max(axis=(1, 3)))


class Ambit:
    """Our programs at the same scene."""

    def __init__(self, tools, file, view, size, work):
        self.tools, self.view, self.size, self.work = tools, view, size, work
        with open(work / "scene.oct", "wb") as octree:
            subprocess.run([tools / "oconv", file], stdout=octree, check=True)

    def render(self, fine, options, seed):
        """Picture of means of fine x fine of rpict's, seconds, and seconds of processors."""
        size, file = str(fine * self.size), self.work / "ours.hdr"
        command = [self.tools / "rpict", "-n", str(os.cpu_count()), "-vf", self.view, "-x", size, "-y", size, *options.split(), "--seed", str(seed), self.work / "scene.oct"]
        spent = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
        wall, cpu = time.perf_counter(), spent()
        with open(file, "wb") as out:
            subprocess.run(command, stdout=out, check=True)
        wall, cpu = time.perf_counter() - wall, spent() - cpu
        picture = pixels(file.read_bytes())
        start = time.perf_counter()
        picture = picture.reshape(self.size, fine, self.size, fine, 3).mean(axis=(1, 3))
        averaged = time.perf_counter() - start
        return picture, wall + averaged, cpu + averaged


def pixels(data):
    """The radiances of a picture whose rows are run-length coded from the top."""
    line, at = data.split(b"\n\n", 1)[1].split(b"\n", 1)
    height, width = int(line.split()[1]), int(line.split()[3])
    at, out = len(data) - len(at), numpy.empty((height, 4, width), numpy.uint8)
    for row in out:
        if data[at:at + 2] != b"\2\2":
            sys.exit("a picture that is not run-length coded")
        at += 4
        for channel in row:
            x = 0
            while x < width:
                count, at = data[at], at + 1
                run = count > 128
                count -= 128 if run else 0
                channel[x:x + count] = data[at] if run else numpy.frombuffer(data, numpy.uint8, count, at)
                x, at = x + count, at + (1 if run else count)
    out = out.transpose(0, 2, 1)
    scale = numpy.ldexp(1.0, out[:, :, 3:].astype(int) - 136)
    # The middle of each step; an exponent of zero is black.
    return numpy.where(out[:, :, 3:] == 0, 0, (out[:, :, :3] + 0.5) * scale)


def wider(mask):
    """A mask and its neighbours."""
    padded = numpy.pad(mask, 1)
    h, w = mask.shape
    return numpy.any([padded[y:y + h, x:x + w] for y in range(3) for x in range(3)], axis=0)
