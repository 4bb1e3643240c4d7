#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A signal ends the command within a second, whatever it is doing, and leaves nothing behind; so do --timeout,
--max-memory and --max-cells.

usage: stop_test.py MESO [unittest arguments]     STOP_TEST=all: every kind of work at every moment, some minutes
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

MESO = str(pathlib.Path(sys.argv.pop(1)).resolve())
VERBS = set(re.findall(r"^  ([a-z]+) ", subprocess.run([MESO, "--help"], capture_output=True, text=True,
                                                        check=True).stdout.partition("Subcommands:")[2], re.M))
EVERYTHING = os.environ.get("STOP_TEST") == "all"
MOMENTS = (0.3, 1, 2) if EVERYTHING else (0.7,)
SECONDS_TO_STOP = 1.0
# Of the test itself: starting a process and reading its end on a machine that does other things.
SECONDS_OF_GRACE = 1.0

DOCUMENT = """<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
<macrostructures><macrostructure id="m"><csg>{macrostructure}</csg></macrostructure></macrostructures>
<unitCells><unitCell id="u"><box dx="5" dy="5" dz="5"/>{cell}</unitCell></unitCells>
<patterns><pattern id="c" unitCell="u">{loops}</pattern></patterns>
<parts><part id="p" macrostructure="m"><apply pattern="c" operation="{operation}"/></part></parts></meso>
"""


def loops(*counts, start="0"):
    return "".join(f'<loop index="{index}" axis="{axis}" count="{count}" start="{start}" spacing="5"/>'
                   for index, axis, count in zip("ijk", "xyz", counts))


def struts():
    corners = [(x, y, z) for x in (0, 5) for y in (0, 5) for z in (0, 5)]
    nodes = "".join(f'<node id="n{n}" x="{x}" y="{y}" z="{z}"/>' for n, (x, y, z) in enumerate(corners))
    return ('<beams radius="0.5" nodeRadius="0.9"><node id="m" x="2.5" y="2.5" z="2.5"/>' + nodes +
            "".join(f'<beam from="n{n}" to="m"/>' for n in range(8)) + "</beams>")


def box(x, y, z):
    return f'<box dx="{x}" dy="{y}" dz="{z}"/>'


TORUS = '<torus x="81.3" y="80.7" z="20.4" ax="0.1" ay="0.2" az="1" majorRadius="60" minorRadius="17.3"/>'
# Each pair of neighbours overlaps, and so does each with the body's surface: one boolean of 600 solids.
BALLS = '<csg><sphere x="2.5" y="2.5" z="2.4" radius="2.8"/></csg>'
DOCUMENTS = {
    "torus": DOCUMENT.format(macrostructure=TORUS, cell=struts(), loops=loops(32, 32, 8), operation="intersection"),
    "many": DOCUMENT.format(macrostructure=box(200, 250, 250), cell=struts(), loops=loops(40, 50, 50), operation="intersection"),
    "fuse": DOCUMENT.format(macrostructure=box(60, 60, 9), cell=BALLS, loops=loops(12, 12, 3), operation="difference"),
    "gyroid": DOCUMENT.format(macrostructure=box(100, 100, 100), cell='<implicit field="sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)"/>',
                              loops=loops(20, 20, 20), operation="intersection"),
}
# name, files it needs made before, words; {d} is the folder of documents, {o} that of outputs
WORK = {
    "lattice in a torus": "convert {d}/torus.meso {o}/a.step",
    "lattice in a torus, as triangles": "convert {d}/torus.meso {o}/a.stl",
    "100 000 cells to STEP": "convert {d}/many.meso {o}/a.step",
    "100 000 cells to STL": "convert {d}/many.meso {o}/a.stl",
    "100 000 cells to .brep": "convert {d}/many.meso {o}/a.brep",
    "one large boolean": "convert {d}/fuse.meso {o}/a.step",
    "field of 1600^3": "convert {d}/gyroid.meso {o}/a.ply --samples 1600^3",
    "words, 1600^3": "sdf tpms.gyroid -s 1600,1600,1600 --polish -o {o}/a.ply",
    "tetrahedra": "sdf tpms.gyroid -s 560,560,560 -o {o}/a.vtu",
    "a large STEP read": "verify --deep {d}/large.step",
    "a large STEP imported": "convert {d}/import.meso {o}/a.stl",
    "a deep check": "verify --deep {d}/many.meso",
    "a deep check of a cut lattice": "verify --deep {d}/torus.meso",
    "a comparison": "compare {d}/many.meso",
    "a picture": "render {d}/many.meso {o}/a.png",
    "an estimate": "info --estimate {d}/torus.meso",
}
QUICK = ("lattice in a torus", "100 000 cells to STEP", "one large boolean", "field of 1600^3", "a large STEP read", "a deep check")


