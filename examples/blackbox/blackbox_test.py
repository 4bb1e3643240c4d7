#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A few evaluations of a coarse block: rows are complete, the least is what the rows say, and a stiffer block moves less.

usage: blackbox_test.py MESO     exit code 77 where NLopt or ccx is missing
"""

import csv
import pathlib
import subprocess
import sys
import tempfile

OPTIMISE = pathlib.Path(__file__).resolve().parent / "optimise.py"


def main():
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, OPTIMISE, "--meso", sys.argv[1], "--out", folder, "--surfaces", "gyroid", "--evaluations", "5", "--sampled", "3", "--samples", "10"]
        code = subprocess.run(words).returncode
        if code != 0:
            sys.exit(code)
        with open(pathlib.Path(folder) / "evaluations.csv", newline="") as file:
            rows = [{k: v if k == "surface" else float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    assert [r["evaluation"] for r in rows] == [1, 2, 3, 4, 5], rows
    assert all(r["surface"] == "gyroid" and 0.1 < r["solid"] < 0.75 and r["displacement"] > 0 for r in rows), rows
    kept = [r["solid"] for r in rows if r["displacement"] <= 0.02]
    assert kept and rows[-1]["least"] == min(kept), rows
    # A block that were solid throughout, held and pressed at its faces, would move 0.002 mm or a little less.
    assert all(r["displacement"] > 0.0015 for r in rows), rows
    most, least = max(rows, key=lambda r: r["solid"]), min(rows, key=lambda r: r["solid"])
    assert most["displacement"] < least["displacement"], rows


if __name__ == "__main__":
    main()
