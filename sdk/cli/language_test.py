#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`meso sdf` from outside: words and flags, faults, limits, meshes.

usage: language_test.py MESO [unittest arguments]     verbs that this build lacks are skipped
"""
import json
import os
import signal
import subprocess
import time
import unittest

from command_case import MESO, needs, CommandTest


@needs("sdf")
class CommandLanguage(CommandTest):
    def sdf(self, code, words, says=""):
        return self.expect(code, "sdf", *words.split(), says=says, cwd=self.folder)

    def test_words_and_flags_mix(self):
        report = json.loads(self.sdf(0, "--jobs 1 ball --json move -1,0,0 -o ball.stl -s 30^3 --no-clobber").stdout)
        self.assertEqual(sorted(report), sorted("""output volume area solidFraction extrapolated triangles vertices components cavities crumbs
                                                   closed euler bbox box samples bytes seconds peakBytes diagnostics""".split()))
        self.assertAlmostEqual(report["volume"], 4.18879, delta=0.05)
        self.assertEqual((report["components"], report["euler"], report["closed"], report["samples"]), (1, 2, True, [30] * 3))
        self.assertEqual(report["bytes"], (self.folder / "ball.stl").stat().st_size)
        self.sdf(7, "ball -o ball.stl --no-clobber", says="WRITE_EXISTS")
        help = self.sdf(0, "-h").stdout
        for said in (b"intersection", b"tpms.gyroid", b"tpms.slotted-p"):
            self.assertIn(said, help)
        self.sdf(0, "ball --version")
        self.sdf(0, "ball -s 20^3")
        self.assertTrue((self.folder / "out.ply").exists())

    def test_faults_have_codes_of_the_one_table(self):
        (self.folder / "loop.txt").write_text("@loop.txt")
        (self.folder / "empty.off").write_text("OFF\n0 0 0\n")
        (self.folder / "full.ply").symlink_to("/dev/full")
        for code, says, words in ((2, "SDF_STACK_LEFT", ""), (2, "SDF_STACK_LEFT", "ball ball"), (2, "SDF_STACK_UNDERFLOW", "union"),
                                  (2, "^~~", "ball bxo"), (2, "SDF_VALUE", "ball scale 0"), (2, "SDF_INCLUDE", "@loop.txt"),
                                  (2, ".vtu .msh .inp", "ball -o a.step"), (6, "1e+10 nodes", "ball -s 1e30"), (2, "USAGE", "ball --jobs many"), (2, "USAGE", "ball --double -o a.stl"),
                                  (2, "SDF_UNKNOWN_WORD", "ball --max-cells 3"), (3, "FILE_NOT_FOUND", "@none.txt"), (3, "FILE_NOT_FOUND", "file none.ply"),
                                  (3, "MESH_FILE", "file empty.off"), (7, "WRITE_FAILED", "ball -o none/a.ply"), (7, "WRITE_FAILED", "ball -s 200^3 -o full.ply"),
                                  (6, "LIMIT", "tpms.gyroid -s 30000,30000,30000 --max-memory 256M -o a.ply"), (6, "LIMIT_TIME", "tpms.gyroid -s 3000,3000,3000 --timeout 0.2 -o a.ply")):
            with self.subTest(words=words):
                self.sdf(code, words, says=says)
        self.assertFalse(any(self.folder.glob("a.*")) or any(self.folder.glob("out*")))

    def test_json_is_one_object_however_a_run_ends(self):
        for code, name, words in ((2, "SDF_UNKNOWN_WORD", "ball bxo --json"), (2, "USAGE", "ball --json --jobs many"),
                                  (2, "USAGE", "ball --json --max-memory 3X"), (2, "SDF_EXTENSION", "ball --json -o a.step"),
                                  (3, "FILE_NOT_FOUND", "--json file none.ply"), (6, "LIMIT_GRID", "ball -s 1e30 --json"),
                                  (6, "LIMIT_GRID_MEMORY", "ball -s 30000,30000,30000 --max-memory 64M --json"),
                                  (6, "LIMIT_TIME", "tpms.gyroid -s 3000,3000,3000 --timeout 0.2 --json"),
                                  (7, "WRITE_FAILED", "ball -o none/a.ply --json")):
            with self.subTest(words=words):
                failed = json.loads(self.sdf(code, words, says=name).stdout)
                self.assertEqual((failed["error"]["code"], failed["error"]["exitCode"]), (name, code))
                self.assertTrue(failed["error"]["message"] and failed["error"]["number"])
        self.assertNotIn("error", json.loads(self.sdf(0, "ball -s 20^3 --json").stdout))

    def test_words_that_never_come(self):
        os.mkfifo(self.folder / "silent")
        keep_open = os.open(self.folder / "silent", os.O_RDWR)
        failed = json.loads(self.sdf(6, "@silent --timeout 0.5 --json", says="LIMIT_TIME").stdout)
        os.close(keep_open)
        self.assertEqual(failed["error"]["code"], "LIMIT_TIME")

    def test_a_lost_terminal_and_a_file_size_limit_leave_nothing(self):
        job = subprocess.Popen([MESO, "sdf", "tpms.gyroid", "-s", "2000,2000,2000", "-o", "a.ply", "--json"], cwd=self.folder,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        while job.poll() is None and not any(self.folder.glob(".a.ply*")):
            time.sleep(0.01)
        job.send_signal(signal.SIGHUP)
        told, _ = job.communicate(timeout=30)
        self.assertEqual((job.returncode, json.loads(told)["error"]["code"]), (130, "CANCELLED"))
        limited = subprocess.run(["bash", "-c", f"ulimit -f 64; exec {MESO} sdf tpms.gyroid -o a.ply"], cwd=self.folder, capture_output=True)
        self.assertEqual(limited.returncode, 7, limited.stderr)
        self.assertEqual(list(self.folder.glob("*a.ply*")), [])

    @needs("verify")
    @needs("render")
    def test_meshes_are_judged_and_drawn(self):
        for name in ("a.ply", "a.stl", "a.obj", "a.off"):
            with self.subTest(name=name):
                self.sdf(0, f"ball -s 20^3 -o {name}")
                report = json.loads(self.expect(0, "verify", self.folder / name, "--json").stdout)
                self.assertEqual((report["verdict"], report["closed"], report["solids"]), ("passed", True, 1))
                self.expect(0, "render", self.folder / name, self.folder / "a.png", "--width", "64", "--height", "64")
                self.expect(2, "verify", self.folder / name, "--set", "n=1", says="on documents only")
        for name in ("a.vtk", "a.3mf"):  # written, not read
            self.sdf(0, f"ball -s 20^3 -o {name}")
            self.expect(3, "verify", self.folder / name, says="MESH_FILE_FORMAT")

    def test_an_empty_solid_is_a_warning(self):
        report = json.loads(self.sdf(0, "tpms.gyroid offset -9 --json", says="SDF_EMPTY").stdout)
        self.assertEqual((report["triangles"], report["volume"], report["bbox"]), (0, 0, None))

    def test_equal_bytes(self):
        for name in ("a.ply", "a.stl", "a.3mf", "a.obj", "a.off", "a.vtk"):
            seen = set()
            for number, jobs in enumerate((1, 2, 7)):
                locale = {**os.environ, "LC_ALL": ["C", "de_DE.UTF-8", "tr_TR.UTF-8"][number]}
                self.expect(0, "sdf", "tpms.s", "-s", "40^3", "-o", name, "--jobs", jobs, env=locale, cwd=self.folder)
                seen.add((self.folder / name).read_bytes())
            with self.subTest(name=name):
                self.assertEqual(len(seen), 1)


if __name__ == "__main__":
    unittest.main()
