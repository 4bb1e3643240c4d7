#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Random parts against a second opinion: points and volumes from the definitions alone, no geometry kernel.

usage: membership.py --meso PATH [--count 40] [--seed 1] [--kind NAME] [--keep FOLDER]

Each document is written together with a function that says which points are inside. `meso verify` then answers for
some points away from the boundary, and for the volume, which is compared with the share of a jittered grid of points
that are inside (4 standard deviations). A part that `meso` refuses with a diagnostic is counted, a wrong one fails.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

GRID = 26  # points along each edge of the bounding box
SAMPLES = 24
CLEAR_MM = 0.2  # samples stay this far from the boundary: the mesh that answers them is this coarse
REFUSALS = {4, 5, 6}  # exit codes: not realised, geometry failed, limit


# ---- shapes: text and membership --------------------------------------------------------------------------------

def box(corner, size):
    (x, y, z), (dx, dy, dz) = corner, size
    text = f'<box x="{x}" y="{y}" z="{z}" dx="{dx}" dy="{dy}" dz="{dz}"/>'
    return text, lambda p: x <= p[0] <= x + dx and y <= p[1] <= y + dy and z <= p[2] <= z + dz


def sphere(c, r):
    return f'<sphere x="{c[0]}" y="{c[1]}" z="{c[2]}" radius="{r}"/>', lambda p: math.dist(p, c) <= r


def ellipsoid(c, radii):
    text = f'<ellipsoid x="{c[0]}" y="{c[1]}" z="{c[2]}" rx="{radii[0]}" ry="{radii[1]}" rz="{radii[2]}"/>'
    return text, lambda p: sum(((a - b) / r) ** 2 for a, b, r in zip(p, c, radii)) <= 1


def in_frustum(p, a, b, ra, rb):
    axis = [v - u for u, v in zip(a, b)]
    length2 = sum(v * v for v in axis)
    t = sum((q - u) * v for q, u, v in zip(p, a, axis)) / length2
    if not 0 <= t <= 1:
        return False
    return math.dist(p, [u + t * v for u, v in zip(a, axis)]) <= ra + t * (rb - ra)


def cone(a, b, ra, rb):
    ends = f'x1="{a[0]}" y1="{a[1]}" z1="{a[2]}" x2="{b[0]}" y2="{b[1]}" z2="{b[2]}"'
    text = f'<cylinder {ends} radius="{ra}"/>' if ra == rb else f'<cone {ends} radius1="{ra}" radius2="{rb}"/>'
    return text, lambda p: in_frustum(p, a, b, ra, rb)


def torus(c, axis, major, minor):
    text = (f'<torus x="{c[0]}" y="{c[1]}" z="{c[2]}" ax="{axis[0]}" ay="{axis[1]}" az="{axis[2]}" '
            f'majorRadius="{major}" minorRadius="{minor}"/>')
    norm = math.hypot(*axis)

    def inside(p):
        d = [u - v for u, v in zip(p, c)]
        along = sum(u * v for u, v in zip(d, axis)) / norm
        return math.hypot(math.sqrt(max(0.0, sum(u * u for u in d) - along * along)) - major, along) <= minor
    return text, inside


def extrusion(points, z, height):
    corners = "".join(f'<point x="{x}" y="{y}"/>' for x, y in points)

    def inside(p):
        if not z <= p[2] <= z + height:
            return False
        odd = False
        for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1]):
            if (ay > p[1]) != (by > p[1]) and p[0] < ax + (p[1] - ay) * (bx - ax) / (by - ay):
                odd = not odd
        return odd
    return f'<extrusion z="{z}" height="{height}">{corners}</extrusion>', inside


