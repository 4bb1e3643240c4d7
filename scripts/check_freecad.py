#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A second opinion on a STEP or STL file from FreeCAD, headless.

usage: check_freecad.py FILE [VOLUME_MM3 [RELATIVE_TOLERANCE]]
Prints one JSON line; exit 0 if the file is one or more closed valid solids (and has the volume), 1 if not, 77 without FreeCAD.
"""
import json
import pathlib
import sys

for folder in ("/usr/lib/freecad-python3/lib", "/usr/lib/freecad/lib"):
    if pathlib.Path(folder).is_dir():
        sys.path.insert(0, folder)


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


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    try:
        import FreeCAD  # noqa: F401  (must come before Part and Mesh)
    except ImportError:
        print("FreeCAD is not installed: skipped")
        sys.exit(77)
    path = sys.argv[1]
    result = check_stl(path) if path.lower().endswith(".stl") else check_step(path)
    good = result["valid"] and result["closed"]
    if len(sys.argv) > 2:
        expected = float(sys.argv[2])
        tolerance = float(sys.argv[3]) if len(sys.argv) > 3 else 1e-4
        result["relativeDifference"] = (result["volume"] - expected) / expected
        good = good and abs(result["relativeDifference"]) <= tolerance
    print(json.dumps({"file": path, **result}))
    sys.stdout.flush()
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
