#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Least solid under a displacement limit: level and cell size of a surface, by NLopt, `meso sdf` and CalculiX.

usage: optimise.py [--meso PROGRAM] [--ccx PROGRAM] [--out FOLDER] [--surfaces NAME,...] [--evaluations N] [--sampled N] [--samples N]
                    [--check N]

A block of 2 mm of `tpms.NAME offset LEVEL scale SIZE` stands on a plate that holds it and carries 4 N through a plate that
does not let it slide. No point may move more than 0.02 mm, 1 % of the height; as little of the block as can be is solid.
The first --sampled of the --evaluations are a Latin hypercube; from the best of them COBYLA goes on. FOLDER/evaluations.csv
has a row for each evaluation. --samples: cubes of the tetrahedra's lattice along an edge of the block. --check: the best
is pressed again with so many. Exit code 77 where NLopt or ccx is missing.
"""

import argparse
import csv
import math
import pathlib
import random
import shutil
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mechanics"))
from compression import held_together, press, read_tets, volume

try:
    import nlopt
except ImportError:
    print("NLopt's Python module is not installed: skipped")
    sys.exit(77)

LOAD = 4.0  # N: 1 MPa on the block's face
LIMIT = 0.02  # mm
# Levels that fill 15 % and 70 % of a cell.
LEVELS = {"gyroid": (-1.06, 0.62), "iwp": (-2.58, 1.62), "frd": (-2.86, 1.71)}
SIZES = (0.8, 2.0)  # mm
COLUMNS = ["surface", "evaluation", "level", "size", "elements", "solid", "displacement", "least"]


class Spent(Exception):
    pass


class Blackbox:
    """Two numbers from 0 to 1 in; the share of solid and the logarithm of displacement over limit out."""

    def __init__(self, surface, options, write):
        self.surface, self.options, self.write = surface, options, write
        self.known = {}
        self.best, self.least = None, math.inf

    def __call__(self, x):
        x = tuple(min(1.0, max(0.0, float(v))) for v in x)
        if x not in self.known:
            if len(self.known) == self.options.evaluations:
                raise Spent
            self.known[x] = self.evaluate(x)
        return self.known[x]

    def pressed(self, x, samples):
        """Level, size, elements, share of solid, displacement."""
        level, size = (low + v * (high - low) for v, (low, high) in zip(x, (LEVELS[self.surface], SIZES)))
        mesh = self.options.out / f"{self.surface}.inp"
        n = samples + 1
        subprocess.run([self.options.meso, "sdf", f"tpms.{self.surface}", "offset", repr(level), "scale", repr(size), "-b", "-1,-1,-1,1,1,1",
                        "-s", f"{n},{n},{n}", "-o", mesh], check=True, stderr=subprocess.DEVNULL)
        nodes, elements = read_tets(mesh)
        solid = volume(nodes, elements) / 8
        nodes, elements = held_together(nodes, elements, -1, 1)
        displacement = math.inf
        if elements:
            force, farthest = press(nodes, elements, -1, 1, LIMIT, self.options.out, f"{self.surface}-pressed", self.options.ccx)
            displacement = farthest * LOAD / force  # it is linear
        return level, size, len(elements), solid, displacement

    def evaluate(self, x):
        started = time.monotonic()
        level, size, elements, solid, displacement = self.pressed(x, self.options.samples)
        if displacement <= LIMIT and solid < self.least:
            self.best, self.least = x, solid
        number = len(self.known) + 1
        self.write([self.surface, number, f"{level:.6f}", f"{size:.6f}", elements, f"{solid:.6f}", f"{displacement:.6f}", f"{self.least:.6f}"])
        print(f"{self.surface:<7} {number:>3}  level {level:+.4f}  size {size:.4f}  solid {solid:.4f}  displacement {displacement:.5f} mm"
              f"  least {self.least:.4f}  {time.monotonic() - started:.1f} s", flush=True)
        # A block in two pieces is only so bad: COBYLA looks at differences.
        return solid, min(math.log(displacement / LIMIT), 3.0)


def latin_hypercube(n, seed):
    """n points of the unit square, one in each of n columns and of n rows."""
    draw = random.Random(seed)
    columns, rows = list(range(n)), list(range(n))
    draw.shuffle(rows)
    return [((i + draw.random()) / n, (j + draw.random()) / n) for i, j in zip(columns, rows)]


def optimise(blackbox, sampled):
    try:
        points = latin_hypercube(sampled, seed=1)
        for x in points:
            blackbox(x)
        start = blackbox.best or min(points, key=lambda x: blackbox(x)[1])
        step = 0.15
        while True:  # until evaluations are spent
            method = nlopt.opt(nlopt.LN_COBYLA, 2)
            method.set_lower_bounds([0.0, 0.0])
            method.set_upper_bounds([1.0, 1.0])
            method.set_initial_step(step)
            method.set_xtol_abs(0.002)
            method.set_min_objective(lambda x, _: blackbox(x)[0])
            method.add_inequality_constraint(lambda x, _: blackbox(x)[1], 0.0)
            method.optimize(start)
            start, step = blackbox.best or start, step / 2
    except Spent:
        pass


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meso", default="meso")
    arguments.add_argument("--ccx", default="ccx")
    arguments.add_argument("--out", type=pathlib.Path, default=pathlib.Path("blackbox"))
    arguments.add_argument("--surfaces", default=",".join(LEVELS))
    arguments.add_argument("--evaluations", type=int, default=50)
    arguments.add_argument("--sampled", type=int, default=20)
    arguments.add_argument("--samples", type=int, default=20)
    arguments.add_argument("--check", type=int, default=0)
    options = arguments.parse_args()
    if not shutil.which(options.ccx):
        print(f"{options.ccx} is not installed: skipped")
        sys.exit(77)
    options.out.mkdir(parents=True, exist_ok=True)
    with (options.out / "evaluations.csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(COLUMNS)
        for surface in options.surfaces.split(","):
            blackbox = Blackbox(surface, options, rows.writerow)
            optimise(blackbox, min(options.sampled, options.evaluations))
            file.flush()
            if options.check and blackbox.best:
                level, size, elements, solid, displacement = blackbox.pressed(blackbox.best, options.check)
                print(f"{surface:<7} checked: {elements} tetrahedra, solid {solid:.4f}, displacement {displacement:.5f} mm", flush=True)


if __name__ == "__main__":
    main()
