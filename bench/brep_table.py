#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints how fast exact bodies are made, as Markdown, beside what was asked for and OpenCASCADE's own fuse.

  cmake --preset release && cmake --build --preset release && bench/brep_table.py

Each row is one run of `meso convert` on a document of bench/brep, with its wall clock and processor seconds, the largest
memory of the process, and how much longer it took than dd needs for as many bytes into the same folder a moment later.
Volumes are compared with closed forms. --quick leaves out what takes more than half a minute: 100 000 cells (1.6 GB),
the tilted lattice, the torn plate and the fuse of 512. Rows appear on standard error as they are done.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

from table import ROOT, dd_seconds, print_table, run_json

DOCUMENTS = ROOT / "bench/brep"


def bcc_cell(edge, strut, ball):
    """Volume in one box: two balls, and eight struts less what is in the balls."""
    height = math.sqrt(ball**2 - strut**2)
    cap = math.pi * (ball - height)**2 * (2 * ball + height) / 3
    length = math.sqrt(3) / 2 * edge
    return 2 * 4 / 3 * math.pi * ball**3 + 8 * (math.pi * strut**2 * (length - 2 * height) - 2 * cap)


def sectors_volume():
    gap = 0.1
    removed = 0
    for i in range(10):
        low, high = 8 + 2 * (i + gap), 8 + 2 * (i + 1 - gap)
        for k in range(14):
            step = 2 * math.pi / 3 / 14
            south, north = -math.pi / 3 + (k + gap) * step, -math.pi / 3 + (k + 1 - gap) * step
            removed += 50 * (high**3 - low**3) / 3 * (2 * math.pi / 50 * 0.8) * (math.sin(north) - math.sin(south))
    return 4 / 3 * math.pi * 30**3 - removed


def disk_volume():
    removed = sum((12 + 4.5 * (i + 0.9))**2 - (12 + 4.5 * (i + 0.1))**2 for i in range(8)) * 0.8
    return math.pi * 10 * (50**2 - removed)


CELL = bcc_cell(5, 0.5, 0.9)
THOUSANDS_10 = ["--set", "nx=20", "--set", "ny=20", "--set", "nz=25"]
THOUSANDS_100 = ["--set", "nx=40", "--set", "ny=50", "--set", "nz=50"]
OFFSET = ["--set", "shiftX=1.3mm", "--set", "shiftY=1.7mm", "--set", "shiftZ=2.1mm"]
# name, document, settings, output, seconds asked for, seconds aimed at, volume where it has a closed form
ROWS = [
    ("aligned I-beam, 2 240 cells", "beam", [], "step", 3, 1, 2240 * CELL),
    ("10 000 cells", "block", THOUSANDS_10, "step", 4, 1.5, 10_000 * CELL),
    ("10 000 cells", "block", THOUSANDS_10, "stl", 5, 2, None),
    ("100 000 cells", "block", THOUSANDS_100, "step", 30, 15, 100_000 * CELL),
    ("10 000 cells, radii that grow", "graded", [], "step", 10, 4, None),
    ("lattice offset from the beam", "beam", OFFSET, "step", 15, 5, None),
    ("tilted lattice, 1 480 cells cut, none alike", "tilted", [], "step", 60, 20, None),
    ("ball, 7 000 enclosed sectors", "sectors", [], "step", 15, 2, sectors_volume()),
    ("plate, 1 000 through holes", "holes", [], "step", 3, 0.3, 500_000 - 1000 * 45 * math.pi),
    ("the same, radii that vary", "holes", ["--set", "vary=1"], "step", 3, 0.3, None),
    ("plate, 1 000 through holes", "holes", [], "stl", 2, 1, None),
    ("disk, 384 sectors cut through", "disk", [], "step", 3, 1, disk_volume()),
    ("4 000 enclosed ellipsoids", "ellipsoids", [], "step", 5, 1, 4e6 - 4000 * 32 * math.pi),
    ("the same, sizes that vary", "ellipsoids", ["--set", "vary=1"], "step", 5, 1, None),
    ("plate, 2 500 holes across its border and each other", "torn", [], "step", 60, 10, None),
]


