#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the records of stress.h5 and the holes that the document makes of them. Needs python3-h5py, python3-matplotlib and python3-pil.

usage: field_picture.py OUT.png CELLS.csv     CELLS.csv from `meso eval gear.meso CELLS.csv`
"""

import csv
import pathlib
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PatchCollection
from matplotlib.patches import Circle
from PIL import Image


def main():
    out, cells = sys.argv[1:]
    with h5py.File(pathlib.Path(__file__).resolve().parent / "stress.h5") as field:
        x, y, _, stress = field["records"][:].T
    with open(cells) as table:
        holes = [(float(row[5]), float(row[9]), float(row[-1])) for row in list(csv.reader(table))[1:]]
    figure, views = plt.subplots(1, 2, figsize=(11, 5.2), dpi=80, layout="constrained")
    for view, size in zip(views, (5, 22)):
        dots = view.scatter(x, y, c=stress, s=size, vmin=0, vmax=100, cmap="turbo", linewidths=0, zorder=2)
        view.set_aspect("equal")
    rings = [Circle((a, b), r) for a, b, r in holes]
    views[1].add_collection(PatchCollection(rings, facecolor="none", edgecolor="black", linewidths=1, zorder=3))
    views[1].set_xlim(-9, 9)
    views[1].set_ylim(17, 35)
    views[0].set_title(f"{len(x)} records: nodes of the face z = 10 mm")
    views[1].set_title("the loaded tooth; circles: holes")
    views[1].annotate("", (-1.6, 31.5), (-5.6, 33.2), arrowprops={"width": 3, "headwidth": 10, "color": "black"}, zorder=4)
    views[1].text(-8.5, 33.6, "2000 N")
    figure.colorbar(dots, ax=views, label="von Mises stress, MPa", extend="max")
    figure.savefig(out)
    Image.open(out).convert("RGB").quantize(128).save(out, optimize=True)  # a third of the bytes


if __name__ == "__main__":
    main()
