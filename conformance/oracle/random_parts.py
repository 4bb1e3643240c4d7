#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Random parts that `meso verify --deep` must pass: many small documents, and the smallest that fails.

usage: random_parts.py --meso PATH [--count 40 | --quick] [--seed 1] [--kind NAME] [--keep FOLDER] [--jobs 1]
       random_parts.py --meso PATH --documents FOLDER

Documents are those of membership.py and more: lattices offset from and turned against bodies, graded ones, imported
bodies, parts in cells. `meso` realises each and judges it by its own evaluator of the definitions, which shares no code with the engine.
One that fails is made smaller, element by element and number by number, as long as it still fails, and printed.

Refusals are judged, too. A part called empty must have no point of the definitions inside, by functions that are written
beside each document here. Booleans that failed the engine's own check, struts too thick for their nodes and documents that took more than --seconds of a
processor are counted, and must stay a small share (--refusals). Any other reason fails.
"""
import argparse
import collections
import concurrent.futures
import functools
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
import xml.etree.ElementTree as ElementTree

import membership
from bent_parts import bent_truss, grown_truss
from joined_parts import joined
from membership import (REFUSALS, box, boolean, cell_section, cone, document, in_boxed, loops, moved, number, random_tree,
                        rotation, sphere, truss, turned)
from nested_parts import nested

NAMESPACE = "urn:meso-format:1.0"
ALLOWED = {"GEOMETRY_BOOLEAN", "GEOMETRY_STRUTS_THICK", "LIMIT_TIME"}  # reasons for refusals, besides parts that are empty
STEPS = 80  # runs of `meso` that making a document smaller may take
ElementTree.register_namespace("", NAMESPACE)


# ---- documents --------------------------------------------------------------------------------------------------
# Each kind: (random numbers, folder, function that runs `meso`) -> text of a document, what tells whether a point is
# inside, and a box to look in; or None if it has no chance.

def round_or_flat_body(rng, reach):
    kind = rng.randrange(5)
    size = [number(rng, 0.5 * r, r) for r in reach]
    centre = [d / 2 for d in size]
    if kind == 0:
        return box((0, 0, 0), size)
    if kind == 1:
        return sphere(centre, number(rng, 0.35 * min(size), 0.6 * min(size)))
    if kind == 2:
        radius = number(rng, 0.3 * min(size), 0.5 * min(size))
        return cone([*centre[:2], 0], [*centre[:2], size[2]], radius, rng.choice((radius, round(0.6 * radius, 2))))
    if kind == 3:
        bore = round(0.25 * min(size), 2)
        return boolean("difference", [box((0, 0, 0), size), cone([*centre[:2], -1], [*centre[:2], size[2] + 1], bore, bore)])
    return boolean("union", [box((0, 0, 0), size), sphere(size, round(0.4 * min(size), 2))])


def lattice_in_body(rng, cell, statements="", at_most=3, body=None):
    """A lattice and a body that stand to each other as it happens. `cell` makes a text and what tells whether a point is
    in the cell with an index, from the cell's own origin."""
    size = [number(rng, 3, 6) for _ in range(3)]
    counts = [rng.randrange(1, at_most + 1) for _ in range(3)]
    starts = [number(rng, -3, 3) for _ in range(3)]
    import_text = body[0] if body else None
    if body is None:
        body = round_or_flat_body(rng, [max(4, c * d) for c, d in zip(counts, size)])
    if import_text is None and rng.random() < 0.5:
        body = turned(body, [number(rng, -1, 1), number(rng, -1, 1), 1], rng.choice((number(rng, -3, 3), 0.01, 1e-4)))
    cell_text, in_cell = cell(rng, size)
    is_clipped = rng.random() < 0.3
    rest = (cell_section(cell_text, size, is_clipped) +
            f'<patterns><pattern id="p" unitCell="u">{loops(counts, starts, size)}{statements}</pattern></patterns>')
    operation = rng.choice(("intersection", "intersection", "intersection", "difference", "union"))

    def in_cells(p):
        for index in itertools.product(*map(range, counts)):
            q = [x - s - n * d for x, s, n, d in zip(p, starts, index, size)]
            if (not is_clipped or all(0 <= x <= d for x, d in zip(q, size))) and in_cell(index, q):
                return True
        return False
    inside = {"intersection": lambda p: body[1](p) and in_cells(p), "difference": lambda p: body[1](p) and not in_cells(p),
              "union": lambda p: body[1](p) or in_cells(p)}[operation]
    reach = 0.5 * max(size)
    extents = [max(4, c * d) for c, d in zip(counts, size)]
    radius = math.hypot(*(1.5 * e for e in extents))  # the body is turned about the origin
    box_of_cells = ([s - reach for s in starts], [s + c * d + reach for s, c, d in zip(starts, counts, size)])
    box_of_body = ([-radius] * 3, [radius] * 3)
    text = document(body[0], rest, f'<apply pattern="p" operation="{operation}"/>')
    if import_text:
        text = text.replace(f"<csg>{import_text}</csg>", import_text)
    return (text, inside,
            box_of_cells if operation == "intersection" else box_of_body)


