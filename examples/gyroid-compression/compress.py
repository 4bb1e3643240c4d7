#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compression of a gyroid block: tetrahedra against voxels, both from `meso sdf`, both solved by CalculiX.

usage: compress.py [--meso PROGRAM] [--ccx PROGRAM] [--out FOLDER] [--tets N,N,...] [--voxels N,N,...]

The block's lower face is held, its upper face pressed down by 1 % and kept from sliding. Printed for each mesh: elements,
nodes, the share of solid, and the block's stiffness: force over area over strain, as a part of the material's modulus.
The last line of each kind is the limit that the two finest meshes point to.
"""

import argparse
import pathlib
import re
import subprocess

SIZE = 10.0  # mm: two cells of 5 mm along each axis
SOLID = ["tpms.gyroid", "scale", "5", "-b", f"0,0,0,{SIZE},{SIZE},{SIZE}"]
STRAIN = 0.01


def meso(program, *words):
    subprocess.run([program, "sdf", *SOLID, *words], check=True, stderr=subprocess.DEVNULL)


def read_tets(path):
    """Nodes and elements of an INP file, counted from 1."""
    nodes, elements, into = {}, [], None
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            into = "nodes" if line.startswith("*NODE,") else "elements" if line.startswith("*ELEMENT,") else None
        elif into == "nodes":
            number, *xyz = line.split(",")
            nodes[int(number)] = tuple(map(float, xyz))
        elif into == "elements":
            elements.append(tuple(map(int, line.split(",")[1:])))
    return nodes, elements


def read_voxels(path):
    """An occupied voxel becomes a brick of eight nodes."""
    header, _, data = path.read_bytes().partition(b"\n\n")
    n = int(re.search(rb"sizes: (\d+)", header).group(1))
    m, h = n + 1, SIZE / n
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    nodes, elements = {}, []
    for index, occupied in enumerate(data):
        if not occupied:
            continue
        i, j, k = index % n, index // n % n, index // n // n
        element = []
        for a, b, c in corner:
            x, y, z = i + a, j + b, k + c
            number = 1 + x + m * (y + m * z)
            nodes[number] = (x * h, y * h, z * h)
            element.append(number)
        elements.append(tuple(element))
    return nodes, elements


def held_together(nodes, elements):
    """Leaves out pieces that do not reach from the lower to the upper face: nothing would hold them."""
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
    low = {root(n) for n, p in nodes.items() if p[2] == 0}
    high = {root(n) for n, p in nodes.items() if p[2] == SIZE}
    kept = [e for e in elements if root(e[0]) in low & high]
    used = {n for e in kept for n in e}
    return {n: p for n, p in nodes.items() if n in used}, kept


def solve(ccx, folder, name, nodes, elements):
    """Force over area over strain over modulus. Sums the reactions of the upper face."""
    kind = "C3D4" if len(elements[0]) == 4 else "C3D8"
    lines = ["*NODE, NSET=ALL"]
    # CalculiX takes 20 characters of a number.
    lines += [f"{n},{x:.13g},{y:.13g},{z:.13g}" for n, (x, y, z) in sorted(nodes.items())]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=SOLID")
    lines += [",".join(map(str, (i, *e))) for i, e in enumerate(elements, 1)]
    for face, z in (("LOWER", 0), ("UPPER", SIZE)):
        lines.append(f"*NSET, NSET={face}")
        lines += [str(n) for n, p in sorted(nodes.items()) if p[2] == z]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=SOLID, MATERIAL=M",
              "*STEP", "*STATIC, SOLVER=ITERATIVE CHOLESKY", "*BOUNDARY", "LOWER, 1, 3, 0.", "UPPER, 1, 2, 0.",
              f"UPPER, 3, 3, {-STRAIN * SIZE}", "*NODE PRINT, NSET=UPPER, TOTALS=ONLY", "RF",
              "*NODE FILE", "U", "*END STEP"]
    (folder / f"{name}.inp").write_text("\n".join(lines) + "\n")
    subprocess.run([ccx, name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    force = float((folder / f"{name}.dat").read_text().split()[-1])
    return -force / SIZE**2 / STRAIN / 1000


def volume(nodes, elements):
    if len(elements[0]) == 8:
        (x, _, _), (y, _, _) = nodes[elements[0][0]], nodes[elements[0][1]]
        return len(elements) * abs(y - x) ** 3
    total = 0
    for element in elements:
        o, a, b, c = (nodes[n] for n in element)
        u, v, w = ([p[i] - o[i] for i in range(3)] for p in (a, b, c))
        total += (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6
    return total


def numbers(text):
    return [int(float(n)) for n in text.split(",")]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meso", default="meso")
    arguments.add_argument("--ccx", default="ccx")
    arguments.add_argument("--out", type=pathlib.Path, default=pathlib.Path("gyroid-compression"))
    arguments.add_argument("--tets", type=numbers, default=[20000, 60000, 160000])
    arguments.add_argument("--voxels", type=numbers, default=[20, 30, 40])
    options = arguments.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    print(f"{'mesh':<10} {'elements':>9} {'nodes':>8} {'solid':>8} {'stiffness':>10}")
    limits = []
    for kind, sizes in (("tets", options.tets), ("voxels", options.voxels)):
        found = []  # (spacing squared, stiffness)
        for size in sizes:
            path = options.out / f"{kind}_{size}.{'inp' if kind == 'tets' else 'nrrd'}"
            if kind == "tets":
                meso(options.meso, "--elements", str(size), "-o", path)
                nodes, elements = held_together(*read_tets(path))
            else:
                meso(options.meso, "-s", f"{size},{size},{size}", "-o", path)
                nodes, elements = held_together(*read_voxels(path))
            stiffness = solve(options.ccx, options.out, f"solve_{kind}_{size}", nodes, elements)
            solid = volume(nodes, elements)
            found.append(((solid / len(elements)) ** (2 / 3), stiffness))
            print(f"{kind:<10} {len(elements):>9} {len(nodes):>8} {solid / SIZE**3:>8.5f} {stiffness:>10.5f}", flush=True)
        (h1, s1), (h2, s2) = found[-2:]
        limits.append(s2 + (s2 - s1) * h2 / (h1 - h2))
        print(f"{kind:<10} {'limit':>9} {'':>8} {'':>8} {limits[-1]:>10.5f}")
    print(f"tetrahedra against voxels, limits: {100 * (limits[0] / limits[1] - 1):+.2f} %")


if __name__ == "__main__":
    main()
