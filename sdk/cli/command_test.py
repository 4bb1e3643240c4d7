#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command from outside: flags, exit codes, files that appear whole or not at all, equal bytes.

usage: command_test.py MESO [unittest arguments]     verbs that this build lacks are skipped
"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MESO = str(pathlib.Path(sys.argv.pop(1)).resolve())
VERBS = set(re.findall(r"^  ([a-z]+) ", subprocess.run([MESO, "--help"], capture_output=True, text=True,
                                                        check=True).stdout.partition("Subcommands:")[2], re.M))
BEAM = ROOT / "examples" / "ibeam" / "ibeam.meso"
CONVERT_KEYS = """input output engine cells solids faces triangles volume area closed fragments bytes seconds
                  peakBytes diagnostics way""".split()
COMPARE_KEYS = """name cells macroStep partStep partStl framework packed vsStep vsStl triangles deflection angle
                  seconds""".split()
SECONDS = {"read", "evaluate", "realise", "write", "total"}

DOCUMENT = """<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter"{attributes}>
  <parameters><parameter id="n" value="3"/></parameters>
  {macrostructures}
  <unitCells><unitCell id="u"><parameter id="r" value="1"/><box dx="5" dy="5" dz="5"/>{body}</unitCell></unitCells>
  <patterns><pattern id="p" unitCell="u"><loop index="i" axis="x" count="{count}" spacing="5"/>{instructions}</pattern></patterns>
  <parts><part id="a"{part}><apply pattern="p" operation="union"/></part></parts>
</meso>
"""
SPHERE = "<csg><sphere radius=\"r\"/></csg>"


def document(body=SPHERE, count="n", instructions="", attributes="", macrostructures="", part=""):
    return DOCUMENT.format(**locals())


def needs(verb):
    return unittest.skipUnless(verb in VERBS, f"this build has no {verb}")


def flags_in_help(verb):
    """Those of the verb and of what stands below it (meso field import)."""
    text = subprocess.run([MESO, *verb, "--help"], capture_output=True, text=True, check=True).stdout
    flags = set(re.findall(r"^\s+(?:-\w,)?(--[a-z-]+)", text, re.M)) - {"--help", "--version"}
    _, _, below = text.partition("Subcommands:")
    return flags.union(*(flags_in_help([*verb, name]) for name in re.findall(r"^  ([a-z]+) ", below, re.M)))


def flags_in_page():
    """verb -> flags, from the table of docs/command.md."""
    table, previous = {}, []
    for line in (ROOT / "docs" / "command.md").read_text(encoding="utf-8").splitlines():
        if not line.startswith("| `--"):
            continue
        cells = [cell.strip() for cell in line[1:-1].split("|")]
        verbs = previous if cells[3] == "the same" else cells[3].split()
        previous = verbs
        for flag in re.findall(r"`(--[a-z-]+)", cells[0]):
            for verb in verbs:
                table.setdefault(verb, set()).add(flag)
    return table


class CommandTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="meso_command_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def file(self, name, text):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def out(self, name="out.step"):
        """A path in a folder that holds nothing else."""
        folder = self.folder / "out"
        folder.mkdir(exist_ok=True)
        return folder / name

    def run_meso(self, *arguments, **options):
        return subprocess.run([MESO, *map(str, arguments)], capture_output=True, timeout=120, **options)

    def expect(self, code, *arguments, says="", **options):
        done = self.run_meso(*arguments, **options)
        told = done.stderr.decode(errors="replace")
        self.assertEqual(done.returncode, code, f"meso {' '.join(map(str, arguments))}\n{told}")
        self.assertIn(says, told)
        return done

    def assert_nothing_written(self):
        self.assertEqual(list((self.folder / "out").iterdir()), [])


