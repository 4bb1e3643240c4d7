#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of random_parts.py: planted faults are found and made small, refusals are judged.

usage: random_parts_test.py
"""
import pathlib
import random
import re
import tempfile
import unittest

import random_parts


class PlantedFault:
    """Judges like an engine that gets every difference with a torus wrong whose cell stands at x > 1."""

    def __init__(self):
        self.asked = 0

    def verdict(self, file):
        self.asked += 1
        text = file.read_text(encoding="utf-8")
        start = re.search(r'axis="x"[^>]* start="([-0-9.]+)"', text)
        wrong = "<difference>" in text and "<torus" in text and start and float(start[1]) > 1
        return ("wrong", "planted") if wrong else ("ok", "")


class Minimisation(unittest.TestCase):
    def test_only_what_the_fault_needs_is_left(self):
        found = 0
        for seed in range(1, 200):
            text, _, _ = random_parts.solids_in_cells(random.Random(f"solids_in_cells {seed}"), None, None)
            judge = PlantedFault()
            with tempfile.TemporaryDirectory() as name:
                file = pathlib.Path(name) / "smallest.meso"
                file.write_text(text, encoding="utf-8")
                if judge.verdict(file)[0] != "wrong":
                    continue
                small = random_parts.smallest(judge, text, file)
                self.assertEqual(judge.verdict(file)[0], "wrong")
                self.assertLessEqual(judge.asked, random_parts.STEPS + 2)
            self.assertLess(len(small), 0.6 * len(text))
            self.assertEqual(small.count("<torus"), 1, small)
            self.assertLessEqual(small.count("<loop"), 1, small)
            self.assertNotIn("<ellipsoid", small)
            found += 1
            if found == 3:
                return
        self.fail("no document has the planted fault")


class Refusals(unittest.TestCase):
    BOX = ([-1] * 3, [3] * 3)

    def judged(self, words, inside):
        return random_parts.judged_refusal(random.Random(1), words, inside, self.BOX)

    def test_empty_parts_must_be_empty(self):
        self.assertEqual(self.judged("GEOMETRY_EMPTY", lambda p: False)[0], "empty")
        self.assertEqual(self.judged("GEOMETRY_EMPTY", lambda p: max(map(abs, p)) < 0.3)[0], "wrong")

    def test_only_reasons_that_are_known_are_allowed(self):
        self.assertEqual(self.judged("GEOMETRY_BOOLEAN", lambda p: True)[0], "refused")
        self.assertEqual(self.judged("INTERNAL", lambda p: True)[0], "wrong")
        self.assertEqual(self.judged("GEOMETRY_KERNEL", lambda p: True)[0], "wrong")


class Membership(unittest.TestCase):
    def test_every_kind_tells_inside_from_outside(self):
        for kind, make in random_parts.KINDS.items():
            if kind == "imported":  # needs a program that writes the body
                continue
            found = set()
            for seed in range(1, 9):
                made = make(random.Random(f"{kind} {seed}"), None, None)
                rng = random.Random(seed)
                found |= {bool(made[1]([rng.uniform(l, h) for l, h in zip(*made[2])])) for _ in range(300)}
            self.assertEqual(found, {True, False}, kind)


if __name__ == "__main__":
    unittest.main()