def plain_truss(rng, size):
    text, boxed = truss(rng, size)
    return text, lambda _, q: in_boxed(boxed, q)


def offset(rng, *_):
    return lattice_in_body(rng, plain_truss)


def set_by_index(rng, *_):
    step = rng.choice((0.1, 0.05, -0.1))

    def cell(r, size):
        state = r.getstate()
        text = truss(r, size)[0]

        @functools.cache
        def boxed(i, j, k):
            again = random.Random()
            again.setstate(state)
            return truss(again, size, 1 + step * (i + 2 * j - k))[1]
        return re.sub(r'(radius2?|nodeRadius)="([0-9.]+)"', r'\1="\2*t"', text), lambda index, q: in_boxed(boxed(*index), q)
    text, inside, where = lattice_in_body(rng, cell, f'<set parameter="t" value="1+{step}*(i+2*j-k)"/>', 2)
    return re.sub("(<unitCell [^>]*>)", r'\1<parameter id="t" value="1"/>', text), inside, where


def solids_in_cells(rng, *_):
    def cell(r, size):
        text, inside = moved(random_tree(r, 1), [d / 2 for d in size])
        return f"<csg>{text}</csg>", lambda _, q: inside(q)
    return lattice_in_body(rng, cell, at_most=2)


def imported(rng, folder, meso):
    """A body that was written by `meso` itself, read again and cut."""
    source = folder / "body.meso"
    body = round_or_flat_body(rng, [8, 8, 8])
    source.write_text(document(body[0]).replace("@VALIDATION@", ""), encoding="utf-8")
    name = rng.choice(("body.step", "body.stl"))
    if meso("convert", source, folder / name).returncode != 0:
        return None
    unit = ' unit="millimeter"' if name.endswith("stl") else ""
    matrix, shift = rotation([1, 2, 2], number(rng, -1, 1)), [0, 0, 0]
    rows = []
    for i, row in enumerate(matrix):
        shift[i] = number(rng, -1, 1)
        rows += [*row, shift[i]]
    is_moved = rng.random() < 0.5

    def in_import(p):
        q = [x - t for x, t in zip(p, shift)]
        return body[1]([sum(matrix[k][i] * q[k] for k in range(3)) for i in range(3)] if is_moved else p)
    transform = f'<transform matrix="{", ".join(map(repr, rows))}"/>' if is_moved else ""
    import_text = f'<import href="{name}"{unit}>{transform}</import>'
    return lattice_in_body(rng, plain_truss, at_most=2, body=(import_text, in_import))


KINDS = {f.__name__: f for f in (offset, set_by_index, solids_in_cells, imported, bent_truss, grown_truss, nested, joined)}
for known, make in membership.KINDS.items():
    KINDS[known] = lambda rng, folder, meso, make=make: make(rng)


# ---- judging ----------------------------------------------------------------------------------------------------

