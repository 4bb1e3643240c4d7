#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compression of a gyroid block: tetrahedra against voxels, both from `meso sdf`, both solved by CalculiX.

usage: compress.py [--meso PROGRAM] [--ccx PROGRAM] [--out FOLDER] [--tets N,N,...] [--voxels N,N,...] [--linear]
                   [--within PERCENT]

The block's lower face is held, its upper face pressed down by 1 % and kept from sliding. Printed for each mesh: elements,
nodes, the share of solid, and the block's stiffness: force over area over strain, as a part of the material's modulus.
Tetrahedra get nodes in the middles of their edges (C3D10), but for --linear (C3D4).
Exit code 1 if the finest of both kinds differ by more than --within, 77 where ccx is not installed.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mechanics"))
from compression import MODULUS, held_together, press, quadratic, read_tets, volume

SIZE = 10.0  # mm: two cells of 5 mm along each axis
SOLID = ["tpms.gyroid", "scale", "5", "-b", f"0,0,0,{SIZE},{SIZE},{SIZE}"]
STRAIN = 0.01


def meso(program, *words):
    subprocess.run([program, "sdf", *SOLID, *words], check=True, stderr=subprocess.DEVNULL)


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


def numbers(text):
    return [int(float(n)) for n in text.split(",")]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meso", default="meso")
    arguments.add_argument("--ccx", default="ccx")
    arguments.add_argument("--out", type=pathlib.Path, default=pathlib.Path("gyroid-compression"))
    arguments.add_argument("--tets", type=numbers, default=[12000, 20000, 40000])
    arguments.add_argument("--linear", action="store_true")
    arguments.add_argument("--voxels", type=numbers, default=[20, 30, 40])
    arguments.add_argument("--within", type=float, default=float("inf"), metavar="PERCENT")
    options = arguments.parse_args()
    if not shutil.which(options.ccx):
        print(f"{options.ccx} is not installed: skipped")
        sys.exit(77)
    options.out.mkdir(parents=True, exist_ok=True)
    print(f"{'mesh':<10} {'elements':>9} {'nodes':>8} {'solid':>8} {'stiffness':>10}")
    finest = []
    for kind, sizes in (("tets", options.tets), ("voxels", options.voxels)):
        for size in sizes:
            path = options.out / f"{kind}_{size}.{'inp' if kind == 'tets' else 'nrrd'}"
            if kind == "tets":
                meso(options.meso, "--elements", str(size), "-o", path)
                nodes, elements = held_together(*read_tets(path), 0, SIZE)
                if not options.linear:
                    nodes, elements = quadratic(nodes, elements)
            else:
                meso(options.meso, "-s", f"{size},{size},{size}", "-o", path)
                nodes, elements = held_together(*read_voxels(path), 0, SIZE)
            force, _ = press(nodes, elements, 0, SIZE, STRAIN * SIZE, options.out, f"solve_{kind}_{size}", options.ccx)
            stiffness = force / SIZE**2 / STRAIN / MODULUS
            print(f"{kind:<10} {len(elements):>9} {len(nodes):>8} {volume(nodes, elements) / SIZE**3:>8.5f} {stiffness:>10.5f}", flush=True)
        finest.append(stiffness)
    off = 100 * (finest[0] / finest[1] - 1)
    print(f"tetrahedra against voxels, finest: {off:+.2f} %")
    return 1 if abs(off) > options.within else 0


if __name__ == "__main__":
    sys.exit(main())