def wedge(c, size, top, top_size):
    """Between two rectangles: at each height a rectangle whose corner and size are on straight lines."""
    text = (f'<wedge x="{c[0]}" y="{c[1]}" z="{c[2]}" dx="{size[0]}" dy="{size[1]}" dz="{size[2]}" topX="{top[0]}" topY="{top[1]}" '
            f'topDx="{top_size[0]}" topDy="{top_size[1]}"/>')

    def inside(p):
        t = (p[2] - c[2]) / size[2]
        return 0 <= t <= 1 and all(0 <= p[i] - c[i] - t * top[i] <= size[i] + t * (top_size[i] - size[i]) for i in (0, 1))
    return text, inside


def revolution(points):
    profile = extrusion(points, -1, 2)[1]
    corners = "".join(f'<point r="{r}" z="{z}"/>' for r, z in points)
    return f"<revolution>{corners}</revolution>", lambda p: profile([math.hypot(p[0], p[1]), p[2], 0])


def pyramid_star(c, radii, height):
    """Two pyramids, up and down, over a star-shaped polygon about c: at each height a smaller star."""
    n = len(radii)
    ring = [(round(r * math.cos(2 * math.pi * k / n), 4), round(r * math.sin(2 * math.pi * k / n), 4)) for k, r in enumerate(radii)]
    vertices = [(c[0] + x, c[1] + y, c[2]) for x, y in ring] + [(c[0], c[1], c[2] + height), (c[0], c[1], c[2] - height)]
    faces = [(k, (k + 1) % n, n) for k in range(n)] + [((k + 1) % n, k, n + 1) for k in range(n)]
    text = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in vertices)
    text += "".join(f'<face vertices="{", ".join(map(str, f))}"/>' for f in faces)
    star = extrusion(ring, -1, 2)[1]

    def inside(p):
        t = 1 - abs(p[2] - c[2]) / height
        return t > 0 and star([(p[0] - c[0]) / t, (p[1] - c[1]) / t, 0])
    return f"<polyhedron>{text}</polyhedron>", inside


def rotation(axis, angle):
    n = math.hypot(*axis)
    x, y, z = (v / n for v in axis)
    c, s = math.cos(angle), math.sin(angle)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def turned(shape, axis, angle):
    m = rotation(axis, -angle)
    text = f'<rotate x="{axis[0]}" y="{axis[1]}" z="{axis[2]}" angle="{angle}">{shape[0]}</rotate>'
    return text, lambda p: shape[1]([sum(a * b for a, b in zip(row, p)) for row in m])


def moved(shape, by):
    text = f'<translate x="{by[0]}" y="{by[1]}" z="{by[2]}">{shape[0]}</translate>'
    return text, lambda p: shape[1]([a - b for a, b in zip(p, by)])


def scaled(shape, by):
    text = f'<scale x="{by[0]}" y="{by[1]}" z="{by[2]}">{shape[0]}</scale>'
    return text, lambda p: shape[1]([a / b for a, b in zip(p, by)])


def boolean(name, shapes):
    tests = [s[1] for s in shapes]
    inside = {"union": lambda p: any(t(p) for t in tests),
              "intersection": lambda p: all(t(p) for t in tests),
              "difference": lambda p: tests[0](p) and not any(t(p) for t in tests[1:])}[name]
    return f"<{name}>{''.join(s[0] for s in shapes)}</{name}>", inside


# ---- documents --------------------------------------------------------------------------------------------------

def document(macro, rest="", apply=""):
    """Sections around a part `a`, with a place for its validation values."""
    macros = f'<macrostructures><macrostructure id="m"><csg>{macro}</csg></macrostructure></macrostructures>' if macro else ""
    return (f'<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">\n{macros}\n{rest}\n'
            f'<parts><part id="a"{" macrostructure=" + chr(34) + "m" + chr(34) if macro else ""}>{apply}@VALIDATION@</part></parts>\n</meso>\n')


def loops(counts, starts, steps):
    return "".join(f'<loop index="{i}" axis="{a}" count="{n}" start="{s}" spacing="{d}"/>'
                   for i, a, n, s, d in zip("ijk", "xyz", counts, starts, steps))


def number(rng, low, high):
    return round(rng.uniform(low, high), rng.choice((1, 2, 4)))


