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

FILE_FOR_FREECAD = "CHECK_FREECAD_FILE"  # freecadcmd takes every further argument for a file to open


def check_step(path):
    import Part
    shape = Part.Shape()
    shape.read(path)
    solids = shape.Solids
    closed = bool(solids) and all(s.isClosed() for s in solids) and len(shape.Shells) == sum(len(s.Shells) for s in solids)
    return {"solids": len(solids), "faces": len(shape.Faces), "valid": shape.isValid(), "closed": closed, "volume": shape.Volume}


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
