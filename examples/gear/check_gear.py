#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The gear example against a second evaluation, by numpy and h5py, of the same stress.h5.

usage: check_gear.py MESO [--part]

Judged by nobody else's word: which records are holes (sorting, thinning, stress, distance from the true involute outline) and how large they
are; values between the records at 1000 random places, by both methods that a cloud of points allows; with --part the volume of the exact part
(its STEP, read again) against that of the body less the cylinders, and the STEP of gear-thinned.meso. Exit code 77 if numpy or h5py are missing.
"""

import csv
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"{missing}: skipped")
    sys.exit(77)

sys.dont_write_bytecode = True
import gear_profile as gear

HERE = pathlib.Path(__file__).resolve().parent
NS = "{urn:meso-format:1.0}"
RELATIVE = 1e-12

PROBE = """<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <unitCells><unitCell id="dot"><parameter id="v" value="0"/><csg><sphere radius="1"/></csg></unitCell></unitCells>
  <vectorFields><vectorField id="fea">{structure}
    <external href="stress.h5" format="hdf5" path="records"/>{method}</vectorField></vectorFields>
  <patterns><pattern id="probes" unitCell="dot"><list>{places}</list><sample field="fea"/><set parameter="v" value="fea.vonMises"/></pattern></patterns>
  <parts><part id="dots"><apply pattern="probes" operation="union"/></part></parts>
</meso>
"""


def meso(program, *words):
    done = subprocess.run([program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise SystemExit(f"meso {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr[:2000]}")
    return done.stdout


def cells(program, document, folder):
    """Rows of numbers: ordinal, index, the placement's three rows of four, the cell's one parameter."""
    meso(program, "eval", document, folder / "cells.csv")
    with (folder / "cells.csv").open() as table:
        return np.array([[float(cell) for cell in row] for row in list(csv.reader(table))[1:]])


def expect(what, good):
    print(f"{'ok  ' if good else 'FAIL'} {what}")
    if not good:
        raise SystemExit(1)


def parameters():
    """Values of the document's parameters, lengths in millimetres."""
    found = xml.parse(HERE / "gear.meso").iter(f"{NS}parameter")
    return {p.get("id"): float(p.get("value").removesuffix("mm")) for p in found if p.get("id") != "r"}


def thinned(places, order, distance):
    """Records in that order, each that is farther than `distance` from all kept ones."""
    kept = []
    for i in order:
        if not kept or np.min(np.sum((places[kept] - places[i]) ** 2, axis=1)) > distance**2:
            kept.append(i)
    return np.array(kept)


def distance_inside(places):
    """Distance of points of the gear's section from its outline. The nearest point of the outline is in the same half of a tooth."""
    radius, angle = np.hypot(places[:, 0], places[:, 1]), np.arctan2(places[:, 1], places[:, 0])
    pitch = 2 * np.pi / gear.TEETH
    angle = np.abs(angle - pitch * np.round(angle / pitch))
    outline = np.array(gear.outline(2000))
    folded = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    from_teeth = np.array([np.min(np.hypot(*(outline - p).T)) for p in folded])
    return np.minimum(from_teeth, radius - gear.BORE_RADIUS)


def check_holes(program, folder, records):
    p = parameters()
    places, stress = records[:, :3], records[:, 3]
    kept = thinned(places, np.argsort(stress, kind="stable"), p["apart"])
    radius = p["large"] - (p["large"] - p["small"]) * np.clip(stress[kept] / p["full"], 0, 1)
    gap = distance_inside(places[kept]) - radius - p["rim"]
    # On the boundary the outline is 0 away, so it does not tell inside from outside; there the gap is negative either way.
    expect(f"no site is within 1e-4 mm of what the rim allows (nearest {np.abs(gap).min():.5f})", np.abs(gap).min() > 1e-4)
    holes = (stress[kept] < p["full"]) & (gap > 0)
    found = cells(program, HERE / "gear.meso", folder)
    index = found[:, 1].astype(int)
    expect(f"{holes.sum()} of {len(kept)} thinned of {len(records)} records are holes, the same in the same order", index.tolist() == kept[holes].tolist())
    worst = np.max(np.abs(found[:, [5, 9, 13]] - places[index]))
    expect(f"each stands at its record, to {worst:.1e} mm", worst <= RELATIVE)
    worst = np.max(np.abs(found[:, -1] / radius[holes] - 1))
    expect(f"each has its radius, to {worst:.1e}", worst <= RELATIVE)
    return radius[holes]


def check_between(program, folder, records):
    """Values at 1000 random places, seeded, of which the first is a record."""
    rng = np.random.default_rng(20)
    low, high = records[:, :3].min(axis=0), records[:, :3].max(axis=0)
    places = rng.uniform(low, high, (1000, 3))
    places[0] = records[17, :3]
    structure = xml.parse(HERE / "gear.meso").find(f".//{NS}structure")
    text = xml.tostring(structure, encoding="unicode").replace("ns0:", "").replace(":ns0", "")
    at = "".join(f'<place at="{x:.17g}, {y:.17g}, {z:.17g}"/>' for x, y, z in places)
    shutil.copy(HERE / "stress.h5", folder)
    squares = np.array([np.sum((records[:, :3] - p) ** 2, axis=1) for p in places])
    near = np.argsort(squares, axis=1, kind="stable")[:, :8]
    weights = 1 / np.maximum(np.take_along_axis(squares, near, 1), 1e-300)
    values = records[near, 3]
    expected = {
        '<interpolation method="nearest"/>': values[:, 0],
        '<interpolation method="inverseDistance" power="2"/>': np.sum(weights * values, axis=1) / np.sum(weights, axis=1),
    }
    for method, wanted in expected.items():
        (folder / "probe.meso").write_text(PROBE.format(structure=text, method=method, places=at))
        found = cells(program, folder / "probe.meso", folder)[:, -1]
        worst = np.max(np.abs(found / wanted - 1))
        expect(f"{len(found)} random places, {method}: the same values, to {worst:.1e}", len(found) == 1000 and worst <= RELATIVE)


def volume_of(program, path):
    """Volume of what stands in a STEP file, read again, which has to be closed."""
    lines = meso(program, "verify", path).splitlines()
    return float(next(line.split()[-1] for line in lines if line.startswith("ok   volume ")))


def check_part(program, folder, radius):
    made = json.loads(meso(program, "convert", HERE / "gear.meso", folder / "part.step", "--json"))
    body, part = volume_of(program, HERE / "gear.step"), volume_of(program, folder / "part.step")
    expected = body - np.pi * gear.WIDTH * np.sum(radius**2)
    worst = abs(part / expected - 1)
    expect(f"gear.step ({body:.6f} mm3) less {len(radius)} cylinders = {expected:.6f} mm3, to {worst:.1e}", worst <= 1e-9 and made["solids"] == 1)
    (folder / "thinned").mkdir()
    meso(program, "convert", HERE / "gear-thinned.meso", folder / "thinned" / "part.step")
    same = (folder / "part.step").read_bytes() == (folder / "thinned" / "part.step").read_bytes()
    expect("gear-thinned.meso makes the same bytes of STEP", same)
    expect("gear.step is the true involute gear, to 1e-5", abs(body / gear.volume() - 1) <= 1e-5)


def main():
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    with h5py.File(HERE / "stress.h5") as field:
        records = field["records"][:]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        radius = check_holes(sys.argv[1], folder, records)
        check_between(sys.argv[1], folder, records)
        if "--part" in sys.argv:
            check_part(sys.argv[1], folder, radius)


if __name__ == "__main__":
    main()
