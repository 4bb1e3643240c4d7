#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the eval cases expect, stated by hand for each document and computed by place.py.

usage: eval_cases.py check    fails if an expectation in cases/eval differs (relative 1e-13)
       eval_cases.py write    writes the expectations beside the documents
"""
import json
import math
import pathlib
import re
import sys

from place import IDENTITY, Loop, System, add, apply, cross, dot, matrix, multiply, place, scaled, turn, unit, walk

CASES = pathlib.Path(__file__).resolve().parent.parent / "cases" / "eval"
CARTESIAN = System([("x", "linear", (1, 0, 0)), ("y", "linear", (0, 1, 0)), ("z", "linear", (0, 0, 1))])
POLAR = System([("r", "distance", (1, 0, 0)), ("phi", "circular", (0, 0, 1)), ("h", "linear", (0, 0, 1))])
SPHERICAL = System([("r", "distance", (1, 0, 0)), ("lon", "circular", (0, 0, 1)), ("lat", "circular", (0, -1, 0))])
DEG = math.pi / 180


def n(value):
    return lambda *index: value


def row(count=4, spacing=5.0, start=0.0):
    return [Loop("x", n(count), n(start), n(spacing))]


def rotated(frame, rotation):
    frame["rotation"] = multiply(frame["rotation"], rotation)


def moved(frame, vector):
    frame["point"] = add(frame["point"], apply(frame["rotation"], vector))


def stretched(frame, x, y, z):
    rotated(frame, ((x, 0, 0), (0, y, 0), (0, 0, z)))


def turned_cells(frame, index, q):
    rotated(frame, turn((0, 0, 1), 30 * DEG * index[0]))


def turned_then_moved(frame, index, q):
    turned_cells(frame, index, q)
    moved(frame, (1, 2, 3))


def moved_then_turned(frame, index, q):
    moved(frame, (1, 2, 3))
    turned_cells(frame, index, q)


def scaled_then_moved(frame, index, q):
    stretched(frame, 2, 3, 4)
    moved(frame, (1, 1, 1))


def along(frame, axis, target, second=None, second_target=None):
    """Turns the frame so that base vector `axis` points along `target`, given in the frame."""
    e, u = IDENTITY[axis], unit(target)
    if second is None:
        k = cross(e, u)
        rotated(frame, turn(k, math.atan2(math.sqrt(dot(k, k)), dot(e, u))))
        return
    w = unit(add(second_target, scaled(-dot(second_target, u), u)))
    columns = [None, None, None]
    columns[axis], columns[second] = u, w
    third = 3 - axis - second
    columns[third] = cross(columns[(third + 1) % 3], columns[(third + 2) % 3])
    rotated(frame, tuple(tuple(columns[j][i] for j in range(3)) for i in range(3)))


def oriented_global(frame, index, q):
    back = tuple(zip(*frame["rotation"]))
    along(frame, 2, apply(back, (1, 1, 1)))


def conformal(system, loops, names):
    """Coordinates and steps only: a conformal cell has no single matrix."""
    cells = place(system, loops)
    return [{"index": c["index"], "q": [c["_q"].get(a, 0.0) for a in names], "step": [c["_step"][a] for a in names[:3]]} for c in cells]


def millimeters(cells, factor):
    for cell in cells:
        for i in (3, 7, 11):
            cell["matrix"][i] *= factor
    return cells


def listed(system, names, places):
    out = []
    for number, place_ in enumerate(places):
        point, rotation = system.frame(dict(zip(names, place_)))
        out.append({"index": [number], "matrix": matrix(rotation, point)})
    return out


PARENT = turn((0, 0, 1), 90 * DEG)
NESTED = System([("u", "linear", (1, 0, 0))], multiply(PARENT, turn((1, 0, 0), 90 * DEG)), add((10.0, 0.0, 0.0), apply(PARENT, (0.0, 0.0, 7.0))))
OBLIQUE = System([("u", "linear", (1, 0, 0)), ("v", "linear", (1, 1, 0))])

# name: (title, rule, cells, extra keys of "cells")
EXPECT = {
    "5.5/cartesian": ("Last loop fastest, starts and spacings along x, y and z", "R-5.5.1",
                      place(CARTESIAN, [Loop("x", n(2), n(-5.0), n(5.0)), Loop("y", n(3), n(0.0), n(4.0)), Loop("z", n(2), n(1.0), n(3.0))])),
    "5.5/polar": ("The local frame turns with the circular coordinate", "R-5.5.1",
                  place(POLAR, [Loop("r", n(2), n(10.0), n(5.0)), Loop("phi", n(6), n(0.0), n(math.pi / 3)), Loop("h", n(2), n(0.0), n(4.0))])),
    "5.5/spherical": ("Two circular axes: the first in the document is the outer rotation", "R-5.5.1",
                      place(SPHERICAL, [Loop("r", n(1), n(20.0), n(5.0)), Loop("lon", n(4), n(0.0), n(math.pi / 2)), Loop("lat", n(3), n(-math.pi / 4), n(math.pi / 4))])),
    "5.5/nested": ("Placements of parents multiply, outermost first", "R-5.5.1", place(NESTED, [Loop("u", n(3), n(0.0), n(2.0))])),
    "5.5/oblique": ("Oblique axes move cells and do not shear them", "R-5.5.1",
                    place(OBLIQUE, [Loop("u", n(2), n(0.0), n(3.0)), Loop("v", n(2), n(0.0), n(4.0))])),
    "5.5/scalar": ("A scalar coordinate moves nothing and can be used by name", "R-5.5.1",
                   place(System(CARTESIAN.axes[:1] + [("density", "scalar", None)]),
                         [Loop("x", n(2), n(0.0), n(5.0)), Loop("density", n(3), n(0.1), n(0.2))],
                         parameters=lambda i, q, p: {"t": 10 * (0.1 + 0.2 * i[1])})),
    "5.4/inches": ("Results are in millimetres whatever the document's unit", "R-5.4.8", millimeters(place(CARTESIAN, row(3, 2.0, 1.0)), 25.4)),
    "5.4/suffixes": ("Suffixes give values in the document's unit", "R-5.4.8", millimeters(place(CARTESIAN, row(3, 0.5, 2.0)), 10.0)),
    "5.10/cumulative_spacing": ("Spacing adds up: q is the sum of the spacings before", "R-5.10.3",
                                place(CARTESIAN, [Loop("x", n(5), n(2.0), lambda i: 1.0 + i)])),
    "5.10/position": ("position gives the coordinate itself", "R-5.10.3", place(CARTESIAN, [Loop("x", n(5), position=lambda i: float(i * i))])),
    "5.10/direction": ("A loop along a direction, which is normalised", "R-5.10.3", place(CARTESIAN, [Loop((3, 0, 4), n(3), n(5.0), n(10.0))])),
    "5.10/direction_and_axis": ("Loops along a direction and an axis add up", "R-5.10.3",
                                place(CARTESIAN, [Loop("z", n(2), n(0.0), n(7.0)), Loop((1, 1, 0), n(2), n(0.0), n(2.0))])),
    "5.10/counting_loop": ("A loop that only counts gives cells at one place", "R-5.10.3", place(CARTESIAN, row(2) + [Loop(None, n(2))])),
    "5.10/triangle": ("A count may depend on the outer index", "R-5.10.2",
                      place(CARTESIAN, [Loop("x", n(4), n(0.0), n(5.0)), Loop("y", lambda i: i, n(0.0), n(5.0))])),
    "5.10/count_zero": ("A pattern may have no cell", "R-5.10.2", []),
    "5.10/list": ("Coordinates in the order of the axes, the rest is 0", "R-5.10.4",
                  listed(POLAR, ("r", "phi", "h"), [(10.0, math.pi / 2, 3.0), (5.0,), (7.0, math.pi)])),
    "5.10/fill": ("Whole steps between from and to", "R-5.10.5",
                  place(CARTESIAN, [Loop("x", n(2), None, n(5.0), first=-1), Loop("y", n(3), None, n(2.0), first=1)])),
    "5.10/fill_tolerance": ("Rounding noise of a step is forgiven", "R-5.10.5", place(CARTESIAN, [Loop("x", n(3), n(0.0), n(0.1))])),
    "5.10/rotate": ("A rotation about an axis through the cell's origin", "R-5.10.11", place(CARTESIAN, row(), turned_cells)),
    "5.10/rotate_then_translate": ("A translation acts in the frame that the rotation left", "R-5.10.11", place(CARTESIAN, row(), turned_then_moved)),
    "5.10/translate_then_rotate": ("A rotation is about the place that the translation left", "R-5.10.11", place(CARTESIAN, row(), moved_then_turned)),
    "5.10/scale_then_translate": ("A translation is scaled by the factors before it", "R-5.10.11", place(CARTESIAN, row(2), scaled_then_moved)),
    "5.10/rotate_in_polar": ("Instructions start in the local frame", "R-5.10.11",
                             place(POLAR, [Loop("r", n(1), n(8.0), n(1.0)), Loop("phi", n(4), n(0.0), n(math.pi / 2))],
                                   lambda f, i, q: rotated(f, turn((1, 0, 0), 90 * DEG)))),
    "5.10/orient": ("The smallest rotation that takes a cell axis to a direction", "R-5.10.8",
                    place(CARTESIAN, row(2), lambda f, i, q: along(f, 2, (1, 2, 2)))),
    "5.10/orient_with_second": ("A second axis as near to its direction as the first allows", "R-5.10.8",
                                place(CARTESIAN, row(2), lambda f, i, q: along(f, 2, (1, 0, 1), 0, (0, 1, 1)))),
    "5.10/orient_global": ("Directions in the global frame", "R-5.10.8",
                           place(POLAR, [Loop("r", n(1), n(8.0), n(1.0)), Loop("phi", n(4), n(0.2), n(1.1))], oriented_global)),
    "5.10/when": ("Dropped cells keep their index", "R-5.10.11",
                  place(CARTESIAN, [Loop("x", n(3), n(0.0), n(5.0)), Loop("y", n(3), n(0.0), n(5.0))], lambda f, i, q: (i[0] + i[1]) % 2 == 0)),
    "5.10/set": ("set sees indices, coordinates and earlier values", "R-5.10.11",
                 place(CARTESIAN, row(), parameters=lambda i, q, p: {"t": 2 * (1 + 0.1 * q["x"]) + i[0]})),
    "5.10/global_before_instructions": ("global is the place before any instruction", "R-5.2.2",
                                        place(POLAR, [Loop("r", n(1), n(10.0), n(1.0)), Loop("phi", n(3), n(0.0), n(0.5))],
                                              lambda f, i, q: moved(f, (100, 0, 0)), lambda i, q, p: {"t": p[0] + 2 * p[1]})),
    "5.10/default_of_placement": ("A default may use the placement", "R-5.2.2",
                                  place(CARTESIAN, row(), parameters=lambda i, q, p: {"a": 1 + 0.5 * p[0], "b": (1 + 0.5 * p[0]) / 2 + i[0]})),
    "5.3/override": ("A user replaces a parameter; what depends on it follows", "R-5.3.4", place(CARTESIAN, row(8, 2.5, -10.0)), {"set": {"pitch": "2.5mm"}}),
    "5.11/conformal_polar": ("A conformal cell has coordinates and steps", "R-5.11.1",
                             conformal(POLAR, [Loop("r", n(2), n(10.0), lambda i: 5.0 + i), Loop("phi", n(4), n(0.0), n(math.pi / 2)), Loop("h", n(1), n(0.0), n(3.0))],
                                       ("r", "phi", "h"))),
}


def expectation(name):
    title, rule, cells, *extra = EXPECT[name]
    for cell in cells:
        cell.pop("_q", None)
        cell.pop("_step", None)
    return {"rule": rule, "profile": "eval", "title": title, "cells": {"pattern": "p", **(extra[0] if extra else {}), "cells": cells}}


def text(value):
    """JSON with every list of numbers on one line."""
    return re.sub(r"\[\s+([-0-9.,e+\s]+?)\s+\]", lambda m: "[" + re.sub(r"\s+", " ", m.group(1)) + "]", json.dumps(value, indent=1)) + "\n"


def is_same(a, b):
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(is_same(a[k], b[k]) for k in a)
    if isinstance(a, list):
        return isinstance(b, list) and len(a) == len(b) and all(is_same(x, y) for x, y in zip(a, b))
    if isinstance(a, float) or isinstance(b, float):
        return abs(a - b) <= 1e-13 * max(1.0, abs(a), abs(b))
    return a == b


def main():
    task = sys.argv[1] if len(sys.argv) == 2 else ""
    if task not in ("check", "write"):
        sys.exit(__doc__)
    for name in EXPECT:
        path = CASES / f"{name}.expect.json"
        if not path.with_name(path.name.replace(".expect.json", ".meso")).exists():
            sys.exit(f"{name}: there is no document")
        if task == "write":
            path.write_text(text(expectation(name)), encoding="utf-8")
        elif not is_same(expectation(name), json.loads(path.read_text(encoding="utf-8"))):
            sys.exit(f"{name}: the expectation is not what place.py computes")
    print(f"{len(EXPECT)} expectations, {task}")


if __name__ == "__main__":
    main()
