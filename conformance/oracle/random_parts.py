#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Random parts that `meso verify --deep` must pass: many small documents, and the smallest that fails.

usage: random_parts.py --meso PATH [--count 40] [--seed 1] [--kind NAME] [--keep FOLDER]

Documents are those of membership.py and more: lattices offset from and turned against bodies, graded ones, imported
bodies. `meso` realises each and judges it by its own evaluator of the definitions, which shares no code with the engine.
A part that `meso` refuses with a diagnostic is counted. One that fails is made smaller, element by element and number by
number, as long as it still fails, and printed.
"""
import argparse
import collections
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import membership
from membership import REFUSALS, box, boolean, cell_section, cone, document, loops, moved, number, random_tree, rotation, sphere, truss, turned

NAMESPACE = "urn:meso-format:1.0"
STEPS = 80  # runs of `meso` that making a document smaller may take
ElementTree.register_namespace("", NAMESPACE)


# ---- documents --------------------------------------------------------------------------------------------------
# Each kind: (random numbers, folder, function that runs `meso`) -> text of a document, or None if it has no chance.

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


def lattice_in_body(rng, cell, statements="", at_most=3):
    """A lattice and a body that stand to each other as it happens."""
    size = [number(rng, 3, 6) for _ in range(3)]
    counts = [rng.randrange(1, at_most + 1) for _ in range(3)]
    starts = [number(rng, -3, 3) for _ in range(3)]
    body = round_or_flat_body(rng, [max(4, c * d) for c, d in zip(counts, size)])
    if rng.random() < 0.5:
        body = turned(body, [number(rng, -1, 1), number(rng, -1, 1), 1], rng.choice((number(rng, -3, 3), 0.01, 1e-4)))
    rest = (cell_section(cell(rng, size), size, rng.random() < 0.3) +
            f'<patterns><pattern id="p" unitCell="u">{loops(counts, starts, size)}{statements}</pattern></patterns>')
    operation = rng.choice(("intersection", "intersection", "intersection", "difference", "union"))
    return document(body[0], rest, f'<apply pattern="p" operation="{operation}"/>')


def offset(rng, *_):
    return lattice_in_body(rng, lambda r, size: truss(r, size)[0])


def set_by_index(rng, *_):
    def cell(r, size):
        text = truss(r, size)[0]
        return re.sub(r'(radius2?|nodeRadius)="([0-9.]+)"', r'\1="\2*t"', text)
    step = rng.choice((0.1, 0.05, -0.1))
    text = lattice_in_body(rng, cell, f'<set parameter="t" value="1+{step}*(i+2*j-k)"/>', 2)
    return re.sub("(<unitCell [^>]*>)", r'\1<parameter id="t" value="1"/>', text)


def solids_in_cells(rng, *_):
    def cell(r, size):
        return f"<csg>{moved(random_tree(r, 1), [d / 2 for d in size])[0]}</csg>"
    return lattice_in_body(rng, cell, at_most=2)


def imported(rng, folder, meso):
    """A body that was written by `meso` itself, read again and cut."""
    source = folder / "body.meso"
    source.write_text(document(round_or_flat_body(rng, [8, 8, 8])[0]).replace("@VALIDATION@", ""), encoding="utf-8")
    name = rng.choice(("body.step", "body.stl"))
    if meso("convert", source, folder / name).returncode != 0:
        return None
    unit = ' unit="millimeter"' if name.endswith("stl") else ""
    text = lattice_in_body(rng, lambda r, size: truss(r, size)[0], at_most=2)
    rows = ", ".join(f"{v!r}" for row in rotation([1, 2, 2], number(rng, -1, 1)) for v in (*row, number(rng, -1, 1)))
    import_text = f'<import href="{name}"{unit}>' + rng.choice(("", f'<transform matrix="{rows}"/>')) + "</import>"
    return re.sub("<csg>.*?</csg>", import_text, text, count=1)


KINDS = {f.__name__: f for f in (offset, set_by_index, solids_in_cells, imported)}
for known, make in membership.KINDS.items():
    KINDS[known] = lambda rng, folder, meso, make=make: make(rng)[0]


# ---- judging ----------------------------------------------------------------------------------------------------

class Judge:
    def __init__(self, program, points):
        self.program, self.points = program, points

    def run(self, *arguments):
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True)

    def verdict(self, file):
        """('ok' | 'touching' | 'refused' | 'invalid' | 'wrong', words)"""
        done = self.run("verify", "--deep", "--points", self.points, "--part", "a", "--json", "--timeout", 60, file)
        first = (done.stderr.strip().splitlines() or [""])[0]
        if done.returncode == 0:
            return "ok", ""
        if done.returncode in REFUSALS:
            return "refused", (re.search(r"(?:error|warning) ([A-Z_]+)", done.stderr) or [None, first])[1]
        failed = []
        if done.stdout.strip():
            failed = [f'{c["what"]}: {c["found"]} instead of {c["expected"]}' for c in json.loads(done.stdout).get("checks", []) if not c["passed"]]
        if done.returncode in (1, 2, 3) and not failed:
            return "invalid", first
        # Parts that touch in a line are told, and are what the definitions say.
        if "GEOMETRY_NON_MANIFOLD" in done.stderr and all(f.startswith(("closed", "multiple edges")) for f in failed):
            return "touching", ""
        return "wrong", "; ".join(failed) or f"exit code {done.returncode}: {first}"


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


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--meso", required=True)
    parser.add_argument("--count", type=int, default=40, help="documents in all")
    parser.add_argument("--seed", type=int, default=1, help="of the first document")
    parser.add_argument("--points", type=int, default=60000, help="random points for each")
    parser.add_argument("--kind", choices=sorted(KINDS), action="append")
    parser.add_argument("--keep", help="a folder for the documents")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    judge = Judge(a.meso, a.points)
    kinds = a.kind or list(KINDS)
    total, reasons = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as temporary:
        for n in range(a.count):
            kind, seed = kinds[n % len(kinds)], a.seed + n // len(kinds)
            folder = pathlib.Path(a.keep or temporary) / f"{kind}_{seed}"
            folder.mkdir(parents=True, exist_ok=True)
            text = KINDS[kind](random.Random(f"{kind} {seed}"), folder, judge.run)
            if text is None:
                total["skipped"] += 1
                continue
            file = folder / "part.meso"
            file.write_text(text.replace("@VALIDATION@", ""), encoding="utf-8")
            verdict, words = judge.verdict(file)
            total[verdict] += 1
            if verdict == "refused":
                reasons[words] += 1
            if verdict in ("wrong", "invalid") or a.verbose:
                print(f"{verdict} {kind} {seed} {words}", flush=True)
            if verdict == "wrong":
                print(smallest(judge, file.read_text(encoding="utf-8"), folder / "smallest.meso"), flush=True)
                print(judge.verdict(folder / "smallest.meso")[1], flush=True)
    print(", ".join(f"{total[v]} {v}" for v in ("ok", "touching", "refused", "skipped", "invalid", "wrong")) +
          "".join(f"; {n} x {r}" for r, n in reasons.most_common()))
    sys.exit(1 if total["wrong"] or total["invalid"] or not total["ok"] else 0)


if __name__ == "__main__":
    main()