class Stopping(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = pathlib.Path(tempfile.mkdtemp(prefix="meso_stop_"))
        cls.documents, cls.outputs = cls.root / "documents", cls.root / "outputs"
        cls.documents.mkdir()
        cls.outputs.mkdir()
        for name, text in DOCUMENTS.items():
            (cls.documents / f"{name}.meso").write_text(text)
        # OpenCASCADE takes minutes to read a lattice of 1 000 cells.
        large = DOCUMENT.format(macrostructure=box(50, 50, 50), cell=struts(), loops=loops(10, 10, 10), operation="intersection")
        (cls.documents / "large.meso").write_text(large)
        subprocess.run([MESO, "convert", cls.documents / "large.meso", cls.documents / "large.step"], check=True, capture_output=True)
        (cls.documents / "import.meso").write_text(
            DOCUMENT.format(macrostructure="", cell=struts(), loops=loops(2, 2, 2), operation="intersection").replace(
                "<csg></csg>", '<import href="large.step"/>'))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.root)

    def start(self, words, **options):
        temporary = self.root / "tmp"
        temporary.mkdir(exist_ok=True)
        return subprocess.Popen([MESO, *words.format(d=self.documents, o=self.outputs).split()],
                                **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
                                env={**os.environ, "TMPDIR": str(temporary)})

    def full_pipe(self):
        """To write to; its reader has stopped reading, as a pager does."""
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        self.addCleanup(os.close, writer)
        os.set_blocking(writer, False)
        try:
            while True:
                os.write(writer, bytes(4096))
        except BlockingIOError:
            os.set_blocking(writer, True)
        return writer

    def wait_until_it_listens(self, job):
        """Until then the system ends it, and there is nothing to remove."""
        while job.poll() is None:
            status = pathlib.Path(f"/proc/{job.pid}/status").read_text()
            if int(re.search(r"SigBlk:\s*(\w+)", status)[1], 16) & 1 << (signal.SIGTERM - 1):
                return
            time.sleep(0.005)

    def assert_nothing_left(self):
        left = [p for folder in (self.outputs, self.root / "tmp") for p in folder.rglob("*")]
        self.assertEqual(left, [])

    def assert_stops(self, words, moment, number):
        job = self.start(words)
        self.wait_until_it_listens(job)
        time.sleep(moment)
        if job.poll() is not None:
            told = job.communicate()
            self.assertEqual(job.returncode, 0, told)
            for path in self.outputs.iterdir():
                path.unlink()
            self.skipTest("it was done before the signal came")
        job.send_signal(number)
        asked = time.monotonic()
        told = job.communicate(timeout=60)[1]
        took = time.monotonic() - asked
        print(f"  {took:5.2f} s  {signal.Signals(number).name} after {moment} s: {words}", file=sys.stderr)
        self.assertEqual(job.returncode, 130, told)
        self.assertIn(b"CANCELLED", told)
        self.assert_nothing_left()
        self.assertLess(took, SECONDS_TO_STOP + SECONDS_OF_GRACE)

    def test_a_signal_while_the_file_is_written(self):
        for words in ("convert {d}/many.meso {o}/a.step", "convert {d}/many.meso {o}/a.stl", "sdf tpms.gyroid -s 1600,1600,1600 -o {o}/a.ply"):
            if words.split()[0] not in VERBS:
                continue
            with self.subTest(words=words):
                job = self.start(words)
                while job.poll() is None and not any(self.outputs.iterdir()):
                    time.sleep(0.01)
                self.assertIsNone(job.poll(), "it ended too early")
                job.send_signal(signal.SIGTERM)
                asked = time.monotonic()
                told = job.communicate(timeout=60)[1]
                self.assertLess(time.monotonic() - asked, SECONDS_TO_STOP + SECONDS_OF_GRACE)
                self.assertEqual(job.returncode, 130, told)
                self.assert_nothing_left()

    @unittest.skipUnless("convert" in VERBS, "this build does not convert")
    def test_a_warning_is_told_before_the_work_is_stopped(self):
        text = DOCUMENT.format(macrostructure=box(90, 90, 90), cell=struts(), loops=loops(20, 20, 20), operation="intersection")
        (self.documents / "overlap.meso").write_text(text.replace('spacing="5"', 'spacing="4.6"'))
        job = self.start("convert {d}/overlap.meso {o}/a.step", text=True, bufsize=1)
        self.addCleanup(job.communicate)
        told = job.stderr.readline()
        self.assertIn("warning CELLS_OVERLAP", told)
        self.assertIn("help: Write the cell's edge as spacing", job.stderr.readline())
        self.assertIsNone(job.poll(), "it ended too early")
        job.send_signal(signal.SIGTERM)

    def test_a_link_to_a_file_elsewhere(self):
        elsewhere = self.root / "elsewhere"
        elsewhere.mkdir()
        target = elsewhere / "real.stl"
        target.write_text("old")
        (self.outputs / "a.stl").symlink_to(target)
        try:
            job = self.start("convert {d}/many.meso {o}/a.stl")
            while job.poll() is None and len(list(elsewhere.iterdir())) == 1:
                time.sleep(0.01)
            self.assertIsNone(job.poll(), "it ended too early")
            job.send_signal(signal.SIGTERM)
            told = job.communicate(timeout=60)[1]
            self.assertEqual(job.returncode, 130, told)
            self.assertEqual([p.name for p in elsewhere.iterdir()], ["real.stl"])
            self.assertEqual(target.read_text(), "old")
        finally:
            (self.outputs / "a.stl").unlink()

    def test_nobody_reads_what_is_told(self):
        for words in ("convert {d}/many.meso {o}/a.step --progress json", "convert {d}/torus.meso {o}/a.step"):
            with self.subTest(words=words):
                job = self.start(words, stderr=self.full_pipe())
                self.wait_until_it_listens(job)
                time.sleep(0.5)
                job.send_signal(signal.SIGTERM)
                asked = time.monotonic()
                self.assertEqual(job.wait(timeout=60), 130)
                self.assertLess(time.monotonic() - asked, SECONDS_TO_STOP + SECONDS_OF_GRACE)
                job.stdout.close()
                self.assert_nothing_left()
        began = time.monotonic()
        with self.start("convert {d}/many.meso {o}/a.step --progress json --timeout 0.5", stderr=self.full_pipe()) as job:
            self.assertEqual(job.wait(timeout=60), 6)
        self.assertLess(time.monotonic() - began, 0.5 + 2 * SECONDS_TO_STOP + 1)
        self.assert_nothing_left()

    @unittest.skipUnless("eval" in VERBS, "this build has no eval")
    def test_nobody_reads_the_answer(self):
        with self.start("eval {d}/many.meso --json") as job:
            self.wait_until_it_listens(job)
            time.sleep(1.5)
            job.send_signal(signal.SIGTERM)
            asked = time.monotonic()
            self.assertEqual(job.wait(timeout=60), 130)
            self.assertLess(time.monotonic() - asked, 2 * SECONDS_TO_STOP + SECONDS_OF_GRACE)

    @unittest.skipUnless("eval" in VERBS, "this build has no eval")
    def test_an_answer_that_has_begun_is_one_object(self):
        job = self.start("eval {d}/many.meso --json")
        self.wait_until_it_listens(job)
        time.sleep(1.5)
        job.send_signal(signal.SIGTERM)
        time.sleep(0.9)  # the work alone would have been ended by now
        answer, told = job.communicate(timeout=60)
        self.assertEqual(job.returncode, 130, told)
        self.assertEqual([d["code"] for d in json.loads(answer)["diagnostics"]], ["CANCELLED"])

    def test_signals_that_are_ignored_stay_so(self):
        def ignore():
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        job = self.start("convert {d}/fuse.meso {o}/a.step", preexec_fn=ignore)
        self.wait_until_it_listens(job)
        job.send_signal(signal.SIGHUP)
        job.send_signal(signal.SIGINT)
        time.sleep(SECONDS_TO_STOP + SECONDS_OF_GRACE)
        self.assertIsNone(job.poll(), "it was ended")
        job.send_signal(signal.SIGTERM)
        told = job.communicate(timeout=60)[1]
        self.assertEqual(job.returncode, 130, told)
        self.assert_nothing_left()

    def test_a_crash_is_one_diagnostic(self):
        for number, exit_code, code in ((signal.SIGSEGV, 5, "GEOMETRY_CRASHED"), (signal.SIGABRT, 5, "GEOMETRY_CRASHED"), (signal.SIGKILL, 6, "LIMIT_MEMORY")):
            for flags in ("", " --json"):
                with self.subTest(signal=number.name, flags=flags):
                    job = self.start("convert {d}/many.meso {o}/a.step" + flags)
                    while job.poll() is None and not any(self.outputs.iterdir()):
                        time.sleep(0.01)
                    os.kill(self.worker_of(job), number)
                    answer, told = job.communicate(timeout=60)
                    self.assertEqual(job.returncode, exit_code, told)
                    self.assertEqual(re.findall(r"error ([A-Z_]+)", told.decode()), [code])
                    if flags:
                        self.assertEqual(json.loads(answer)["error"]["code"], code)
                    self.assert_nothing_left()

    def test_the_work_ends_with_who_waits_for_it(self):
        job = self.start("convert {d}/fuse.meso {o}/a.step")
        self.wait_until_it_listens(job)
        time.sleep(0.3)
        worker = self.worker_of(job)
        job.kill()
        job.communicate(timeout=60)
        began = time.monotonic()
        while os.path.exists(f"/proc/{worker}") and "zombie" not in pathlib.Path(f"/proc/{worker}/status").read_text():
            self.assertLess(time.monotonic() - began, SECONDS_TO_STOP + SECONDS_OF_GRACE)
            time.sleep(0.02)
        self.assert_nothing_left()

    @staticmethod
    def worker_of(job):
        return int(pathlib.Path(f"/proc/{job.pid}/task/{job.pid}/children").read_text().split()[0])

    def assert_limit(self, words, flags, says, seconds):
        began = time.monotonic()
        job = self.start(words + " " + flags)
        told = job.communicate(timeout=120)[1].decode()
        self.assertEqual(job.returncode, 6, told)
        self.assertIn(says, told)
        self.assertLess(time.monotonic() - began, seconds)
        self.assert_nothing_left()

    def test_timeouts(self):
        for name, words in WORK.items():
            if words.split()[0] in VERBS and name != "an estimate" and (EVERYTHING or name in QUICK):
                with self.subTest(work=name):
                    self.assert_limit(words, "--timeout 0.5", "LIMIT_TIME", 0.5 + SECONDS_TO_STOP + 1)  # a second to start

    def test_memory(self):
        for name, words in WORK.items():
            if words.split()[0] in VERBS and name != "an estimate" and (EVERYTHING or name in QUICK):
                with self.subTest(work=name):
                    self.assert_limit(words, "--max-memory 40M", "LIMIT_", 60)

    def test_cells(self):
        for words in ("convert {d}/many.meso {o}/a.step", "convert {d}/many.meso {o}/a.stl", "convert {d}/gyroid.meso {o}/a.ply",
                      "convert {d}/torus.meso {o}/a.stl", "convert {d}/fuse.meso {o}/a.step", "verify --deep {d}/many.meso",
                      "compare {d}/many.meso", "render {d}/many.meso {o}/a.png", "eval {d}/many.meso"):
            if words.split()[0] in VERBS:
                with self.subTest(words=words):
                    self.assert_limit(words, "--max-cells 99", "LIMIT_CELLS", 20)

    def test_signals(self):
        for name, words in WORK.items():
            if words.split()[0] not in VERBS or not (EVERYTHING or name in QUICK):
                continue
            for moment in MOMENTS:
                with self.subTest(work=name, moment=moment):
                    self.assert_stops(words, moment, signal.SIGINT if moment == 1 else signal.SIGTERM)


if __name__ == "__main__":
    unittest.main()
