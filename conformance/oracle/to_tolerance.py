#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`meso convert --tolerance` on the example documents: whether meshes are as close as they say.

usage: to_tolerance.py --meso PATH [--quick | --documents PATH...] [--verbose]

Each document is meshed to a quarter and to a sixteenth of its smallest feature (as FEATURE_BELOW_TOLERANCE names it; a
25th of its longest side, where nothing is known). Each mesh must be closed, no farther from a second mesh than the
tolerance, or than the report says where that is not reached, and differ in volume by less than that times its area; and no point of a second mesh that is the exact
engine's may be farther from the mesh. What is not reached, refused, or takes more than --seconds of a processor is
counted. Distances are measured here, at vertices, eighths of edges and points all over triangles. The second mesh is the exact engine's, to an
eighth of the tolerance; where that engine refuses or takes long, the implicit engine's from a fine uniform grid, whose
own error, by halving its spacing, is allowed for; where it is farther all the same at some points, a grid of half that
spacing decides at these.
"""
import argparse
import collections
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

try:
    import numpy
    import vtkmodules.util.numpy_support as vtk_numpy
    from vtkmodules.vtkCommonCore import mutable, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator
except ImportError:
    print("skipped: no numpy or no VTK")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
QUICK = ["documents/drilled_plate", "documents/graded_block"]
# More triangles than are looked at here in a minute.
LARGE = {"gear", "ibeam", "sphere", "disk", "direction-beam"}
SHARES = (4, 16)
SAMPLES, REFERENCE_NODES = 20000, 4e7
MOST_DOUBTED = 100  # points that a finer reference is asked for


class Refused(Exception):
    pass


def meso(a, *arguments, seconds=None):
    """Its report, and how many seconds of a processor it took."""
    limit = seconds or a.seconds
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([a.meso, "convert", *map(str, arguments), "--json", "--jobs", "1", "--timeout", str(4 * limit)],
                          capture_output=True, text=True, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    took = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode:
        raise Refused((done.stderr.strip().splitlines() or [f"exit code {done.returncode} after {took:.0f} s"])[0])
    return json.loads(done.stdout), took


def mesh_of(file):
    """Points and triangles of a binary PLY."""
    with open(file, "rb") as opened:
        counts, real, line = {}, "<f4", b""
        while line.strip() != b"end_header":
            line = opened.readline()
            if line.startswith(b"element"):
                counts[line.split()[1]] = int(line.split()[2])
            if line.startswith(b"property double"):
                real = "<f8"
        points = numpy.frombuffer(opened.read(3 * numpy.dtype(real).itemsize * counts[b"vertex"]), real).reshape(-1, 3)
        faces = numpy.frombuffer(opened.read(13 * counts[b"face"]), numpy.dtype([("n", "u1"), ("corners", "<i4", 3)]))
    return points.astype(float), faces["corners"].astype(numpy.int64)


def is_closed(triangles):
    edges = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    most = triangles.max() + 1
    there, back = edges[:, 0] * most + edges[:, 1], edges[:, 1] * most + edges[:, 0]
    return len(numpy.unique(there)) == len(there) and numpy.array_equal(numpy.sort(there), numpy.sort(back))


def volume_and_area(points, triangles):
    a, b, c = (points[triangles[:, k]] - points.mean(0) for k in range(3))
    normals = numpy.cross(b - a, c - a)
    return numpy.einsum("ij,ij->", a, normals) / 6, numpy.linalg.norm(normals, axis=1).sum() / 2


class Distance:
    """From points to triangles."""

    def __init__(self, points, triangles):
        self.body, self.locator, places = vtkPolyData(), vtkStaticCellLocator(), vtkPoints()
        places.SetData(vtk_numpy.numpy_to_vtk(numpy.ascontiguousarray(points), deep=True))
        cells = vtkCellArray()
        cells.ImportLegacyFormat(vtk_numpy.numpy_to_vtkIdTypeArray(
            numpy.hstack([numpy.full((len(triangles), 1), 3, numpy.int64), triangles]).ravel(), deep=True))
        self.body.SetPoints(places)
        self.body.SetPolys(cells)
        self.locator.SetDataSet(self.body)
        self.locator.BuildLocator()

    def __call__(self, points):
        nearest, cell, part, square = [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
        result = numpy.empty(len(points))
        for n, p in enumerate(points):
            self.locator.FindClosestPoint(p, nearest, cell, part, square)
            result[n] = square.get() ** 0.5
        return result


def some_points(points, triangles, rng):
    """Vertices, eighths of edges, points all over triangles."""
    chosen = triangles[rng.permutation(len(triangles))[:SAMPLES // 4]]
    chosen = numpy.repeat(chosen, max(1, SAMPLES // 4 // len(chosen)), axis=0)
    a, b, c = (points[chosen[:, k]] for k in range(3))
    eighth = rng.integers(1, 8, (len(chosen), 1)) / 8
    shares = rng.dirichlet((1, 1, 1), len(chosen))
    inside = sum(shares[:, k:k + 1] * (a, b, c)[k] for k in range(3))
    return numpy.concatenate([a, b + eighth * (c - b), (a + b + c) / 3, inside])


def feature_of(a, document, folder):
    report, _ = meso(a, document, folder / "any.ply", "--engine", "implicit", "--tolerance", "1000mm")
    for told in report["diagnostics"]:
        if told["code"] == "FEATURE_BELOW_TOLERANCE":
            return float(told["message"].split(" is ")[1].split(" mm")[0])
    points, _ = mesh_of(folder / "any.ply")
    return (points.max(0) - points.min(0)).max() / 25


def from_finer(a, document, folder, spacing, points):
    """How far points are from a uniform grid's mesh, which is looked at near them only."""
    file = folder / "finer.ply"
    meso(a, document, file, "--engine", "implicit", "--sharp", "--spacing", f"{spacing}mm", seconds=240)
    places, triangles = mesh_of(file)
    result = numpy.empty(len(points))
    for n, p in enumerate(points):
        near = triangles[(numpy.abs(places[triangles[:, 0]] - p) < 8 * spacing).all(1)]
        used, corners = numpy.unique(near, return_inverse=True)
        result[n] = Distance(places[used], corners.reshape(-1, 3))(p[None])[0] if len(near) else 8 * spacing
    return result


