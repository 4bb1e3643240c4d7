#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the direction beam against numpy, which reads the field file by itself. Needs neither Gmsh nor CalculiX.

usage: check.py MESO [--part] [FOLDER]     with direction-beam.meso and its files; exit 0 if all holds, 1 if not, 77 without numpy

 1. direction-beam.meso is valid, makes 1 120 voids, and has the volume that the closed form gives.
 2. The cells' axes are the eigenvectors of the stress to 1e-9 rad, wherever eigenvalues are 1e-3 MPa apart.
 3. Components, principal values and von Mises stress at 1 000 records drawn at random, and components between records, are numpy's to 1e-12.
 4. With --part: OpenCASCADE reads the STEP file as one body of 212 800 mm3 less 1 120 voids of 4/3 pi a b c each.
"""

import csv
import io
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("numpy is not installed: skipped")
    sys.exit(77)

WORDS = [word for word in sys.argv[1:] if word != "--part"]
HERE = pathlib.Path(WORDS[1] if len(WORDS) > 1 else __file__).resolve()
HERE = HERE if HERE.is_dir() else HERE.parent
ORDERS = ("xx", "yy", "zz", "xy", "yz", "zx")
SOLID, VOID = 212800, 4 / 3 * math.pi * 0.8 * 0.8 * 2.2  # mm3
FLANGES, WEB = (10, 2, 40), (8, 40)  # x y z and y z
failures = 0


def expect(what, holds, found):
    global failures
    failures += not holds
    print(f"{'ok  ' if holds else 'FAIL'} {what:<58} {found}")


def meso(program, *words):
    return subprocess.run([program, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True).stdout


def cells(program, document, pattern):
    """Rows of `meso eval` as one array for each column."""
    rows = list(csv.DictReader(io.StringIO(meso(program, "eval", document, "--pattern", pattern))))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def read_field():
    """Stress tensors at the records: arrays (10, 2, 40, 3, 3) and (8, 40, 3, 3)."""
    values = np.fromfile(HERE / "stress.raw", dtype="<f8").reshape(-1, 6)
    tensors = values[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    return tensors[:800].reshape(*FLANGES, 3, 3), tensors[800:].reshape(*WEB, 3, 3)


def check_axes(program, pattern, tensors, places):
    found = cells(program, HERE / "direction-beam.meso", pattern)
    tensors = tensors.reshape(-1, 3, 3)
    expect(f"{pattern}: cells", found["n"].tolist() == list(range(len(tensors))), len(found["n"]))
    stands = np.stack([found["m14"], found["m24"], found["m34"]], axis=1)
    expect(f"{pattern}: largest distance from its place", np.abs(stands - places).max() < 1e-12, f"{np.abs(stands - places).max():.1e} mm")
    values, vectors = np.linalg.eigh(tensors)  # ascending
    largest = np.where(values[:, 2] > -values[:, 0], 2, 0)
    for axis, which in (("3", largest), ("1", np.ones_like(largest))):
        own = np.take_along_axis(values, which[:, None], 1)
        others = np.sort(np.abs(values - own), axis=1)[:, 1]
        apart = others >= 1e-3
        expected = np.take_along_axis(vectors, which[:, None, None], 2)[:, :, 0]
        axes = np.stack([found[f"m{row}{axis}"] for row in (1, 2, 3)], axis=1)
        angle = np.linalg.norm(np.cross(axes, expected), axis=1)[apart]
        expect(f"{pattern}: axis {'xz'[axis == '3']} against eigenvectors, {apart.sum()} cells", apart.any() and angle.max() < 1e-9, f"{angle.max():.1e} rad")


def probing_document(folder, between):
    """The same field, its values set as parameters of cells: at all records, and at places of the web between them."""
    shutil.copy(HERE / "stress.raw", folder)
    text = (HERE / "direction-beam.meso").read_text()
    field = text[text.index("<vectorFields>"):text.index("</vectorFields>")].replace(
        'offset="38400"/>', 'offset="38400"/><interpolation method="linear"/>') + "</vectorFields>"
    names = (*ORDERS, "principal1", "principal2", "principal3", "vonMises")
    parameters = "".join(f'<parameter id="v{c}" value="0"/>' for c in names)

    def values(of):
        return "".join(f'<set parameter="v{c}" value="{of}.{c}"/>' for c in names)

    places = "".join(f'<place at="0, {y!r}, {z!r}"/>' for y, z in between.tolist())
    document = folder / "probe.meso"
    document.write_text(f"""<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <unitCells><unitCell id="probe">{parameters}<csg><sphere radius="1"/></csg></unitCell></unitCells>
  {field}
  <patterns>
    <pattern id="flanges_" unitCell="probe"><scatter field="flanges" index="n"/>{values("flanges")}</pattern>
    <pattern id="web_" unitCell="probe"><scatter field="web" index="n"/>{values("web")}</pattern>
    <pattern id="between" unitCell="probe"><list>{places}</list><sample field="web"/>{values("web")}</pattern>
  </patterns>
  <parts><part id="p"><apply pattern="web_" operation="union"/></part></parts>