def place(rng, reach):
    return [number(rng, -reach, reach) for _ in range(3)]


def random_primitive(rng):
    kind = rng.randrange(7)
    if kind == 0:
        return box(place(rng, 4), [number(rng, 2, 7) for _ in range(3)])
    if kind == 1:
        return sphere(place(rng, 4), number(rng, 1.5, 4))
    if kind == 2:
        return ellipsoid(place(rng, 3), [number(rng, 1.5, 4) for _ in range(3)])
    if kind in (3, 4):
        a = place(rng, 4)
        b = [u + rng.choice((-1, 1)) * number(rng, 1, 5) for u in a]
        r = number(rng, 1, 3)
        return cone(a, b, r, r if kind == 3 else rng.choice((0, number(rng, 0.5, 3.5))))
    if kind == 5:
        return torus(place(rng, 3), rng.choice(([0, 0, 1], [1, 2, 3], [1, 0, 0])), number(rng, 2.5, 4), number(rng, 0.8, 2))
    corners = sorted(rng.uniform(0, 2 * math.pi) for _ in range(rng.randrange(3, 7)))
    if any((b - a) % (2 * math.pi) > 2.8 for a, b in zip(corners, corners[1:] + corners[:1])):
        corners = [0.1, 2.2, 4.4]
    points = [(round(5 * math.cos(t), 3), round(4 * math.sin(t), 3)) for t in corners]
    return extrusion(points, number(rng, -4, 0), number(rng, 2, 6))


def random_faced(rng):
    kind = rng.randrange(3)
    if kind == 0:
        return wedge(place(rng, 4), [number(rng, 3, 7) for _ in range(3)], [number(rng, -1, 3) for _ in range(2)],
                     [rng.choice((0, number(rng, 0.5, 5))) for _ in range(2)])
    if kind == 1:
        inner = rng.choice((0, 0, number(rng, 0.5, 2)))
        outer = [number(rng, 3, 6) for _ in range(3)]
        return revolution([(inner, -4), (outer[0], -4), (outer[1], number(rng, -2, 0)), (outer[2], number(rng, 1, 4)), (inner, 4.5)])
    return pyramid_star(place(rng, 3), [number(rng, 2, 6) for _ in range(rng.randrange(4, 8))], number(rng, 2, 6))


def faced(rng):
    """Wedges, revolutions and polyhedra, alone or with another body, turned or stretched."""
    shape = random_faced(rng)
    if rng.random() < 0.7:
        shape = boolean(rng.choice(("union", "difference", "intersection")), [shape, rng.choice((random_faced, random_primitive))(rng)])
    change = rng.randrange(3)
    if change == 1:
        shape = turned(shape, place(rng, 3)[:2] + [1], number(rng, -3, 3))
    if change == 2:
        shape = scaled(shape, [number(rng, 0.6, 1.5) for _ in range(3)])
    return document(shape[0]), shape[1], ([-20] * 3, [20] * 3)


def random_tree(rng, depth):
    if depth == 0 or rng.random() < 0.2:
        return random_primitive(rng)
    kind = rng.randrange(7)
    if kind == 0:
        return turned(random_tree(rng, depth - 1), place(rng, 3)[:2] + [1], number(rng, -3, 3))
    if kind == 1:
        return moved(random_tree(rng, depth - 1), place(rng, 2))
    if kind == 2:
        return scaled(random_tree(rng, depth - 1), [number(rng, 0.6, 1.5) for _ in range(3)])
    name = ("union", "difference", "difference", "intersection")[kind - 3]
    return boolean(name, [random_tree(rng, depth - 1) for _ in range(rng.randrange(2, 4))])


def csg(rng):
    shape = random_tree(rng, 3)
    return document(shape[0]), shape[1], ([-16] * 3, [16] * 3)


