#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Memory and time of fields of ten million records: raw, packed HDF5 and CSV, scattered over and asked for the nearest.

usage: fields_memory.py MESO [FOLDER]        about 1 GB in FOLDER (default: a temporary one); needs python3-numpy, python3-h5py

Own memory is what no file backs (RssAnon); pages of mapped files come and go as the system likes.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

RECORDS = 10_000_000
BLOCK = 500_000
EXTERNAL = {"raw": '<external href="big.raw" format="raw"/>', "hdf5": '<external href="big.h5" format="hdf5" path="/v"/>',
            "csv": '<external href="big.csv" format="csv"/>'}
PATTERNS = {
    "a cell at each record, 33 292 kept": '<scatter field="f"/><when test="f.s &gt; 299"/>',
    "nearest at 10 000 places": "".join(f'<loop index="{a}" axis="{a}" count="100" start="5mm" spacing="0.9mm"/>' for a in "xy")
                                .replace('index="x"', 'index="i"').replace('index="y"', 'index="j"') + '<sample field="f"/>',
}


def write_files(folder):
    random = numpy.random.default_rng(1)
    values = numpy.column_stack([numpy.round(random.uniform(0, 100, (RECORDS, 3)), 3), numpy.round(random.uniform(0, 300, RECORDS), 2)])
    values.astype("<f8").tofile(folder / "big.raw")
    with h5py.File(folder / "big.h5", "w") as out:
        out.create_dataset("v", data=values, chunks=(65536, 4), compression="gzip", compression_opts=1, shuffle=True)
    with open(folder / "big.csv", "w", encoding="ascii") as out:
        out.write("x,y,z,s\n")
        for first in range(0, RECORDS, BLOCK):
            numpy.savetxt(out, values[first:first + BLOCK], fmt="%.3f,%.3f,%.3f,%.2f")


def document(external, pattern):
    positions = "".join(f'<component name="{a}" role="position"/>' for a in "xyz")
    return (f'<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter"><unitCells><unitCell id="c"><parameter id="a" value="0"/>'
            f'<csg><sphere radius="0.5"/></csg></unitCell></unitCells><vectorFields><vectorField id="f"><structure records="{RECORDS}">'
            f'{positions}<component name="s"/><points/></structure>{external}<interpolation method="nearest"/></vectorField></vectorFields>'
            f'<patterns><pattern id="p" unitCell="c">{pattern}<set parameter="a" value="f.s"/></pattern></patterns></meso>')


def own_mebibytes(process):
    """Of a process and those that it started."""
    total = 0
    try:
        for line in open(f"/proc/{process}/status", encoding="ascii"):
            if line.startswith("RssAnon:"):
                total += int(line.split()[1]) / 1024
        for thread in os.listdir(f"/proc/{process}/task"):
            for child in open(f"/proc/{process}/task/{thread}/children", encoding="ascii").read().split():
                total += own_mebibytes(child)
    except OSError:
        pass
    return total


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__.split("\n\n")[1])
    meso = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) == 3 else temporary)
        if not (folder / "big.csv").exists():
            write_files(folder)
        print("| records | pattern | budget | own memory, MiB | CPU s |\n|---|---|---:|---:|---:|")
        for name, external in EXTERNAL.items():
            for (what, pattern), budget in zip(PATTERNS.items(), ("64M", "1G")):
                file = folder / "memory.meso"
                file.write_text(document(external, pattern), encoding="utf-8")
                before = os.times()
                run = subprocess.Popen([meso, "eval", file, folder / "cells.csv", "--max-memory", budget], stderr=subprocess.PIPE)
                most = 0
                while run.poll() is None:
                    most = max(most, own_mebibytes(run.pid))
                    time.sleep(0.02)
                if run.returncode != 0:
                    sys.exit(run.stderr.read().decode())
                after = os.times()
                seconds = after.children_user + after.children_system - before.children_user - before.children_system
                print(f"| {name} | {what} | {budget} | {most:.0f} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
