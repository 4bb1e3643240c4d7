#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Volumes of bent and grown trusses by the specification's text alone: nodes, radii, automatic balls, and a union of cones and balls.

usage: truss_volume.py --meso PATH [--count 40] [--seed 1] [--kind NAME] [--ball auto] [--keep FOLDER] [--seconds 60] [--late 2]

Random documents of bent_parts.py. The volume of the union is the sum over all cones and balls of their volume times the
mean of 1/m, m being how many of them hold a random point of it; `meso convert` must agree to 5 standard deviations. A
document that is refused must be refused for a reason that tells what to write, within --late seconds of a processor.
"""
import argparse
import collections
import itertools
import json
import math
import pathlib
import random
import re
import resource
import subprocess
import sys
import tempfile

try:
    import numpy
except ImportError:
    print("skipped: no numpy")
    sys.exit(77)

import bent_parts

SAMPLES = 1500  # in each cone or ball
ONE = 1e-6  # millimetres between points that are one
TELLS_WHAT_TO_WRITE = {"GEOMETRY_STRUTS_THICK", "BODY_DEGENERATE", "LIMIT_BOOLEANS"}


def unit(a, b):
    way = [y - x for x, y in zip(a, b)]
    length = math.hypot(*way)
    return [w / length for w in way], length


def angle_between(a, b):
    return 2 * math.atan2(math.dist(a, b), math.dist(a, [-x for x in b]))


def parted(angle, radius, growth):
    """R-6.8.5: the distance at which two struts have left each other."""
    opening = math.sin(angle / 2) - growth * math.cos(angle / 2)
    return radius / opening if opening >= 1e-6 else math.inf


class Cells:
    """All struts of a truss, their radii and the balls of its nodes. `t` is what bent() and straight() give."""

    def __init__(self, t):
        self.t = t
        self.indices = list(itertools.product(*map(range, t["counts"])))
        self.struts = []  # (cell, from, to, radius at from, radius at to)
        for index in self.indices:
            for a, b in t["beams"]:
                self.struts.append((index, a, b, self.radius(index, a), self.radius(index, b)))
        self.balls = self.automatic() if t["ball"] == "auto" else {}

    def place(self, index, node):
        return self.t["place"](index, node if isinstance(node, (tuple, list)) else self.t["nodes"][node])

    def radius(self, index, node):
        slope, where = self.t["growth"]
        return self.t["radius"] + slope * self.place(index, node if where == "node" else (0, 0, 0))[0]

    def is_on_pole(self, index, node):
        """A quarter of a cell along one coordinate leads nowhere."""
        def moved(axis):
            return [x + (0.25 * self.t["period"][axis] if i == axis else 0) for i, x in enumerate(self.t["nodes"][node])]
        return self.t["is_bent"] and any(math.dist(self.place(index, node), self.place(index, moved(axis))) <= ONE for axis in range(3))

    def leaving(self, strut):
        """Both ends: node, direction, radius, growth, far point."""
        index, a, b, ra, rb = strut
        p, q = self.place(index, a), self.place(index, b)
        way, length = unit(p, q)
        return ((a, way, ra, max(0, (rb - ra) / length), q), (b, [-w for w in way], rb, max(0, (ra - rb) / length), p))

    def beyond(self, index, node):
        """Directions of the struts that neighbouring cells have at a node in a wall."""
        t, out = self.t, []
        for other, at in enumerate(t["nodes"]):
            shift = [round((x - y) / d) for x, y, d in zip(t["nodes"][node], at, t["period"])]
            if not any(shift) or max(map(abs, shift)) > 1:
                continue
            if any(abs((x - y) / d - s) > 1e-9 for x, y, d, s in zip(t["nodes"][node], at, t["period"], shift)):
                continue
            for a, b in t["beams"]:
                for near, far in ((a, b), (b, a)):
                    end = [x + s * d for x, s, d in zip(t["nodes"][far], shift, t["period"])]
                    if near == other and math.dist(self.place(index, end), self.place(index, node)) > ONE:
                        out.append(unit(self.place(index, node), self.place(index, end))[0])
        return out

    def automatic(self):
        """(cell, node) -> radius of its ball."""
        at_poles, own, balls = collections.defaultdict(list), collections.defaultdict(list), {}
        for strut in self.struts:
            for node, *rest in self.leaving(strut):
                own[strut[0], node].append(rest)
                if self.is_on_pole(strut[0], node):
                    at_poles[tuple(round(x, 5) + 0.0 for x in self.place(strut[0], node))].append(rest)

        def pairs(ends):
            for (u, r, k, p), (v, s, l, q) in itertools.combinations(ends, 2):
                if math.dist(p, q) > ONE:  # else they are one beam
                    yield parted(angle_between(u, v), max(r, s), max(k, l))
        pole_balls = {p: max([e[1] for e in ends] + list(pairs(ends))) for p, ends in at_poles.items()}
        for (index, node), ends in own.items():
            if self.is_on_pole(index, node):
                balls[index, node] = pole_balls[tuple(round(x, 5) + 0.0 for x in self.place(index, node))]
                continue
            beyond = self.beyond(index, node)
            outer = [parted(angle_between(u, v), r, k) for u, r, k, _ in ends for v in beyond if math.dist(u, v) / 2 >= 1e-6]
            balls[index, node] = max([e[1] for e in ends] + list(pairs(ends)) + outer)
        return balls

    def primitives(self):
        """Cones as rows a, b, radii; balls as rows centre, radius."""
        t, cones, balls = self.t, {}, {}

        def key(*points):
            return tuple(sorted(tuple(round(x, 5) + 0.0 for x in p) for p in points))

        def raise_ball(p, radius):
            known = balls.get(key(p), (p, 0))
            balls[key(p)] = (p, max(radius, known[1]))
        for index, a, b, ra, rb in self.struts:
            p, q = self.place(index, a), self.place(index, b)
            cones.setdefault((*key(p, q), round(ra, 9), round(rb, 9)), (*p, *q, ra, rb))
            for node, radius in ((a, ra), (b, rb)):
                raise_ball(self.place(index, node), radius)  # caps
        for index in self.indices:
            for node in range(len(t["nodes"])):
                if t["ball"] and t["ball"] != "auto":
                    raise_ball(self.place(index, node), float(t["ball"]))
                elif (index, node) in self.balls:
                    raise_ball(self.place(index, node), self.balls[index, node])
        return numpy.array(list(cones.values())), numpy.array([(*p, r) for p, r in balls.values()])

    def thickest(self):
        """The largest ball in radii of struts, the longest it has in lengths of struts: what cannot part is more than 1."""
        worst = 0
        for strut in self.struts:
            length = math.dist(self.place(strut[0], strut[1]), self.place(strut[0], strut[2]))
            worst = max(worst, *(self.balls.get((strut[0], n), 0) / length for n in strut[1:3]))
        return worst


def volume(cones, balls, rng):
    """Of the union, and the standard deviation of that."""
    a, b, ra, rb = cones[:, :3], cones[:, 3:6], cones[:, 6], cones[:, 7]
    way = b - a
    length2 = (way * way).sum(1)
    middles = numpy.concatenate([(a + b) / 2, balls[:, :3]])
    reaches = numpy.concatenate([numpy.sqrt(length2) / 2 + numpy.maximum(ra, rb), balls[:, 3]])

    def count(points, near):
        """How many primitives hold each point."""
        held = numpy.zeros(len(points), int)
        for i in near:
            if i >= len(a):
                centre = balls[i - len(a)]
                held += ((points - centre[:3]) ** 2).sum(1) <= centre[3] ** 2
                continue
            t = (points - a[i]) @ way[i] / length2[i]
            off = ((points - a[i] - t[:, None] * way[i]) ** 2).sum(1)
            held += (t >= 0) & (t <= 1) & (off <= (ra[i] + t * (rb[i] - ra[i])) ** 2)
        return held

    def in_cone(i):
        # t has the density (ra + t (rb - ra))^2: r^3 is spread evenly between the cubes of both radii.
        n = rng.random(SAMPLES)
        if abs(rb[i] - ra[i]) > 1e-12:
            r = numpy.cbrt(ra[i] ** 3 + n * (rb[i] ** 3 - ra[i] ** 3))
            t = (r - ra[i]) / (rb[i] - ra[i])
        else:
            r, t = numpy.full(SAMPLES, ra[i]), n
        u = numpy.cross(way[i], numpy.eye(3)[numpy.argmin(abs(way[i]))])
        u /= numpy.linalg.norm(u)
        v = numpy.cross(way[i], u) / math.sqrt(length2[i])
        angle, out = 2 * math.pi * rng.random(SAMPLES), (1 - 1e-9) * r * numpy.sqrt(rng.random(SAMPLES))
        return a[i] + t[:, None] * way[i] + (out * numpy.cos(angle))[:, None] * u + (out * numpy.sin(angle))[:, None] * v

    def in_ball(i):
        d = rng.normal(size=(SAMPLES, 3))
        d /= numpy.linalg.norm(d, axis=1)[:, None]
        return balls[i, :3] + d * ((1 - 1e-9) * balls[i, 3] * numpy.cbrt(rng.random(SAMPLES)))[:, None]
    total = variance = 0.0
    for i in range(len(middles)):
        near = numpy.nonzero(numpy.linalg.norm(middles - middles[i], axis=1) <= reaches + reaches[i])[0]
        if i < len(a):
            own = math.pi / 3 * math.sqrt(length2[i]) * (ra[i] ** 2 + ra[i] * rb[i] + rb[i] ** 2)
            points = in_cone(i)
        else:
            own = 4 * math.pi / 3 * balls[i - len(a), 3] ** 3
            points = in_ball(i - len(a))
        shares = own / numpy.maximum(1, count(points, near))
        total += shares.mean()
        variance += shares.var() / SAMPLES
    return total, math.sqrt(variance)


def run(program, seconds, *arguments):
    """The finished process and the seconds of a processor that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5)))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def judged(a, kind, seed, folder):
    """(verdict, words)"""
    rng = random.Random(f"{kind}_truss {seed}")
    made = bent_parts.bent(rng) if kind == "bent" else bent_parts.straight(rng)
    if made is None or (a.ball and made[3]["ball"] != a.ball):
        return "skipped", ""
    file = folder / f"{kind}_truss_{seed}.meso"
    file.write_text(made[0].replace("@VALIDATION@", ""), encoding="utf-8")
    cells = Cells(made[3])
    about = f'nodeRadius {made[3]["ball"]}, largest ball {cells.thickest():.2f} of a beam'
    done, seconds = run(a.meso, a.seconds, "convert", file, folder / "part.step", "--json", "--jobs", 1)
    about += f", {seconds:.2f} s"
    if done.returncode:
        told = re.search(r"error ([A-Z_]+).*", done.stderr) or [f"exit code {done.returncode}"] * 2
        verdict = "refused" if told[1] in TELLS_WHAT_TO_WRITE and seconds < a.late else "late"
        return verdict, f"{told[1]}; {about}"
    answer = json.loads(done.stdout)
    expected, deviation = volume(*cells.primitives(), numpy.random.default_rng(seed))
    off = answer["volume"] - expected
    words = f'{answer["way"]}; {about}; volume {answer["volume"]:.5f}, expected {expected:.5f} +- {deviation:.5f}'
    return ("ok" if abs(off) <= 5 * deviation + 1e-6 * expected else "wrong"), words


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--count", type=int, default=40, help="documents in all")
    parser.add_argument("--seed", type=int, default=1, help="of the first document")
    parser.add_argument("--kind", choices=("bent", "grown"), action="append")
    parser.add_argument("--ball", help="only documents with this nodeRadius")
    parser.add_argument("--seconds", type=int, default=60, help="of a processor, for each document")
    parser.add_argument("--late", type=float, default=2, help="seconds of a processor that a refusal may take")
    parser.add_argument("--keep", help="a folder for the documents")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    kinds = a.kind or ["bent", "grown"]
    total = collections.Counter()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(a.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for n in range(a.count):
            kind, seed = kinds[n % len(kinds)], a.seed + n // len(kinds)
            verdict, words = judged(a, kind, seed, folder)
            total[kind, verdict, words.split(";")[0]] += 1
            if a.verbose or verdict in ("wrong", "late"):
                print(f"{verdict} {kind} {seed} {words}", flush=True)
    for (kind, verdict, words), n in sorted(total.items()):
        print(f"{kind} {verdict} {words}: {n}")
    sys.exit(1 if any(verdict in ("wrong", "late") for _, verdict, _ in total) else 0)


if __name__ == "__main__":
    main()