class Flags(CommandTest):
    @needs("render")
    def test_help_offers_what_the_page_lists(self):
        page = flags_in_page()
        for verb in sorted(VERBS):
            with self.subTest(verb=verb):
                self.assertEqual(flags_in_help([verb]), page.get(verb, set()))

    def test_unknown_flags_verbs_and_missing_arguments(self):
        self.expect(2)
        self.expect(2, "fly")
        for verb in VERBS:
            self.expect(2, verb, "--no-such-flag", "x")
            if verb != "formats":
                self.expect(2, verb)
        self.expect(2, "validate", "a.meso", "--set", "n=1")
        self.expect(2, "formats", "--jobs", "1")
        self.expect(0, "--version")
        self.expect(0, "--help")

    def test_flags_without_effect(self):
        good = self.file("good.meso", document())
        self.expect(2, "canonical", good, "--no-clobber", says="USAGE")

    @needs("convert")
    def test_flags_without_effect_where_geometry_is_made(self):
        good = self.file("good.meso", document())
        for arguments in (["convert", good, self.out(), "--ascii"], ["convert", good, self.out(), "--deflection", "1mm"],
                          ["convert", good, self.out("a.brep"), "--angle", "1"], ["info", good, "--part", "a"],
                          ["info", good, "--angle", "0.5"], ["compare", good, "--out", self.folder],
                          ["compare", good, "--no-clobber"], ["eval", good, "--no-clobber"],
                          ["eval", good, self.out("a.csv"), "--json"], ["verify", "a.stl", "--set", "n=1"]):
            self.expect(2, *arguments, says="USAGE")
        self.assert_nothing_written()

    @needs("convert")
    def test_values(self):
        good = self.file("good.meso", document())
        for flag in (["--set", "n"], ["--set", "=1"], ["--set", "n="], ["--set", "m=1"], ["--set", "n=1+"], ["--set", "n=1/0"],
                     ["--engine", "magic"], ["--deflection", "-1mm"], ["--deflection", "0"], ["--deflection", "wide"],
                     ["--angle", "1/0"], ["--jobs", "-1"], ["--jobs", "many"], ["--timeout", "0"], ["--timeout", "nan"],
                     ["--max-memory", "2X"], ["--max-memory", "-1G"], ["--max-memory", "1e400"], ["--progress", "loud"],
                     ["--part", "nobody"]):
            with self.subTest(flag=flag):
                self.expect(2, "convert", good, self.out("a.stl"), *flag)
        for name in ("a", "a.txt", "a.step.gz"):
            self.expect(2, "convert", good, self.out(name), says="USAGE")
        self.assert_nothing_written()