class Judge:
    def __init__(self, program, points, seconds):
        self.program, self.points, self.seconds = program, points, seconds

    def run(self, *arguments):
        def limit():  # processor time: on a busy machine a clock would say nothing
            resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds + 5))
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, preexec_fn=limit)

    def verdict(self, file):
        """('ok' | 'touching' | 'refused' | 'invalid' | 'wrong', words)"""
        done = self.run("verify", "--deep", "--points", self.points, "--part", "a", "--json", "--jobs", 1, file)
        first = (done.stderr.strip().splitlines() or [""])[0]
        if done.returncode == 0:
            return "ok", ""
        if done.returncode in REFUSALS:
            told = [re.search(rf"{severity} ([A-Z_]+)", done.stderr) for severity in ("error", "warning")]
            return "refused", next((t[1] for t in told if t), first)
        failed = []
        if done.stdout.strip():
            faults = [c for c in json.loads(done.stdout).get("checks", []) if not c["passed"]]
            failed = [f'{c["what"]}: {c["found"]} instead of {c["expected"]}' for c in faults if not c["what"].startswith(NOT_JUDGED)]
            if faults and not failed:
                return "told", ", ".join(c["what"] for c in faults)
        if done.returncode in (1, 2, 3) and not failed:
            return "invalid", first
        # Parts that touch in a line are told, and are what the definitions say.
        if "GEOMETRY_NON_MANIFOLD" in done.stderr and all(f.startswith(("closed", "multiple edges")) for f in failed):
            return "touching", ""
        return "wrong", "; ".join(failed) or f"exit code {done.returncode}: {first}"


def point_inside(rng, inside, low, high, points=20000, clear=0.01):
    """A point with some of the part all around it, if there is one."""
    around = [(x, y, z) for x in (-clear, clear) for y in (-clear, clear) for z in (-clear, clear)]
    for _ in range(points):
        p = [rng.uniform(l, h) for l, h in zip(low, high)]
        if inside(p) and all(inside([u + v for u, v in zip(p, d)]) for d in around):
            return p
    return None


def judged_refusal(rng, words, inside, where):
    """What becomes of a refusal: a part that is called empty and is not, or a reason that none is meant to have, is wrong."""
    if words == "GEOMETRY_EMPTY":
        p = point_inside(rng, inside, *where)
        return ("wrong", f"called empty, but {p} is inside") if p else ("empty", "")
    return ("refused" if words in ALLOWED else "wrong", words)


def smaller_texts(text):
    """Documents with one element less, a smaller count, or a rounder number: boldest first."""
    root = ElementTree.fromstring(text)
    parents = {child: parent for parent in root.iter() for child in parent}

    def printed():
        return ElementTree.tostring(root, encoding="unicode")
    for child in sorted(parents, key=lambda e: -len(list(e.iter()))):
        if child not in parents[child]:
            continue
        at = list(parents[child]).index(child)
        parents[child].remove(child)
        yield printed()
        parents[child].insert(at, child)
    for element in root.iter():
        for name, value in list(element.attrib.items()):
            simpler = []
            if name == "count" and value.isdigit() and int(value) > 1:
                simpler = ["1", str(int(value) - 1)]
            elif re.fullmatch(r"-?[0-9]+\.[0-9]+", value):
                simpler = [f"{float(value):.{digits}f}" for digits in (0, 1, 2) if len(value.split(".")[1]) > digits]
            for candidate in simpler:
                element.set(name, candidate)
                yield printed()
            element.set(name, value)


def smallest(judge, text, file):
    """The document made smaller while it is still wrong."""
    left = STEPS
    progress = True
    while progress and left > 0:
        progress = False
        for candidate in smaller_texts(text):
            if left <= 0:
                break
            left -= 1
            file.write_text(candidate, encoding="utf-8")
            if judge.verdict(file)[0] == "wrong":
                text, progress = candidate, True
                break
    file.write_text(text, encoding="utf-8")
    return text


