#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Volumes in closed form against the volumes of `meso`, integrated over the faces of the realised bodies.

usage: closed_forms.py --meso PATH [--check] [--quick] > docs/closed-forms.md

Each case is a small document that `meso convert` turns into a STEP file in a temporary folder. --check prints only
what differs by more than 1e-6 and fails then; --quick leaves out the blocks above 3^3 cells.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

LIMIT = 1e-6
PI = math.pi
HEAD = '<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">'
POLAR = ('<coordinateSystem id="c"><axis name="r" kind="distance" x="1"/><axis name="t" kind="circular" z="1"/>'
         '<axis name="h" kind="linear" z="1"/></coordinateSystem>')
SPHERICAL = ('<coordinateSystem id="c"><axis name="r" kind="distance" x="1"/><axis name="t" kind="circular" z="1"/>'
             '<axis name="h" kind="circular" y="-1"/></coordinateSystem>')


def body(csg, systems=""):
    systems = f"<coordinateSystems>{systems}</coordinateSystems>" if systems else ""
    return (f'{HEAD}{systems}<macrostructures><macrostructure id="m"><csg>{csg}</csg></macrostructure></macrostructures>'
            '<parts><part id="a" macrostructure="m"/></parts></meso>')


def cylinder(axis, radius, reach=5):
    ends = " ".join(f'{a}1="{-reach if a == axis else 0}" {a}2="{reach if a == axis else 0}"' for a in "xyz")
    return f'<cylinder {ends} radius="{radius}"/>'


def sector(kind, ranges):
    ranges = "".join(f'<range axis="{a}" from="{low}" to="{high}"/>' for a, (low, high) in zip("rth", ranges))
    return body(f'<volumeElement coordinateSystem="c">{ranges}</volumeElement>', kind)


def ball_and_strut(length, r, ball_1, ball_2=None, r_2=None):
    """Volume of a strut between the surfaces of balls at its two ends: what it adds to them. The strut is a cylinder or a
    cone from r to r_2; each ball is wide enough that the strut leaves it in a full circle."""
    ball_2, r_2 = ball_2 or ball_1, r_2 or r
    slope = (r_2 - r) / length

    def leaves(ball, start, grow):  # where the strut's skin meets the ball, measured from the ball's centre
        # (start + grow t)^2 + t^2 = ball^2
        a, b, c = 1 + grow * grow, 2 * start * grow, start * start - ball * ball
        return (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a)

    def cap(ball, h):  # of the ball, beyond the plane at distance h from its centre
        return PI * (ball - h) ** 2 * (2 * ball + h) / 3
    h_1, h_2 = leaves(ball_1, r, slope), leaves(ball_2, r_2, -slope)
    a, b = r + slope * h_1, r_2 - slope * h_2
    frustum = PI * (length - h_1 - h_2) * (a * a + a * b + b * b) / 3
    return frustum - cap(ball_1, h_1) - cap(ball_2, h_2)


def ball_volume(radius):
    return 4 * PI * radius ** 3 / 3


CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]


def body_centred(size, r, ball):
    """Cell text and volume: eight eighths of a ball, a ball, eight struts."""
    nodes = "".join(f'<node id="n{i}" x="{x * size[0]}" y="{y * size[1]}" z="{z * size[2]}"/>' for i, (x, y, z) in enumerate(CORNERS))
    nodes += f'<node id="c" x="{size[0] / 2}" y="{size[1] / 2}" z="{size[2] / 2}"/>'
    beams = "".join(f'<beam from="c" to="n{i}"/>' for i in range(8))
    text = f'<beams radius="{r}" nodeRadius="{ball}">{nodes}{beams}</beams>'
    # Struts must part within the balls, else their circles overlap.
    half = [s / 2 for s in size]
    length = math.hypot(*half)
    narrowest = min(2 * math.asin(h / length) for h in half)
    assert ball > r / math.sin(narrowest / 2), "the struts do not end in circles"
    return text, 2 * ball_volume(ball) + 8 * ball_and_strut(length, r, ball)


