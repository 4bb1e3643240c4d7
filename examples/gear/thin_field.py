#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes gear-thinned.meso: gear.meso with the records of its holes alone, embedded, so that nothing is left to choose. Needs python3-numpy, python3-h5py.

usage: thin_field.py MESO [OUT.meso]
"""

import base64
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


def main():
    program, out = sys.argv[1], pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else HERE / "gear-thinned.meso"
    with tempfile.TemporaryDirectory() as scratch:
        cells = pathlib.Path(scratch) / "cells.csv"
        subprocess.run([program, "eval", HERE / "gear.meso", cells], check=True, stderr=subprocess.DEVNULL)
        with cells.open() as table:
            holes = [int(row[1]) for row in list(csv.reader(table))[1:]]
    with h5py.File(HERE / "stress.h5") as field:
        records = field["records"][:][holes]
    values = base64.b64encode(np.ascontiguousarray(records, dtype="<f8").tobytes()).decode()
    text = (HERE / "gear.meso").read_text()
    for pattern, into in (
        (r"<!--.*?-->", "<!-- gear.meso with the records of its holes alone, in the order of its cells. -->"),
        (r'records="\d+"', f'records="{len(records)}"'),
        (r"<external [^>]*/>", f"<embedded>{values}</embedded>"),
        (r'<scatter field="fea" index="node">.*?</scatter>', '<scatter field="fea" index="node"/>'),
        (r"\n *<(when|sample field|vectorField id=\"wall\"|parameter id=\"(apart|rim)\")[^>]*/>", ""),
        (r'placed="\d+"', f'placed="{len(records)}"'),
    ):
        text, count = re.subn(pattern, into, text, flags=re.DOTALL)
        if count == 0:
            raise SystemExit(f"gear.meso has nothing like {pattern}")
    out.write_text(text)
    print(f"{out.name}: {len(records)} records, {len(text)} bytes")


if __name__ == "__main__":
    main()