TRUSSES = {
    "bcc": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1), (.5, .5, .5)],
            [(8, i) for i in range(8)]),
    "cubic": ([(.5, .5, .5), (0, .5, .5), (1, .5, .5), (.5, 0, .5), (.5, 1, .5), (.5, .5, 0), (.5, .5, 1)], [(0, i) for i in range(1, 7)]),
    "edges": ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1), (0, 2), (0, 3)]),
    "half": ([(0, 0, 0), (.5, .5, .5), (1, 1, 1)], [(0, 1), (1, 2)]),
    "octet": ([(0, 0, 0), (.5, .5, 0), (.5, 0, .5), (0, .5, .5)], [(0, 1), (0, 2), (0, 3), (1, 2), (2, 3), (3, 1)]),
    "faces": ([(0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)], [(0, 1), (0, 2), (0, 3)]),
}


def truss(rng, size, factor=1):
    """A random cell of beams: text, and a list of membership tests with their boxes, all radii times the factor."""
    nodes, beams = TRUSSES[rng.choice(sorted(TRUSSES))]
    at = [[round(u * s, 6) for u, s in zip(n, size)] for n in nodes]
    short = min(size)
    radius = number(rng, 0.06 * short, 0.16 * short)
    ball = rng.choice((None, round(radius * rng.uniform(1.05, 1.7), 3)))
    cap = rng.choice(("sphere", "butt", "sphere")) if ball is None else rng.choice(("butt", "sphere"))
    text, tests = "", []
    for i, n in enumerate(at):
        text += f'<node id="n{i}" x="{n[0]}" y="{n[1]}" z="{n[2]}"/>'
        if ball:
            tests.append((lambda p, n=n: math.dist(p, n) <= factor * ball, n, n, factor * ball))
    conical = rng.random() < 0.25
    for a, b in beams:
        r1 = radius
        r2 = round(radius * 0.7, 4) if conical else radius
        text += f'<beam from="n{a}" to="n{b}"' + (f' radius2="{r2}"' if conical else "") + "/>"
        u, v, ra, rb = at[a], at[b], factor * r1, factor * r2
        tests.append((lambda p, u=u, v=v, ra=ra, rb=rb: in_frustum(p, u, v, ra, rb), u, v, max(ra, rb)))
        if cap == "sphere":
            tests.append((lambda p, u=u, ra=ra: math.dist(p, u) <= ra, u, u, ra))
            tests.append((lambda p, v=v, rb=rb: math.dist(p, v) <= rb, v, v, rb))
    attributes = f'radius="{radius}" cap="{cap}"' + (f' nodeRadius="{ball}"' if ball else "")
    boxed = [(t, [min(x, y) - r for x, y in zip(u, v)], [max(x, y) + r for x, y in zip(u, v)]) for t, u, v, r in tests]
    return f"<beams {attributes}>{text}</beams>", boxed


def in_boxed(boxed, p):
    return any(all(l <= x <= h for l, x, h in zip(low, p, high)) and t(p) for t, low, high in boxed)


def in_lattice(boxed, size, starts, counts, p, clipped):
    """p in the union of the cells: those whose parts can reach it."""
    at = [(x - s) / d for x, s, d in zip(p, starts, size)]
    reach = 0 if clipped else 1
    for i in range(math.floor(at[0]) - reach, math.floor(at[0]) + reach + 1):
        for j in range(math.floor(at[1]) - reach, math.floor(at[1]) + reach + 1):
            for k in range(math.floor(at[2]) - reach, math.floor(at[2]) + reach + 1):
                if not all(0 <= n < c for n, c in zip((i, j, k), counts)):
                    continue
                if in_boxed(boxed, [x - s - n * d for x, s, n, d in zip(p, starts, (i, j, k), size)]):
                    return True
    return False


def cell_section(body, size, clip, corner=(0, 0, 0)):
    clip_text = ' clipToBox="true"' if clip else ""
    return (f'<unitCells><unitCell id="u"{clip_text}><box x="{corner[0]}" y="{corner[1]}" z="{corner[2]}" dx="{size[0]}" dy="{size[1]}" dz="{size[2]}"/>'
            f"{body}</unitCell></unitCells>")


