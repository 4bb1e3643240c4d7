#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Random documents whose parts stand in the cells of other parts, two and three levels deep, for random_parts.py."""
import itertools
import math

from membership import box, boolean, cone, in_boxed, loops, moved, number, random_primitive, rotation, scaled, sphere, truss


def leaf(rng):
    """A cell of beams or of a solid: text, what tells whether a point is inside, and the size of its box."""
    size = [number(rng, 3, 6) for _ in range(3)]
    if rng.random() < 0.4:
        text, boxed = truss(rng, size)
        return text, lambda p: in_boxed(boxed, p), size
    middle = [d / 2 for d in size]
    kind = rng.randrange(4)
    if kind == 0:
        shape = sphere(middle, number(rng, 0.3 * min(size), 0.48 * min(size)))
    elif kind == 1:  # bars that meet those of the next cells
        width = round(0.3 * min(size), 2)
        shape = boolean("union", [box([0 if i == a else round(m - width / 2, 3) for i, m in enumerate(middle)],
                                      [d if i == a else width for i, d in enumerate(size)]) for a in range(3)])
    elif kind == 2:
        bore = round(0.2 * min(size), 2)
        shape = boolean("difference", [box((0, 0, 0), size), cone([*middle[:2], -1], [*middle[:2], size[2] + 1], bore, bore)])
    else:
        shape = moved(scaled(random_primitive(rng), [round(0.12 * min(size), 3)] * 3), middle)
    return f"<csg>{shape[0]}</csg>", shape[1], size


def instructions(rng):
    """Text, and what takes a point back into the frame of the cell."""
    kind = rng.randrange(4)
    if kind == 0:
        axis, angle = rng.choice(([0, 0, 1], [1, 2, 2])), number(rng, -1, 1)
        back = rotation(axis, -angle)
        return (f'<rotate x="{axis[0]}" y="{axis[1]}" z="{axis[2]}" angle="{angle}"/>',
                lambda p: [sum(a * b for a, b in zip(row, p)) for row in back])
    if kind == 1:
        factor = number(rng, 0.5, 0.9)
        return f'<scale factor="{factor}"/>', lambda p: [x / factor for x in p]
    return "", lambda p: p


def body_of(rng, extent):
    """A body that the cells of these extents are cut with."""
    low = [number(rng, -0.2 * e, 0.1 * e) for e in extent]
    size = [number(rng, 0.6 * e, 1.1 * e) for e in extent]
    if rng.random() < 0.6:
        return box(low, size)
    return sphere([l + s / 2 for l, s in zip(low, size)], round(0.45 * max(extent), 2))


def level(rng, name, inner, sections):
    """A part of a pattern of cells: appended to the sections as text; what tells whether a point is inside, and extents."""
    text, in_inner, size = inner
    counts = [rng.choice((1, 2)) for _ in range(3)] if rng.random() < 0.5 else rng.choice(([1, 2, 1], [2, 1, 1], [1, 1, 3]))
    stretch = rng.choice((1, 1, 1, 1.15, 0.93))
    steps = [d if stretch == 1 else round(stretch * d, 3) for d in size]
    is_clipped = rng.random() < 0.25
    statements, back = instructions(rng)
    sections["unitCells"] += (f'<unitCell id="u{name}"{" clipToBox=" + chr(34) + "true" + chr(34) if is_clipped else ""}>'
                              f'<box x="0" y="0" z="0" dx="{size[0]}" dy="{size[1]}" dz="{size[2]}"/>{text}</unitCell>')
    sections["patterns"] += f'<pattern id="q{name}" unitCell="u{name}">{loops(counts, (0, 0, 0), steps)}{statements}</pattern>'
    extent = [(c - 1) * s + d for c, s, d in zip(counts, steps, size)]
    places = [[n * s for n, s in zip(index, steps)] for index in itertools.product(*map(range, counts))]
    operation = rng.choice(("union", "union", "intersection", "intersection", "difference"))
    alone = operation == "union" and rng.random() < 0.8
    body = None if alone else body_of(rng, extent)
    if body:
        sections["macrostructures"] += f'<macrostructure id="m{name}"><csg>{body[0]}</csg></macrostructure>'
    macro = f' macrostructure="m{name}"' if body else ""
    sections["parts"] += f'<part id="{name}"{macro}><apply pattern="q{name}" operation="{operation}"/></part>'

    def in_cells(p):
        for at in places:
            q = back([x - a for x, a in zip(p, at)])
            if (not is_clipped or all(0 <= x <= d for x, d in zip(q, size))) and in_inner(q):
                return True
        return False
    inside = {"union": lambda p: body is not None and body[1](p) or in_cells(p),
              "intersection": lambda p: body[1](p) and in_cells(p),
              "difference": lambda p: body[1](p) and not in_cells(p)}[operation]
    return f'<part ref="{name}"/>', inside, extent


def nested(rng, *_):
    sections = {"macrostructures": "", "unitCells": "", "patterns": "", "parts": ""}
    made = leaf(rng)
    for name in rng.choice(("ca", "dca", "ca")):
        made = level(rng, name, made, sections)
    radius = 2 * math.hypot(*made[2]) + 5
    text = "".join(f"<{name}>{content}</{name}>" for name, content in sections.items() if content)
    return (f'<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">{text}</meso>', made[1], ([-radius] * 3, [radius] * 3))
