#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The same documents through both engines: volumes to a thousandth, and 100 000 random points on the same side.

usage: two_engines.py --meso PATH [--count 40 | --quick | --documents PATH...] [--seed 1] [--kind NAME] [--keep FOLDER]

The exact engine says the volume and writes triangles to a deflection of an eighth of the spacing h. The implicit engine
meshes at a spacing and at half of it; what it misses of a volume shrinks with the square of the spacing, so that both
volumes say a third one, V(h/2) + (V(h/2) - V(h)) / 3, which is compared. There are --samples samples in the box at h/2, and
more, up to four halvings, while the two volumes are not within 0.4 % of each other or the third not within a thousandth of
the exact one: faces between two planes of samples make it jump. The side of a point is told by crossings of lines along x, y
and z with each engine's triangles; where the sides differ, the point must be within h/2 of the exact triangles. Documents
that an engine refuses are counted, and those that both engines find empty; the exact engine's refusals are judged by
random_parts.py. A body whose walls, 2 V / A, are thinner than ten of the finest spacings has no volume to a thousandth
there: it is counted as thin if its points do not differ.
"""
import argparse
import collections
import concurrent.futures
import json
import pathlib
import random
import sys
import tempfile

try:
    import numpy
except ImportError:
    print("skipped: no numpy")
    sys.exit(77)

import random_parts

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Minutes for the exact engine, or more triangles than lines are counted through here; --all has them.
LARGE = {"gear", "ibeam", "sphere", "disk", "direction-beam"}
HALVINGS = 4  # of the spacing, at most
LINES, POINTS = 999, 101  # lines, a third along each axis, and points on each


class Refused(Exception):
    pass


def meso(a, *arguments):
    done = random_parts.Judge(a.meso, 0, a.seconds).run("convert", *arguments, "--json", "--jobs", 1)
    if done.returncode:
        error = json.loads(done.stdout)["error"] if done.stdout else {"code": "?", "message": f"exit code {done.returncode}"}
        raise Refused(f'{error["code"]}: {error["message"]}')
    return json.loads(done.stdout)


def triangles(file):
    """Corners of a binary STL: triangle, corner, coordinate."""
    data = numpy.fromfile(file, numpy.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]), offset=84)
    return data["corners"]


class Sides:
    """Points of a line along z on one side or the other of triangles."""

    def __init__(self, corners):
        self.corners = corners[numpy.argsort(corners[:, :, 0].min(1))]
        self.low, self.high = self.corners[:, :, :2].min(1), self.corners[:, :, :2].max(1)
        self.widest = (self.high - self.low)[:, 0].max()

    def inside(self, x, y, heights):
        begin, end = numpy.searchsorted(self.low[:, 0], (x - 1.001 * self.widest, x + 1e-6 * abs(x)))
        low, high = self.low[begin:end], self.high[begin:end]
        over = begin + numpy.flatnonzero((high[:, 0] >= x) & (low[:, 1] <= y) & (high[:, 1] >= y))
        a, b, c = (self.corners[over, k].astype(float) - (x, y, 0) for k in range(3))
        areas = numpy.stack([u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] for u, v in ((b, c), (c, a), (a, b))])
        hit = (areas > 0).all(0) | (areas < 0).all(0)
        weights = areas[:, hit] / areas[:, hit].sum(0)
        crossings = numpy.sort(weights[0] * a[hit, 2] + weights[1] * b[hit, 2] + weights[2] * c[hit, 2])
        return numpy.searchsorted(crossings, heights) % 2 == 1


def distance(p, corners, within):
    """From a point to triangles, if it is not above `within`; else more than that."""
    near = ((corners.min(1) <= p + within) & (corners.max(1) >= p - within)).all(1)
    best = numpy.inf
    for t in corners[near] - p:
        normal = numpy.cross(t[1] - t[0], t[2] - t[0])
        length = numpy.linalg.norm(normal)
        edges = [(t[k], t[(k + 1) % 3] - t[k]) for k in range(3)]
        if length > 0 and all(numpy.cross(e, -a) @ normal >= 0 for a, e in edges):
            best = min(best, abs(t[0] @ normal) / length)
        for a, e in edges:
            best = min(best, numpy.linalg.norm(a + e * numpy.clip(-(a @ e) / max(e @ e, 1e-300), 0, 1)))
    return best


def differing(exact, implicit, near):
    """How many random points were asked, and those that the engines put on different sides although no surface is near."""
    rng, far = numpy.random.default_rng(1), []
    low, high = exact.min((0, 1)), exact.max((0, 1))
    low, high = low - 0.03 * (high - low), high + 0.03 * (high - low)
    for axis in range(3):
        order = [(axis + 1) % 3, (axis + 2) % 3, axis]
        ours, theirs = Sides(exact[:, :, order]), Sides(implicit[:, :, order])
        for x, y in rng.uniform(low[order[:2]], high[order[:2]], (LINES // 3, 2)):
            heights = rng.uniform(low[axis], high[axis], POINTS)
            for z in heights[ours.inside(x, y, heights) != theirs.inside(x, y, heights)]:
                p = numpy.empty(3)
                p[order] = x, y, z
                if distance(p, exact, near) > near:
                    far.append(p)
    return LINES * POINTS, far


def empty_to_one(a, file, folder, part, refusal):
    """What is to be said of a document whose coarse grid holds nothing."""
    try:
        exact = meso(a, file, folder / "one.stl", *part, "--engine", "brep")
    except Refused as by_exact:
        return ("empty", "to both engines", 0) if "GEOMETRY_EMPTY" in str(by_exact) else ("refused", str(by_exact), 0)
    width = 2 * exact["volume"] / exact["area"]
    try:
        meso(a, file, folder / "one.stl", *part, "--engine", "implicit", "--spacing", width / 3)
    except Refused as by_implicit:
        if "GEOMETRY_EMPTY" in str(by_implicit):
            return "wrong", f"empty to one engine only: {refusal}", 0
        return "thin", f"walls of {width:.2g} mm, lost between samples; finer ones: {by_implicit}", 0
    return "thin", f"walls of {width:.2g} mm, found at samples three times as fine only", 0


def compared(a, file, folder, part):
    """(verdict, words, relative difference of the volumes)"""
    part = ["--part", part] if part else []
    try:
        exact_file, mesh_file = folder / "exact.stl", folder / "implicit.stl"
        coarse = meso(a, file, mesh_file, *part, "--engine", "implicit", "--samples", a.samples // 8, "--measure")
        exact = None
        for _ in range(HALVINGS):
            h = coarse["grid"]["spacing"]
            fine = meso(a, file, mesh_file, *part, "--engine", "implicit", "--spacing", h / 2, "--measure")
            volume = fine["volume"] + (fine["volume"] - coarse["volume"]) / ((h / fine["grid"]["spacing"]) ** 2 - 1)
            if abs(fine["volume"] - coarse["volume"]) <= 0.004 * volume:
                exact = meso(a, file, exact_file, *part, "--engine", "brep", "--deflection", h / 8)
                if abs(volume / exact["volume"] - 1) <= 1e-3:
                    break
            coarse = fine
        exact = exact or meso(a, file, exact_file, *part, "--engine", "brep", "--deflection", h / 8)
    except Refused as refusal:
        if "GEOMETRY_EMPTY" in str(refusal):
            return empty_to_one(a, file, folder, part, refusal)
        return "refused", str(refusal), 0
    off = abs(volume / exact["volume"] - 1)
    asked, far = differing(triangles(exact_file), triangles(mesh_file), h / 2)
    words = f'spacing {h / 2:.4f} mm, volume {exact["volume"]:.6g} and {volume:.6g} ({off:.1e}), {len(far)} of {asked} points differ'
    if far:
        return "wrong", words + f", such as {far[0]}", off
    if off <= 1e-3:
        return "ok", words, off
    return "thin" if exact["volume"] / exact["area"] < 5 * h / 2 else "wrong", words, off


def compared_and_cleared(a, file, folder, part):
    """Meshes of a thousand documents would fill a disk."""
    try:
        return compared(a, file, folder, part)
    finally:
        for mesh in [] if a.keep else folder.glob("*.stl"):
            mesh.unlink()


def random_one(a, kind, seed, parent):
    folder = parent / f"{kind}_{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    made = random_parts.KINDS[kind](random.Random(f"{kind} {seed}"), folder, random_parts.Judge(a.meso, 0, a.seconds).run)
    if made is None:
        return f"{kind} {seed}", "refused", "no body to import", 0
    file = folder / "part.meso"
    file.write_text(made[0].replace("@VALIDATION@", ""), encoding="utf-8")
    return f"{kind} {seed}", *compared_and_cleared(a, file, folder, "a")


def known_one(a, file, parent):
    folder = parent / f"{file.parent.name}_{file.stem}"
    folder.mkdir(parents=True, exist_ok=True)
    return f"{file.parent.name}/{file.name}", *compared_and_cleared(a, file, folder, None)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--count", type=int, default=40, help="random documents in all")
    parser.add_argument("--quick", action="store_true", help="one document of each kind and an example, fewer samples")
    parser.add_argument("--examples", action="store_true", help="the documents of examples/, and none that are random")
    parser.add_argument("--all", action="store_true", help="the large examples, too")
    parser.add_argument("--documents", nargs="*", type=pathlib.Path, help="these, and none that are random")
    parser.add_argument("--seed", type=int, default=1, help="of the first document")
    parser.add_argument("--samples", type=int, default=4000000, help="of the finer grid")
    parser.add_argument("--seconds", type=int, default=60, help="of a processor, for each run of meso")
    parser.add_argument("--jobs", type=int, default=1, help="documents at a time")
    parser.add_argument("--kind", choices=sorted(random_parts.KINDS), action="append")
    parser.add_argument("--keep", help="a folder for the documents and both meshes")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    kinds, documents = a.kind or list(random_parts.KINDS), a.documents or []
    if a.examples or a.all:
        documents += [f for f in sorted(ROOT.glob("examples/*/*.meso")) if a.all or f.parent.name not in LARGE | {"implicit"}]
    elif a.quick:
        a.count, a.samples, a.seconds = len(kinds), 500000, 6
    asked = [] if documents else [(kinds[n % len(kinds)], a.seed + n // len(kinds)) for n in range(a.count)]
    if a.quick:
        documents.append(ROOT / "examples/documents/drilled_plate.meso")
    counts, worst = collections.Counter(), (0, "none")
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        parent = pathlib.Path(a.keep or temporary)
        jobs = [pool.submit(random_one, a, *one, parent) for one in asked] + [pool.submit(known_one, a, f, parent) for f in documents]
        for name, verdict, words, off in (job.result() for job in jobs):
            counts[verdict] += 1
            worst = max(worst, (off, name))
            if verdict == "wrong" or a.verbose:
                print(f"{verdict} {name}: {words}", flush=True)
    print(f"{len(jobs)} documents: {', '.join(f'{n} {v}' for v, n in sorted(counts.items()))}; worst volume {worst[0]:.1e} ({worst[1]})")
    sys.exit(1 if counts["wrong"] or not counts["ok"] else 0)


if __name__ == "__main__":
    main()
