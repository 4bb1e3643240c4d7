#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a process as the wall costs: processor milliseconds to start the command, and for the I-beam to STEP.

usage: wall_cost.py MESO
"""
import pathlib
import resource
import subprocess
import sys
import tempfile

IBEAM = pathlib.Path(__file__).resolve().parents[1] / "examples/ibeam/ibeam.meso"


def milliseconds(times, *words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    for _ in range(times):
        subprocess.run([str(w) for w in words], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1000 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / times


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        start = milliseconds(40, sys.argv[1], "--version")
        beam = milliseconds(6, sys.argv[1], "convert", IBEAM, pathlib.Path(folder) / "beam.step")
    print(f"start {start:.1f} ms; I-beam to STEP {beam:.0f} ms; a start is {100 * start / beam:.1f} % of it")


if __name__ == "__main__":
    main()
