#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws evaluations.csv: the least share of solid so far against evaluations, and all that was tried. Needs Matplotlib.

usage: convergence.py EVALUATIONS.csv OUT.png
"""

import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LIMIT = 0.02  # mm, as in optimise.py


def main():
    source, out = sys.argv[1:]
    runs = {}
    with open(source, newline="") as file:
        for row in csv.DictReader(file):
            runs.setdefault(row["surface"], []).append({key: float(value) for key, value in row.items() if key != "surface"})
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), dpi=90, layout="constrained")
    for (surface, rows), colour in zip(runs.items(), ("tab:blue", "tab:orange", "tab:green")):
        left.step([r["evaluation"] for r in rows], [r["least"] for r in rows], where="post", color=colour, label=surface)
        met = [r for r in rows if r["displacement"] <= LIMIT]
        missed = [r for r in rows if r["displacement"] > LIMIT]
        left.plot([r["evaluation"] for r in met], [r["solid"] for r in met], ".", color=colour, alpha=0.5)
        left.plot([r["evaluation"] for r in missed], [r["solid"] for r in missed], "x", color=colour, alpha=0.4, markersize=4)
        right.plot([r["solid"] for r in rows], [r["displacement"] for r in rows], ".", color=colour, label=surface)
    left.set(xlabel="evaluation", ylabel="share of solid", title="least share of solid so far (× over the limit)")
    right.set(xlabel="share of solid", ylabel="displacement, mm", title="all evaluations", yscale="log")
    right.axhline(LIMIT, color="0.4", linewidth=0.8, linestyle="--")
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(out)


if __name__ == "__main__":
    main()