class ExitCodes(CommandTest):
    def reading_verbs(self):
        yield from (["validate"], ["info"], ["canonical"])
        if "convert" in VERBS:
            yield from (["eval"], ["verify"], ["compare"])

    def test_files_that_cannot_be_read(self):
        good = document()
        bad = {"empty.meso": b"", "text.meso": b"hello", "cut.meso": good[:300].encode(), "binary.meso": bytes(range(256)) * 9,
               "latin.meso": good.replace("id=\"a\"", "id=\"\xe4\"").encode("latin-1"), "null.meso": b"\0" * 1000}
        files = [self.file(name, text) for name, text in bad.items()] + [self.folder, self.folder / "missing.meso"]
        for verb in self.reading_verbs():
            for file in files:
                with self.subTest(verb=verb, file=file.name):
                    self.expect(3, *verb, file, says="error")

    def test_a_file_beyond_every_limit(self):
        huge = self.folder / "huge.meso"
        with open(huge, "wb") as file:
            file.truncate(1 << 40)
        began = time.monotonic()
        self.expect(6, "validate", huge, says="FILE_TOO_LARGE")
        self.assertLess(time.monotonic() - began, 5)

    def test_valid(self):
        done = self.expect(0, "validate", self.file("good.meso", document()), "--json")
        self.assertEqual(json.loads(done.stdout)["verdict"], "valid")

    def test_a_count_beyond_every_limit_is_valid(self):
        self.expect(0, "validate", self.file("many.meso", document(count="10^12")))

    def test_unknown_requires(self):
        self.expect(4, "validate", self.file("a.meso", document(attributes=' requires="warp"')), says="REQUIRES_UNKNOWN")

    def test_links_to_files(self):
        def linked(href):
            return document(macrostructures=f'<macrostructures><macrostructure id="m"><import href="{href}"/></macrostructure></macrostructures>',
                            part=' macrostructure="m"')
        self.expect(3, "validate", self.file("a.meso", linked("none.step")), says="HREF_NOT_FOUND")
        for href in ("../x.step", "/etc/passwd", "a/../../x.step"):
            self.expect(1, "validate", self.file("a.meso", linked(href)), says="HREF_OUTSIDE")

    @needs("convert")
    def test_imports_that_cannot_be_read(self):
        text = (ROOT / "examples/ibeam/ibeam.step").read_bytes()
        point = re.search(rb"CARTESIAN_POINT\('[^']*',\(([^,]+),", text)
        broken = {"empty.step": b"", "garbage.step": bytes(range(256)) * 40, "cut.step": text[:len(text) // 2],
                  "nan.step": text[:point.start(1)] + b"nan" + text[point.end(1):],
                  "cut.stl": b"\0" * 80 + (1000).to_bytes(4, "little") + b"\0" * 500, "empty.stl": b""}
        for name, content in broken.items():
            self.file(name, content)
            href = f'<import href="{name}"' + (' unit="millimeter"' if name.endswith("stl") else "") + "/>"
            file = self.file("a.meso", document(
                macrostructures=f'<macrostructures><macrostructure id="m">{href}</macrostructure></macrostructures>', part=' macrostructure="m"'))
            with self.subTest(name=name):
                done = self.run_meso("convert", file, self.out())
                self.assertIn(done.returncode, (3, 5), done.stderr)
                self.assertIn(b"error", done.stderr)
                self.assert_nothing_written()
                self.assertIn(self.run_meso("verify", self.folder / name).returncode, (1, 3, 5))

    @needs("convert")
    def test_what_stops_a_conversion(self):
        for code, says, text in ((1, "EXPRESSION_DOMAIN", document(count="20", instructions='<set parameter="r" value="1 + 1/(17 - i)"/>')),
                                 (4, "BREP_NOT_REALISED", document(body='<implicit field="hypot(x, hypot(y, z)) - r"/>')),
                                 (6, "LIMIT_CELLS", document(count="10^12"))):
            with self.subTest(says=says):
                self.expect(code, "convert", self.file("a.meso", text), self.out(), says=says)
                self.assert_nothing_written()
        self.expect(2, "convert", self.file("a.meso", document()), self.out(), "--engine", "implicit", says="exact faces")
        self.expect(6, "convert", self.file("a.meso", document()), self.out(), "--max-cells", "2", says="LIMIT_CELLS")
        self.assert_nothing_written()

    @needs("convert")
    def test_bodies_that_are_fields(self):
        field = self.file("field.meso", document(body='<implicit field="hypot(x, hypot(y, z)) - r"/>'))
        for name in ("a.stl", "a.ply", "a.obj", "a.off", "a.vtk"):
            out = self.out(name)
            self.expect(0, "convert", field, out, "--spacing", "0.2mm", says="ENGINE_CHOSEN")
            self.assertGreater(pathlib.Path(out).stat().st_size, 1000)
        before = pathlib.Path(self.out("a.ply")).read_bytes()
        self.expect(5, "convert", field, self.out("a.ply"), "--samples", "2,2,2", says="GEOMETRY_EMPTY")
        self.assertEqual(pathlib.Path(self.out("a.ply")).read_bytes(), before)
        solid = self.file("solid.meso", document())
        report = json.loads(self.expect(0, "convert", solid, self.out("b.ply"), "--engine", "implicit", "--samples", "60^3",
                                        "--measure", "--json").stdout)
        self.assertEqual(report["engine"], "implicit")
        self.assertTrue(report["closed"])
        exact = json.loads(self.expect(0, "convert", solid, self.out("c.ply"), "--json").stdout)
        self.assertEqual(exact["engine"], "brep")
        self.assertLess(abs(report["volume"] / exact["volume"] - 1), 0.05)
        for flags in (["--engine", "brep", "--spacing", "1mm"], ["--engine", "implicit", "--deflection", "1mm"],
                      ["--samples", "1"], ["--samples", "2,3"], ["--spacing", "0"], ["--spacing", "1mm", "--samples", "9"]):
            self.expect(2, "convert", solid, self.out("d.ply"), *flags)
        self.expect(5, "convert", field, self.out("d.ply"), "--samples", "2,2,2", says="part 'a'")
        self.expect(2, "convert", solid, self.out("d.ply"), "--engine", "brep", "--measure", says="--measure")
        self.assertGreater(exact["trianglesVolume"], 0.9 * exact["volume"])
        self.assertLess(exact["trianglesVolume"], exact["volume"])
        self.expect(6, "convert", field, self.out("d.ply"), "--samples", "60000^3", "--max-memory", "64M", says="LIMIT_GRID")
        self.assertFalse(pathlib.Path(self.out("d.ply")).exists())

    @needs("convert")
    @unittest.skipUnless("sdf" in VERBS, "this build has no implicit engine")
    def test_why_the_exact_engine_does_not_make_it(self):
        axes = "".join(f'<loop index="{i}" axis="{axis}" count="9" spacing="1"/>' for i, axis in zip("uvw", "xyz"))
        file = self.file("many.meso", f"""<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
          <macrostructures><macrostructure id="m"><csg><box dx="6" dy="6" dz="6"/></csg></macrostructure></macrostructures>
          <unitCells><unitCell id="u"><box dx="1" dy="1" dz="1"/><csg><sphere radius="0.7"/></csg></unitCell></unitCells>
          <patterns><pattern id="none" unitCell="u"><loop index="i" count="3"/><when test="i &gt; 5"/></pattern>
            <pattern id="many" unitCell="u">{axes}</pattern></patterns>
          <parts><part id="a" macrostructure="m"><apply pattern="none" operation="union"/><apply pattern="many" operation="union"/></part></parts>
        </meso>""")
        told = self.expect(0, "convert", file, self.out("a.stl"), says="the exact one answers: more than 600 solids").stderr.decode()
        self.assertEqual(told.count("PATTERN_KEEPS_NONE"), 1)

    @needs("render")
    def test_a_cut_beside_the_part(self):
        self.expect(2, "render", self.file("a.meso", document()), self.out("a.png"), "--cut", "z=90mm", says="does not meet the part")
        self.assert_nothing_written()

    @needs("convert")
    def test_fragments_that_are_dropped(self):
        text = document(macrostructures='<macrostructures><macrostructure id="m"><csg><box x="-3" y="-3" z="-3" dx="16" dy="6" dz="6"/></csg></macrostructure></macrostructures>',
                        part=' macrostructure="m"').replace('operation="union"', 'operation="intersection" fragments="drop"')
        file = self.file("a.meso", text)
        told = self.expect(0, "convert", file, self.out("a.step")).stderr.decode()
        self.assertIn("fragments dropped", told)
        self.assertNotIn("loose fragments", told)
        report = json.loads(self.expect(0, "convert", file, self.out("a.step"), "--json").stdout)
        self.assertEqual((report["solids"], report["fragments"], report["droppedFragments"]), (1, 0, 2))
        # Of two parts the first keeps them, and is the one that is built.
        step = '<apply pattern="p" operation="intersection" fragments="{}"/>'.format
        two = re.sub(r"<parts>.*</parts>", f'<parts><part id="a" macrostructure="m">{step("keep")}</part>'
                     f'<part id="b" macrostructure="m">{step("drop")}</part></parts><build><item part="a"/></build>', text)
        file = self.file("two.meso", two)
        for part, solids, kept, dropped in ([], 3, 2, None), (["--part", "b"], 1, 0, 2):
            report = json.loads(self.expect(0, "convert", file, self.out("a.step"), *part, "--json").stdout)
            self.assertEqual((report["solids"], report["fragments"], report.get("droppedFragments")), (solids, kept, dropped))

    @needs("convert")
    def test_step_files_are_audited(self):
        out = self.out("a.step")
        plate = BEAM.parent.parent / "documents" / "drilled_plate.meso"
        self.expect(0, "convert", plate, out)
        own = json.loads(self.expect(0, "verify", out, "--json").stdout)
        self.assertEqual((own["closed"], own["solids"], own["notes"]), (True, 1, []))
        self.assertEqual(len(own["shellVolumes"]), 1)

    @needs("convert")
    def test_limits_of_time_and_memory(self):
        began = time.monotonic()
        self.expect(6, "convert", BEAM, self.out(), "--set", "pitch=1mm", "--set", "strut=0.1mm", "--timeout", "0.5", says="LIMIT_TIME")
        self.assertLess(time.monotonic() - began, 5)
        self.expect(6, "convert", BEAM, self.out(), "--set", "pitch=1mm", "--set", "strut=0.1mm", "--max-memory", "64M", says="LIMIT_MEMORY")
        self.assert_nothing_written()


class Outputs(CommandTest):
    def test_folders_and_full_disks(self):
        good = self.file("good.meso", document())
        (self.folder / "full.stl").symlink_to("/dev/full")
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
            self.expect(7, "convert", good, self.folder / "full.stl", says="WRITE_FAILED")
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
        self.sdf(0, "ball -s 20^3 -o a.vtk")  # written, not read
        self.expect(3, "verify", self.folder / "a.vtk", says="MESH_FILE_FORMAT")

    def test_an_empty_solid_is_a_warning(self):
        report = json.loads(self.sdf(0, "tpms.gyroid offset -9 --json", says="SDF_EMPTY").stdout)
        self.assertEqual((report["triangles"], report["volume"], report["bbox"]), (0, 0, None))

    def test_equal_bytes(self):
        for name in ("a.ply", "a.stl", "a.obj", "a.off", "a.vtk"):
            seen = set()
            for number, jobs in enumerate((1, 2, 7)):
                locale = {**os.environ, "LC_ALL": ["C", "de_DE.UTF-8", "tr_TR.UTF-8"][number]}
                self.expect(0, "sdf", "tpms.s", "-s", "40^3", "-o", name, "--jobs", jobs, env=locale, cwd=self.folder)
                seen.add((self.folder / name).read_bytes())
            with self.subTest(name=name):
                self.assertEqual(len(seen), 1)


if __name__ == "__main__":
    unittest.main()