def lattice(cell, size, counts, clip=False, parameters="", statements=""):
    """A block of cells: cut by a macrostructure, or each cut to its box."""
    loops = "".join(f'<loop index="{i}" axis="{a}" count="{n}" spacing="{d}"/>' for i, a, n, d in zip("ijk", "xyz", counts, size))
    extent = [n * d for n, d in zip(counts, size)]
    macro = "" if clip else (f'<macrostructures><macrostructure id="m"><csg><box dx="{extent[0]}" dy="{extent[1]}" dz="{extent[2]}"/>'
                             "</csg></macrostructure></macrostructures>")
    part = '<part id="a"><apply pattern="p" operation="union"/></part>' if clip else (
        '<part id="a" macrostructure="m"><apply pattern="p" operation="intersection"/></part>')
    clip_text = ' clipToBox="true"' if clip else ""
    return (f'{HEAD}{macro}<unitCells><unitCell id="u"{clip_text}>{parameters}<box dx="{size[0]}" dy="{size[1]}" dz="{size[2]}"/>{cell}</unitCell>'
            f'</unitCells><patterns><pattern id="p" unitCell="u">{loops}{statements}</pattern></patterns><parts>{part}</parts></meso>')


def chain(count, length, radii, ball):
    """Struts end to end along x, each a cone from one radius to the next, with balls between: graded by the index."""
    text = '<node id="a" x="0" y="0" z="0"/>' + f'<node id="b" x="{length}" y="0" z="0"/>'
    cell = f'<beams radius="t" nodeRadius="{ball}"><node id="a" x="0" y="0" z="0"/><node id="b" x="{length}" y="0" z="0"/><beam from="a" to="b" radius1="t" radius2="t+g"/></beams>'
    first, grow = radii
    document = (f'{HEAD}<unitCells><unitCell id="u"><parameter id="t" value="{first}"/><parameter id="g" value="{grow}"/>{cell}</unitCell></unitCells>'
                f'<patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="{count}" spacing="{length}"/>'
                f'<set parameter="t" value="{first}+{grow}*i"/></pattern></patterns>'
                '<parts><part id="a"><apply pattern="p" operation="union"/></part></parts></meso>')
    volume = (count + 1) * ball_volume(ball)
    for i in range(count):
        volume += ball_and_strut(length, first + grow * i, ball, ball, first + grow * (i + 1))
    return document, volume


def polyhedron(vertices, faces):
    return body("<polyhedron>" + "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in vertices)
                + "".join(f'<face vertices="{", ".join(map(str, face))}"/>' for face in faces) + "</polyhedron>")


def dodecahedron(edge):
    """Corners in circular order around each of the twelve directions (0, g, 1), turned cyclically."""
    g, s = (1 + math.sqrt(5)) / 2, edge * (1 + math.sqrt(5)) / 4
    signs = (-1, 1)
    corners = [(x, y, z) for x in signs for y in signs for z in signs]
    for a in signs:
        for b in signs:
            corners += [(0, a / g, b * g), (a / g, b * g, 0), (a * g, 0, b / g)]
    faces = []
    for a in signs:
        for b in signs:
            for n in ((0, a * g, b), (a * g, b, 0), (a, 0, b * g)):
                height = [sum(u * v for u, v in zip(n, c)) for c in corners]
                face = [i for i, h in enumerate(height) if h > max(height) - 1e-9]
                middle = [sum(corners[i][k] for i in face) / 5 for k in range(3)]
                u = [corners[face[0]][k] - middle[k] for k in range(3)]
                v = [n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]]
                size = math.hypot(*n)

                def angle(i, u=u, v=v, middle=middle, size=size):
                    d = [corners[i][k] - middle[k] for k in range(3)]
                    return math.atan2(sum(p * q for p, q in zip(d, v)) / size, sum(p * q for p, q in zip(d, u)))
                faces.append(sorted(face, key=angle))
    return polyhedron([tuple(s * c for c in p) for p in corners], faces)


