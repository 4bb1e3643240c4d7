#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the implicit engine's table of docs/performance.md as Markdown: meso sdf beside VTK and OpenVDB.

  cmake --preset release && cmake --build --preset release && bench/implicit_table.py [--pairs N] [--only WORD]

Ours and each peer run alternately, so that a neighbour's load meets both; figures are medians, ratios are medians of the
pairs' ratios. CPU is user plus system time of the whole process, file included. Peers that are not installed
(scripts/install-deps.sh --all) are left out; the row of --tolerance needs numpy. Error: distance of vertices from the surface, first order |f| / |grad f|, in
grid spacings, of 50 000 vertices that do not lie in the box planes.
"""
import argparse
import importlib.util
import json
import math
import os
import pathlib
import random
import re
import statistics
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TRIANGLES = re.compile(r'"triangles": (\d+)|(\d+) triangles')
READING = re.compile(r"([\d.]+) s reading")
GYROID = "cos(2*pi*x)*sin(2*pi*y) + cos(2*pi*y)*sin(2*pi*z) + cos(2*pi*z)*sin(2*pi*x)"
HIERARCHY = "ball scale 5 tpms.p scale 4 tpms.d scale 3.75 tpms.gyroid scale 1.25 intersection intersection intersection".split()


def run(command):
    """What one process costs, and how many triangles it says it wrote."""
    read, write = os.pipe()
    begin = time.monotonic()
    job = subprocess.Popen([str(c) for c in command], stdout=write, stderr=write)
    os.close(write)
    with os.fdopen(read) as pipe:
        printed = pipe.read()
    _, status, usage = os.wait4(job.pid, 0)
    wall = time.monotonic() - begin
    job.returncode = os.waitstatus_to_exitcode(status)
    if job.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {job.returncode}")
    return {"user": usage.ru_utime, "cpu": usage.ru_utime + usage.ru_stime, "wall": wall, "peak": usage.ru_maxrss / 1024,
            "triangles": int("".join(TRIANGLES.search(printed).groups(""))),
            "reading": float(READING.search(printed).group(1)) if READING.search(printed) else 0}


def gyroid_error(ply, samples):
    """Largest and root mean square error of vertices, in grid spacings."""
    h = 2 / (samples - 1)
    with open(ply, "rb") as file:
        count, line = 0, b""
        while line.strip() != b"end_header":
            line = file.readline()
            if line.startswith(b"element vertex"):
                count = int(line.split()[2])
        start = file.tell()
        random_numbers = random.Random(1)
        errors = []
        for _ in range(500):
            file.seek(start + 12 * random_numbers.randrange(max(count - 100, 1)))
            for point in struct.iter_unpack("<3f", file.read(1200)):
                if max(map(abs, point)) > 1 - h / 2:
                    continue
                (sx, cx), (sy, cy), (sz, cz) = ((math.sin(a), math.cos(a)) for a in (2 * math.pi * c for c in point))
                slope = 2 * math.pi * math.hypot(cz * cx - sx * sy, cx * cy - sy * sz, cy * cz - sz * sx)
                errors.append(abs(cx * sy + cy * sz + cz * sx) / slope / h)
    return max(errors), math.sqrt(sum(e * e for e in errors) / len(errors))


def median(runs, key):
    return statistics.median(r[key] for r in runs)


def row(name, runs, samples=None, ours=None):
    triangles = runs[0]["triangles"]
    error = f"{runs[0]['error'][0]:.4f} / {runs[0]['error'][1]:.4f}" if "error" in runs[0] else ""
    ratio = lambda key: statistics.median(a[key] / b[key] for a, b in zip(ours, runs)) if ours else None
    ratios = f"{ratio('cpu'):.3f} / {ratio('user'):.3f} / {ratio('wall'):.3f}" if ours else ""
    print(f"| {name} | {median(runs, 'cpu'):.2f} | {median(runs, 'user'):.2f} | {median(runs, 'wall'):.2f} "
          f"| {median(runs, 'peak'):.0f} | {triangles:,} | {error} | {ratios} |", flush=True)


def head(title):
    print(f"\n{title}\n\n| | CPU s | user s | wall s | peak MiB | triangles | error max / rms | ours over it: CPU / user / wall |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")


def alternate(commands, pairs, out, samples):
    """name -> runs, one of each in turn."""
    runs = {name: [] for name in commands}
    for _ in range(pairs):
        for name, command in commands.items():
            # Writing over an old large file costs other system time than writing a new one.
            out.unlink(missing_ok=True)
            done = run(command)
            if not runs[name] and samples:
                done["error"] = gyroid_error(out, samples)
            runs[name].append(done)
    return runs


def against_peers(binaries, samples, pairs, out):
    head(f"Gyroid as a text over [-1,1]³, {samples}³ samples, closed at the box, binary PLY; medians of {pairs}")
    commands = {}
    for threads in (1, 2):
        commands[f"meso, {threads} thread{'s' * (threads > 1)}"] = [
            binaries / "meso", "sdf", "expression", GYROID, "-s", f"{samples},{samples},{samples}", "-b", "-1,-1,-1,1,1,1",
            "-o", out, "--jobs", threads]
        for title, peer in (("VTK FlyingEdges", "vtk_flying_edges"), ("OpenVDB", "openvdb")):
            binary = binaries / f"meso_bench_peer_{peer}"
            if binary.exists():
                commands[f"{title}, {threads} thread{'s' * (threads > 1)}"] = [binary, samples, threads, out]
    runs = alternate(commands, pairs, out, samples)
    for name, done in runs.items():
        threads = name.split(", ")[1]
        row(name, done, ours=None if name.startswith("meso") else runs[f"meso, {threads}"])
    one, two = runs["meso, 1 thread"], runs["meso, 2 threads"]
    print(f"\nWall on 2 threads over wall on one: {statistics.median(b['wall'] / a['wall'] for a, b in zip(one, two)):.2f}.")


def ours_alone(binaries, pairs, out, folder):
    head(f"meso sdf alone, 1 thread; medians of {pairs}")
    flags = ["-o", out, "--jobs", 1]
    box = lambda half: ["-b", ",".join([f"-{half}"] * 3 + [f"{half}"] * 3)]
    meso = [binaries / "meso", "sdf"]
    mesh = folder / "torus.ply"
    # By another process: a child's peak counts what its parent held when it was started.
    subprocess.run([sys.executable, __file__, "--write-torus", mesh], check=True)
    commands = {
        "gyroid as a text, 1600³": meso + ["expression", GYROID, "-s", "1600,1600,1600"] + box(1) + flags,
        "hierarchy of figure 6, 512³": meso + HIERARCHY + ["-s", "512,512,512"] + box(4) + flags,
        "1 million triangles ∩ gyroid, 200³": meso + ["file", mesh, "tpms.gyroid", "scale", "0.5", "intersection", "-s", "200^3"] + flags,
    }
    runs = alternate(commands, pairs, out, None)
    for name, done in runs.items():
        row(name, done)
    loading = runs["1 million triangles ∩ gyroid, 200³"]
    print(f"\nOf the mesh's row, reading the file took {median(loading, 'reading'):.2f} s wall.")


def write_torus(path, around, across):
    """A torus of 2 * around * across triangles in shuffled order; radii 1 and 0.4."""
    points = []
    for i in range(around):
        u = 2 * math.pi * i / around
        for j in range(across):
            v = 2 * math.pi * j / across
            ring = 1 + 0.4 * math.cos(v)
            points.append(struct.pack("<3f", ring * math.cos(u), ring * math.sin(u), 0.4 * math.sin(v)))
    corner = lambda i, j: (i % around) * across + j % across
    faces = []
    for i in range(around):
        for j in range(across):
            a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
            faces += [struct.pack("<B3i", 3, a, b, c), struct.pack("<B3i", 3, a, c, d)]
    random.Random(1).shuffle(faces)
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
              f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + b"".join(points) + b"".join(faces))


def kernels(binaries):
    binary = binaries / "meso_bench_implicit"
    report = subprocess.run([binary, "--benchmark_format=json", "--benchmark_min_time=0.2"], stdout=subprocess.PIPE, check=True).stdout
    times = {b["name"]: b["ns_per_sample"] for b in json.loads(report)["benchmarks"]}
    print("\nFilling, one thread, CPU nanoseconds per sample in rows of 800 (meso_bench_implicit)\n")
    print("| expression | meso | muParser's bulk mode | ratio |\n|---|---:|---:|---:|")
    for name, ours in times.items():
        kind, _, what = name.partition("/")
        if kind == "fill":
            peer = times.get(f"muparser/{what}")
            print(f"| {what} | {ours:.2f} | " + (f"{peer:.1f} | {ours / peer:.4f} |" if peer else " | |"))


DOCUMENT = """<?xml version="1.0" encoding="UTF-8"?>
<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
{systems}{bodies}<unitCells>{cell}</unitCells><patterns>{pattern}</patterns>
<parts><part id="part"{body}><apply pattern="cells" operation="{operation}"/></part></parts>
<build><item part="part"><mesh samples="{samples}" {box}/></item></build></meso>
"""
SHEET = """<unitCell id="cell"><box dx="1" dy="1" dz="1"/><implicit surface="gyroid" kind="shell" thickness="0.6"/></unitCell>"""
TUBE = dict(operation="union", samples="521, 521, 41", box='x="-26" y="-26" z="0" dx="52" dy="52" dz="4"')


def fill(lower, upper, step):
    return "".join(f'<range axis="{a}" from="{lo}" to="{hi}" step="{step}"/>' for a, lo, hi in zip("xyz", lower, upper))


def bcc_block():
    corners = "".join(f'<node id="n{i}" x="{5 * (i & 1)}" y="{5 * (i >> 1 & 1)}" z="{5 * (i >> 2)}"/>' for i in range(8))
    beams = "".join(f'<beam from="n{i}" to="m"/>' for i in range(8))
    return DOCUMENT.format(
        systems="", operation="intersection", body=' macrostructure="cube"', samples="501, 501, 501", box='x="0" y="0" z="0" dx="50" dy="50" dz="50"',
        bodies='<macrostructures><macrostructure id="cube"><csg><box dx="50" dy="50" dz="50"/></csg></macrostructure></macrostructures>',
        cell=f'<unitCell id="cell"><box dx="5" dy="5" dz="5"/><beams radius="0.5"><node id="m" x="2.5" y="2.5" z="2.5"/>{corners}{beams}</beams></unitCell>',
        pattern=f'<pattern id="cells" unitCell="cell"><fill>{fill([0] * 3, [50] * 3, 5)}</fill></pattern>')


def conformal_tube():
    """20 cells across the wall, 60 around, 4 along."""
    return DOCUMENT.format(
        bodies="", cell=SHEET, body="", **TUBE,
        systems='<coordinateSystems><coordinateSystem id="polar"><axis name="r" kind="distance" x="1"/><axis name="phi" kind="circular" z="1"/>'
                '<axis name="z" kind="linear" z="1"/></coordinateSystem></coordinateSystems>',
        pattern='<pattern id="cells" unitCell="cell" coordinateSystem="polar" mapping="conformal"><loop index="i" axis="r" count="20" start="5" spacing="1"/>'
                '<loop index="j" axis="phi" count="60" spacing="6deg"/><loop index="k" axis="z" count="4" spacing="1"/></pattern>')


def rigid_tube():
    """Cells of the same size, not bent, in the same tube."""
    tube = ('<difference><cylinder x1="0" y1="0" z1="0" x2="0" y2="0" z2="4" radius="25"/>'
            '<cylinder x1="0" y1="0" z1="-1" x2="0" y2="0" z2="5" radius="5"/></difference>')
    return DOCUMENT.format(
        systems="", cell=SHEET, body=' macrostructure="tube"', **{**TUBE, "operation": "intersection"},
        bodies=f'<macrostructures><macrostructure id="tube"><csg>{tube}</csg></macrostructure></macrostructures>',
        pattern=f'<pattern id="cells" unitCell="cell"><fill>{fill([-26, -26, 0], [26, 26, 4], 1)}</fill></pattern>')


CUT_BOX = "box scale 0.6,0.5,0.4 rotate 1,2,3 0.7 cylinder scale 0.25 difference -b -1,-1,-1,1,1,1 -s 100,100,100".split()


def documents(binaries, pairs, out, folder):
    head(f"Documents, sharp edges and tetrahedra, 1 thread; medians of {pairs}")
    meso, flags = binaries / "meso", ["--jobs", 1]
    convert = lambda document, *more: [meso, "convert", document, out, "--engine", "implicit", *more, *flags]
    for name, text in (("bcc", bcc_block()), ("conformal", conformal_tube()), ("rigid", rigid_tube())):
        (folder / f"{name}.meso").write_text(text, encoding="utf-8")
    beam = ROOT / "examples/ibeam/ibeam.meso"
    commands = {
        "BCC, 10³ cells, r = 0.5 mm, 0.1 mm": convert(folder / "bcc.meso"),
        "I-beam ∩ BCC, pitch 5 mm, 0.2 mm": convert(beam, "--spacing", "0.2mm"),
        "I-beam ∩ BCC, pitch 2.5 mm, 0.2 mm": convert(beam, "--spacing", "0.2mm", "--set", "pitch=2.5mm", "--set", "strut=0.5mm"),
        "gyroid tube, conformal, 20 × 60 × 4 cells, 0.1 mm": convert(folder / "conformal.meso"),
        "gyroid tube, rigid, the same samples": convert(folder / "rigid.meso"),
        "rotated box − cylinder, 100³": [meso, "sdf", *CUT_BOX, "-o", out, *flags],
        "rotated box − cylinder, 100³, --sharp": [meso, "sdf", *CUT_BOX, "--sharp", "-o", out, *flags],
    }
    runs = alternate(commands, pairs, out, None)
    for name, done in runs.items():
        row(name, done)
    over = lambda a, b: statistics.median(x["cpu"] / y["cpu"] for x, y in zip(runs[a], runs[b]))
    names = list(commands)
    print(f"\nConformal over rigid: {over(names[3], names[4]):.2f}; sharp over plain: {over(names[6], names[5]):.2f}.")
    tets = folder / "gyroid.vtu"
    job = subprocess.run([meso, "sdf", "tpms.gyroid", "-b", "0,0,0,4,4,4", "--elements", "1000000", "-o", tets, "--json", "--jobs", "1"],
                         stdout=subprocess.PIPE, check=True)
    report = json.loads(job.stdout)
    low, high = report["dihedralDegrees"]
    print(f"\nGyroid of 4³ cells: {report['elements']:,} tetrahedra in {report['seconds']:.2f} s wall, dihedral angles {low:.1f}° to {high:.1f}°.")


# A gyroid in a cube of 40 mm: cells of 2.5 mm at one corner, of 10 mm at the other. A cell at x is 2.5 + 0.1875 x long,
# so its phase is the integral of 1 / (2.5 + 0.1875 x).
SIDE, PHASE = 40, "log(1 + 0.075*{0})/0.1875"
GRADED = ("cos(2*pi*X)*sin(2*pi*Y) + cos(2*pi*Y)*sin(2*pi*Z) + cos(2*pi*Z)*sin(2*pi*X)"
          .replace("X", PHASE.format("x")).replace("Y", PHASE.format("y")).replace("Z", PHASE.format("z")))


def farthest_from_graded(ply, every=1):
    """How far points of a mesh's triangles are from the graded gyroid: Newton's steps along its gradient, derived here."""
    import numpy as np

    def foot(p):
        angle = 2 * np.pi * np.log(1 + 0.075 * p) / 0.1875
        s, c = np.sin(angle), np.cos(angle)
        f = (c * np.roll(s, -1, 1)).sum(1)
        g = (np.roll(c, 1, 1) * c - s * np.roll(s, -1, 1)) * 2 * np.pi / (2.5 + 0.1875 * p)
        return p - (f / (g * g).sum(1))[:, None] * g

    with open(ply, "rb") as file:
        counts, line = {}, b""
        while line.strip() != b"end_header":
            line = file.readline()
            if line.startswith(b"element"):
                counts[line.split()[1]] = int(line.split()[2])
        points = np.frombuffer(file.read(12 * counts[b"vertex"]), "<f4").reshape(-1, 3).astype(float)
        triangles = np.frombuffer(file.read(13 * counts[b"face"]), np.dtype([("n", "u1"), ("corners", "<i4", 3)]))["corners"][::every]
    places = np.array([[1, 1, 0], [0, 1, 1], [1, 0, 1], [2 / 3] * 3, [4 / 3, 1 / 3, 1 / 3], [1 / 3, 4 / 3, 1 / 3], [1 / 3, 1 / 3, 4 / 3]]) / 2
    worst = 0
    for begin in range(0, len(triangles), 100_000):
        corners = points[triangles[begin:begin + 100_000]]
        in_side = ((corners == 0).all(1) | (corners == SIDE).all(1)).any(1)
        at = np.einsum("kj,tjx->tkx", places, corners[~in_side]).reshape(-1, 3)
        end = at
        for _ in range(3):
            end = foot(end)
        worst = max(worst, np.linalg.norm(end - at, axis=1).max(initial=0))
    return worst


def tolerance(binaries, out):
    if importlib.util.find_spec("numpy") is None:
        print("\nThe row of --tolerance needs numpy, which this Python has not (Debian: /usr/bin/python3).")
        return
    meso = [binaries / "meso", "sdf", "expression", GRADED, "-b", f"0,0,0,{SIDE},{SIDE},{SIDE}", "-o", out, "--json"]
    told = lambda *more: json.loads(subprocess.run([*meso, *more], stdout=subprocess.PIPE, check=True).stdout)
    report = told("--tolerance", "0.02")
    samples = report["accuracy"]["gridSamples"] + report["accuracy"]["surfaceSamples"]
    error = farthest_from_graded(out)
    print(f"\nGyroid with cells of 2.5 mm to 10 mm in a cube of {SIDE} mm, --tolerance 0.02: {report['triangles']:,} triangles, "
          f"{samples:,} samples ({report['accuracy']['gridSamples']:,} on grids); farthest point that was measured "
          f"{error:.4f} mm.", flush=True)
    # The coarsest uniform grid that is as close: errors go about with the square of the spacing. Of its many triangles,
    # a part is looked at, which is in its favour.
    nodes, best = 336, None
    for _ in range(4):
        told("-s", f"{nodes},{nodes},{nodes}")
        uniform = farthest_from_graded(out, every=8)
        print(f"{nodes}³ samples, uniform: {uniform:.4f} mm.", flush=True)
        if uniform <= error:
            best = min(nodes, best or nodes)
        following = math.ceil((nodes - 1) * math.sqrt(uniform / error)) + 1
        if following == nodes or (best and following >= best):
            break
        nodes = following
    if best:
        print(f"Samples over those of the coarsest uniform grid as close, {best}³: {samples / best ** 3:.3f}.")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--samples", type=int, default=800, help="along each axis, of the rows beside peers")
    parser.add_argument("--binaries", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--only", choices=["peers", "ours", "documents", "tolerance", "kernels"])
    parser.add_argument("--write-torus", type=pathlib.Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.write_torus:
        write_torus(arguments.write_torus, 1000, 500)
        return
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start.")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if arguments.only in (None, "peers"):
            against_peers(arguments.binaries, arguments.samples, arguments.pairs, folder / "out.ply")
        if arguments.only in (None, "ours"):
            ours_alone(arguments.binaries, arguments.pairs, folder / "out.ply", folder)
        if arguments.only in (None, "documents"):
            documents(arguments.binaries, arguments.pairs, folder / "out.ply", folder)
        if arguments.only in (None, "tolerance"):
            tolerance(arguments.binaries, folder / "out.ply")
        if arguments.only in (None, "kernels"):
            kernels(arguments.binaries)


if __name__ == "__main__":
    main()
