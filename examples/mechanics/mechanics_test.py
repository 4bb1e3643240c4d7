#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests what stands around the programs: one tetrahedron, results whose numbers touch, words of a solver that failed. Exit code 77 without numpy."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
try:
    import numpy as np
except ImportError:
    print("numpy is not installed: skipped")
    sys.exit(77)

import mechanics

# Nodes 5 to 10 in Gmsh's order: 1-2, 2-3, 3-1, 1-4, 3-4, 2-4. Node 11 belongs to no tetrahedron.
MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "foot of it"
3 8 "solid"
$EndPhysicalNames
$Nodes
11
1 0 0 0
2 2 0 0
3 0 2 0
4 0 0 2
5 1 0 0
6 1 1 0
7 0 1 0
8 0 0 1
9 0 1 1
10 1 0 1
11 9 9 9
$EndNodes
$Elements
2
1 9 2 7 1 1 2 3 5 6 7
2 11 2 8 1 1 2 3 4 5 6 7 8 9 10
$EndElements
"""

FRD = """    1C
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1         1 1.00000E+00 2.00000E+00 3.00000E+00
 -3
 -4  STRESS      6    1
 -5  SXX         1    4    1    1
 -1         5-2.50000E+01-3.00000E+00 0.00000E+00 1.00000E+00-1.00000E-10 2.00000E+00
 -1       123 1.00000E+00 1.00000E+00 1.00000E+00 0.00000E+00 0.00000E+00 0.00000E+00
 -3
 9999
"""


class Mechanics(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def mesh(self):
        (self.folder / "one.msh").write_text(MSH)
        return mechanics.read_msh(self.folder / "one.msh")

    def test_middle_nodes_stand_between_the_corners_that_calculix_expects(self):
        mesh = self.mesh()
        self.assertNotIn(11, mesh.nodes)
        tet = mesh.tets[0]
        for middle, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], 4):
            np.testing.assert_array_equal(2 * mesh.nodes[tet[middle]], mesh.nodes[tet[a]] + mesh.nodes[tet[b]])

    def test_areas_point_outwards_whatever_the_order_of_corners(self):
        mesh = self.mesh()
        face = mesh.faces["foot of it"]
        for order in ([0, 1, 2, 3, 4, 5], [0, 2, 1, 5, 4, 3]):
            np.testing.assert_array_equal(mechanics.area_vectors(mesh, face[:, order]), [[0, 0, -2]])

    def test_traction_adds_up_and_acts_in_the_middle_of_edges(self):
        mesh = self.mesh()
        loads = mechanics.traction(mesh, mesh.faces["foot of it"], [3, 0, -6])
        self.assertEqual(sorted(loads), [5, 6, 7])
        for force in loads.values():
            np.testing.assert_allclose(force, [1, 0, -2], rtol=1e-15)

    def test_results_are_read_by_columns(self):
        (self.folder / "one.frd").write_text(FRD)
        stress = mechanics.read_frd(self.folder / "one.frd", "STRESS")
        self.assertEqual(sorted(stress), [5, 123])
        self.assertEqual(stress[5].tolist(), [-25, -3, 0, 1, -1e-10, 2])
        self.assertEqual(mechanics.read_frd(self.folder / "one.frd", "DISP")[1].tolist(), [1, 2, 3])
        with self.assertRaises(SystemExit):
            mechanics.read_frd(self.folder / "one.frd", "TEMP")

    def test_von_mises_of_tension_shear_and_pressure(self):
        stress = mechanics.von_mises([[5, 0, 0, 0, 0, 0], [0, 0, 0, 0, 2, 0], [7, 7, 7, 0, 0, 0]])
        np.testing.assert_allclose(stress, [5, 2 * 3**0.5, 0], atol=1e-15)

    def test_a_solver_that_does_not_finish_is_noticed(self):
        mesh = self.mesh()
        loads = mechanics.traction(mesh, mesh.faces["foot of it"], [1, 0, 0])
        with self.assertRaises(SystemExit):
            mechanics.solve(mesh, [4], loads, self.folder, "one", ccx="true")
        with self.assertRaises(SystemExit):
            mechanics.solve(mesh, [4], loads, self.folder, "one", ccx="no-such-solver")


if __name__ == "__main__":
    unittest.main()
