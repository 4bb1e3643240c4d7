#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the gear example from nothing: body, mesh, stresses, field, exact part. Needs gmsh, ccx, meso, python3-numpy, python3-h5py.

usage: run.py [--meso PROGRAM] [--gmsh PROGRAM] [--ccx PROGRAM] [--out FOLDER] [--size MM] [--fine MM] [--keep]

Everything is made in FOLDER (gear-work); gear.step and stress.h5 there are compared with those beside this script, and with --keep they and
the document, which states the number of records, take their place. A check that fails ends the script.
"""

import argparse
import math
import os
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "mechanics"))
sys.dont_write_bytecode = True

import h5py
import numpy as np

import gear_profile as gear
import mechanics

FORCE = 2000.0  # N on the loaded tooth's flank, along its inward normal
LEWIS_FORM_FACTOR = 0.322  # of 20 full-depth teeth of 20 degrees

BODY = """<?xml version="1.0" encoding="UTF-8"?>
<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <macrostructures>
    <macrostructure id="gear"><import href="gear-gmsh.step"/></macrostructure>
  </macrostructures>
  <parts>
    <part id="body" macrostructure="gear"/>
  </parts>
</meso>
"""

MESH = """SetFactory("OpenCASCADE");
v() = ShapeFromFile("gear.step");
bore() = Surface In BoundingBox {{-{bore}, -{bore}, -0.01, {bore}, {bore}, {high}}};
face() = Surface In BoundingBox {{-40, -40, {low}, 40, 40, {high}}};
load() = Surface In BoundingBox {{-3, {pitch}, -0.01, -1, 40, {high}}};
Physical Volume("solid") = v();
Physical Surface("bore") = bore();
Physical Surface("face") = face();
Physical Surface("load") = load();
// Fine around the foot of the loaded tooth.
Field[1] = Ball;
Field[1].YCenter = {root};
Field[1].ZCenter = {middle};
Field[1].Radius = 6.5;
Field[1].Thickness = 6;
Field[1].VIn = {fine};
Field[1].VOut = {size};
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
"""


def check(what, value, low, high):
    good = low <= value <= high
    print(f"{'ok  ' if good else 'FAIL'} {what:<58} {value:14.6f}   in {low:g} .. {high:g}", flush=True)
    if not good:
        raise SystemExit(1)


def make_body(options, out):
    """Gmsh's STEP repeats every edge as a curve in the parameters of its faces; meso writes the same solid without these."""
    script = gear.geometry() + 'Recursive Delete { Surface{1}; }\nSave "gear-gmsh.step";\n'
    (out / "body.geo").write_text(script)
    mechanics.run_program([options.gmsh, "-0", "body.geo"], out, "body.gmsh.log")
    (out / "body.meso").write_text(BODY)
    mechanics.run_program([options.meso, "convert", "body.meso", "gear.step"], out, "body.meso.log")
    print(f"gear.step: {(out / 'gear.step').stat().st_size} bytes, gear-gmsh.step: {(out / 'gear-gmsh.step').stat().st_size} bytes")


def solve(options, out):
    """Records x y z vonMises at the nodes of the face z = width."""
    script = MESH.format(bore=gear.BORE_RADIUS + 0.01, low=gear.WIDTH - 0.01, high=gear.WIDTH + 0.01,
                         pitch=gear.PITCH - 0.2, root=gear.ROOT, middle=gear.WIDTH / 2, fine=options.fine, size=options.size)
    mesh = mechanics.mesh_with_gmsh(script, out, "gear", options.gmsh)
    print(f"mesh: {len(mesh.nodes)} nodes, {len(mesh.tets)} tetrahedra")
    flank = mesh.faces["load"]
    area = mechanics.area_vectors(mesh, flank).sum(axis=0)
    force = -FORCE * area / np.linalg.norm(area)
    loads = mechanics.traction(mesh, flank, force)
    torque = sum(np.cross(mesh.nodes[n], f)[2] for n, f in loads.items())
    # The normals of an involute touch the base circle.
    check("lever arm of the load / base circle's radius", abs(torque) / FORCE / gear.BASE, 0.995, 1.005)
    reaction = mechanics.solve(mesh, mechanics.nodes_of(mesh.faces["bore"]), loads, out, "gear", options.ccx)
    check("reaction of the bore / load", np.linalg.norm(reaction) / FORCE, 0.9999, 1.0001)
    stress = mechanics.read_frd(out / "gear.frd", "STRESS")
    check_root(mesh, stress)
    face = mechanics.nodes_of(mesh.faces["face"])
    return np.column_stack([[mesh.nodes[n] for n in face], mechanics.von_mises([stress[n] for n in face])])