def reference(a, document, folder, feature, tolerance):
    """A second mesh, the spacing of its grid (None: it is the exact engine's), and how far it is from the surface."""
    file = folder / "reference.ply"
    try:
        meso(a, document, file, "--engine", "brep", "--deflection", f"{tolerance / 8}mm", seconds=30)
        return mesh_of(file), None, tolerance / 8
    except Refused:
        pass
    points, _ = mesh_of(folder / "mesh.ply")
    size = points.max(0) - points.min(0)
    spacing = max(min(feature / 10, tolerance / 2), (size.prod() / REFERENCE_NODES) ** (1 / 3))
    meshes = []
    for h in (2 * spacing, spacing):
        meso(a, document, file, "--engine", "implicit", "--sharp", "--spacing", f"{h}mm", seconds=120)
        meshes.append(mesh_of(file))
    rng = numpy.random.default_rng(1)
    # Errors go with the square of the spacing: a third of what the two differ by is left.
    left = numpy.quantile(Distance(*meshes[1])(some_points(*meshes[0], rng)), 0.999) / 3
    return meshes[1], spacing, left


def judge(a, document, folder, share):
    """What is wrong, or None where the tolerance was refused or not reached; and words about it."""
    feature = feature_of(a, document, folder)
    tolerance = feature / share
    try:
        report, took = meso(a, document, folder / "mesh.ply", "--engine", "implicit", "--tolerance", f"{tolerance:.6g}mm")
    except Refused as refusal:
        return None, f"to {tolerance:.4g} mm: {refusal}"
    points, triangles = mesh_of(folder / "mesh.ply")
    (other_points, other_triangles), spacing, left = reference(a, document, folder, feature, tolerance)
    rng = numpy.random.default_rng(1)
    asked = some_points(points, triangles, rng)
    far = Distance(other_points, other_triangles)(asked)
    back = Distance(points, triangles)(some_points(other_points, other_triangles, rng))
    volume, area = volume_and_area(points, triangles)
    other_volume, other_area = volume_and_area(other_points, other_triangles)
    told = any(d["code"] == "TOLERANCE_NOT_REACHED" for d in report["diagnostics"])
    allowed = (report["accuracy"]["distance"] if told else tolerance) + left
    doubted = numpy.flatnonzero(far > allowed)
    if spacing and 0 < len(doubted) <= MOST_DOUBTED:
        # Tips of thin sheets come and go with a uniform grid's nodes.
        far[doubted] = from_finer(a, document, folder, 0.45 * spacing, asked[doubted])
    faults = []
    if not is_closed(triangles):
        faults.append("not closed")
    if far.max() > allowed:
        faults.append(f"{(far > allowed).sum()} of {len(far)} points are farther")
    if spacing is None and back.max() > allowed:
        faults.append(f"{(back > allowed).sum()} of {len(back)} points of the body are farther from the mesh")
    if abs(volume - other_volume) > allowed * max(area, other_area):
        faults.append("volume")
    if not told and report["accuracy"]["distance"] > tolerance:
        faults.append("farther by its own report, without a warning")
    words = (f"{'not reached: ' if told else ''}to {tolerance:.4g} mm: {len(triangles)} triangles, {took:.1f} s, told {report['accuracy']['distance']:.3g}, "
             f"farthest {far.max():.3g} and back {back.max():.3g} ({f'{spacing:.3g} mm' if spacing else 'exact'}, {left:.2g}), volume {volume:.5g} and {other_volume:.5g}")
    return None if told and not faults else faults, words


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--quick", action="store_true", help="two documents, the coarser tolerance")
    parser.add_argument("--documents", nargs="*", type=pathlib.Path)
    parser.add_argument("--seconds", type=int, default=30, help="of a processor, for a mesh")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    if a.documents:
        documents = a.documents
    elif a.quick:
        documents = [ROOT / "examples" / f"{name}.meso" for name in QUICK]
    else:
        documents = [f for f in sorted(ROOT.glob("examples/*/*.meso")) if f.parent.name not in LARGE]
    counts = collections.Counter()
    for document in documents:
        for share in SHARES[:1] if a.quick else SHARES:
            with tempfile.TemporaryDirectory() as folder:
                try:
                    faults, words = judge(a, document, pathlib.Path(folder), share)
                except Refused as refusal:
                    faults, words = None, str(refusal)
            verdict = "wrong" if faults else "ok" if faults is not None else "not reached"
            counts[verdict] += 1
            if faults or a.verbose:
                print(f"{verdict} {document.parent.name}/{document.stem} {words} {'; '.join(faults or [])}", flush=True)
    print(f"{len(documents)} documents: {', '.join(f'{n} {v}' for v, n in sorted(counts.items()))}")
    sys.exit(1 if counts["wrong"] or not counts["ok"] else 0)


if __name__ == "__main__":
    main()