def one(judge, kind, seed, parent):
    """What became of one document: (kind, seed, verdict, words, text of the smallest that fails as it does)"""
    folder = parent / f"{kind}_{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    rng = random.Random(f"{kind} {seed}")
    made = KINDS[kind](rng, folder, judge.run)
    if made is None:
        return kind, seed, "skipped", "", None
    text, inside, where = made
    file = folder / "part.meso"
    file.write_text(text.replace("@VALIDATION@", ""), encoding="utf-8")
    verdict, words = judge.verdict(file)
    if verdict == "refused":
        verdict, words = judged_refusal(rng, words, inside, where)
        return kind, seed, verdict, words, None
    small = smallest(judge, file.read_text(encoding="utf-8"), folder / "smallest.meso") if verdict == "wrong" else None
    return kind, seed, verdict, words, small


# Counted as told: OpenCASCADE's reader takes the other side of some spheres with many holes, and so do programs that use it; an edge on a B-spline
# can be cut off at the wrong place when its ends are looked for.
NOT_JUDGED = ("STEP read back", "vertices from edges")
VERDICTS = ("ok", "told", "touching", "empty", "refused", "skipped", "invalid", "wrong")


def print_summary(total, reasons):
    """A line for each kind, and one for all."""
    for kind, counts in (*total.items(), ("all", sum(total.values(), collections.Counter()))):
        told = [f"{counts[v]} {v}" for v in VERDICTS if counts[v]]
        because = reasons[kind] if kind != "all" else sum(reasons.values(), collections.Counter())
        print(f"{kind}: {sum(counts.values())} documents, {', '.join(told)}" + "".join(f"; {n} x {r}" for r, n in because.most_common()))


def judge_again(judge, folder):
    """Whether all documents of a folder are what their definitions say."""
    good = True
    for file in sorted(pathlib.Path(folder).glob("*.meso")):
        verdict, words = judge.verdict(file)
        print(f"{verdict} {file.name} {words}".rstrip(), flush=True)
        good = good and verdict in ("ok", "touching")
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--count", type=int, default=40, help="documents in all")
    parser.add_argument("--quick", action="store_true", help="one document of each kind, few points, a few seconds of a processor for each")
    parser.add_argument("--seed", type=int, default=1, help="of the first document")
    parser.add_argument("--points", type=int, default=60000, help="random points for each")
    parser.add_argument("--seconds", type=int, default=60, help="of a processor, for each run of meso")
    parser.add_argument("--refusals", type=float, default=0.25, help="largest share of the documents")
    parser.add_argument("--jobs", type=int, default=1, help="documents at a time")
    parser.add_argument("--kind", choices=sorted(KINDS), action="append")
    parser.add_argument("--keep", help="a folder for the documents")
    parser.add_argument("--documents", help="a folder of documents, to be judged instead of random ones")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    if a.documents:
        sys.exit(0 if judge_again(Judge(a.meso, a.points, a.seconds), a.documents) else 1)
    kinds = a.kind or list(KINDS)
    if a.quick:
        a.count, a.points, a.seconds, a.refusals = len(kinds), 20000, 12, 0.5
    judge = Judge(a.meso, a.points, a.seconds)
    total, reasons = collections.defaultdict(collections.Counter), collections.defaultdict(collections.Counter)
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        parent = pathlib.Path(a.keep or temporary)
        asked = [(kinds[n % len(kinds)], a.seed + n // len(kinds)) for n in range(a.count)]
        for kind, seed, verdict, words, small in pool.map(lambda k: one(judge, *k, parent), asked):
            total[kind][verdict] += 1
            if verdict == "refused":
                reasons[kind][words] += 1
            if verdict in ("wrong", "invalid") or a.verbose:
                print(f"{verdict} {kind} {seed} {words}", flush=True)
            if small:
                print(f"smallest: {small}", flush=True)
    print_summary(total, reasons)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{used.ru_utime + used.ru_stime:.0f} s of a processor")
    found = sum(total.values(), collections.Counter())
    failed = found["wrong"] or found["invalid"] or not found["ok"] or found["refused"] > a.refusals * a.count
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
