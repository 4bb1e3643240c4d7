#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""STEP files, read by programs that are not ours: closed solids of the volume that we tell, filled with tetrahedra.

usage: read_back_test.py MESO [--all]

Each file is read by OpenCASCADE's own reader (meso verify), by FreeCAD, and meshed by Gmsh, where these are installed;
without --all the two smallest. Prints a table; exit 1 if anything differs.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MESO = str(pathlib.Path(sys.argv[1]).resolve())
SAME_VOLUME = 1e-4
SAME_VOLUME_READ_BY_US = 1e-5
CHORDS = 0.05  # tetrahedra fill round struts with chords

DOCUMENT = """<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
<macrostructures><macrostructure id="m"><csg>{body}</csg></macrostructure></macrostructures>
<unitCells><unitCell id="u">{cell}</unitCell></unitCells>
<patterns><pattern id="c" unitCell="u">{loops}</pattern></patterns>
<parts><part id="p" macrostructure="m"><apply pattern="c" operation="{operation}" fragments="{fragments}"/></part></parts></meso>
"""


def loops(counts, spacing, start=0):
    return "".join(f'<loop index="{i}" axis="{a}" count="{n}" start="{start}" spacing="{spacing}"/>' for i, a, n in zip("ijk", "xyz", counts))


def struts():
    corners = [(x, y, z) for x in (0, 5) for y in (0, 5) for z in (0, 5)]
    return ('<box dx="5" dy="5" dz="5"/><beams radius="0.6" nodeRadius="1.1"><node id="m" x="2.5" y="2.5" z="2.5"/>' +
            "".join(f'<node id="n{n}" x="{x}" y="{y}" z="{z}"/>' for n, (x, y, z) in enumerate(corners)) +
            "".join(f'<beam from="n{n}" to="m"/>' for n in range(8)) + "</beams>")


def lattice(body, counts):
    return DOCUMENT.format(body=body, cell=struts(), loops=loops(counts, 5), operation="intersection", fragments="drop")


ELLIPSOIDS = DOCUMENT.format(body='<box dx="30" dy="30" dz="30"/>', cell='<csg><rotate x="1" y="2" z="3" angle="0.7"><ellipsoid rx="3" ry="2" rz="1.5"/></rotate></csg>',
                             loops=loops((3, 3, 3), 9, 6), operation="difference", fragments="keep")
# name, document or file, largest edge of Gmsh's tetrahedra
CASES = [("aligned lattice", lattice('<box dx="10" dy="10" dz="10"/>', (2, 2, 2)), 0.8),
         ("plate with holes", ROOT / "examples/documents/drilled_plate.meso", 4),
         ("offset beam", lattice('<box x="1.3" y="1.7" z="2.1" dx="10" dy="10" dz="20"/>', (3, 3, 5)), 0.8),
         ("lattice in a ball", lattice('<sphere x="7.3" y="6.9" z="7.1" radius="6.2"/>', (3, 3, 3)), 0.8),
         ("ellipsoids", ELLIPSOIDS, 3),
         ("octet truss of the library", ROOT / "examples/documents/library_cells.meso", 0.6)]


def run(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, cwd=ROOT, check=False)


def judged(script, *arguments):
    """The script's report, "-" where its program is not installed, and whether it was content."""
    done = run(sys.executable, ROOT / "scripts" / script, *arguments)
    if done.returncode == 77:
        return None, True
    last = done.stdout.strip().splitlines()[-1] if done.stdout.strip() else "{}"
    return json.loads(last), done.returncode == 0


def check(name, source, size, folder):
    document, step = folder / "part.meso", folder / "part.step"
    if isinstance(source, str):
        document.write_text(source)
    made = run(MESO, "convert", document if isinstance(source, str) else source, step, "--json")
    if made.returncode != 0:
        print(f"{name}: {made.stderr}")
        return False
    report = json.loads(made.stdout)
    volume = report["volume"]
    read = run(MESO, "verify", step, "--json")
    own = json.loads(read.stdout)
    good = read.returncode == 0 and own.get("closed", False) and abs(own["volume"] / volume - 1) < SAME_VOLUME_READ_BY_US and own["solids"] == report["solids"]
    theirs = f"{own.get('volume', 0) / volume - 1:+.1e}"
    freecad, freecad_good = judged("check_freecad.py", step, volume, SAME_VOLUME)
    gmsh, gmsh_good = judged("check_gmsh.py", step, volume, CHORDS, size)
    in_freecad = "-" if freecad is None else f"{freecad.get('relativeDifference', 1):+.1e}" + ("" if freecad.get("valid") and freecad.get("closed") else " not closed")
    in_gmsh = "-" if gmsh is None else f"{gmsh.get('tetrahedra', 0):7d} {gmsh.get('relativeDifference', 1):+.1e}"
    print(f"{name:28} {report['solids']:3d} {report['faces']:6d} {volume:12.4f} {theirs:>10} {in_freecad:>10} {in_gmsh:>18}  "
          f"{'ok' if good and freecad_good and gmsh_good else 'DIFFERS'}", flush=True)
    for report in (freecad, gmsh):
        if report and report.get("errors") or report and report.get("error"):
            print("   ", report.get("errors") or report.get("error"))
    return good and freecad_good and gmsh_good


def main():
    cases = CASES if "--all" in sys.argv[2:] else CASES[:2]
    print(f"{'document':28} {'sol':>3} {'faces':>6} {'volume mm3':>12} {'OpenCASC.':>10} {'FreeCAD':>10} {'Gmsh: tetrahedra':>18}")
    with tempfile.TemporaryDirectory() as folder:
        results = [check(*case, pathlib.Path(folder)) for case in cases]
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
