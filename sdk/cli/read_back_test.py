#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""STEP files, read by programs that are not ours: closed solids of the volume that we tell, filled with tetrahedra.

usage: read_back_test.py MESO [--all] [--jobs N] [--only WORD]

Each file is read by OpenCASCADE's own reader (meso verify), by FreeCAD, and meshed by Gmsh, where these are installed.
--all: every document of examples/, a block of each cell of library/, and some made here, up to 5 000 faces each; without
it three small ones. Prints a table; exit 1 if anything differs.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAME_VOLUME = 1e-4
SAME_VOLUME_READ_BY_US = 1e-5
MOST_FACES = 5000
AROUND = 6  # edges of tetrahedra around a circle
CHORDS = 0.25  # a regular hexagon is 17 % less than its circle
SECONDS = 400  # of a processor, for each program and document
NOT_REALISED = 4  # exit code: a body that is not made of faces

DOCUMENT = """<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
<macrostructures><macrostructure id="m"><csg>{body}</csg></macrostructure></macrostructures>
<unitCells><unitCell id="u"{attributes}>{cell}</unitCell></unitCells>
<patterns><pattern id="c" unitCell="u">{loops}</pattern></patterns>
<parts><part id="p" macrostructure="m"><apply pattern="c" operation="{operation}" fragments="{fragments}"/></part></parts></meso>
"""


def loops(counts, spacing, start=0):
    return "".join(f'<loop index="{i}" axis="{a}" count="{n}" start="{start}" spacing="{d}"/>'
                   for i, a, n, d in zip("ijk", "xyz", counts, spacing))


def struts():
    corners = [(x, y, z) for x in (0, 5) for y in (0, 5) for z in (0, 5)]
    return ('<box dx="5" dy="5" dz="5"/><beams radius="0.6" nodeRadius="1.1"><node id="m" x="2.5" y="2.5" z="2.5"/>' +
            "".join(f'<node id="n{n}" x="{x}" y="{y}" z="{z}"/>' for n, (x, y, z) in enumerate(corners)) +
            "".join(f'<beam from="n{n}" to="m"/>' for n in range(8)) + "</beams>")


def lattice(body, counts):
    return DOCUMENT.format(body=body, attributes="", cell=struts(), loops=loops(counts, (5, 5, 5)), operation="intersection", fragments="drop")


def library_block(name):
    """2 x 2 x 2 boxes of their usual size."""
    edges = ("sqrt(3)*5", "15", "5") if name == "honeycomb" else ("10", "10", "10")
    block = '<box dx="2*({})" dy="2*({})" dz="2*({})"/>'.format(*edges)
    return DOCUMENT.format(body=block, attributes=f' library="{name}"', cell="", loops=loops((2, 2, 2), edges), operation="intersection", fragments="drop")


ELLIPSOIDS = DOCUMENT.format(body='<box dx="30" dy="30" dz="30"/>', attributes="",
                             cell='<csg><rotate x="1" y="2" z="3" angle="0.7"><ellipsoid rx="3" ry="2" rz="1.5"/></rotate></csg>',
                             loops=loops((3, 3, 3), (9, 9, 9), 6), operation="difference", fragments="keep")


def automatic_balls(example, cells=()):
    """An example whose balls are as small as they can be, so that their circles touch or nearly do; with fewer cells."""
    text = (ROOT / "examples/documents" / example).read_text().replace('nodeRadius="0.9mm"', 'nodeRadius="auto"')
    for many, few in cells:
        text = text.replace(f'count="{many}"', f'count="{few}"')
    return re.sub("<validation>.*?</validation>", "", text, flags=re.S)


FEW = [("aligned lattice", lattice('<box dx="10" dy="10" dz="10"/>', (2, 2, 2))),
       ("plate with holes", ROOT / "examples/documents/drilled_plate.meso"),
       ("smallest balls in a block", automatic_balls("graded_block.meso", [(6, 2), (3, 2)]))]
