# SPDX-License-Identifier: Apache-2.0
"""Stress in a body: meshed by Gmsh, solved by CalculiX, both run as programs.

    mesh = mesh_with_gmsh(geo_text, folder, "beam")            # tet10, faces by the names of their physical groups
    loads = traction(mesh, mesh.faces["load"], force)          # node -> force vector; adds up to `force`
    solve(mesh, fixed_nodes, loads, folder, "beam")            # beam.inp -> ccx -> beam.frd, beam.dat
    stress = read_frd(folder / "beam.frd", "STRESS")           # node -> xx yy zz xy yz zx

Millimetres, newtons, megapascals. Elements are C3D10: tetrahedra of ten nodes with straight edges. Needs numpy.
"""

import collections
import pathlib
import subprocess

import numpy as np

Mesh = collections.namedtuple("Mesh", "nodes tets faces")
Mesh.__doc__ = """nodes: {number: array of x y z}; tets: array (n, 10) of numbers in CalculiX's order; faces: {physical name: array (n, 6)}."""

STEEL = (210000.0, 0.3)  # Young's modulus in MPa, Poisson's ratio


def run_program(words, folder, log):
    """Runs a program in a folder, its output into the file `log` there; returns that output. A program that is missing or fails ends the script."""
    path = pathlib.Path(folder) / log
    with path.open("w") as out:
        try:
            code = subprocess.run([str(w) for w in words], cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT).returncode
        except FileNotFoundError:
            raise SystemExit(f"{words[0]}: not installed")
    if code != 0:
        raise SystemExit(f"{words[0]}: exit code {code}, see {path}")
    return path.read_text(errors="replace")


def mesh_with_gmsh(geo_text, folder, name, gmsh="gmsh"):
    """Meshes what a Gmsh script describes with tet10 of straight edges; leaves NAME.geo and NAME.msh in the folder.

    The script says sizes and names physical groups: one volume, and the surfaces that are asked for by name later.
    """
    folder = pathlib.Path(folder)
    options = "Mesh.ElementOrder = 2;\nMesh.SecondOrderLinear = 1;\nMesh.MshFileVersion = 2.2;\nMesh.Binary = 0;\n"
    (folder / f"{name}.geo").write_text(geo_text + options)
    run_program([gmsh, "-3", "-nt", "1", "-o", f"{name}.msh", f"{name}.geo"], folder, f"{name}.gmsh.log")
    return read_msh(folder / f"{name}.msh")


def read_msh(path):
    """Reads a Gmsh file (2.2, text) of tet10 and of tri6 in named physical groups.

    Gmsh and CalculiX disagree about the last two nodes of a tet10: they are swapped here. Nodes that no tetrahedron uses are left out.
    """
    lines = iter(pathlib.Path(path).read_text().splitlines())
    names, nodes, tets, faces = {}, {}, [], collections.defaultdict(list)
    for section in lines:
        if section == "$PhysicalNames":
            for _ in range(int(next(lines))):
                dimension, number, name = next(lines).split(maxsplit=2)
                names[int(dimension), int(number)] = name.strip('"')
        elif section == "$Nodes":
            for _ in range(int(next(lines))):
                number, *xyz = next(lines).split()
                nodes[int(number)] = np.array(xyz, dtype=float)
        elif section == "$Elements":
            for _ in range(int(next(lines))):
                _, kind, tags, *rest = map(int, next(lines).split())
                if kind == 11:
                    *corners, i, j = rest[tags:]
                    tets.append([*corners, j, i])
                elif kind == 9:
                    faces[names[2, rest[0]]].append(rest[tags:])
    if not tets:
        raise SystemExit(f"{path}: no tetrahedra of ten nodes")
    used = np.unique(tets)
    return Mesh({int(n): nodes[int(n)] for n in used}, np.array(tets), {name: np.array(f) for name, f in faces.items()})


def corners_of(mesh, triangles):
    """Corner places of triangles, array (n, 3, 3)."""
    return np.array([[mesh.nodes[int(n)] for n in triangle[:3]] for triangle in triangles])