def aligned_body(rng, size, starts, counts):
    """A body on planes of the cells, somewhere among them."""
    kind = rng.randrange(4)
    first = [rng.randrange(0, max(1, c)) if kind else 0 for c in counts]
    first = [min(f, c - 1) for f, c in zip(first, counts)]
    last = [rng.randrange(f + 1, c + 1) if kind else c for f, c in zip(first, counts)]
    low = [s + f * d for s, f, d in zip(starts, first, size)]
    extent = [(l - f) * d for l, f, d in zip(last, first, size)]
    whole = box(low, extent)
    if kind < 2 or any(l - f < 2 for l, f in zip(last, first)):
        return whole
    if kind == 2:  # an L
        (x, y), (X, Y) = low[:2], [a + b for a, b in zip(low[:2], extent[:2])]
        cx, cy = x + size[0], y + size[1]
        return extrusion([(x, y), (X, y), (X, cy), (cx, cy), (cx, Y), (x, Y)], low[2], extent[2])
    hole = [low[0] + size[0], low[1], low[2] + size[2]]
    return boolean("difference", [whole, box(hole, size)])


def lattice(rng):
    size = [rng.choice((4, 5, 3.3, 10 / 3, 6))] * 3 if rng.random() < 0.4 else [number(rng, 3, 6) for _ in range(3)]
    counts = [rng.randrange(1, 4) for _ in range(3)]
    starts = [rng.choice((0, number(rng, -5, 5))) for _ in range(3)]
    body, boxed = truss(rng, size)
    macro = aligned_body(rng, size, starts, counts)
    rest = cell_section(body, size, False) + f'<patterns><pattern id="p" unitCell="u">{loops(counts, starts, size)}</pattern></patterns>'
    text = document(macro[0], rest, '<apply pattern="p" operation="intersection"/>')
    high = [s + c * d for s, c, d in zip(starts, counts, size)]
    return text, lambda p: macro[1](p) and in_lattice(boxed, size, starts, counts, p, False), (starts, high)


def clipped(rng):
    size = [number(rng, 3, 6) for _ in range(3)]
    counts = [rng.randrange(1, 4) for _ in range(3)]
    starts = [number(rng, -5, 5) for _ in range(3)]
    high = [s + c * d for s, c, d in zip(starts, counts, size)]
    if rng.random() < 0.6:
        body, boxed = truss(rng, size)
    else:
        centre = [d / 2 for d in size]
        ball = sphere(centre, round(rng.uniform(0.3, 0.62) * min(size), 3))
        solid = rng.choice((ball, boolean("difference", [box((0, 0, 0), size), ball]),
                            boolean("union", [ball, cone([-1, *centre[1:]], [size[0] + 1, *centre[1:]], 0.6, 0.6)])))
        body, boxed = f"<csg>{solid[0]}</csg>", [(solid[1], [-99] * 3, [99] * 3)]
    rest = cell_section(body, size, True) + f'<patterns><pattern id="p" unitCell="u">{loops(counts, starts, size)}</pattern></patterns>'
    text = document("", rest, '<apply pattern="p" operation="union"/>')
    return text, lambda p: in_lattice(boxed, size, starts, counts, p, True), (starts, high)


