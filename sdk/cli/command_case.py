# SPDX-License-Identifier: Apache-2.0
"""What the tests of the command share: the build's verbs, small documents, a folder that goes away."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

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
