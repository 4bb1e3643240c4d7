#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Words as documents and back, and meshes to an accuracy, as the command makes them.

usage: words_and_accuracy_test.py MESO
"""

import collections
import json
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

MESO = pathlib.Path(sys.argv.pop(1)).resolve()
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
HAS_CONVERT = "convert" in subprocess.run([MESO, "--help"], capture_output=True, text=True).stdout


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def meso(self, code, verb, words, says=""):
        done = subprocess.run([MESO, verb, *shlex.split(words)], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, f"meso {verb} {words}\n{done.stderr}")
        self.assertIn(says, done.stderr + done.stdout, words)
        return done.stdout

    def bytes(self, name):
        return (self.folder / name).read_bytes()


class WordsAsDocuments(Command):
    DESIGNS = [
        "tpms.gyroid scale 1.5 shell 0.4 ball scale 2 intersection -s 30^3",
        "tpms.gyroid shell '0.3 + 0.1*x' -b 0,0,0,2,1,0.7 -s 30,20,14",
        "tpms.gyroid density 0.3 tpms.p scale 0.7 union -b -.1,-.2,-.3,.9,1.1,.7 -s 20^3",
        "box scale 2 ball scale 2.4 difference rotate 1,2,3 0.7 -s 24^3",
        "strut.octet 0.07 def core box scale 1.2 dup shell 0.2 swap recall core intersection union -s 24^3",
        "ball box move 1,1,1 smooth-union 0.3 mirror 1,1,0 complement -s 20^3",
        "tpms.gyroid density 0.4 cylindrical 12 cylinder scale 2.9 intersection cylinder difference -b -3,-3,0,3,3,2 -s 30^3",
        "strut.octet 0.07 scale 0.8 cylindrical 10 -b -2,-2,-1,2,2,1 -s 24^3",
        "tpms.p shell 0.6 spherical 12,6 ball scale 2.9 intersection half-space 1,-1,0,0 intersection -s 30^3",
        "tpms.p shell 0.8 helix 8,3 cylinder scale 2.9 intersection cylinder scale 0.9 difference -b -3,-3,0,3,3,4 -s 30^3",
        "tpms.d helix 3,-1 rotate 1,1,0 0.5 cylindrical -7 shell 0.4 box ball move 1,0,0 union spherical -3,2 union -b -2,-2,-2,2,2,2 -s 24^3",
        "cylinder scale 0.3 orient 0,1,0 move 1.2,0,0 repeat 0,0,1 helix 1,1 -b -2,-2,0,2,2,4 -s 30^3",
        "tpms.gyroid tpms.d blend '(x + 1)/2' -s 20^3",
        "ball box move 0.5,0,0 difference rotate 1,2,3 0.4 shell 0.1 -s 24^3",
    ]

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_same_bytes(self):
        for words in self.DESIGNS:
            with self.subTest(words=words):
                self.meso(0, "sdf", f"{words} -o words.ply")
                self.meso(0, "sdf", f"{words} -o part.meso")
                self.meso(0, "validate", "part.meso")
                self.meso(0, "convert", "part.meso part.ply")
                self.assertEqual(self.bytes("part.ply"), self.bytes("words.ply"))
                printed = self.meso(0, "sdf", "--print part.meso").strip()
                self.meso(0, "sdf", f"{printed} -o printed.ply")
                self.assertEqual(self.bytes("printed.ply"), self.bytes("words.ply"), printed)
        self.meso(0, "convert", "part.meso sharp.stl --sharp")
        self.meso(0, "sdf", f"{self.DESIGNS[-1]} --sharp -o words.stl")
        self.assertEqual(self.bytes("sharp.stl"), self.bytes("words.stl"))

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_meshes_are_referred_to(self):
        (self.folder / "deep").mkdir()
        self.meso(0, "sdf", "torus 1,0.4 -s 20^3 -o deep/torus.stl")
        words = "file deep/torus.stl tpms.p scale 0.5 intersection -s 20^3"
        self.meso(0, "sdf", f"{words} -o deep/part.meso")
        self.meso(0, "convert", "deep/part.meso part.ply")
        self.meso(0, "sdf", f"{words} -o words.ply")
        self.assertEqual(self.bytes("part.ply"), self.bytes("words.ply"))
        printed = self.meso(0, "sdf", "--print deep/part.meso").strip()
        self.meso(0, "sdf", f"{printed} -o printed.ply")
        self.assertEqual(self.bytes("printed.ply"), self.bytes("words.ply"))

    def test_what_cannot_be_said_is_named(self):
        self.meso(4, "sdf", "ball box smooth-union 0.2 shell 0.1 -o part.meso", says="SDF_NOT_A_DOCUMENT: no document is written: 'shell'")
        self.assertFalse((self.folder / "part.meso").exists())
        self.meso(0, "sdf", "tpms.gyroid cylindrical 8 -o bent.meso")
        self.meso(4, "convert", "bent.meso bent.step", says="CONFORMAL_NOT_REALISED")
        self.meso(2, "sdf", "ball --sharp -o part.meso", says="USAGE")
        self.meso(0, "sdf", "ball -s 20^3 -o ball.stl")
        (self.folder / "deep").mkdir()
        self.meso(4, "sdf", "file ball.stl -o deep/part.meso", says="'file': the mesh does not lie in the document's folder")
        self.meso(4, "sdf", f"--print {EXAMPLES / 'implicit' / 'gyroid_ball.meso'}", says="SDF_NOT_WORDS")
        self.meso(2, "sdf", "--print part.meso ball", says="USAGE")
        self.meso(3, "sdf", "--print none.meso", says="FILE_NOT_FOUND")
        self.meso(0, "sdf", "ball -o part.meso", says="part.meso: 1 part, 0 unit cells, ")
        self.meso(7, "sdf", "ball -o part.meso --no-clobber", says="WRITE_EXISTS")

    def test_new_words_have_faults(self):
        for words, says in [
            ("ball recall a", "no solid is named 'a'"),
            ("ball def wall recall wal", "did you mean 'wall'?"),
            ("drop", "SDF_STACK_UNDERFLOW"),
            ("ball over union", "SDF_STACK_UNDERFLOW"),
            ("ball dup", "SDF_STACK_LEFT"),
            ("ball density 0.5", "no period to fill"),
            ("tpms.gyroid density 1.5", "a share lies between 0 and 1"),
            ("ball shell 'x + w'", "there is no name 'w'"),
            ("strut.bcc 0.3", "less than a quarter"),
            ("strut.bbc 0.1", "did you mean 'strut.bcc'?"),
            ("ball repeat 0,0,0", "steps are positive"),
            ("ball 5 out.stl", "there is no word '5'; 'ball' takes no size: 'scale 5' behind it scales it"),
            ("ball box union 3", "'union' takes no number"),
            ("ball shell 0.1 0.2", "'shell' takes t, separated by commas"),
            ("ball out.stl", "-o out.stl writes it"),
            ("expression 'sin(x'", "'(' has no matching ')'"),
            ("ball cylindrical 0", "it would not be bent"),
            ("ball box smooth-union -1", "not negative"),
        ]:
            with self.subTest(words=words):
                self.meso(2, "sdf", words, says=says)

    def test_what_is_clamped_is_told(self):
        says = "SDF_CLAMPED: '0.5 + x' goes from -0.5 to 1.5 in the box; at 48 % of it"
        words = "tpms.gyroid density '0.5 + x' -b -1,-1,-1,1,1,1 -s 20^3"
        self.meso(0, "sdf", f"{words} -o words.ply", says=says)
        self.meso(0, "sdf", "tpms.gyroid tpms.d blend '2*x' -b 0,0,0,1,1,1 -s 20^3", says="SDF_CLAMPED")
        done = subprocess.run([MESO, *shlex.split("sdf tpms.gyroid tpms.d blend 'clamp(2*x, 0, 1)' -s 20^3")],
                              cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0)
        self.assertNotIn("SDF_CLAMPED", done.stderr)
        if not HAS_CONVERT:
            return
        self.meso(0, "sdf", f"{words} -o part.meso")
        self.meso(0, "convert", "part.meso part.ply", says=says)
        self.assertEqual(self.bytes("part.ply"), self.bytes("words.ply"))


def read_off(path):
    words = path.read_text().split()
    count, faces = int(words[1]), int(words[2])
    numbers = words[4:]
    points = [tuple(map(float, numbers[3 * i: 3 * i + 3])) for i in range(count)]
    rest = numbers[3 * count:]
    return points, [tuple(map(int, rest[4 * i + 1: 4 * i + 4])) for i in range(faces)]


class Accuracy(Command):
    def mesh(self, words, code=0, says=""):
        report = json.loads(self.meso(code, "sdf", f"{words} -o mesh.off --json", says=says))
        return (report, *read_off(self.folder / "mesh.off"))

    def assert_closed(self, triangles):
        edges = collections.Counter()
        for t in triangles:
            for i in range(3):
                edges[t[i], t[(i + 1) % 3]] += 1
        self.assertTrue(all(count == 1 and edges[b, a] == 1 for (a, b), count in edges.items()))

    def farthest_from_ball(self, points, triangles):
        """At vertices, middles of edges and of triangles."""
        worst = max(abs(math.hypot(*p) - 1) for p in points)
        for t in triangles:
            a, b, c = (points[i] for i in t)
            middle = [sum(x) / 3 for x in zip(a, b, c)]
            half = [sum(x) / 2 for x in zip(a, b)]
            worst = max(worst, abs(math.hypot(*middle) - 1), abs(math.hypot(*half) - 1))
        return worst

    def test_tolerance_holds_on_a_ball(self):
        counts = []
        for tolerance in (0.02, 0.002):
            report, points, triangles = self.mesh(f"ball --tolerance {tolerance}")
            self.assert_closed(triangles)
            self.assertLessEqual(report["accuracy"]["distance"], tolerance)
            # Told distances are to the surface from points on the mesh: nothing is farther but for rounding to floats.
            self.assertLessEqual(self.farthest_from_ball(points, triangles), tolerance + 1e-6)
            counts.append(len(triangles))
        self.assertLess(counts[1], 20 * counts[0], "about as tolerance over tolerance")

    def test_simplified_stays_as_close(self):
        plain = len(self.mesh("ball -s 40^3")[2])
        report, points, triangles = self.mesh("ball -s 40^3 --simplify 0.01")
        self.assert_closed(triangles)
        self.assertLessEqual(report["accuracy"]["distance"], 0.01)
        self.assertLessEqual(self.farthest_from_ball(points, triangles), 0.01 + 1e-6)
        self.assertLess(len(triangles), plain / 5)
        words = "box rotate 1,2,3 0.4 -s 30^3 --sharp"
        plain, box = self.mesh(words), self.mesh(words + " --simplify 0.001")
        self.assert_closed(box[2])
        self.assertLess(len(box[2]), len(plain[2]) / 10)
        self.assertAlmostEqual(box[0]["volume"], 8, delta=0.02)

    def test_sharp_edges_are_on_the_solid(self):
        # A box turned about z; its edges along z go through (sqrt(2) cos a, sqrt(2) sin a).
        angle, h = 0.3, 3 / 40
        words = "box rotate 0,0,1 0.3 cylinder scale 0.4 difference -b -1.5,-1.5,-1.5,1.5,1.5,1.5 -s 41,41,41"
        corner = [math.sqrt(2) * math.cos(angle + math.pi / 4), math.sqrt(2) * math.sin(angle + math.pi / 4)]

        def edge_error(points):
            """The farthest of the points nearest to the edge, at heights well inside."""
            return max(min(math.hypot(p[0] - corner[0], p[1] - corner[1]) for p in points if abs(p[2] - z) < h) for z in (-0.5, 0, 0.5))

        plain, sharp = self.mesh(words), self.mesh(words + " --sharp")
        self.assert_closed(sharp[2])
        self.assertGreater(edge_error(plain[1]), 0.05 * h)
        self.assertLess(edge_error(sharp[1]), 1e-3 * h)
        true = 8 - 2 * math.pi * 0.4 ** 2
        # Flat triangles in the hole leave about twice its area times (h / 0.4)^2 / 12.
        self.assertAlmostEqual(sharp[0]["volume"], true, delta=8e-3)

    def test_limits_and_flags(self):
        self.meso(6, "sdf", "tpms.gyroid --tolerance 1e-9 --timeout 60", says="LIMIT_TOLERANCE")
        self.meso(2, "sdf", "ball -s 40^3 --tolerance 0.01", says="--tolerance picks the samples")
        self.meso(2, "sdf", "ball --tolerance 0", says="USAGE")
        if not HAS_CONVERT:
            return
        tube, wall = (EXAMPLES / "implicit" / f"{name}.meso" for name in ("gyroid_tube", "wall_of_a_length"))
        self.meso(6, "convert", f"{wall} a.stl --tolerance 1e-9mm --timeout 60", says="LIMIT_TOLERANCE")
        self.meso(2, "convert", f"{tube} a.stl --tolerance 0.1deg", says="is an angle, and a length such as 0.2mm is asked for")
        for flag in ("--samples 40", "--spacing 1mm"):
            self.meso(2, "convert", f"{tube} a.stl --tolerance 0.1mm {flag}", says="--tolerance picks the samples")

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_memory_is_as_told(self):
        """160 bytes a triangle, and what the program takes: 420 000 triangles of blended_cells fit into 120 MiB."""
        blended, ball = (EXAMPLES / "implicit" / f"{name}.meso" for name in ("blended_cells", "gyroid_ball"))
        report = json.loads(self.meso(0, "convert", f"{blended} a.ply --engine implicit --tolerance 0.1mm --max-memory 120M --jobs 1 --json"))
        self.assertEqual([d["code"] for d in report["diagnostics"]], [])
        self.assertGreater(report["triangles"], 250000)
        self.meso(6, "convert", f"{ball} a.ply --tolerance 0.01mm --max-memory 60M --jobs 1", says="MiB at least, the budget is 60 MiB")

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_says_what_it_would_take(self):
        """Whatever the budget: beyond it from the start, while a mesh is refined, while a finer grid is made."""
        ball = EXAMPLES / "implicit/gyroid_ball.meso"
        words = [MESO, "convert", ball, self.folder / "a.ply", "--engine", "implicit", "--jobs", "1", "--progress", "none", "--tolerance"]
        whole = subprocess.Popen([*words, "0.1mm"], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(whole.pid, 0)
        whole.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(whole.returncode, 0)
        for tolerance, budget in (("0.1mm", 100), ("0.01mm", 100), ("0.01mm", 60), ("1e-5mm", 200)):
            done = subprocess.run([*words, tolerance, "--max-memory", f"{budget}M"], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 6, done.stderr)
            told = re.search(r"LIMIT_TOLERANCE: .* takes about \S+ triangles and (\d+) MiB at least, the budget is (\d+) MiB", done.stderr)
            self.assertTrue(told, done.stderr)
            takes = int(told[1])
            self.assertGreater(takes, budget)
            self.assertEqual(int(told[2]), budget)
            if tolerance == "0.1mm":
                self.assertGreater(2 * takes, usage.ru_maxrss / 1024)
                self.assertLess(takes / 2, usage.ru_maxrss / 1024)

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_rounds_that_make_it_worse_ask_for_no_finer_grid(self):
        """Where walls end at thin angles, refining moves what is far, and farther: the grid that the closest mesh asks for is enough."""
        ball = EXAMPLES / "implicit/gyroid_ball.meso"
        report = json.loads(self.meso(0, "convert", f"{ball} a.ply --tolerance 0.06mm --set radius=6mm --json"))
        self.assertLessEqual(report["accuracy"]["distance"], 0.06)
        self.assertLess(report["accuracy"]["gridSamples"], 2.1e6)

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_edges_ask_for_no_finer_grid(self):
        """Two rings of the cone: its thin sheets end in edges as long as they are, beside which triangles fold on any grid."""
        cone = (EXAMPLES / "implicit/gyroid_cone.meso").read_text(encoding="utf-8")
        (self.folder / "cone.meso").write_text(cone.replace('count="8"', 'count="2"'), encoding="utf-8")
        report = json.loads(self.meso(0, "convert", "cone.meso a.ply --engine implicit --tolerance 0.2mm --json"))
        self.assertLessEqual(report["accuracy"]["distance"], 0.2)
        self.assertLess(report["accuracy"]["gridSamples"], 2e7)

    @unittest.skipUnless(HAS_CONVERT, "this build does not convert")
    def test_a_finer_grid_where_the_first_is_not_enough(self):
        spring = EXAMPLES / "implicit/spring.meso"
        report = json.loads(self.meso(0, "convert", f"{spring} a.ply --engine implicit --tolerance 0.1mm --json"))
        self.assertLessEqual(report["accuracy"]["distance"], 0.1)


if __name__ == "__main__":
    unittest.main()
