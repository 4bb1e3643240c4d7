#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Can Gmsh fill a STEP file with tetrahedra? Runs the program `gmsh`, which is never linked.

usage: check_gmsh.py FILE.step [VOLUME_MM3 [RELATIVE_TOLERANCE [SIZE_MM [ROUND]]]]
Prints one JSON line; exit 0 if all solids are filled (and the tetrahedra have the volume, by default to 3 %: they are
chords of round faces), 1 if not, 77 without Gmsh. SIZE_MM: the largest edge, 0: as Gmsh likes. ROUND: edges around a circle.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

TETRAHEDRON = 4  # Gmsh's number of the element type


def volume_of(mesh):
    """Number of tetrahedra of a mesh file (format 2.2), and the sum of their volumes."""
    lines = iter(mesh.read_text().splitlines())
    points, count, total = {}, 0, 0.0
    for line in lines:
        if line == "$Nodes":
            for _ in range(int(next(lines))):
                number, *at = next(lines).split()
                points[number] = [float(v) for v in at]
        elif line == "$Elements":
            for _ in range(int(next(lines))):
                fields = next(lines).split()
                if int(fields[1]) != TETRAHEDRON:
                    continue
                o, a, b, c = (points[n] for n in fields[-4:])
                u, v, w = ([q - p for p, q in zip(o, end)] for end in (a, b, c))
                total += abs(u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6
                count += 1
    return count, total


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    if shutil.which("gmsh") is None:
        print("Gmsh is not installed: skipped")
        sys.exit(77)
    path = sys.argv[1]
    size = ["-clmax", sys.argv[4]] if len(sys.argv) > 4 and float(sys.argv[4]) > 0 else []
    around = sys.argv[5] if len(sys.argv) > 5 else "12"
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "solid.msh"
        done = subprocess.run(["gmsh", "-3", "-format", "msh2", "-setnumber", "Mesh.MeshSizeFromCurvature", around, *size, "-o", str(mesh), path],
                              capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
        errors = [line for line in done.stdout.splitlines() + done.stderr.splitlines() if line.startswith("Error")]
        count, volume = volume_of(mesh) if mesh.exists() else (0, 0.0)
    result = {"file": path, "exit": done.returncode, "errors": errors[:3], "tetrahedra": count, "volume": volume}
    good = done.returncode == 0 and not errors and count > 0
    if len(sys.argv) > 2:
        expected = float(sys.argv[2])
        result["relativeDifference"] = (volume - expected) / expected
        good = good and abs(result["relativeDifference"]) <= (float(sys.argv[3]) if len(sys.argv) > 3 else 0.03)
    print(json.dumps(result))
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
