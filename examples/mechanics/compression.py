# SPDX-License-Identifier: Apache-2.0
"""Compression between two plates: meshes of `meso sdf`, pressed by CalculiX, which is run as a program.

    nodes, elements = held_together(*read_tets("block.inp"), lower=0, upper=10)
    force, farthest = press(nodes, elements, lower=0, upper=10, by=0.1, folder=".", name="pressed")

nodes: {number: (x, y, z)}; elements: tuples of 4, 8 or 10 numbers. Millimetres and newtons. Needs nothing but Python.
"""

import pathlib
import subprocess

MODULUS = 1000.0  # MPa
POISSON = 0.3


def read_tets(path):
    """Nodes and elements of an INP file."""
    nodes, elements, into = {}, [], None
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith("*"):
            into = "nodes" if line.startswith("*NODE,") else "elements" if line.startswith("*ELEMENT,") else None
        elif into == "nodes":
            number, *xyz = line.split(",")
            nodes[int(number)] = tuple(map(float, xyz))
        elif into == "elements":
            elements.append(tuple(map(int, line.split(",")[1:])))
    return nodes, elements


def quadratic(nodes, elements):
    """Tetrahedra of ten nodes: those of four are much too stiff in bending. The six are in the middles of the edges."""
    nodes, middles, last = dict(nodes), {}, max(nodes)

    def between(a, b):
        key = (min(a, b), max(a, b))
        if key not in middles:
            middles[key] = last + 1 + len(middles)
            nodes[middles[key]] = tuple((p + q) / 2 for p, q in zip(nodes[a], nodes[b]))
        return middles[key]

    edges = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
    return nodes, [(*e, *(between(e[i], e[j]) for i, j in edges)) for e in elements]


def held_together(nodes, elements, lower, upper):
    """Leaves out pieces that do not reach from the lower to the upper plate: nothing would hold them. Maybe nothing is left."""
    parent = {number: number for number in nodes}

    def root(number):
        while parent[number] != number:
            parent[number] = parent[parent[number]]
            number = parent[number]
        return number

    for element in elements:
        first = root(element[0])
        for number in element[1:]:
            parent[root(number)] = first
    ends = {root(n) for n, p in nodes.items() if p[2] == lower} & {root(n) for n, p in nodes.items() if p[2] == upper}
    kept = [e for e in elements if root(e[0]) in ends]
    used = {n for e in kept for n in e}
    return {n: p for n, p in nodes.items() if n in used}, kept


def press(nodes, elements, lower, upper, by, folder, name, ccx="ccx"):
    """Holds the nodes at height `lower`, moves those at `upper` down without letting them slide. Leaves NAME.inp, .dat and .frd.

    Returns the force, and how far the point that moved farthest did.
    """
    folder = pathlib.Path(folder)
    kind = f"C3D{len(elements[0])}"
    lines = ["*NODE, NSET=ALL"]
    # CalculiX takes 20 characters of a number.
    lines += [f"{n},{x:.13g},{y:.13g},{z:.13g}" for n, (x, y, z) in sorted(nodes.items())]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=SOLID")
    lines += [",".join(map(str, (i, *e))) for i, e in enumerate(elements, 1)]
    for plate, z in (("LOWER", lower), ("UPPER", upper)):
        lines.append(f"*NSET, NSET={plate}")
        lines += [str(n) for n, p in sorted(nodes.items()) if p[2] == z]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{MODULUS}, {POISSON}", "*SOLID SECTION, ELSET=SOLID, MATERIAL=M",
              "*STEP", "*STATIC, SOLVER=ITERATIVE CHOLESKY", "*BOUNDARY", "LOWER, 1, 3, 0.", "UPPER, 1, 2, 0.",
              f"UPPER, 3, 3, {-by}", "*NODE PRINT, NSET=UPPER, TOTALS=ONLY", "RF", "*NODE FILE", "U", "*END STEP"]
    (folder / f"{name}.inp").write_text("\n".join(lines) + "\n")
    printed = subprocess.run([ccx, name], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True).stdout
    # CalculiX's exit code does not tell; its last words do.
    if "Job finished" not in printed:
        raise SystemExit(f"{ccx} {name}: did not finish in {folder}\n{printed[-2000:]}")
    force = -float((folder / f"{name}.dat").read_text().split()[-1])
    return force, farthest(folder / f"{name}.frd")


def farthest(path):
    """The largest displacement in CalculiX's results. Columns have fixed widths; numbers may touch."""
    largest, reading = 0.0, False
    for line in path.read_text().splitlines():
        if line.startswith(" -4"):
            reading = line.split()[1] == "DISP"
        elif line.startswith(" -3"):
            reading = False
        elif reading and line.startswith(" -1"):
            largest = max(largest, sum(float(line[i:i + 12]) ** 2 for i in (13, 25, 37)))
    return largest**0.5


def volume(nodes, elements):
    """Of tetrahedra, or of bricks that are cubes."""
    if len(elements[0]) == 8:
        (x, _, _), (y, _, _) = nodes[elements[0][0]], nodes[elements[0][1]]
        return len(elements) * abs(y - x) ** 3
    total = 0
    for element in elements:
        o, a, b, c = (nodes[n] for n in element[:4])
        u, v, w = ([p[i] - o[i] for i in range(3)] for p in (a, b, c))
        total += (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6
    return total
