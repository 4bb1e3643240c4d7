#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The I-beam over the number of its cells: bytes, time and memory.

usage: series.py [--pitches 10mm,5mm,10mm/3,2.5mm] [--out series.png]     meso must be on the PATH

Prints a table in Markdown and draws it. Bytes are those of `meso compare --series`; time and memory are those of `meso convert` to STEP, one
process for each number of cells: user and system seconds, and the largest resident memory.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plot  # noqa: E402

BEAM = pathlib.Path(__file__).resolve().parent / "ibeam.meso"


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rows_of(pitches, folder):
    compared = subprocess.run(["meso", "compare", BEAM, "--series", "pitch=" + ",".join(pitches), "--out", folder, "--json"], check=True, capture_output=True)
    rows = json.loads(compared.stdout)
    for pitch, row in zip(pitches, rows):
        before = cpu_seconds()
        made = subprocess.run(["meso", "convert", BEAM, folder / "beam.step", "--set", f"pitch={pitch}", "--json"], check=True, capture_output=True)
        report = json.loads(made.stdout)
        row.update(pitch=pitch, cpu=cpu_seconds() - before, memory=report["peakBytes"])
        assert report["bytes"] == row["partStep"], "convert and compare disagree"
    return rows


def print_table(rows):
    print("| cell | cells | document | framework | packed | part STEP | part ASCII STL | triangles | s to STEP | MB to STEP |")
    print("|---|" + "---:|" * 9)
    for r in rows:
        body = BEAM.with_suffix(".step").stat().st_size
        print(f"| {r['pitch']} | {r['cells']} | {r['framework'] - body} | {r['framework']} | {r['packed']} | {r['partStep']} | {r['partStl']} "
              f"| {r['triangles']} | {r['cpu']:.2f} | {r['memory'] / 1e6:.0f} |")


def draw(rows, out):
    cells = [r["cells"] for r in rows]
    figure, axes = plot.subplots(1, 3, figsize=(12, 3.8), dpi=100)
    for key, label in (("partStl", "part, ASCII STL"), ("partStep", "part, STEP"), ("framework", "document and body"), ("packed", "the same, packed")):
        axes[0].plot(cells, [r[key] for r in rows], "o-", label=label)
    axes[1].plot(cells, [r["cpu"] for r in rows], "o-", color="tab:red")
    axes[2].plot(cells, [r["memory"] / 1e6 for r in rows], "o-", color="tab:purple")
    for axis, title in zip(axes, ("bytes", "CPU seconds, document to STEP", "megabytes of memory, the same")):
        axis.set(xlabel="cells", title=title)
        axis.grid(True, alpha=0.3)
    axes[0].set(xscale="log", yscale="log")
    for axis in axes[1:]:
        axis.set_ylim(bottom=0)
        axis.locator_params(axis="x", nbins=4)
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pitches", default="10mm,5mm,10mm/3,2.5mm")
    parser.add_argument("--out", type=pathlib.Path, default=BEAM.parent / "series.png")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = rows_of(arguments.pitches.split(","), pathlib.Path(folder))
    print_table(rows)
    draw(rows, arguments.out)


if __name__ == "__main__":
    main()
