#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command from outside: flags and exit codes.

usage: command_test.py MESO [unittest arguments]     verbs that this build lacks are skipped
"""
import json
import pathlib
import re
import subprocess
import time
import unittest

from command_case import ROOT, MESO, VERBS, BEAM, document, needs, CommandTest


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

    def test_misspelt_words(self):
        good = self.file("good.meso", document())
        self.expect(2, "konvert", good, says="there is no verb 'konvert'")
        self.expect(2, "validte", good, says="did you mean 'validate'?")
        self.expect(2, "info", "--jsn", good, says="error USAGE: there is no flag '--jsn'; did you mean '--json'?")
        self.expect(2, "info", "--jsn=1", good, says="did you mean '--json'?")
        self.expect(2, "validate", says="error USAGE: FILE is required")
        if "convert" in VERBS:
            self.expect(2, "convert", self.file("a.step", ""), self.out(), says='<import href="a.step"/>')

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
                     ["--deflection", "1deg"], ["--angle", "1mm"],
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
        for flag in (["--tolerance", "0.1mm"], ["--sharp"], ["--simplify", "0.1mm"]):
            chosen = json.loads(self.expect(0, "convert", solid, self.out("c.ply"), "--json", *flag).stdout)
            self.assertEqual(chosen["engine"], "implicit")
            self.expect(2, "convert", solid, self.out("d.ply"), "--engine", "brep", *flag, says="--deflection")
            self.expect(2, "convert", solid, self.out("d.step"), *flag, says="meshes only")
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
        axes = "".join(f'<loop index="{i}" axis="{axis}" count="9" spacing="0.9"/>' for i, axis in zip("uvw", "xyz"))
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


if __name__ == "__main__":
    unittest.main()