def convert(meso, document, settings, target):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(meso), "convert", str(DOCUMENTS / f"{document}.meso"), str(target), "--json", *settings],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    report = json.loads(done.stdout)
    report["cpu"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    report["failed"] = done.returncode != 0
    return report


def rows_of_figures(meso, folder, quick):
    rows, cells = [], {}
    for name, document, settings, kind, asked, aim, volume in ROWS:
        if quick and (settings is THOUSANDS_100 or document in ("torn", "tilted")):
            continue
        target = folder / f"out.{kind}"
        report = convert(meso, document, settings, target)
        if report["failed"]:
            rows.append([name, kind, f"{asked}", f"{aim}", report["diagnostics"][0]["code"]] + ["–"] * 6)
            continue
        size, seconds = report["bytes"], report["seconds"]["total"]
        target.unlink()
        ratio = seconds / dd_seconds(folder, size)
        error = "–" if volume is None else f"{abs(report['volume'] / volume - 1):.0e}"
        assert report["closed"]
        if document == "block" and kind == "step":
            cells[report["cells"]["kept"]] = report["cpu"]
        print(f"{name}: {seconds:.2f} s, {report['cpu']:.2f} s of processors", file=sys.stderr, flush=True)
        rows.append([name, kind, f"{asked}", f"{aim}", f"{seconds:.2f}", f"{report['cpu']:.2f}",
                     f"{report['peakBytes'] / 2**20:.0f}", f"{size / 1e6:.1f}", f"{ratio:.1f}",
                     f"{report['triangles'] or report['faces']}", error])
    return rows, cells


def block(meso, folder, edge):
    """Processor seconds of a cube of cells."""
    settings = [word for axis in "xyz" for word in ("--set", f"n{axis}={edge}")]
    return convert(meso, "block", settings, folder / "out.step")["cpu"]


def peer(meso, fuse, folder, quick, fixed, each):
    rows = []
    for edge in (3, 5) if quick else (3, 5, 8):
        theirs = run_json([fuse, edge])
        count, whole = edge**3, block(meso, folder, edge)
        print(f"{count} cells: {theirs['seconds']:.1f} s fused, {whole:.2f} s repeated", file=sys.stderr, flush=True)
        rows.append([f"{count}", f"{1e3 * theirs['seconds'] / count:.1f}", f"{1e3 * whole / count:.2f}",
                     f"{theirs['seconds'] / whole:.0f}", f"{1e3 * each:.3f}", f"{theirs['seconds'] / count / each:.0f}"])
    print(f"One cell alone, which is the template: {fixed:.2f} s of a processor. Each further cell: what 10 000 take beyond that.\n")
    print_table(["cells in a block", "OpenCASCADE's fuse, CPU ms per cell", "document to STEP, CPU ms per cell", "ratio",
                 "each further cell, CPU ms", "ratio"], rows)


def main():
    parser = argparse.ArgumentParser(description="Speeds and memory of exact bodies as Markdown tables.")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--quick", action="store_true", help="leave out 100 000 cells, the tilted lattice, the torn plate and the fuse of 512")
    arguments = parser.parse_args()
    binaries = arguments.build / "bin"
    for program in ("meso", "meso_bench_peer_fuse"):
        if not (binaries / program).exists():
            sys.exit(f"{binaries} has no {program}: cmake --preset release && cmake --build --preset release")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start.\n")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        rows, cells = rows_of_figures(binaries / "meso", folder, arguments.quick)
        print_table(["what", "to", "asked s", "aim s", "s", "CPU s", "peak MiB", "MB", "times dd", "faces or triangles",
                     "volume off by"], rows)
        meso = binaries / "meso"
        fixed = block(meso, folder, 1)
        peer(meso, binaries / "meso_bench_peer_fuse", folder, arguments.quick, fixed, (cells[10_000] - fixed) / 10_000)
    if len(cells) == 2:
        (few, few_seconds), (many, many_seconds) = sorted(cells.items())
        slope = math.log((many_seconds - fixed) / (few_seconds - fixed)) / math.log(many / few)
        print(f"Slope of log CPU seconds over log cells, {few} to {many}, {fixed:.2f} s for the template left out: {slope:.2f}.")


if __name__ == "__main__":
    main()
