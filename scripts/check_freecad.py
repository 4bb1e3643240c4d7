#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A second opinion on a STEP or STL file from FreeCAD. Runs the program `freecadcmd`, which is never linked.

usage: check_freecad.py FILE [VOLUME_MM3 [RELATIVE_TOLERANCE]]
Prints one JSON line; exit 0 if the file is one or more closed valid solids (and has the volume), 1 if not, 77 without FreeCAD.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

MOST_SHELLS = 100
FILE_FOR_FREECAD = "CHECK_FREECAD_FILE"  # freecadcmd takes every further argument for a file to open


GAUSS = [(0.5 - 0.5 * x, 0.5 * w) for x, w in ((-0.9061798459386640, 0.2369268850561891), (-0.5384693101056831, 0.4786286704993665),
         (0.0, 0.5688888888888889), (0.5384693101056831, 0.4786286704993665), (0.9061798459386640, 0.2369268850561891))]


def fills_its_rectangle(face):
    """Whether the face is a whole rectangle of its surface's parameters, so that it can be integrated without its edges."""
    low_u, high_u, low_v, high_v = face.ParameterRange
    if len(face.Edges) != 4:
        return False
    for edge in face.Edges:
        for share in (0.25, 0.5, 0.75):
            at = edge.valueAt(edge.FirstParameter + share * (edge.LastParameter - edge.FirstParameter))
            u, v = face.Surface.parameter(at)
            if min(u - low_u, high_u - u) > 1e-6 * (high_u - low_u) and min(v - low_v, high_v - v) > 1e-6 * (high_v - low_v):
                return False
    return True


def between_knots(knots, low, high):
    ends = [low, *(k for k in knots if low < k < high), high]
    return [(a + t * (b - a), w * (b - a)) for a, b in zip(ends, ends[1:]) for t, w in GAUSS]


def ends_of_edges(face):
    return [vertex.Point for edge in face.Edges for vertex in edge.Vertexes]


def lost_by_quadrature(face, apex):
    """Volume between a B-spline face and a point less what FreeCAD's quadrature finds, which passes the knots as if there were none."""
    import Part
    if not isinstance(face.Surface, Part.BSplineSurface) or not fills_its_rectangle(face):
        return 0.0
    low_u, high_u, low_v, high_v = face.ParameterRange
    volume = 0.0
    for u, in_u in between_knots(face.Surface.getUKnots(), low_u, high_u):
        for v, in_v in between_knots(face.Surface.getVKnots(), low_v, high_v):
            normal = face.Surface.getDN(u, v, 1, 0).cross(face.Surface.getDN(u, v, 0, 1))
            volume += in_u * in_v * (face.Surface.value(u, v) - apex).dot(normal) / 3
    # OpenCASCADE takes the mean of all ends of edges for the apex: points beside the face move it.
    found = Part.Compound([face, *(Part.Vertex(2 * apex - end) for end in ends_of_edges(face))]).Volume
    return min(volume - found, -volume - found, key=abs)  # either side of the surface


def is_valid(shape):
    """OpenCASCADE compares every shell with every other: where they are many, each is checked alone."""
    return all(shell.isValid() for shell in shape.Shells) if len(shape.Shells) > MOST_SHELLS else shape.isValid()


def check_step(path):
    import FreeCAD
    import Part
    shape = Part.Shape()
    shape.read(path)
    solids = shape.Solids
    ends = [end for face in shape.Faces for end in ends_of_edges(face)]
    apex = sum(ends, FreeCAD.Vector()) * (1 / max(len(ends), 1))
    volume = shape.Volume + sum(lost_by_quadrature(face, apex) for face in shape.Faces)
    closed = bool(solids) and all(s.isClosed() for s in solids) and len(shape.Shells) == sum(len(s.Shells) for s in solids)
    return {"solids": len(solids), "faces": len(shape.Faces), "valid": is_valid(shape), "closed": closed, "volume": volume}


def check_stl(path):
    import Mesh
    mesh = Mesh.Mesh(path)
    good = mesh.isSolid() and not mesh.hasNonManifolds() and not mesh.hasNonUniformOrientedFacets()
    return {"solids": mesh.countComponents(), "faces": mesh.CountFacets, "valid": good, "closed": mesh.isSolid(), "volume": mesh.Volume}


def inside_freecad(path):
    result = check_stl(path) if path.lower().endswith(".stl") else check_step(path)
    print("\n" + json.dumps(result), flush=True)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    if shutil.which("freecadcmd") is None:
        print("FreeCAD is not installed: skipped")
        sys.exit(77)
    path = sys.argv[1]
    done = subprocess.run(["freecadcmd", str(pathlib.Path(__file__).resolve())], capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          env={**os.environ, "LC_ALL": "C", FILE_FOR_FREECAD: str(pathlib.Path(path).resolve())})
    told = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if not told:
        print(json.dumps({"file": path, "error": (done.stderr or done.stdout)[-300:]}))
        sys.exit(1)
    result = json.loads(told[-1])
    good = result["valid"] and result["closed"]
    if len(sys.argv) > 2:
        expected = float(sys.argv[2])
        tolerance = float(sys.argv[3]) if len(sys.argv) > 3 else 1e-4
        result["relativeDifference"] = (result["volume"] - expected) / expected
        good = good and abs(result["relativeDifference"]) <= tolerance
    print(json.dumps({"file": path, **result}))
    sys.exit(0 if good else 1)


if FILE_FOR_FREECAD in os.environ:
    inside_freecad(os.environ[FILE_FOR_FREECAD])
elif __name__ == "__main__":
    main()