def cases(quick):
    yield "box 4 × 5 × 6", "abc", body('<box dx="4" dy="5" dz="6"/>'), 120.0
    yield "ball, r = 3", "4πr³/3", body('<sphere radius="3"/>'), ball_volume(3)
    yield "ellipsoid 2, 3, 5", "4πabc/3", body('<ellipsoid rx="2" ry="3" rz="5"/>'), 40 * PI
    yield "oblique cylinder, r = 1.5, from 0 to (2, 3, 6)", "πr²h", body(
        '<cylinder x1="0" y1="0" z1="0" x2="2" y2="3" z2="6" radius="1.5"/>'), PI * 2.25 * 7
    yield "cone, r = 3, h = 4", "πr²h/3", body('<cone x1="0" y1="0" z1="0" x2="0" y2="0" z2="4" radius1="3" radius2="0"/>'), 12 * PI
    yield "frustum, 5 and 2, h = 4", "πh(a² + ab + b²)/3", body(
        '<cone x1="0" y1="0" z1="0" x2="0" y2="0" z2="4" radius1="5" radius2="2"/>'), 52 * PI
    yield "torus 10, 2", "2π²Rr²", body('<torus majorRadius="10" minorRadius="2"/>'), 80 * PI ** 2
    yield "torus 3, 2.9, tilted", "2π²Rr²", body('<torus ax="1" ay="2" az="2" majorRadius="3" minorRadius="2.9"/>'), 2 * PI ** 2 * 3 * 2.9 ** 2
    yield "hexagonal prism, edge 2, h = 7", "3√3 a²h/2", body('<extrusion height="7">' + "".join(
        f'<point x="{2 * math.cos(k * PI / 3)!r}" y="{2 * math.sin(k * PI / 3)!r}"/>' for k in range(6)) + "</extrusion>"), 1.5 * math.sqrt(3) * 4 * 7
    yield "wedge 6 × 4, h = 3, top 2 × 1", "h(A + 4M + B)/6", body('<wedge dx="6" dy="4" dz="3" topX="1" topY="2" topDx="2" topDy="1"/>'), 3 * (24 + 4 * 10 + 2) / 6
    yield "roof 6 × 4, h = 3, ridge 2", "h(A + 4M)/6", body('<wedge dx="6" dy="4" dz="3" topX="2" topY="2" topDx="2" topDy="0"/>'), 3 * (24 + 4 * 8) / 6
    yield "oblique pyramid 6 × 4, h = 3", "abh/3", body('<wedge dx="6" dy="4" dz="3" topX="9" topY="-2" topDx="0" topDy="0"/>'), 24.0
    yield "revolved L, r = 1–4", "2π Σ Rᵢ Aᵢ", body('<revolution>' + "".join(
        f'<point r="{r}" z="{z}"/>' for r, z in ((1, -1), (4, -1), (4, 1), (2, 1), (2, 3), (1, 3))) + "</revolution>"), 36 * PI
    yield "turned pencil, r = 2", "πr²(h + t/3)", body('<revolution>' + "".join(
        f'<point r="{r}" z="{z}"/>' for r, z in ((0, 0), (2, 0), (2, 5), (0, 8))) + "</revolution>"), 24 * PI
    yield "octahedron, edge 3√2", "√2 a³/3", polyhedron([(3, 0, 0), (-3, 0, 0), (0, 3, 0), (0, -3, 0), (0, 0, 3), (0, 0, -3)],
        [(a, b, c) if (a % 2 + b % 2 + c % 2) % 2 == 0 else (b, a, c) for a in (0, 1) for b in (2, 3) for c in (4, 5)]), 36.0
    yield "dodecahedron, edge 2", "(15 + 7√5)a³/4", dodecahedron(2), (15 + 7 * math.sqrt(5)) * 2
    yield "polar sector 5–10, 60°, h = 3", "θ(R² − r²)h/2", sector(POLAR, [(5, 10), (0, "60deg"), (0, 3)]), PI / 6 * 75 * 3
    yield "ring 5–10, h = 3", "π(R² − r²)h", sector(POLAR, [(5, 10), (0, "360deg"), (0, 3)]), PI * 75 * 3
    yield "spherical sector 5–10, 90°, ±30°", "(R³ − r³)/3 · θ · (sin β − sin α)", sector(
        SPHERICAL, [(5, 10), (0, "90deg"), ("-30deg", "30deg")]), 875 / 3 * PI / 2
    yield "ball as spherical sector, R = 4", "4πR³/3", sector(SPHERICAL, [(0, 4), (0, "360deg"), ("-90deg", "90deg")]), ball_volume(4)
    yield "two cylinders crossing, r = 2", "16r³/3", body(f"<intersection>{cylinder('x', 2)}{cylinder('y', 2)}</intersection>"), 128 / 3
    yield "three cylinders crossing, r = 2", "8(2 − √2)r³", body(
        f"<intersection>{cylinder('x', 2)}{cylinder('y', 2)}{cylinder('z', 2)}</intersection>"), 64 * (2 - math.sqrt(2))
    yield "union of two cylinders, r = 2, length 10", "2πr²h − 16r³/3", body(f"<union>{cylinder('x', 2)}{cylinder('y', 2)}</union>"), 80 * PI - 128 / 3
    yield "box 10³ minus ball r = 4 within", "a³ − 4πr³/3", body('<difference><box dx="10" dy="10" dz="10"/><sphere x="5" y="5" z="5" radius="4"/></difference>'), 1000 - ball_volume(4)
    yield "box 10³ minus ball r = 6 through its walls", "a³ − 4πr³/3 + 6 caps", body(
        '<difference><box dx="10" dy="10" dz="10"/><sphere x="5" y="5" z="5" radius="6"/></difference>'), 1000 - ball_volume(6) + 6 * PI * 1 * 17 / 3
    yield "ball with a bore, napkin ring, h = 6", "πh³/6", body(f'<difference><sphere radius="5"/>{cylinder("z", 4, 6)}</difference>'), 36 * PI
    yield "lens of two balls r = 3, 4 apart", "π(4r + d)(2r − d)²/12", body(
        '<intersection><sphere radius="3"/><sphere x="4" radius="3"/></intersection>'), PI * 16 * 4 / 12
    document, volume = chain(3, 6, (0.5, 0.1), 1.1)
    yield "graded chain, 3 cones r = 0.5–0.8, balls 1.1", "balls + frusta − caps", document, volume
    size = (5, 5, 5)
    cell, one = body_centred(size, 0.5, 0.9)
    for n in range(1, 4 if quick else 9):
        yield f"body-centred 5³, r = 0.5, R = 0.9: {n}³ cells in a box", "n³ · cell", lattice(cell, size, (n, n, n)), n ** 3 * one
    for n in (1, 2) if quick else (1, 2, 4, 8):
        yield f"the same, each cut to its box: {n}³ cells", "n³ · cell", lattice(cell, size, (n, n, n), clip=True), n ** 3 * one
    size = (5, 4, 6)
    cell, one = body_centred(size, 0.4, 1.0)
    for n in range(1, 4 if quick else 9):
        yield f"body-centred 5 × 4 × 6, r = 0.4, R = 1: {n}³ cells in a box", "n³ · cell", lattice(cell, size, (n, n, n)), n ** 3 * one