MORE = [("offset beam", lattice('<box x="1.3" y="1.7" z="2.1" dx="10" dy="10" dz="20"/>', (3, 3, 5))),
        ("lattice in a ball", lattice('<sphere x="7.3" y="6.9" z="7.1" radius="6.2"/>', (3, 3, 3))),
        ("ellipsoids", ELLIPSOIDS),
        ("smallest balls in a tube", automatic_balls("bcc_tube.meso", [(2, 1), (6, 1)])),
        ("smallest balls in a ball", automatic_balls("bcc_ball.meso", [(2, 1)]))]


def all_cases():
    library = sorted(path.stem for path in (ROOT / "library").glob("*.meso"))
    examples = sorted((ROOT / "examples").rglob("*.meso"))
    return (FEW[:1] + FEW[2:] + MORE + [(f"2 x 2 x 2 of {name}", library_block(name)) for name in library] +
            [(str(path.relative_to(ROOT / "examples").with_suffix("")), path) for path in examples])


def run(*words):
    def limit():  # processor time: on a busy machine a clock would say nothing
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, cwd=ROOT, check=False, preexec_fn=limit)


def judged(script, *arguments):
    """The script's report, nothing where its program is not installed, and whether it was content."""
    done = run(sys.executable, ROOT / "scripts" / script, *arguments)
    if done.returncode == 77:
        return None, True
    last = done.stdout.strip().splitlines()[-1] if done.stdout.strip() else "{}"
    return json.loads(last), done.returncode == 0


def check(meso, name, source):
    """Whether all agree, and a line of the table."""
    with tempfile.TemporaryDirectory() as folder:
        document, step = pathlib.Path(folder) / "part.meso", pathlib.Path(folder) / "part.step"
        if isinstance(source, str):
            document.write_text(source, encoding="utf-8")
        made = run(meso, "convert", document if isinstance(source, str) else source, step, "--engine", "brep", "--json")
        if made.returncode == NOT_REALISED:
            return True, f"{name:36} has no exact body"
        if made.returncode != 0:
            return False, f"{name:36} FAILS {made.stderr.strip()[:300]}"
        report = json.loads(made.stdout)
        volume = report["volume"]
        line = f"{name:36} {report['solids']:3d} {report['faces']:6d} {volume:12.4f}"
        if report["faces"] > MOST_FACES:
            return True, line + " too many faces"
        read = run(meso, "verify", step, "--json")
        own = json.loads(read.stdout or "{}")
        good = (read.returncode == 0 and own.get("closed", False) and own["solids"] == report["solids"] and
                abs(own["volume"] / volume - 1) < SAME_VOLUME_READ_BY_US)
        freecad, freecad_good = judged("check_freecad.py", step, volume, SAME_VOLUME)
        gmsh, gmsh_good = judged("check_gmsh.py", step, volume, CHORDS, 0, AROUND)
    in_freecad = "-" if freecad is None else f"{freecad.get('relativeDifference', 1):+.1e}" + ("" if freecad.get("valid") and freecad.get("closed") else " not closed")
    in_gmsh = "-" if gmsh is None else f"{gmsh.get('tetrahedra', 0):7d} {gmsh.get('relativeDifference', 1):+.1e}"
    told = [str(r.get("errors") or r.get("error")) for r in (freecad, gmsh) if r and (r.get("errors") or r.get("error"))]
    all_good = good and freecad_good and gmsh_good
    line += f" {own.get('volume', 0) / volume - 1:+10.1e} {in_freecad:>10} {in_gmsh:>18}  {'ok' if all_good else 'DIFFERS'}"
    return all_good, "\n    ".join([line, *told])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("meso", type=pathlib.Path)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", help="documents whose name matches")
    a = parser.parse_args()
    cases = [case for case in (all_cases() if a.all else FEW) if not a.only or re.search(a.only, case[0])]
    print(f"{'document':36} {'sol':>3} {'faces':>6} {'volume mm3':>12} {'OpenCASC.':>10} {'FreeCAD':>10} {'Gmsh: tetrahedra':>18}", flush=True)
    results = []
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        for done in concurrent.futures.as_completed([pool.submit(check, a.meso.resolve(), *case) for case in cases]):
            good, line = done.result()
            print(line, flush=True)
            results.append(good)
    print(f"{sum(results)} of {len(results)} as they must be")
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
