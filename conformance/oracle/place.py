#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Places cells by the specification's text alone: an independent second implementation that makes the numbers of the
eval cases. It reads no document; a case's script states the system and the loops as Python values, so that nothing is
shared with the implementation under test, not even a parser.

  system = System([("r", "distance", (1, 0, 0)), ("phi", "circular", (0, 0, 1)), ("h", "linear", (0, 0, 1))])
  place(system, [Loop("r", lambda i: 2, start=lambda i: 10, spacing=lambda i: 5), ...])

Lengths in millimetres, angles in radians; matrices are 3x4, row-major.
"""
import math
from dataclasses import dataclass
from typing import Callable, Optional

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def multiply(a, b):
    return tuple(tuple(sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)) for i in range(3))


def apply(a, v):
    return tuple(sum(a[i][k] * v[k] for k in range(3)) for i in range(3))


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def scaled(s, v):
    return tuple(s * x for x in v)


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def turn(axis, angle):
    """Right-handed rotation about an axis through the origin, built from its action on the base vectors."""
    n = unit(axis)
    columns = []
    for e in IDENTITY:
        along = scaled(dot(n, e), n)
        across = add(e, scaled(-1, along))
        columns.append(add(along, add(scaled(math.cos(angle), across), scaled(math.sin(angle), cross(n, e)))))
    return tuple(tuple(columns[j][i] for j in range(3)) for i in range(3))


@dataclass
class System:
    axes: list  # (name, kind, direction)
    rotation: tuple = IDENTITY
    origin: tuple = (0.0, 0.0, 0.0)

    def frame(self, q, extra=(0.0, 0.0, 0.0)):
        """R-5.5.1: the point P(q) and the local frame; `extra` is what loops along directions add."""
        straight, turned, rotation = extra, (0.0, 0.0, 0.0), IDENTITY
        for name, kind, direction in self.axes:
            if kind == "linear":
                straight = add(straight, scaled(q.get(name, 0.0), unit(direction)))
            elif kind == "distance":
                turned = add(turned, scaled(q.get(name, 0.0), unit(direction)))
            elif kind == "circular":
                rotation = multiply(rotation, turn(direction, q.get(name, 0.0)))
        point = add(apply(self.rotation, add(straight, apply(rotation, turned))), self.origin)
        return point, multiply(self.rotation, rotation)


@dataclass
class Loop:
    """`axis` is a name, a direction, or None. Functions take the index tuple so far, own index last."""
    axis: object
    count: Callable
    start: Callable = lambda *i: 0.0
    spacing: Optional[Callable] = None
    position: Optional[Callable] = None
    first: int = 0  # of a fill: its lowest n; then spacing is the step and q = n * step

    def coordinate(self, outer, i):
        if self.position:
            return float(self.position(*outer, i))
        if not self.spacing:
            return 0.0
        if self.first or self.start is None:
            return i * float(self.spacing(*outer, i))
        return float(self.start(*outer)) + math.fsum(float(self.spacing(*outer, m)) for m in range(i))

    def step(self, outer, i):
        return float(self.spacing(*outer, i)) if self.spacing else self.coordinate(outer, i + 1) - self.coordinate(outer, i)


def walk(loops, outer=()):
    """Index tuples in normative order: first loop outermost, last fastest (R-5.10.2)."""
    if not loops:
        yield outer
        return
    for i in range(loops[0].first, loops[0].first + loops[0].count(*outer)):
        yield from walk(loops[1:], outer + (i,))


def matrix(rotation, point):
    return [v for i in range(3) for v in (*rotation[i], point[i])]


def place(system, loops, instruct=None, parameters=None):
    """All cells. `instruct(frame, index, q)` may change frame["rotation"] and frame["point"] and returns False to drop."""
    cells = []
    for index in walk(loops):
        q, steps, extra = {}, {}, (0.0, 0.0, 0.0)
        for depth, loop in enumerate(loops):
            value = loop.coordinate(index[:depth], index[depth])
            if isinstance(loop.axis, str):
                q[loop.axis] = value
                steps[loop.axis] = loop.step(index[:depth], index[depth])
            elif loop.axis is not None:
                extra = add(extra, scaled(value, unit(loop.axis)))
        point, rotation = system.frame(q, extra)
        frame = {"rotation": rotation, "point": point, "global": point}
        if instruct and instruct(frame, index, q) is False:
            continue
        cell = {"index": list(index), "matrix": matrix(frame["rotation"], frame["point"])}
        if parameters:
            cell["parameters"] = parameters(index, q, point)
        cell["_q"], cell["_step"] = q, steps
        cells.append(cell)
    return cells
