#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the command writes: files that appear whole or not at all, reports, equal bytes, packages.

usage: outputs_test.py MESO [unittest arguments]     verbs that this build lacks are skipped
"""
import json
import os
import re
import shutil
import signal
import subprocess
import time
import unittest
import zipfile

from command_case import ROOT, MESO, VERBS, BEAM, CONVERT_KEYS, COMPARE_KEYS, SECONDS, document, needs, CommandTest


class Outputs(CommandTest):
    def test_folders_and_full_disks(self):
        good = self.file("good.meso", document())
        (self.folder / "full.meso").symlink_to("/dev/full")
        self.expect(7, "canonical", good, self.folder / "none" / "out.meso", says="WRITE_FAILED")
        self.expect(7, "canonical", good, self.folder / "full.meso", says="WRITE_FAILED")
        with open("/dev/full", "wb") as full:
            done = subprocess.run([MESO, "info", str(good)], stdout=full, stderr=subprocess.PIPE)
            self.assertEqual(done.returncode, 7, done.stderr)
        if "render" in VERBS:
            (self.folder / "full.png").symlink_to("/dev/full")
            self.expect(7, "render", good, self.folder / "full.png", "--width", "64", "--height", "64", says="WRITE_FAILED")
        if "convert" in VERBS:
            self.expect(7, "convert", good, self.folder / "none" / "out.step", says="WRITE_FAILED")
            for ending in "step brep stl 3mf ply obj off vtk".split():
                (self.folder / f"full.{ending}").symlink_to("/dev/full")
                with self.subTest(ending=ending):
                    self.expect(7, "convert", good, self.folder / f"full.{ending}", says="WRITE_FAILED")
            self.expect(7, "eval", good, self.folder / "none" / "out.csv", says="WRITE_FAILED")

    def test_no_clobber(self):
        good, out = self.file("good.meso", document()), self.out("a.meso")
        self.expect(0, "canonical", good, out, "--no-clobber")
        out.write_text("mine")
        self.expect(7, "canonical", good, out, "--no-clobber", says="WRITE_EXISTS")
        self.assertEqual(out.read_text(), "mine")
        self.expect(0, "canonical", good, out)
        self.assertEqual(self.run_meso("canonical", out).stdout, out.read_bytes())

    @needs("convert")
    def test_a_failing_run_leaves_the_old_file(self):
        out = self.out()
        out.write_text("old")
        self.expect(6, "convert", self.file("a.meso", document(count="10^12")), out)
        self.assertEqual(out.read_text(), "old")
        self.expect(0, "convert", self.file("b.meso", document()), out)
        self.assertTrue(out.read_text().startswith("ISO-10303-21;"))
        self.assertEqual([p.name for p in out.parent.iterdir()], ["out.step"])
        self.expect(7, "convert", self.folder / "b.meso", out, "--no-clobber", says="WRITE_EXISTS")

    @needs("convert")
    def test_reports(self):
        done = self.expect(0, "convert", BEAM, self.out(), "--set", "pitch=10mm", "--json")
        report = json.loads(done.stdout)
        self.assertEqual(sorted(report), sorted(CONVERT_KEYS))
        self.assertEqual((report["cells"]["placed"], report["cells"]["kept"]), (600, 280))
        self.assertEqual(set(report["cells"]), {"placed", "kept", "crossing"})
        self.assertEqual(set(report["seconds"]), SECONDS)
        self.assertEqual((report["solids"], report["closed"], report["diagnostics"]), (1, True, []))
        self.assertEqual(report["bytes"], self.out().stat().st_size)
        done = self.expect(0, "compare", self.file("good.meso", document()), "--json")
        rows = json.loads(done.stdout)
        self.assertEqual([sorted(row) for row in rows], [sorted(COMPARE_KEYS)])
        self.assertEqual(set(rows[0]["seconds"]), SECONDS)
        made_elsewhere = self.file("scan/scan.meso", document(macrostructures='<macrostructures><macrostructure id="m"><import href="scan.step"/></macrostructure></macrostructures>'))
        self.expect(3, "compare", made_elsewhere, says="HREF_NOT_FOUND")
        self.file("scan/run.sh", "")
        made_by_script, mistyped = self.folder / "scan" / "made.meso", self.folder / "scan" / "maed.meso"
        self.file("scan/made.meso.in", "")
        done = self.expect(0, "compare", made_by_script, self.folder / "good.meso", says="COMPARE_NOT_MADE")
        self.assertRegex(done.stdout.decode(), r"(?s)good .*\nmade +not made; run .*/scan/run.sh .*/scan\n")
        self.expect(3, "compare", made_elsewhere, says="HREF_NOT_FOUND")
        self.expect(3, "compare", mistyped, says="FILE_NOT_FOUND")
        self.expect(3, "compare", self.folder / ("n" * 300 + ".meso"), says="error")
        self.expect(2, "verify", self.folder / "good.meso", says="--deep")
        failed = self.expect(6, "convert", self.file("a.meso", document(count="10^12")), self.out("b.step"), "--json")
        self.assertEqual(json.loads(failed.stdout)["diagnostics"][0]["code"], "LIMIT_CELLS")

    @needs("convert")
    @needs("sdf")
    def test_volumes_of_documents(self):
        words, design = ["tpms.gyroid", "scale", "5", "-b", "0,0,0,10,10,10", "-s", "20,20,20"], self.folder / "design.meso"
        self.expect(0, "sdf", *words, "-o", design)
        for ending in "vtu msh inp nrrd vti".split():
            by_words, by_document = self.out(f"words.{ending}"), self.out(f"document.{ending}")
            self.expect(0, "sdf", *words, "-o", by_words)
            self.expect(0, "convert", design, by_document)
            with self.subTest(ending=ending):
                self.assertEqual(by_words.read_bytes(), by_document.read_bytes())
        # Balls of a volume that is known, in a document that is no words.
        balls = self.file("balls.meso", document())
        exact = json.loads(self.expect(0, "convert", balls, self.out("a.stl"), "--json").stdout)["volume"]
        report = json.loads(self.expect(0, "convert", balls, self.out("a.inp"), "--elements", "100000", "--json").stdout)
        self.assertLess(abs(report["elements"] / 100000 - 1), 0.3)
        self.assertLess(abs(report["volume"] / exact - 1), 0.01)
        self.expect(0, "convert", balls, self.out("a.svg"), "--slices", "axis=z,count=3", "--samples", "40^3")
        self.assertEqual(len(list(self.out("").glob("a_000?.svg"))), 3)
        self.expect(0, "convert", balls, self.out("a.nrrd"), "--voxels", "density", "--samples", "40^3")
        self.out("a.vtu").write_text("old")
        self.expect(7, "convert", balls, self.out("a.vtu"), "--elements", "1000", "--no-clobber", says="WRITE_EXISTS")
        for name, *flags in (("b.vtu", "--tolerance", "0.1mm"), ("b.vtu", "--engine", "brep"), ("b.step", "--elements", "9"),
                             ("b.vtu", "--elements", "9", "--spacing", "1mm"), ("b.stl", "--voxels", "density"),
                             ("b.vtu", "--deflection", "1mm"), ("b.nrrd", "--slices", "axis=z")):
            with self.subTest(name=name, flags=flags):
                self.expect(2, "convert", balls, self.out(name), *flags)
        self.assertEqual(self.out("a.vtu").read_text(), "old")
        self.assertEqual(list(self.out("").glob("b.*")), [])

    @needs("convert")
    def test_equal_bytes(self):
        shutil.copy(BEAM.parent / "ibeam.step", self.folder)
        beam = shutil.copy(BEAM, self.folder)
        small = self.file("small.meso", document())
        drilled, ball = (BEAM.parents[1] / "documents" / name for name in ("drilled_plate.meso", "bcc_ball.meso"))
        for source, name, values in ((beam, "a.step", ["--set", "pitch=10mm"]), (beam, "a.stl", ["--set", "pitch=10mm"]), (small, "a.brep", []),
                                     (drilled, "b.stl", []), (ball, "b.step", [])):
            variants = [["--jobs", "1"], ["--jobs", "2"], ["--jobs", "7"], ["--jobs", "7"]]
            seen = set()
            for number, flags in enumerate(variants):
                locale = {**os.environ, "LC_ALL": ["C", "C.UTF-8", "de_DE.UTF-8", "tr_TR.UTF-8"][number]}
                self.expect(0, "convert", source, self.out(name), *values, *flags, env=locale)
                seen.add(self.out(name).read_bytes())
            with self.subTest(name=name):
                self.assertEqual(len(seen), 1)

    @needs("convert")
    def test_stopped_by_the_user(self):
        # Both while the body is made and while its file is written.
        for number, wait_for_file in ((signal.SIGINT, False), (signal.SIGTERM, True)):
            out = self.out("long.stl")
            job = subprocess.Popen([MESO, "convert", str(BEAM), str(out), "--ascii", "--set", "pitch=2mm", "--set", "strut=0.4mm",
                                    "--deflection", "0.002mm", "--angle", "0.1"], stderr=subprocess.PIPE)
            began = time.monotonic()
            while job.poll() is None and time.monotonic() - began < (60 if wait_for_file else 0.3):
                if wait_for_file and any(out.parent.iterdir()):
                    break
                time.sleep(0.01)
            self.assertIsNone(job.poll(), "the work ended too early to be stopped")
            job.send_signal(number)
            asked = time.monotonic()
            told = job.communicate(timeout=30)[1]
            with self.subTest(signal=number):
                self.assertLess(time.monotonic() - asked, 2)
                self.assertEqual(job.returncode, 130, told)
                self.assertIn(b"CANCELLED", told)
                self.assert_nothing_written()


@needs("pack")
class Packages(CommandTest):
    def packed_beam(self):
        """A package of the beam, and nothing else that a verb could read."""
        package = self.folder / "beam.mesoz"
        self.expect(0, "pack", BEAM, package)
        return package

    def same(self, verb, package, *flags, output=None, code=0):
        """The verb prints, and writes, of a package what it does of the document; and writes nothing else."""
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir(exist_ok=True)
        seen = []
        for source in (BEAM, package):
            names = [self.out(output)] if output else []
            done = self.expect(code, verb, source, *names, *flags, cwd=elsewhere, env={**os.environ, "TMPDIR": str(elsewhere)})
            seen.append((done.stdout.replace(str(source).encode(), b""), names[0].read_bytes() if names else b""))
        self.assertEqual(list(elsewhere.iterdir()), [])
        return seen

    def test_every_verb_reads_packages(self):
        package = self.packed_beam()
        for verb, flags, output in [("validate", ["--json"], None), ("info", [], None), ("eval", [], "cells.csv"),
                                    ("convert", ["--set", "pitch=10mm"], "beam.step"),
                                    ("convert", ["--engine", "implicit", "--samples", "60^3"], "beam.ply"),
                                    ("render", ["--set", "pitch=10mm", "--width", "64", "--height", "48"], "beam.png")]:
            if verb in VERBS:
                with self.subTest(verb=verb):
                    folder, packed = self.same(verb, package, *flags, output=output)
                    self.assertEqual(folder, packed)
        # The sum that pack has added is all that differs.
        folder, packed = self.same("canonical", package)
        self.assertEqual(re.sub(rb' sha256="[0-9a-f]{64}"', b"", packed[0]), folder[0])
        self.assertNotEqual(packed, folder)

    @needs("verify")
    def test_verify_and_compare_read_packages(self):
        package = self.packed_beam()
        self.expect(0, "verify", package)
        rows = json.loads(self.expect(0, "compare", BEAM, package, "--deflection", "1mm", "--json").stdout)
        self.assertEqual(rows[0]["packed"], package.stat().st_size)
        self.assertEqual(rows[1]["framework"], rows[0]["framework"] + len(' sha256=""') + 64)
        for key in ("cells", "macroStep", "partStep", "partStl", "packed"):
            self.assertEqual(rows[0][key], rows[1][key], key)

    @needs("field")
    def test_fields_in_packages(self):
        package = self.folder / "holes.mesoz"
        source = ROOT / "examples" / "documents"
        self.expect(0, "pack", source / "holes_at_records.meso", package)
        self.assertEqual(self.expect(0, "field", "info", package / "stress.csv").stdout,
                         self.expect(0, "field", "info", source / "stress.csv").stdout)
        self.expect(3, "field", "info", package / "nothing.csv", says="IMPORT_UNREADABLE")
        self.expect(1, "field", "info", package / ".." / "stress.csv", says="HREF_OUTSIDE")

    def test_packages_that_are_refused(self):
        package = self.packed_beam()
        for name, says in (("../../up.txt", "leads out"), ("/up.txt", "absolute"), ("more.txt", "does not list it")):
            bad = self.folder / "bad.mesoz"
            shutil.copy(package, bad)
            with zipfile.ZipFile(bad, "a") as archive:
                archive.writestr(name, "x")
            for arguments in (["validate", bad], ["unpack", bad, self.out("folder")]):
                self.expect(1, *arguments, says=says)
            self.assert_nothing_written()
        self.expect(6, "unpack", package, self.out("folder"), "--max-memory", "10K", says="PACKAGE_TOO_LARGE")
        cut = self.file("cut.mesoz", package.read_bytes()[:-30])
        self.expect(3, "unpack", cut, self.out("folder"), says="PACKAGE_UNREADABLE")
        self.expect(3, "validate", self.folder / "nothing.mesoz", says="FILE_NOT_FOUND")
        self.assert_nothing_written()

    def test_what_is_there_stays(self):
        package = self.packed_beam()
        self.expect(7, "pack", BEAM, package, "--no-clobber", says="WRITE_EXISTS")
        self.expect(2, "pack", BEAM, self.out("beam.zip"), says="pack writes .mesoz")
        self.expect(0, "unpack", package, self.out("folder"))
        self.expect(7, "unpack", package, self.out("folder"), says="WRITE_EXISTS")
        self.assertEqual(sorted(f.name for f in self.out("folder").iterdir()), ["ibeam.meso", "ibeam.step", "manifest.sha256"])

    @needs("render")
    def test_thumbnail(self):
        small, package = self.file("small.meso", document()), self.out("small.mesoz")
        self.expect(0, "pack", small, package, "--thumbnail")
        with zipfile.ZipFile(package) as archive:
            self.assertEqual(archive.namelist(), ["mimetype", "manifest.sha256", "small.meso", "thumbnail.png"])
            self.assertTrue(archive.read("thumbnail.png").startswith(b"\x89PNG"))
        self.assertTrue(package.read_bytes()[30:].startswith(b"mimetypeapplication/vnd.meso+zip"))
        self.expect(0, "validate", package)



if __name__ == "__main__":
    unittest.main()