def boundary(rng):
    """Few balls, boxes or cylinders through the surface of a body, under every operation and rule."""
    extent = [number(rng, 6, 12) for _ in range(3)]
    macro = box((0, 0, 0), extent)
    centre_m, radius_m = [e / 2 for e in extent], min(extent) / 2 + 1
    round_body = rng.random() < 0.3
    if round_body:
        macro = sphere(centre_m, radius_m)
    counts = [rng.randrange(1, 4) for _ in range(3)]
    steps = [rng.choice((number(rng, 2, 5), 3)) for _ in range(3)]
    starts = [number(rng, -2, 3) for _ in range(3)]
    size = [number(rng, 1.5, 4) for _ in range(3)]
    kind = rng.randrange(3)
    shape = {0: box((0, 0, 0), size), 1: sphere([d / 2 for d in size], round(min(size) / 2, 3)),
             2: cone([0, size[1] / 2, size[2] / 2], [size[0], size[1] / 2, size[2] / 2], *[round(min(size[1:]) / 2, 3)] * 2)}[kind]
    operation = rng.choice(("difference", "intersection", "union"))
    rule = {"difference": ("clip", "clip", "dropPartial"), "intersection": ("clip", "dropPartial", "keepWhole"), "union": ("clip",)}[operation]
    rule = rng.choice(rule)
    places = [[s + n * d for s, n, d in zip(starts, (i, j, k), steps)]
              for i in range(counts[0]) for j in range(counts[1]) for k in range(counts[2])]

    def chosen(at):
        corners = [[a + d * (n >> e & 1) for e, (a, d) in enumerate(zip(at, size))] for n in range(8)]
        if rule == "dropPartial":
            return all(macro[1](c) for c in corners)
        nearest = [min(max(m, a), a + d) for m, a, d in zip(centre_m, at, size)]
        if round_body:
            return math.dist(nearest, centre_m) < radius_m
        return all(a < e and a + d > 0 for a, d, e in zip(at, size, extent))
    cells = [a for a in places if rule == "clip" or chosen(a)]

    def inside(p):
        in_cells = any(shape[1]([x - a for x, a in zip(p, at)]) for at in cells)
        if operation == "difference":
            return macro[1](p) and not in_cells
        if operation == "union":
            return macro[1](p) or in_cells
        return in_cells and (rule != "clip" or macro[1](p))
    rest = cell_section(f"<csg>{shape[0]}</csg>", size, False)
    rest += f'<patterns><pattern id="p" unitCell="u">{loops(counts, starts, steps)}</pattern></patterns>'
    rule_text = f' boundary="{rule}"' if rule != "clip" else ""
    text = document(macro[0], rest, f'<apply pattern="p" operation="{operation}"{rule_text}/>')
    return text, inside, ([-4] * 3, [18] * 3)


def sectors(rng):
    """Polar cells in a disk: their product of ranges is exact by definition."""
    rings, parts, layers = rng.randrange(1, 4), rng.choice((1, 2, 3, 5, 8)), rng.randrange(1, 3)
    inner, step, height = rng.choice((0, number(rng, 1, 4))), number(rng, 2, 4), number(rng, 2, 4)
    start, angle = number(rng, -3, 3), round(rng.uniform(0.2, 2 * math.pi / parts), 6)
    if rng.random() < 0.4:
        angle = 2 * math.pi / parts  # all round
    wall = rng.choice((0, 0.05, 0.2, 0.3))
    corner, edge = [wall] * 3, [round(1 - 2 * wall, 3)] * 3
    outer = inner + rings * step + rng.choice((-1, 0, 1))
    macro = cone([0, 0, 0], [0, 0, layers * height + rng.choice((0, 1))], outer, outer)
    operation = rng.choice(("difference", "intersection", "union"))

    def in_cells(p):
        r, phi = math.hypot(p[0], p[1]), math.atan2(p[1], p[0])
        u, w = (r - inner) / step, p[2] / height
        v = ((phi - start) % (2 * math.pi)) / angle
        if not (0 <= u <= rings and 0 <= v <= parts and 0 <= w <= layers):
            return False
        return all(wall <= t - math.floor(t) <= 1 - wall for t in (u, v, w))
    inside = {"difference": lambda p: macro[1](p) and not in_cells(p), "intersection": lambda p: macro[1](p) and in_cells(p),
              "union": lambda p: macro[1](p) or in_cells(p)}[operation]
    rest = ('<coordinateSystems><coordinateSystem id="c"><axis name="r" kind="distance" x="1"/><axis name="t" kind="circular" z="1"/>'
            '<axis name="h" kind="linear" z="1"/></coordinateSystem></coordinateSystems>'
            + cell_section(f"<csg>{box(corner, edge)[0]}</csg>", (1, 1, 1), False)
            + '<patterns><pattern id="p" unitCell="u" coordinateSystem="c" mapping="conformal">'
            + f'<loop index="i" axis="r" count="{rings}" start="{inner}" spacing="{step}"/>'
            + f'<loop index="j" axis="t" count="{parts}" start="{start}" spacing="{angle!r}"/>'
            + f'<loop index="k" axis="h" count="{layers}" spacing="{height}"/></pattern></patterns>')
    reach = inner + rings * step + 1.5
    text = document(macro[0], rest, f'<apply pattern="p" operation="{operation}"/>')
    return text, inside, ([-reach, -reach, -0.5], [reach, reach, layers * height + 1.5])