def measure(meso, document, folder):
    file = pathlib.Path(folder) / "case.meso"
    file.write_text(document, encoding="utf-8")
    start = time.perf_counter()
    done = subprocess.run([meso, "convert", str(file), str(file.with_suffix(".step")), "--json"], capture_output=True, text=True, encoding="utf-8")
    seconds = time.perf_counter() - start
    if done.returncode != 0:
        return None, seconds, done.stderr.strip()
    return json.loads(done.stdout), seconds, ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--quick", action="store_true")
    a = parser.parse_args()
    rows, faults = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, formula, document, volume in cases(a.quick):
            report, seconds, told = measure(a.meso, document, folder)
            if report is None:
                faults.append(f"{name}: {told}")
                continue
            difference = abs(report["volume"] - volume) / volume
            if difference > LIMIT or not report["closed"]:
                faults.append(f"{name}: {report['volume']!r} instead of {volume!r}, closed: {report['closed']}")
            rows.append(f"| {name} | {formula} | {volume:.9f} | {report['volume']:.9f} | {difference:.0e} | {report['solids']} | {report['faces']} | {seconds:.1f} |")
    if not a.check:
        print("# Volumes in closed form\n\nWritten by `scripts/closed_forms.py`. Each body is made by `meso convert`; its volume is integrated over the faces written to the STEP file.\n"
              f"The largest relative difference allowed is {LIMIT:.0e}. Lengths are in mm; a body-centred cell is\n"
              "2 · 4πR³/3 + 8 · (πr²(L − 2h) − 2π(R − h)²(2R + h)/3) with h² = R² − r² and L half the space diagonal.\n\n"
              "| body | closed form | mm³ | ours, mm³ | difference | solids | faces | s |\n|---|---|---|---|---|---|---|---|\n" + "\n".join(rows))
    for fault in faults:
        print(fault, file=sys.stderr)
    if a.check:
        print(f"{len(rows)} volumes, {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
