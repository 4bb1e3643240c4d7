#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the conformance cases against an implementation. PROTOCOL.md says what it asks and what it compares.

usage: run.py [--profile core] [--case TEXT] [--columns] [--jobs N] [--verbose] -- COMMAND [ARGUMENT ...]

COMMAND is called as: COMMAND ... TASK FILE --out JSON.  Exit code 0 if every case passed.
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent
CASES = ROOT / "cases"
PROFILES = ("core", "eval", "implicit", "brep", "package")
CELL_TOLERANCE = 1e-12  # relative, of placed cells; to the largest number of the case
TIMEOUT = 120


class Mismatch(Exception):
    """What an implementation answered is not what the case expects."""


def ask(command, task, file, folder, *options):
    """One call of the implementation; its answer."""
    out = pathlib.Path(folder) / f"{task}.json"
    if out.exists():
        out.unlink()
    done = subprocess.run([*command, task, str(file), "--out", str(out), *options], capture_output=True, text=True, timeout=TIMEOUT)
    if not out.exists():
        raise Mismatch(f"{task}: no answer (exit code {done.returncode}) {done.stderr.strip()[-400:]}")
    with open(out, encoding="utf-8") as stream:
        return json.load(stream)


def compare_errors(expected, answer, columns):
    keys = ("rule", "line", "column") if columns else ("rule", "line")
    want = sorted(tuple(str(e.get(k)) for k in keys) for e in expected)
    found = sorted(tuple(str(e.get(k)) for k in keys) for e in answer.get("errors", []))
    if want != found:
        raise Mismatch(f"errors ({', '.join(keys)}): expected {want}, found {found}")


def is_close(want, found, relative, scale=0.0):
    return math.isfinite(found) and abs(want - found) <= relative * max(abs(want), abs(found), scale)


def compare_cells(expected, answer, columns):
    if "errors" in expected:
        compare_errors(expected["errors"], answer, columns)
        return
    if answer.get("errors"):
        raise Mismatch(f"cells: evaluation failed: {answer['errors']}")
    want, found = expected["cells"], answer.get("cells", [])
    if len(want) != len(found):
        raise Mismatch(f"cells: expected {len(want)}, found {len(found)}")
    scale = max((abs(v) for cell in want for v in cell.get("matrix", [])), default=0.0)
    for w, f in zip(want, found):
        name = f"cell {w['index']}"
        if w["index"] != f["index"]:
            raise Mismatch(f"{name}: found {f['index']} in its place")
        for k in ("matrix", "q", "step"):
            if k not in w:
                continue
            if len(w[k]) != len(f.get(k, [])) or not all(is_close(a, b, CELL_TOLERANCE, scale) for a, b in zip(w[k], f[k])):
                raise Mismatch(f"{name}: {k} expected {w[k]}, found {f.get(k)}")
        for parameter, value in w.get("parameters", {}).items():
            if not is_close(value, f.get("parameters", {}).get(parameter, math.nan), CELL_TOLERANCE, 1e-300):
                raise Mismatch(f"{name}: {parameter} expected {value}, found {f.get('parameters', {}).get(parameter)}")


def compare_measures(expected, answer):
    if answer.get("errors") and "volume" not in answer:
        raise Mismatch(f"measure: not realised: {answer['errors']}")
    for what in ("volume", "area"):
        if what in expected and not is_close(expected[what], answer.get(what, math.nan), expected.get("tolerance", 1e-6)):
            raise Mismatch(f"{what}: expected {expected[what]}, found {answer.get(what)}")
    for what in ("solids", "samples"):
        if what in expected and expected[what] != answer.get(what):
            raise Mismatch(f"{what}: expected {expected[what]}, found {answer.get(what)}")


def run_case(command, path, columns):
    """Raises Mismatch; returns nothing if the case passes."""
    expect = load(path)
    document = path.with_name(path.name.replace(".expect.json", ".mesoz" if expect["profile"] == "package" else ".meso"))
    with tempfile.TemporaryDirectory() as folder:
        if "verdict" in expect:
            answer = ask(command, "validate", document, folder)
            if answer.get("verdict") != expect["verdict"]:
                raise Mismatch(f"verdict: expected {expect['verdict']}, found {answer.get('verdict')} {answer.get('errors')}")
            if expect["profile"] != "package":  # what is wrong with a ZIP archive has no line
                compare_errors(expect.get("errors", []), answer, columns)
        if "canonical" in expect:
            wanted = document.with_name(expect["canonical"]).read_text(encoding="utf-8")
            if ask(command, "canonical", document, folder).get("canonical") != wanted:
                raise Mismatch(f"canonical: not the bytes of {expect['canonical']}")
        if "cells" in expect:
            options = [f"--set={k}={v}" for k, v in expect["cells"].get("set", {}).items()]
            answer = ask(command, "cells", document, folder, "--pattern", expect["cells"]["pattern"], *options)
            compare_cells(expect["cells"], answer, columns)
        if "measures" in expect:
            compare_measures(expect["measures"], ask(command, "measure", document, folder, "--part", expect["measures"]["part"]))


def load(path):
    with open(path, encoding="utf-8") as stream:
        return json.load(stream)


def attempt(command, path, columns):
    try:
        run_case(command, path, columns)
        return None
    except Mismatch as mismatch:
        return str(mismatch)
    except (OSError, ValueError, KeyError, subprocess.TimeoutExpired) as error:
        return f"{type(error).__name__}: {error}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--profile", action="append", choices=PROFILES, help="repeatable; all if absent")
    parser.add_argument("--case", default="", help="only cases whose path contains this text")
    parser.add_argument("--columns", action="store_true", help="compare the columns of errors too")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--verbose", action="store_true", help="name every case")
    parser.add_argument("command", nargs="+", help="the implementation's adapter, after --")
    arguments = parser.parse_args()
    profiles = arguments.profile or PROFILES
    total = {"passed": 0, "failed": 0}
    with concurrent.futures.ThreadPoolExecutor(max_workers=max(1, arguments.jobs)) as pool:
        for profile in profiles:
            paths = [p for p in sorted((CASES / profile).rglob("*.expect.json")) if arguments.case in str(p)]
            results = pool.map(lambda p: attempt(arguments.command, p, arguments.columns), paths)
            failed = 0
            for path, fault in zip(paths, results):
                failed += fault is not None
                if fault or arguments.verbose:
                    print(f"{'FAIL' if fault else 'ok  '} {path.relative_to(CASES)}" + (f": {fault}" if fault else ""))
            print(f"{profile}: {len(paths) - failed} passed, {failed} failed")
            total["passed"] += len(paths) - failed
            total["failed"] += failed
    print(f"{total['passed']} passed, {total['failed']} failed")
    if total["passed"] + total["failed"] == 0:
        sys.exit("no case was run")
    sys.exit(1 if total["failed"] else 0)


if __name__ == "__main__":
    main()