def graded(rng):
    """Beams whose radius grows with the index, cells that turn and grow: few cells, a body through them."""
    size = [number(rng, 4, 6) for _ in range(3)]
    counts = [rng.randrange(1, 3), rng.randrange(1, 3), 1]
    step, base = round(rng.uniform(0.03, 0.1), 3), number(rng, 0.3, 0.5)
    angle, factor = rng.choice((0, number(rng, 0.1, 1))), rng.choice((1, number(rng, 0.7, 1)))
    centre = [d / 2 for d in size]
    ends = [[0.5, *centre[1:]], [size[0] - 0.5, *centre[1:]], [centre[0], 0.5, centre[2]], [*centre[:2], size[2] - 0.5]]
    nodes = [centre, *ends]
    text = "".join(f'<node id="n{i}" x="{n[0]}" y="{n[1]}" z="{n[2]}"/>' for i, n in enumerate(nodes))
    text += "".join(f'<beam from="n0" to="n{i}"/>' for i in range(1, 5))
    body = f'<parameter id="t" value="{base}"/><box dx="{size[0]}" dy="{size[1]}" dz="{size[2]}"/><beams radius="t" nodeRadius="1.4*t">{text}</beams>'
    statements = f'<set parameter="t" value="{base}+{step}*(i+j)"/>'
    if angle:
        statements += f'<rotate x="0" y="0" z="1" angle="{angle}*i"/>'
    if factor != 1:
        statements += f'<scale factor="{factor}"/>'
    rest = (f'<unitCells><unitCell id="u">{body}</unitCell></unitCells>'
            f'<patterns><pattern id="p" unitCell="u">{loops(counts, (0, 0, 0), size)}{statements}</pattern></patterns>')
    corner = [number(rng, -1, 1) for _ in range(3)]
    macro = box(corner, [c * d - 0.5 for c, d in zip(counts, size)])

    def inside(p):
        if not macro[1](p):
            return False
        for i in range(counts[0]):
            back = rotation([0, 0, 1], -angle * i)
            for j in range(counts[1]):
                r = base + step * (i + j)
                d = [p[0] - i * size[0], p[1] - j * size[1], p[2]]
                q = [sum(a * b for a, b in zip(row, d)) / factor for row in back]
                if math.dist(q, centre) <= 1.4 * r or any(math.dist(q, e) <= 1.4 * r or in_frustum(q, centre, e, r, r) for e in ends):
                    return True
        return False
    low = [c - 0.01 for c in corner]
    high = [a + c * d for a, c, d in zip(corner, counts, size)]
    return document(macro[0], rest, '<apply pattern="p" operation="intersection"/>'), inside, (low, high)


KINDS = {f.__name__: f for f in (csg, lattice, clipped, boundary, sectors, graded, faced)}


# ---- comparison -------------------------------------------------------------------------------------------------

def estimate(rng, inside, low, high):
    """Volume inside a box by one random point in each cell of a grid, and its standard deviation from above."""
    state = {}
    edge = [(h - l) / GRID for l, h in zip(low, high)]
    for i in range(GRID):
        for j in range(GRID):
            for k in range(GRID):
                p = [l + (n + rng.random()) * e for l, n, e in zip(low, (i, j, k), edge)]
                state[i, j, k] = inside(p)
    mixed = sum(any(state.get(n) not in (None, s) for n in ((i + 1, j, k), (i, j + 1, k), (i, j, k + 1), (i - 1, j, k), (i, j - 1, k), (i, j, k - 1)))
                for (i, j, k), s in state.items())
    cell = math.prod(edge)
    return cell * sum(state.values()), cell * (0.5 * math.sqrt(mixed) + 1), [k for k, s in state.items() if s], edge


