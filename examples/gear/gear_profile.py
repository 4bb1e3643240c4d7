# SPDX-License-Identifier: Apache-2.0
"""The true involute gear of this example as a Gmsh script: module 3 mm, 20 teeth, pressure angle 20 degrees, 10 mm wide, bore 16 mm."""

import math

MODULE, TEETH, PRESSURE_ANGLE, WIDTH, BORE_RADIUS = 3.0, 20, math.radians(20), 10.0, 8.0
PITCH = MODULE * TEETH / 2
BASE, TIP, ROOT = PITCH * math.cos(PRESSURE_ANGLE), PITCH + MODULE, PITCH - 1.25 * MODULE
FILLET = 0.38 * MODULE  # as of a basic rack
SPANS = 8  # of the spline of a flank
LOADED_TOOTH = TEETH // 4  # the one along +y


def involute(angle):
    return math.tan(angle) - angle


def half_tooth(radius):
    """Half the angle of a tooth's thickness at a radius between base and tip circle."""
    return math.pi / (2 * TEETH) + involute(PRESSURE_ANGLE) - involute(math.acos(min(1, BASE / radius)))


def radii(start, end, count):
    """Where the spline of a flank is held: dense at the base circle, where an involute turns sharply."""
    u, v = (math.sqrt((r - BASE) / (TIP - BASE)) for r in (start, end))
    return [start, *(BASE + (TIP - BASE) * (u + (v - u) * i / count) ** 2 for i in range(1, count)), end]


def at(radius, angle):
    return radius * math.cos(angle), radius * math.sin(angle)


def fillet():
    """Radius where the fillet leaves the radial line below the base circle, and the angle from that line to the fillet's centre."""
    return math.sqrt((ROOT + FILLET) ** 2 - FILLET**2), math.asin(FILLET / (ROOT + FILLET))


def outline(count):
    """Points of half a tooth from the middle of its tip to the middle of the gap, tooth along +x, `count` on each piece: the true curves, no splines."""
    foot, turn = fillet()
    base, t = half_tooth(BASE), [i / count for i in range(count + 1)]
    centre = at(ROOT + FILLET, base + turn)
    start, end = (math.atan2(p[1] - centre[1], p[0] - centre[0]) for p in (at(foot, base), at(ROOT, base + turn)))
    end = start + (end - start + math.pi) % (2 * math.pi) - math.pi
    points = [at(TIP, half_tooth(TIP) * i) for i in t]
    points += [at(r, half_tooth(r)) for r in radii(BASE, TIP, count)[::-1]]
    points += [(centre[0] + FILLET * math.cos(a), centre[1] + FILLET * math.sin(a)) for a in (start + (end - start) * i for i in t)]
    return points + [at(ROOT, base + turn + (math.pi / TEETH - base - turn) * i) for i in t]


def volume():
    """The gear's volume from the true curves, to 1e-8."""
    points = outline(20000)
    twice = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(points, points[1:]))
    return WIDTH * (TEETH * twice - math.pi * BORE_RADIUS**2)


class Script:
    """Points and curves of a Gmsh script, numbered as they come."""

    def __init__(self):
        self.lines, self.points, self.curves = [], 0, 0

    def point(self, xy):
        self.points += 1
        self.lines.append(f"Point({self.points}) = {{{xy[0]:.15g}, {xy[1]:.15g}, 0}};")
        return self.points

    def curve(self, kind, points):
        self.curves += 1
        self.lines.append(f"{kind}({self.curves}) = {{{', '.join(map(str, points))}}};")

    def flank(self, angle, side, stops):
        """Points along an involute, one list between each two of the radii `stops`, from the tooth's foot to its tip."""
        parts = [[self.point(at(stops[0], angle + side * half_tooth(stops[0])))]]
        for start, end in zip(stops, stops[1:]):
            parts[-1] += [self.point(at(r, angle + side * half_tooth(r))) for r in radii(start, end, SPANS // (len(stops) - 1))[1:]]
            parts.append([parts[-1][-1]])
        return parts[:-1]


def geometry():
    """Gmsh script of the gear. The left flank of the loaded tooth is split at the pitch radius: its addendum is a face of its own."""
    script = Script()
    centre = script.point((0, 0))
    foot, turn = fillet()
    first = previous = None
    for tooth in range(TEETH):
        angle = 2 * math.pi * tooth / TEETH
        # Counter-clockwise: root, right fillet and flank, tip, left flank and fillet.
        low, high = (angle + side * half_tooth(BASE) for side in (-1, 1))
        right_root, right_centre, right_foot = (script.point(p) for p in
                                                (at(ROOT, low - turn), at(ROOT + FILLET, low - turn), at(foot, low)))
        if previous:
            script.curve("Circle", (previous, centre, right_root))
        first = first or right_root
        script.curve("Circle", (right_root, right_centre, right_foot))
        right = script.flank(angle, -1, [BASE, TIP])
        left = script.flank(angle, 1, [BASE, PITCH, TIP] if tooth == LOADED_TOOTH else [BASE, TIP])
        script.curve("Line", (right_foot, right[0][0]))
        for part in right:
            script.curve("Spline", part)
        script.curve("Circle", (right[-1][-1], centre, left[-1][-1]))
        for part in reversed(left):
            script.curve("Spline", part[::-1])
        left_foot, left_centre, previous = (script.point(p) for p in
                                            (at(foot, high), at(ROOT + FILLET, high + turn), at(ROOT, high + turn)))
        script.curve("Line", (left[0][0], left_foot))
        script.curve("Circle", (left_foot, left_centre, previous))
    script.curve("Circle", (previous, centre, first))
    profile = script.curves
    return "\n".join(['SetFactory("OpenCASCADE");', *script.lines, f"Circle({profile + 1}) = {{0, 0, 0, {BORE_RADIUS:g}}};",
                      f"Curve Loop(1) = {{1:{profile}}};", f"Curve Loop(2) = {{{profile + 1}}};", "Plane Surface(1) = {1, 2};",
                      f"Extrude {{0, 0, {WIDTH:g}}} {{ Surface{{1}}; }}", ""])
