# SPDX-License-Identifier: Apache-2.0
"""Random trusses bent into tubes and balls, and blocks whose struts grow from node to node: documents for random_parts.py."""
import itertools
import math

from membership import TRUSSES, document, in_frustum, number

SYSTEMS = {
    "polar": ('<axis name="u" kind="distance" x="1"/><axis name="v" kind="circular" z="1"/><axis name="w" kind="linear" z="1"/>',
              lambda r, phi, h: [r * math.cos(phi), r * math.sin(phi), h]),
    "spherical": ('<axis name="u" kind="distance" x="1"/><axis name="v" kind="circular" z="1"/><axis name="w" kind="circular" y="-1"/>',
                  lambda r, phi, psi: [r * math.cos(psi) * math.cos(phi), r * math.cos(psi) * math.sin(phi), r * math.sin(psi)]),
}


def struts_inside(place, counts, beams, radius):
    """In a strut of the smallest radius that any has, which no ball makes smaller; and the box of all nodes."""
    ends = [[place(index, n) for n in beam] for index in itertools.product(*map(range, counts)) for beam in beams]
    nodes = [p for pair in ends for p in pair]
    where = [min(p[i] for p in nodes) - radius for i in range(3)], [max(p[i] for p in nodes) + radius for i in range(3)]
    return lambda p: any(in_frustum(p, a, b, radius, radius) for a, b in ends), where


def random_ball(rng, radius):
    """Balls as small as they can be, a little larger, or none but the struts' own round ends."""
    return rng.choice(("auto", "auto", "auto", str(round(2.5 * radius, 3)), None))


def truss_text(nodes, beams, radius, ball):
    return (f'<parameter id="r" value="{radius}"/><box dx="1" dy="1" dz="1"/><beams radius="r"' + (f' nodeRadius="{ball}"' if ball else "") + ">" +
            "".join(f'<node id="n{i}" x="{x}" y="{y}" z="{z}"/>' for i, (x, y, z) in enumerate(nodes)) +
            "".join(f'<beam from="n{a}" to="n{b}"/>' for a, b in beams) + "</beams>")


def grown(rng, radius, length):
    """How much struts grow with the place and whether at nodes or by cells, the statement, and the smallest radius that it leaves."""
    if rng.random() < 0.5:
        return (0, "cell"), "", radius
    slope, where = round(0.2 * radius / length, 5), rng.choice(("node", "cell"))
    return (slope, where), f'<set parameter="r" value="{radius} + {slope}*global.x" at="{where}"/>', 0.7 * radius


def bent_truss(rng, *_):
    made = bent(rng)
    return made and made[:3]


def grown_truss(rng, *_):
    return straight(rng)[:3]


def bent(rng):
    """A document, what is inside, a box to look in, and the struts as truss_volume.py takes them; or None."""
    nodes, beams = TRUSSES[rng.choice(sorted(TRUSSES))]
    system = rng.choice(sorted(SYSTEMS))
    axes, mapped = SYSTEMS[system]
    around = rng.randrange(5, 13)
    angle = 360 / around
    inner, step = number(rng, 8, 14), number(rng, 3, 5)
    if system == "polar":
        counts = [rng.randrange(1, 3), rng.choice((around, 3)), rng.randrange(1, 3)]
        start, spacing, degrees = [inner, 0, number(rng, -2, 2)], [step, angle, number(rng, 3, 5)], [False, True, False]
    else:
        rings = rng.randrange(1, 4)
        counts = [1, rng.choice((around, 3)), rings]
        lowest = rng.choice((-90, number(rng, -60, -20)))  # beams may end in a pole
        start, spacing, degrees = [inner, 0, lowest], [step, angle, 30], [False, True, True]

    def place(index, node):
        at = [s + d * (i + u) for s, d, i, u in zip(start, spacing, index, node)]
        return mapped(*(math.radians(x) if is_angle else x for x, is_angle in zip(at, degrees)))
    ends = [[nodes[a], nodes[b]] for a, b in beams]
    shortest = min(math.dist(*(place(index, n) for n in beam)) for index in itertools.product(*map(range, counts)) for beam in ends)
    if shortest < 0.5:
        return None  # on a pole
    radius = round(shortest * rng.uniform(0.04, 0.09), 3)
    growth, statement, least = grown(rng, radius, inner + 3 * step)
    inside, where = struts_inside(place, counts, ends, least)
    words = [f"{s}deg" if is_angle else str(s) for s, is_angle in zip(start, degrees)], [f"{s}deg" if is_angle else str(s) for s, is_angle in zip(spacing, degrees)]
    ball = random_ball(rng, radius)
    loops = "".join(f'<loop index="{i}" axis="{a}" count="{n}" start="{s}" spacing="{d}"/>' for i, a, n, s, d in zip("ijk", "uvw", counts, *words))
    rest = (f'<coordinateSystems><coordinateSystem id="s">{axes}</coordinateSystem></coordinateSystems>'
            f'<unitCells><unitCell id="u">{truss_text(nodes, beams, radius, ball)}</unitCell></unitCells>'
            f'<patterns><pattern id="p" unitCell="u" coordinateSystem="s" mapping="conformal">{loops}{statement}</pattern></patterns>')
    struts = dict(nodes=nodes, beams=beams, place=place, counts=counts, period=(1, 1, 1), radius=radius, growth=growth, ball=ball, is_bent=True)
    return document("", rest, '<apply pattern="p" operation="union"/>'), inside, where, struts


def straight(rng):
    nodes, beams = TRUSSES[rng.choice(sorted(TRUSSES))]
    size, counts = [number(rng, 3, 6) for _ in range(3)], [rng.randrange(1, 4) for _ in range(3)]
    at = [[round(u * s, 6) for u, s in zip(n, size)] for n in nodes]
    ends = [[at[a], at[b]] for a, b in beams]
    radius = round(min(math.dist(*e) for e in ends) * rng.uniform(0.06, 0.14), 3)
    slope = round(rng.uniform(0.1, 0.5) * radius / (counts[0] * size[0]), 5)

    def place(index, n):
        return [x + i * d for x, i, d in zip(n, index, size)]
    inside, where = struts_inside(place, counts, ends, radius)
    loops = "".join(f'<loop index="{i}" axis="{a}" count="{n}" spacing="{d}"/>' for i, a, n, d in zip("ijk", "xyz", counts, size))
    ball = random_ball(rng, radius)
    cell = truss_text(at, beams, radius, ball).replace('<box dx="1" dy="1" dz="1"/>', '<box dx="{}" dy="{}" dz="{}"/>'.format(*size))
    step = rng.choice(("node", "cell"))
    rest = (f'<unitCells><unitCell id="u">{cell}</unitCell></unitCells><patterns><pattern id="p" unitCell="u">{loops}'
            f'<set parameter="r" value="{radius} + {slope}*global.x" at="{step}"/></pattern></patterns>')
    struts = dict(nodes=at, beams=beams, place=place, counts=counts, period=size, radius=radius, growth=(slope, step), ball=ball, is_bent=False)
    return document("", rest, '<apply pattern="p" operation="union"/>'), inside, where, struts