def check_root(mesh, stress):
    """Lewis takes the tooth for a beam: without the notch of the fillet, which adds 20 to 60 %."""
    lewis = FORCE * math.cos(gear.PRESSURE_ANGLE) / (gear.WIDTH * gear.MODULE * LEWIS_FORM_FACTOR)
    print(f"nominal stress at the root after Lewis: {lewis:.1f} MPa")
    for side, name in ((-1, "tension"), (1, "compression")):
        root = [n for n, p in mesh.nodes.items()
                if abs(p[0]) < 4 and side * p[0] > 0 and p[1] > 0 and gear.ROOT + 0.1 < math.hypot(p[0], p[1]) < gear.BASE]
        peak = max(float(mechanics.von_mises(stress[n])) for n in root)
        check(f"highest von Mises stress at the root, {name}, MPa", peak, lewis, 2 * lewis)


def write_field(options, out, records):
    rows = [",".join(f"{v:.17g}" for v in row) for row in records]
    (out / "stress.csv").write_text("\n".join(["x [mm],y [mm],z [mm],vonMises [MPa]", *rows]) + "\n")
    mechanics.run_program([options.meso, "field", "import", "stress.csv", "stress.h5"], out, "field.log")
    print(f"stress.h5: {len(records)} records, {(out / 'stress.h5').stat().st_size} bytes")


def compare_shipped(out, records):
    """gear.step and stress.h5 of this run against those of the repository: bytes, and what decides the part."""
    for name in ("gear.step", "stress.h5"):
        same = (out / name).read_bytes() == (HERE / name).read_bytes()
        print(f"{name}: {'the same bytes as' if same else 'other bytes than'} in the repository")
    with h5py.File(HERE / "stress.h5") as field:
        shipped = field["records"][:, 3]
    for name, percent in (("median", 50), ("99th percentile", 99), ("highest", 100)):
        here, there = np.percentile(records[:, 3], percent), np.percentile(shipped, percent)
        check(f"von Mises, {name}: {here:.2f} MPa here / in the repository", here / there, 0.95, 1.05)


def make_part(options, out, records):
    text = re.sub(r'(<structure records=)"\d+"', rf'\1"{len(records)}"', (HERE / "gear.meso").read_text())
    (out / "gear.meso").write_text(text)
    print(mechanics.run_program([options.meso, "convert", "gear.meso", "part.step"], out, "convert.log"), end="")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meso", default="meso")
    arguments.add_argument("--gmsh", default="gmsh")
    arguments.add_argument("--ccx", default="ccx")
    arguments.add_argument("--out", type=pathlib.Path, default=pathlib.Path("gear-work"))
    arguments.add_argument("--size", type=float, default=2.0, help="edges of elements, mm")
    arguments.add_argument("--fine", type=float, default=0.75, help="the same around the foot of the loaded tooth")
    arguments.add_argument("--keep", action="store_true", help="replace gear.step and stress.h5 beside this script")
    options = arguments.parse_args()
    options.meso = shutil.which(options.meso) or options.meso
    options.meso = os.path.abspath(options.meso) if os.sep in options.meso else options.meso
    out = options.out
    out.mkdir(parents=True, exist_ok=True)

    make_body(options, out)
    text = mechanics.run_program([options.meso, "verify", "gear.step"], out, "verify.log")
    measured = float(next(line.split()[-1] for line in text.splitlines() if " volume " in line))
    check("volume of gear.step / volume of the true involute gear", measured / gear.volume(), 1 - 1e-5, 1 + 1e-5)
    records = solve(options, out)
    write_field(options, out, records)
    compare_shipped(out, records)
    make_part(options, out, records)
    if options.keep:
        for name in ("gear.step", "stress.h5", "gear.meso"):
            shutil.copy(out / name, HERE)


if __name__ == "__main__":
    main()