def tight(rng, inside, low, high):
    """The box of what is inside, with room."""
    _, _, hits, edge = estimate(rng, inside, low, high)
    if not hits:
        return None
    return ([l + (min(h[a] for h in hits) - 1) * edge[a] for a, l in enumerate(low)],
            [l + (max(h[a] for h in hits) + 2) * edge[a] for a, l in enumerate(low)])


def clear_samples(rng, inside, low, high):
    around = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
    out = []
    for _ in range(40 * SAMPLES):
        p = [round(rng.uniform(l, h), 3) for l, h in zip(low, high)]
        state = inside(p)
        wanted = sum(s == state for _, s in out) < SAMPLES // 2
        if wanted and all(inside([u + CLEAR_MM * v for u, v in zip(p, d)]) == state for d in around):
            out.append((p, state))
    return out


def judge(meso, file):
    done = subprocess.run([meso, "verify", str(file), "--part", "a", "--json", "--timeout", "60"], capture_output=True, text=True)
    return done.returncode, json.loads(done.stdout) if done.stdout.strip() else {}, done.stderr


def run_one(meso, kind, seed, folder):
    """('ok' | 'refused' | 'wrong' | 'empty', words)"""
    rng = random.Random(f"{kind} {seed}")
    text, inside, (low, high) = KINDS[kind](rng)
    tightened = tight(rng, inside, low, high)
    if tightened is None:
        return "empty", ""
    volume, deviation, _, _ = estimate(rng, inside, *tightened)
    samples = clear_samples(rng, inside, *tightened)
    stated = "".join(f'<sample x="{p[0]}" y="{p[1]}" z="{p[2]}" inside="{"true" if s else "false"}"/>' for p, s in samples)
    file = pathlib.Path(folder) / f"{kind}_{seed}.meso"
    file.write_text(text.replace("@VALIDATION@", f'<validation><volume value="{volume!r}" tolerance="1"/>{stated}</validation>'), encoding="utf-8")
    code, report, told = judge(meso, file)
    if code in REFUSALS:
        return "refused", told.strip().splitlines()[0]
    if "volume" not in report:
        return "wrong", f"exit code {code}: {told.strip()[:300]}"
    failed = [c["what"] for c in report["checks"] if not c["passed"] and c["what"] != "volume"]
    if failed:
        return "wrong", f"failed: {failed}"
    if abs(report["volume"] - volume) > 4 * deviation:
        return "wrong", f"volume {report['volume']:.6g}, expected {volume:.6g} +- {deviation:.2g}"
    return "ok", ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--count", type=int, default=40, help="documents in all")
    parser.add_argument("--seed", type=int, default=1, help="of the first document")
    parser.add_argument("--kind", choices=sorted(KINDS), action="append")
    parser.add_argument("--keep", help="a folder for the documents")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    kinds = a.kind or list(KINDS)
    total = {"ok": 0, "refused": 0, "wrong": 0, "empty": 0}
    with tempfile.TemporaryDirectory() as temporary:
        folder = a.keep or temporary
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        for n in range(a.count):
            kind, seed = kinds[n % len(kinds)], a.seed + n // len(kinds)
            verdict, words = run_one(a.meso, kind, seed, folder)
            total[verdict] += 1
            if verdict == "wrong" or a.verbose or a.keep and verdict == "refused":
                print(f"{verdict} {kind} {seed} {words}", flush=True)
    print(", ".join(f"{v} {k}" for k, v in total.items()))
    sys.exit(1 if total["wrong"] or not total["ok"] else 0)


if __name__ == "__main__":
    main()
