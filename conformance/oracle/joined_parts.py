# SPDX-License-Identifier: Apache-2.0
"""Random lattices that are joined with bodies: sheets, frames, walls and balls, before and after the lattice, and what is taken away from both."""
import re

from membership import (aligned_body, boolean, box, cell_section, cone, document, in_lattice, loops, number, sphere, truss, turned)


def beside_a_plane(rng, start, size, count):
    """Two heights between which a sheet may be: on planes of the cells, within a cell, across planes, beyond the cells."""
    low = start + rng.randrange(-1, count + 1) * size + rng.choice((0, 0, round(rng.uniform(0.1, 0.9) * size, 3)))
    return low, low + rng.choice((size, 0.2 * size, 0.2 * size, round(rng.uniform(0.1, 1.7) * size, 3)))


def added_body(rng, size, starts, counts):
    low, extent = starts, [c * d for c, d in zip(counts, size)]
    middle = [s + e / 2 for s, e in zip(low, extent)]
    kind = rng.randrange(6)
    rim = rng.choice((0, 0, round(0.4 * min(size), 2), -round(0.1 * min(size), 2)))  # how far beyond the cells
    if kind < 3:  # sheets across one axis or another
        axis = rng.randrange(3)
        sheets = []
        for _ in range(rng.randrange(1, 3)):
            first, last = beside_a_plane(rng, starts[axis], size[axis], counts[axis])
            corner, extents = [s - rim for s in low], [e + 2 * rim for e in extent]
            corner[axis], extents[axis] = first, last - first
            sheets.append(box(corner, extents))
        body = boolean("union", sheets) if len(sheets) > 1 else sheets[0]
    elif kind == 3:  # a frame
        wall = rng.choice((0.2, 0.35)) * min(size)
        room = box([low[0] + wall - rim, low[1] + wall - rim, low[2] - 9],
                   [extent[0] + 2 * rim - 2 * wall, extent[1] + 2 * rim - 2 * wall, extent[2] + 18])
        body = boolean("difference", [box([s - rim for s in low], [e + 2 * rim for e in extent]), room])
    elif kind == 4:  # a tube
        radius = 0.5 * min(extent[:2]) * rng.choice((1.1, 0.8))
        ends = ([*middle[:2], low[2]], [*middle[:2], low[2] + extent[2]])
        bore = ([*middle[:2], low[2] - 1], [*middle[:2], low[2] + extent[2] + 1])
        body = boolean("difference", [cone(*ends, radius, radius), cone(*bore, radius - 0.2 * min(size), radius - 0.2 * min(size))])
    else:
        body = sphere([m + number(rng, -1, 1) for m in middle], round(rng.uniform(0.3, 0.5) * max(min(extent), min(size)), 2))
    if rng.random() < 0.2:
        body = turned(body, [number(rng, -1, 1), number(rng, -1, 1), 1], rng.choice((number(rng, -0.5, 0.5), 0.01)))
    return body


def joined(rng, *_):
    """A lattice, cut or not, and one or two bodies joined with it, by parts or as what it grows on."""
    size = [rng.choice((4, 5, 10 / 3))] * 3 if rng.random() < 0.4 else [number(rng, 3, 6) for _ in range(3)]
    counts = [rng.randrange(1, 4) for _ in range(3)]
    starts = [rng.choice((0, number(rng, -3, 3))) for _ in range(3)]
    cell, boxed = truss(rng, size)
    is_clipped = rng.random() < 0.3
    operands = [added_body(rng, size, starts, counts) for _ in range(rng.choice((1, 1, 2)))]
    names = [rng.choice(("union", "union", "union", "difference")) for _ in operands]
    way = rng.choice(("cut", "cut", "whole", "grown"))
    if way == "cut":
        if rng.random() < 0.6:
            macro = aligned_body(rng, size, starts, counts)
        else:
            macro = box([s + number(rng, -1, 1) for s in starts], [max(2, c * d + number(rng, -1, 1)) for c, d in zip(counts, size)])
    if way == "grown":
        macro = operands.pop(0)
        names.pop(0)
    elif "union" not in names:
        names[0] = "union"
    text = document(macro[0] if way != "whole" else "",
                    cell_section(cell, size, is_clipped) +
                    f'<patterns><pattern id="p" unitCell="u">{loops(counts, starts, size)}</pattern></patterns>' +
                    "<macrostructures>" + "".join(f'<macrostructure id="m{n}"><csg>{o[0]}</csg></macrostructure>' for n, o in enumerate(operands)) +
                    "</macrostructures>",
                    f'<apply pattern="p" operation="{"intersection" if way == "cut" else "union"}"/>' +
                    "".join(f'<apply part="b{n}" operation="{name}"/>' for n, name in enumerate(names)))
    bodies = "".join(f'<part id="b{n}" macrostructure="m{n}"/>' for n in range(len(operands)))
    text = re.sub("</parts>", bodies + "</parts>", text)
    if not operands:
        text = text.replace("<macrostructures></macrostructures>", "")

    def inside(p):
        is_in = in_lattice(boxed, size, starts, counts, p, is_clipped) and (
            not is_clipped or all(s <= x <= s + c * d for x, s, c, d in zip(p, starts, counts, size)))
        if way == "cut":
            is_in = is_in and macro[1](p)
        if way == "grown":
            is_in = is_in or macro[1](p)
        for (_, test), name in zip(operands, names):
            is_in = is_in or test(p) if name == "union" else is_in and not test(p)
        return is_in
    return text, inside, ([s - 9 for s in starts], [s + c * d + 9 for s, c, d in zip(starts, counts, size)])
