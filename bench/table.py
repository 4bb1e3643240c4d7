#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the table of speeds and memory of docs/performance.md as Markdown.

  cmake --preset release && cmake --build --preset release && bench/table.py

Each row is one run. Processor time (CPU) is what a shared machine changes least. Bytes per second stand beside
what dd writes into the same folder a moment later, so that a slow disk or a busy machine shows in both.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENT = ROOT / "examples/ibeam/ibeam.meso"
PITCHES = {"10mm": 280, "5mm": 2240, "2.5mm": 17920, "1.25mm": 143360}
STL_CELLS = 20_000  # 37 kB of triangles a cell


def run_json(command):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


def child_cpu_seconds():
    times = os.times()
    return times.children_user + times.children_system


def benchmarks(binary, pattern):
    report = run_json([binary, f"--benchmark_filter={pattern}", "--benchmark_format=json"])
    return {b["name"]: b for b in report["benchmarks"]}


def dd_seconds(folder, size):
    """Of dd writing as many bytes into the same folder."""
    target = folder / "dd.bin"
    start = time.monotonic()
    command = ["dd", "if=/dev/zero", f"of={target}", "bs=1M", f"count={size}", "iflag=count_bytes", "status=none"]
    subprocess.run(command, check=True)
    seconds = time.monotonic() - start
    target.unlink()
    return seconds


def print_table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "|".join(["---"] + ["---:"] * (len(head) - 1)) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def slope(points):
    """Of the straight line through log y over log x."""
    xs, ys = [math.log(x) for x, _ in points], [math.log(y) for _, y in points]
    x_mean, y_mean = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - x_mean) * (y - y_mean) for x, y in zip(xs, ys)) / sum((x - x_mean) ** 2 for x in xs)


def reading_and_evaluation(binaries):
    read = benchmarks(binaries / "meso_bench_xml", "^read/100000$")["read/100000"]
    cells = benchmarks(binaries / "meso_bench_eval", "BM_ConstantGrid$|BM_PolarRings|BM_ThreeExpressions|BM_BoxQuery")
    million = lambda name: f"{cells[name]['items_per_second'] / 1e6:.1f} million/s"
    print_table(["what, one thread", "speed"], [
        ["reading a document of 200 000 elements", f"{read['bytes_per_second'] / 1e6:.0f} MB/s"],
        ["placed cells, constant pattern", million("BM_ConstantGrid")],
        ["placed cells, polar rings", million("BM_PolarRings")],
        ["placed cells, three expressions each", million("BM_ThreeExpressionsPerCell")],
        ["cells found by box queries in a million", million("BM_BoxQueryInAMillionCells")],
    ])


def realisation(binaries, folder, most_cells):
    rows, stl_rows, points = [], [], []
    for pitch, kept in PITCHES.items():
        if kept > most_cells:
            break
        out = folder / "out.step"
        # Struts grow with the cell, so that every row repeats the same cell.
        cell = ["--set", f"pitch={pitch}", "--set", "strut=pitch/5"]
        convert = [binaries / "meso", "convert", DOCUMENT, "--json"] + cell
        before = child_cpu_seconds()
        report = run_json(convert + [out])
        cpu = child_cpu_seconds() - before
        size, seconds = report["bytes"], report["seconds"]
        out.unlink()
        ratio = seconds["write"] / dd_seconds(folder, size)
        assert report["cells"]["kept"] == kept and report["closed"]
        points.append((kept, cpu))
        rows.append([f"{kept}", f"{report['faces']}"] +
                    [f"{seconds[s]:.3f}" for s in ("read", "evaluate", "realise", "write", "total")] +
                    [f"{cpu:.2f}", f"{size / 1e6:.1f}", f"{size / 1e6 / seconds['write']:.0f}", f"{ratio:.1f}",
                     f"{report['peakBytes'] / 2**20:.0f}"])
        if kept > STL_CELLS:
            continue
        stl = folder / "out.stl"
        report = run_json(convert + [stl])
        stl.unlink()
        write = report["seconds"]["write"]
        stl_rows.append([f"{kept}", f"{report['triangles']}", f"{report['seconds']['realise']:.3f}", f"{write:.3f}",
                         f"{report['triangles'] / write / 1e6:.1f}", f"{report['bytes'] / 1e6 / write:.0f}",
                         f"{write / dd_seconds(folder, report['bytes']):.1f}", f"{report['peakBytes'] / 2**20:.0f}"])
    print_table(["cells kept", "faces", "read s", "evaluate s", "realise s", "write s", "total s", "CPU s",
                 "STEP MB", "MB/s", "times dd", "peak MiB"], rows)
    print(f"Slope of log CPU seconds over log cells: {slope(points):.2f} over all rows, "
          f"{slope(points[-2:]):.2f} between the last two.\n")
    print_table(["cells kept", "triangles", "realise s", "write s", "million triangles/s", "MB/s", "times dd",
                 "peak MiB"], stl_rows)


def peer(binaries):
    ours = benchmarks(binaries / "meso_bench_brep", "BM_LatticeBody/(3|5)/")
    rows = []
    for edge in (3, 5):
        theirs = run_json([binaries / "meso_bench_peer_fuse", edge])
        (name,) = [n for n in ours if n.startswith(f"BM_LatticeBody/{edge}/")]
        seconds = ours[name]["cpu_time"] / 1e3
        cells = theirs["cells"]
        rows.append([f"{cells}", f"{1e3 * seconds / cells:.2f}", f"{1e3 * theirs['seconds'] / cells:.1f}",
                     f"{theirs['seconds'] / seconds:.0f}"])
    print_table(["cells in a block", "repeated template, CPU ms per cell", "OpenCASCADE's fuse, CPU ms per cell",
                 "ratio"], rows)


def main():
    parser = argparse.ArgumentParser(description="Speeds and memory as a Markdown table.")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--most-cells", type=int, default=150_000, help="leave out larger lattices (2.4 GB of STEP)")
    arguments = parser.parse_args()
    binaries = arguments.build / "bin"
    if not (binaries / "meso_bench_brep").exists():
        sys.exit(f"{binaries} has no benchmarks: cmake --preset release && cmake --build --preset release")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start.\n")
    reading_and_evaluation(binaries)
    with tempfile.TemporaryDirectory() as folder:
        realisation(binaries, pathlib.Path(folder), arguments.most_cells)
    peer(binaries)


if __name__ == "__main__":
    main()