def area_vectors(mesh, triangles):
    """Area times outward normal of each triangle of the body's surface, array (n, 3)."""
    a, b, c = np.moveaxis(corners_of(mesh, triangles), 1, 0)
    vectors = np.cross(b - a, c - a) / 2
    wanted = {frozenset(t[:3].tolist()): i for i, t in enumerate(triangles)}
    for tet in mesh.tets[:, :4].tolist():
        for apex in tet:
            i = wanted.get(frozenset(tet) - {apex})
            if i is not None and vectors[i] @ (mesh.nodes[apex] - a[i]) > 0:
                vectors[i] *= -1
    return vectors


def nodes_of(triangles):
    """Numbers of all nodes of triangles, ascending."""
    return [int(n) for n in np.unique(triangles)]


def traction(mesh, triangles, force):
    """Nodal forces of a uniform traction that adds up to `force`: of a straight tri6 each middle node takes a third, the corners nothing."""
    areas = np.linalg.norm(area_vectors(mesh, triangles), axis=1)
    loads = collections.defaultdict(lambda: np.zeros(3))
    for triangle, area in zip(triangles, areas):
        for node in triangle[3:]:
            loads[int(node)] += np.asarray(force, dtype=float) * area / areas.sum() / 3
    return dict(loads)


def write_inp(path, mesh, fixed, loads, material=STEEL):
    """Writes a CalculiX deck: one static linear step; displacements and stresses go to the .frd file, the reaction to the .dat file."""
    lines = ["*NODE, NSET=ALL"]
    # CalculiX reads 20 characters of a number.
    lines += [f"{n},{x:.13g},{y:.13g},{z:.13g}" for n, (x, y, z) in sorted(mesh.nodes.items())]
    lines.append("*ELEMENT, TYPE=C3D10, ELSET=SOLID")
    lines += [",".join(map(str, (i, *tet))) for i, tet in enumerate(mesh.tets, 1)]
    lines += ["*NSET, NSET=FIXED", *map(str, fixed)]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{material[0]}, {material[1]}", "*SOLID SECTION, ELSET=SOLID, MATERIAL=M"]
    lines += ["*STEP", "*STATIC", "*BOUNDARY", "FIXED, 1, 3, 0.", "*CLOAD"]
    lines += [f"{n},{axis},{f[axis - 1]:.12e}" for n, f in sorted(loads.items()) for axis in (1, 2, 3) if f[axis - 1] != 0]
    lines += ["*NODE FILE", "U", "*EL FILE", "S", "*NODE PRINT, NSET=FIXED, TOTALS=ONLY", "RF", "*END STEP"]
    pathlib.Path(path).write_text("\n".join(lines) + "\n")


def solve(mesh, fixed, loads, folder, name, ccx="ccx", material=STEEL):
    """Solves with CalculiX; returns the reaction of the fixed nodes, checked against the loads to 1e-4. CalculiX's exit code does not tell; its last words do."""
    folder = pathlib.Path(folder)
    write_inp(folder / f"{name}.inp", mesh, fixed, loads, material)
    if "Job finished" not in run_program([ccx, "-i", name], folder, f"{name}.ccx.log"):
        raise SystemExit(f"{ccx} did not finish, see {folder / name}.ccx.log")
    reaction = read_reaction(folder / f"{name}.dat")
    load = np.sum(list(loads.values()), axis=0)
    if np.linalg.norm(reaction + load) > 1e-4 * np.linalg.norm(load):
        raise SystemExit(f"{name}: reaction {reaction} does not balance the load {load}")
    return reaction


def read_reaction(path):
    """Total force on the fixed nodes from a .dat file."""
    return np.array(pathlib.Path(path).read_text().split()[-3:], dtype=float)


def read_frd(path, data_set):
    """Nodal values of a data set (DISP, STRESS) from CalculiX's text results: {node: array}. Columns have fixed widths; numbers may touch."""
    values, reading = {}, False
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith(" -4"):
            reading = line.split()[1] == data_set
        elif line.startswith(" -3"):
            reading = False
        elif reading and line.startswith(" -1"):
            values[int(line[3:13])] = np.array([float(line[i:i + 12]) for i in range(13, len(line.rstrip()), 12)])
    if not values:
        raise SystemExit(f"{path}: no data set {data_set}")
    return values


def von_mises(s):
    """Von Mises stress of xx yy zz xy yz zx (last axis)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(np.asarray(s), -1, 0)
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + zx**2))
