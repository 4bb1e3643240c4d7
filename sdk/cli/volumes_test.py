#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Volumes that `meso sdf` writes, read by programs that are not ours: VTK, Gmsh, CalculiX, h5py.

usage: volumes_test.py MESO

Each is asked where it is installed.
"""

import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

MESO = pathlib.Path(sys.argv.pop(1)).resolve()
GYROID = ["tpms.gyroid", "-b", "0,0,0,1,1,1"]
PYTHON = "/usr/bin/python3"  # the one that Debian's modules belong to


def has_module(name):
    return subprocess.run([PYTHON, "-c", f"import {name}"], capture_output=True).returncode == 0


HAS_VTK, HAS_H5PY = has_module("vtk"), has_module("h5py")
HAS_GMSH, HAS_CCX = shutil.which("gmsh"), shutil.which("ccx")

READ_VTK = """
import sys, vtk
reader = vtk.vtkXMLUnstructuredGridReader() if sys.argv[1].endswith("vtu") else vtk.vtkXMLImageDataReader()
reader.SetFileName(sys.argv[1]); reader.Update()
data = reader.GetOutput()
if sys.argv[1].endswith("vti"):
    array = data.GetCellData().GetScalars()
    print(*data.GetDimensions(), array.GetName(), sum(array.GetTuple1(i) for i in range(array.GetNumberOfTuples())))
else:
    sizes = vtk.vtkCellSizeFilter(); sizes.SetInputData(data); sizes.Update()
    volumes = sizes.GetOutput().GetCellData().GetArray("Volume")
    print(data.GetNumberOfCells(), data.GetNumberOfPoints(), sum(volumes.GetTuple1(i) for i in range(data.GetNumberOfCells())))