</meso>
""")
    return document


def bilinear(web, places):
    """Components of the web's grid at (y, z)."""
    grid = web[..., [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    t = (places - (-17.5, 2.5)) / 5
    i = np.minimum(t.astype(int), np.array(WEB) - 2)
    f = (t - i)[..., None]
    j, k = i.T
    return ((1 - f[:, 0]) * ((1 - f[:, 1]) * grid[j, k] + f[:, 1] * grid[j, k + 1])
            + f[:, 0] * ((1 - f[:, 1]) * grid[j + 1, k] + f[:, 1] * grid[j + 1, k + 1]))


def check_values(program, flanges, web):
    random = np.random.default_rng(11)
    between = random.uniform((-17.5, 2.5), (17.5, 197.5), (1000, 2))
    with tempfile.TemporaryDirectory() as folder:
        document = probing_document(pathlib.Path(folder), between)
        tables = [cells(program, document, p) for p in ("flanges_", "web_", "between")]
    tensors = np.concatenate([flanges.reshape(-1, 3, 3), web.reshape(-1, 3, 3)])
    drawn = random.choice(len(tensors), 1000, replace=False)
    t = tensors[drawn]
    principal = np.linalg.eigvalsh(t)
    deviator = t - np.trace(t, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    expected = {c: t[:, "xyz".index(c[0]), "xyz".index(c[1])] for c in ORDERS}
    expected |= {"principal1": principal[:, 2], "principal2": principal[:, 1], "principal3": principal[:, 0],
                 "vonMises": np.sqrt(1.5 * (deviator**2).sum((1, 2)))}
    scale = np.abs(tensors).max()
    for name, values in expected.items():
        off = np.abs(np.concatenate([tables[0][f"v{name}"], tables[1][f"v{name}"]])[drawn] - values).max() / scale
        expect(f"{name} at 1000 records", off < 1e-12, f"{off:.1e}")
    off = max(np.abs(tables[2][f"v{c}"] - values).max() for c, values in zip(ORDERS, bilinear(web, between).T)) / scale
    expect("components at 1000 places between records", off < 1e-12, f"{off:.1e}")


def check_body(program):
    document = HERE / "direction-beam.meso"
    meso(program, "validate", document)
    verified = meso(program, "verify", document)
    expect("meso verify", "direction-beam.meso: passed" in verified, "passed" if "passed" in verified else verified)
    stated = float(document.read_text().split('<volume value="')[1].split('"')[0])
    closed_form = SOLID - 1120 * VOID
    expect("stated volume against the closed form", abs(stated / closed_form - 1) < 1e-12, stated)


def check_part(program):
    """A void can be there in the text of a STEP file and hold nothing for those who read it: only its volume tells."""
    with tempfile.TemporaryDirectory() as folder:
        step = pathlib.Path(folder) / "beam.step"
        meso(program, "convert", HERE / "direction-beam.meso", step)
        shells = json.loads(meso(program, "verify", step, "--json"))["shellVolumes"]
    voids = np.array([-volume for volume in shells if volume < 0])
    expect("voids in the STEP file as it is read", len(voids) == 1120, len(voids))
    off = np.abs(voids / VOID - 1).max(initial=0)
    expect("their volumes, relative", len(voids) > 0 and off < 1e-9, f"{off:.1e}")
    bodies = [volume for volume in shells if volume > 0]
    expect("volume of the skin around them", len(bodies) == 1 and abs(bodies[0] / SOLID - 1) < 1e-9, bodies)


def main():
    if len(WORDS) not in (1, 2):
        sys.exit(__doc__)
    program = WORDS[0]
    flanges, web = read_field()
    x, y, z = np.meshgrid(-22.5 + 5 * np.arange(10), [-26, 26], 2.5 + 5 * np.arange(40), indexing="ij")
    check_axes(program, "flangeVoids", flanges, np.stack([x, y, z], axis=-1).reshape(-1, 3))
    y, z = np.meshgrid(-17.5 + 5 * np.arange(8), 2.5 + 5 * np.arange(40), indexing="ij")
    check_axes(program, "webVoids", web, np.stack([0 * y, y, z], axis=-1).reshape(-1, 3))
    check_values(program, flanges, web)
    check_body(program)
    if "--part" in sys.argv:
        check_part(program)
    sys.exit(failures != 0)


if __name__ == "__main__":
    main()
