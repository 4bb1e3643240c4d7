#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Stress in the I-beam under asymmetric bending, on the 5 mm grid that direction-beam.meso scatters its cells over.

usage: stress.py [--meso PROGRAM] [--gmsh PROGRAM] [--ccx PROGRAM] [--size MM] [--out FOLDER] [--field FILE]

Gmsh meshes beam.step, CalculiX solves it: one end held, 1000 N down on a patch of 8 x 8 mm at a corner of the upper flange. `meso eval` then
interpolates the nodal stresses on the tetrahedra at the 1 120 places of the grid. Stops if the reaction does not balance the load, or if the
bending stress of beam theory is missed by more than 1 %. Needs numpy.
"""

import argparse
import csv
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "mechanics"))
import mechanics  # noqa: E402

FORCE = 1000.0  # N, towards -y
PATCH = (17.0, 25.0, 192.0, 200.0)  # mm: x and z of the loaded corner, on y = 30
SECOND_MOMENT = (50 * 60**3 - 44 * 44**3) / 12  # mm^4, of the section about x
ORDERS = ("xx", "yy", "zz", "xy", "yz", "zx")  # of CalculiX, of the field file, of the documents
# Records of the field file: the flanges' grid, then the web's, last axis fastest.
PLACES = {"flanges": ("x", -22.5, 5, 10), "web": ("y", -17.5, 5, 8)}

GEOMETRY = """SetFactory("OpenCASCADE");
body() = ShapeFromFile("{step}");
x0 = {0}; x1 = {1}; z0 = {2}; z1 = {3};
Point(1001) = {{x0, 30, z0}}; Point(1002) = {{x1, 30, z0}}; Point(1003) = {{x1, 30, z1}}; Point(1004) = {{x0, 30, z1}};
Line(1001) = {{1001, 1002}}; Line(1002) = {{1002, 1003}}; Line(1003) = {{1003, 1004}}; Line(1004) = {{1004, 1001}};
Curve Loop(1001) = {{1001, 1002, 1003, 1004}}; Plane Surface(1001) = {{1001}};
BooleanFragments{{ Volume{{body()}}; Delete; }}{{ Surface{{1001}}; Delete; }}
e = 1e-3;
Physical Volume("solid") = Volume{{:}};
Physical Surface("held") = Surface In BoundingBox{{-25 - e, -30 - e, -e, 25 + e, 30 + e, e}};
Physical Surface("load") = Surface In BoundingBox{{x0 - e, 30 - e, z0 - e, x1 + e, 30 + e, z1 + e}};
Mesh.MeshSizeMin = {size}; Mesh.MeshSizeMax = {size};
"""

# A cell that does nothing but say what the field is where it stands.
SAMPLING = """<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <unitCells>
    <unitCell id="probe">
      {parameters}
      <csg><sphere radius="0.1"/></csg>
    </unitCell>
  </unitCells>
  <vectorFields>
    <vectorField id="s">
      <structure records="{nodes}">
        <component name="x" unit="mm" role="position"/><component name="y" unit="mm" role="position"/><component name="z" unit="mm" role="position"/>
        {components}
        <mesh type="tetra" elements="{elements}"><external href="beam.frd" format="frd"/></mesh>
      </structure>
      <external href="beam.frd" format="frd" path="STRESS"/>
      <interpolation method="linear"/>
    </vectorField>
  </vectorFields>
  <patterns>
    {patterns}
  </patterns>
  <parts>
    <part id="probes">{parts}</part>
  </parts>
</meso>
"""


def solve(options):
    """Mesh, solution, balance of forces; the mesh."""
    geometry = GEOMETRY.format(*PATCH, step=HERE / "beam.step", size=options.size)
    mesh = mechanics.mesh_with_gmsh(geometry, options.out, "beam", options.gmsh)
    loads = mechanics.traction(mesh, mesh.faces["load"], (0, -FORCE, 0))
    reaction = mechanics.solve(mesh, mechanics.nodes_of(mesh.faces["held"]), loads, options.out, "beam", options.ccx)
    print(f"mesh       {len(mesh.nodes)} nodes, {len(mesh.tets)} tetrahedra of ten nodes")
    print("reaction   {:.3f} {:.3f} {:.3f} N".format(*reaction))
    return mesh


def sampling_document(mesh):
    patterns = []
    for name, (across, start, step, count) in PLACES.items():
        sides = '<loop index="side" axis="y" count="2" start="-26" spacing="52"/>' if name == "flanges" else ""
        loops = f'<loop index="i" axis="{across}" count="{count}" start="{start}" spacing="{step}"/>{sides}'
        sets = "".join(f'<set parameter="{c}" value="s.{c}"/>' for c in ORDERS)
        patterns.append(f'<pattern id="{name}" unitCell="probe">{loops}<loop index="k" axis="z" count="40" start="2.5" spacing="5"/>'
                        f'<sample field="s"/>{sets}</pattern>')
    return SAMPLING.format(
        parameters="".join(f'<parameter id="{c}" value="0"/>' for c in ORDERS),
        components="".join(f'<component name="{c}" unit="MPa" role="tensor" order="{c}"/>' for c in ORDERS),
        nodes=len(mesh.nodes), elements=len(mesh.tets), patterns="\n    ".join(patterns),
        parts="".join(f'<apply pattern="{name}" operation="union"/>' for name in PLACES))


def sample(options, mesh):
    """Places and stresses on the grid, interpolated by meso: arrays (1120, 3) and (1120, 6)."""
    document = options.out / "stress-on-grid.meso"
    document.write_text(sampling_document(mesh))
    places, stresses = [], []
    for name in PLACES:
        table = options.out / f"{name}.csv"
        subprocess.run([options.meso, "eval", document, table, "--pattern", name, "--progress", "none"], check=True)
        for row in csv.DictReader(table.open()):
            places.append([float(row[c]) for c in ("m14", "m24", "m34")])
            stresses.append([float(row[c]) for c in ORDERS])
    return np.array(places), np.array(stresses)


def check_beam_theory(places, stresses):
    """Bending stress zz in the middle planes of the flanges, averaged over x (which leaves warping out), against M y / I;
    where support and load are more than a beam's height away."""
    lever = (PATCH[2] + PATCH[3]) / 2
    print("theory     z mm   y mm   M y / I   found MPa")
    for y in (-26.0, 26.0):
        for z in (52.5, 77.5, 102.5):
            found = stresses[(places[:, 1] == y) & (places[:, 2] == z), 2].mean()
            expected = FORCE * (lever - z) * y / SECOND_MOMENT
            print(f"           {z:5.1f}  {y:5.1f}  {expected:8.4f}  {found:8.4f}  {100 * (found / expected - 1):+.2f} %")
            if abs(found / expected - 1) > 0.01:
                sys.exit("stress.py: not the bending stress of beam theory")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meso", default="meso")
    arguments.add_argument("--gmsh", default="gmsh")
    arguments.add_argument("--ccx", default="ccx")
    arguments.add_argument("--size", type=float, default=3.0, help="edges of the tetrahedra, mm")
    arguments.add_argument("--out", type=pathlib.Path, default=pathlib.Path("direction-beam"))
    arguments.add_argument("--field", type=pathlib.Path, help="the field file (OUT/stress.raw)")
    options = arguments.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    mesh = solve(options)
    places, stresses = sample(options, mesh)
    check_beam_theory(places, stresses)
    field = options.field or options.out / "stress.raw"
    stresses.astype("<f8").tofile(field)
    print(f"field      {len(stresses)} records, {field.stat().st_size} bytes: {field}")


if __name__ == "__main__":
    main()