"""


class Volumes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def make(self, name, *words):
        subprocess.run([MESO, "sdf", *GYROID, "-o", name, *words], cwd=self.folder, check=True, capture_output=True)
        return self.folder / name

    def read(self, program, path):
        result = subprocess.run([PYTHON, "-c", program, path], check=True, capture_output=True, text=True)
        return result.stdout.split()

    def test_about_as_many_tetrahedra_as_asked(self):
        """Also of sheets that a first coarse mesh does not see; where walls are lost, that is told."""
        for wall, asked, is_coarse in ((1.5, 10000, True), (1.5, 500000, False), (2, 20000, True), (2.5, 500000, False)):
            words = ["tpms.gyroid", "scale", "5", "shell", str(wall), "-b", "0,0,0,10,10,10", "-o", "a.vtu", "--elements", str(asked)]
            with self.subTest(words=words):
                done = subprocess.run([MESO, "sdf", *words], cwd=self.folder, check=True, capture_output=True, text=True)
                made = int(re.search(r"(\d+) tetrahedra", done.stdout + done.stderr).group(1))
                self.assertTrue(asked / 1.4 < made < 1.4 * asked, made)
                self.assertEqual("SDF_COARSE" in done.stderr, is_coarse, done.stderr)

    def test_sides_of_a_document_are_its_sections(self):
        """Of a gyroid's cells, each face of the box cuts one half; loads stand on sets of that name."""
        axes = "".join(f'<loop index="{i}" axis="{a}" count="2" spacing="5mm"/>' for i, a in zip("ijk", "xyz"))
        (self.folder / "block.meso").write_text(f"""<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <unitCells><unitCell id="g"><box dx="5mm" dy="5mm" dz="5mm"/><implicit surface="gyroid" density="0.5"/></unitCell></unitCells>
  <patterns><pattern id="p" unitCell="g">{axes}</pattern></patterns>
  <parts><part id="block"><apply pattern="p" operation="union"/></part></parts>
</meso>""", encoding="utf-8")
        subprocess.run([MESO, "convert", "block.meso", "block.inp", "--elements", "2.5e5"], cwd=self.folder, check=True, capture_output=True)
        nodes, elements, areas, reading = {}, {}, {}, None
        for line in (self.folder / "block.inp").read_text().splitlines():
            cells = line.split(",")
            if line.startswith("*"):
                reading = cells[0]
                if reading == "*SURFACE":
                    side = cells[1].split("=")[1]
                    areas[side] = 0
            elif reading == "*NODE":
                nodes[cells[0]] = [float(x) for x in cells[1:4]]
            elif reading == "*ELEMENT":
                elements[cells[0]] = cells[1:5]
            elif reading == "*SURFACE":
                corners = {"S1": (0, 1, 2), "S2": (0, 1, 3), "S3": (1, 2, 3), "S4": (0, 2, 3)}[cells[1].strip()]
                a, b, c = (nodes[elements[cells[0]][i].strip()] for i in corners)
                u, v = ([q - o for q, o in zip(end, a)] for end in (b, c))
                areas[side] += math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2
        for side in ("X_MIN", "X_MAX", "Y_MIN", "Y_MAX", "Z_MIN", "Z_MAX"):
            self.assertAlmostEqual(areas["S_" + side], 50, delta=0.03 * 50, msg=side)

    @unittest.skipUnless(HAS_VTK, "VTK is not installed")
    def test_vtk_reads_tetrahedra(self):
        binary = self.read(READ_VTK, self.make("a.vtu", "--elements", "5000"))
        text = self.read(READ_VTK, self.make("b.vtu", "--elements", "5000", "--ascii"))
        self.assertEqual(binary, text)
        self.assertAlmostEqual(float(binary[2]), 0.5, delta=0.03)
        self.assertTrue(4000 < int(binary[0]) < 6000, binary)

    @unittest.skipUnless(HAS_VTK, "VTK is not installed")
    def test_vtk_reads_voxels(self):
        nx, ny, nz, name, total = self.read(READ_VTK, self.make("a.vti", "-s", "20,30,40", "--voxels", "density"))
        self.assertEqual((nx, ny, nz, name), ("21", "31", "41", "density"))
        self.assertAlmostEqual(float(total) / 20 / 30 / 40, 0.5, delta=0.005)

    @unittest.skipUnless(HAS_H5PY, "h5py is not installed")
    def test_h5py_reads_voxels(self):
        read = ("import sys, h5py\nd = h5py.File(sys.argv[1])['distance']\n"
                "print(*d.shape, d.dtype, *d.attrs['spacing_mm'], (d[...] < 0).mean())")
        first = self.make("a.h5", "-s", "20,30,40", "--voxels", "distance")
        shape, (kind, *spacing, share) = (lambda w: (w[:3], w[3:]))(self.read(read, first))
        self.assertEqual((shape, kind), (["40", "30", "20"], "float32"))
        self.assertEqual([float(s) for s in spacing], [1 / 20, 1 / 30, 1 / 40])
        self.assertAlmostEqual(float(share), 0.5, delta=0.005)
        again = self.make("b.h5", "-s", "20,30,40", "--voxels", "distance", "--jobs", "1")
        self.assertEqual(first.read_bytes(), again.read_bytes())

    @unittest.skipUnless(HAS_GMSH, "Gmsh is not installed")
    def test_gmsh_reads_tetrahedra(self):
        path = self.make("a.msh", "--elements", "5000")
        result = subprocess.run(["gmsh", "-check", "-", path], cwd=self.folder, capture_output=True, text=True)
        told = result.stdout + result.stderr
        self.assertNotIn("Error", told)
        elements = int(re.search(r"(\d+) elements", told).group(1))
        self.assertTrue(5000 < elements < 9000, told)  # with triangles of the boundary

    @unittest.skipUnless(HAS_CCX, "CalculiX is not installed")
    def test_calculix_solves_tetrahedra(self):
        # With a Poisson number of 0, a full block under a uniform displacement has the modulus as its stiffness.
        words = ["half-space", "1,0,0,9", "-b", "0,0,0,1,1,1", "-o", "solid.inp", "--elements", "3000"]
        subprocess.run([MESO, "sdf", *words], cwd=self.folder, check=True, capture_output=True)
        (self.folder / "job.inp").write_text(
            "*INCLUDE, INPUT=solid.inp\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=SOLID, MATERIAL=M\n"
            "*STEP\n*STATIC\n*BOUNDARY\nZ_MIN, 1, 3, 0.\nZ_MAX, 3, 3, -0.01\n"
            "*NODE PRINT, NSET=Z_MAX, TOTALS=ONLY\nRF\n*END STEP\n")
        subprocess.run(["ccx", "job"], cwd=self.folder, check=True, capture_output=True)
        force = float((self.folder / "job.dat").read_text().split()[-1])
        self.assertAlmostEqual(force, -10, delta=1e-4)

    def test_stacks_are_numbered_from_the_bottom(self):
        self.make("a.png", "-s", "16,16,16", "--slices", "axis=x,count=3")
        self.make("b.svg", "-s", "16,16,16", "--slices", "at=0.5")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()),
                         ["a_0001.png", "a_0002.png", "a_0003.png", "b.svg"])

    def test_slices_take_units(self):
        self.make("a.svg", "-s", "16,16,16", "--slices", "at=0.5")
        self.make("b.svg", "-s", "16,16,16", "--slices", "at=500um")
        self.assertEqual((self.folder / "a.svg").read_bytes(), (self.folder / "b.svg").read_bytes())
        for slices in ("step=2deg", "at=high", "step=-1mm", "count=3mm"):
            result = subprocess.run([MESO, "sdf", *GYROID, "-o", "c.svg", "--slices", slices], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(result.returncode, 2, slices)
            self.assertIn("step=0.2mm", result.stderr)

    def test_options_without_effect_are_usage_errors(self):
        for words in (["-o", "a.ply", "--elements", "5"], ["-o", "a.vtu", "--slices", "at=0"], ["-o", "a.png", "--slices", "at=9"],
                      ["-o", "a.h5", "--voxels", "colour"], ["-o", "a.inp", "--ascii"], ["-o", "a.vti", "--polish"]):
            result = subprocess.run([MESO, "sdf", *GYROID, *words], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(result.returncode, 2, (words, result.stderr))
            self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
