#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the examples from the implicit engine's mesh: twins of the exact pictures, and parts that no other engine makes. Needs Pillow.

usage: twins.py [--meso PROGRAM] [--exact] [--only WORD] [--statue FOLDER]

Twins are made by `meso convert --engine implicit` and `meso render`, and stand beside the exact pictures as NAME-implicit.png.
--exact draws the exact pictures of documents/, too (those of the case studies are made by the commands on their pages). --only draws
what has WORD in its name. --statue: where statue/run.sh left its documents; without it the statue is left out.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

HERE = pathlib.Path(__file__).resolve().parent
SIZE = (480, 360)

SHARP = ("--sharp",)  # edges as they are; takes ten times as long and more

# Document, distance of samples, how it is contoured, how it is drawn.
CASES = [
    ("ibeam/ibeam", "0.4mm", (), ()),
    ("disk/disk", "0.4mm", (), ("--cut", "z=3mm")),
    ("sphere/sphere", "0.2mm", SHARP, ("--cut", "y=1.6mm")),
    ("gear/gear", "0.2mm", SHARP, ()),
    ("direction-beam/direction-beam", "0.3mm", (), ("--cut", "x=0")),
]
DOCUMENTS = {
    "bcc_ball": "0.2mm", "bcc_tube": "0.25mm", "boundary_rules": "0.2mm", "cartesian": "0.2mm", "drilled_plate": "0.3mm",
    "graded_block": "0.15mm", "graded_spacing": "0.3mm", "holes_at_records": "0.3mm", "keep_when": "0.4mm",
    "library_cells": "0.1mm", "list_of_places": "0.3mm", "offset_lattice": "0.1mm", "orient_along_vector": "0.2mm", "parameters": "0.3mm",
    "parts_of_parts": "0.2mm", "polar": "0.4mm", "radius_at_nodes": "0.1mm", "rotate_step_by_step": "0.25mm",
    "sandwich_panel": "0.1mm", "spherical": "1mm", "truss_of_trusses": "0.1mm",
    "turned_lattice": "0.1mm", "turned_pulley": "0.2mm",
}
CUTS = {"parts_of_parts": ("--cut", "y=8mm")}
# Cells that are functions have no exact picture.
FIELDS = {
    "blended_cells": "0.4mm", "density_from_field": "0.3mm", "graded_density": "0.4mm", "growing_cells": "0.4mm", "gyroid_ball": "0.25mm",
    "gyroid_cone": "0.25mm", "gyroid_globe": "0.25mm", "gyroid_tube": "0.25mm", "skin_and_fillet": "0.4mm", "spring": "0.25mm", "struts_by_cell": "0.15mm",
    "wall_of_a_length": "0.4mm", "walls_along_walls": "0.4mm",
}


def draw(meso, source, picture, *words):
    """Into a palette: a quarter of the bytes, and shades of one colour lose nothing."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "picture.png"
        width, height = SIZE
        subprocess.run([meso, "render", source, path, "--width", str(width), "--height", str(height), *words], check=True)
        picture.parent.mkdir(exist_ok=True)
        Image.open(path).convert("RGB").quantize(48, dither=Image.Dither.NONE).save(picture, optimize=True)
    print(f"{picture}: {picture.stat().st_size} bytes", flush=True)


def twin(meso, document, spacing, picture, *words, edges=()):
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "mesh.ply"
        subprocess.run([meso, "convert", "--engine", "implicit", *edges, "--spacing", spacing, document, mesh], check=True)
        draw(meso, mesh, picture, *words)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meso", default="meso")
    arguments.add_argument("--exact", action="store_true")
    arguments.add_argument("--only", default="", metavar="WORD")
    arguments.add_argument("--statue", type=pathlib.Path, metavar="FOLDER")
    options = arguments.parse_args()
    for name, spacing, edges, words in CASES:
        if options.only in name:
            twin(options.meso, HERE / f"{name}.meso", spacing, HERE / f"{name}-implicit.png", *words, edges=edges)
    if options.statue and options.only in "statue":
        twin(options.meso, options.statue / "upright-statue-stl.meso", "0.4mm", HERE / "statue/statue-implicit.png", "--cut", "y=-4.8mm")
    for name, spacing in DOCUMENTS.items():
        document, pictures = HERE / f"documents/{name}.meso", HERE / "documents/pictures"
        if options.only not in name:
            continue
        if options.exact:
            draw(options.meso, document, pictures / f"{name}.png", *CUTS.get(name, ()))
        twin(options.meso, document, spacing, pictures / f"{name}-implicit.png", *CUTS.get(name, ()), edges=SHARP)
    for name, spacing in FIELDS.items():
        if options.only in name:
            twin(options.meso, HERE / f"implicit/{name}.meso", spacing, HERE / f"implicit/{name}.png", edges=SHARP)


if __name__ == "__main__":
    sys.exit(main())
