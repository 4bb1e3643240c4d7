#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Answers the conformance protocol with the `meso` command.

usage: meso.py --meso PATH TASK FILE --out JSON [--pattern ID] [--set=ID=EXPR] [--part ID]
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

REGISTRY = pathlib.Path(__file__).resolve().parents[2] / "schema" / "diagnostics.json"


def rules():
    with open(REGISTRY, encoding="utf-8") as stream:
        return {c["name"]: c.get("rule") for c in json.load(stream)["codes"]}


def call(arguments):
    return subprocess.run(arguments, capture_output=True, text=True, encoding="utf-8")


def errors_of(report):
    rule_of = rules()
    return [{"rule": rule_of.get(d["code"]), "line": d["line"], "column": d["column"], "code": d["code"]}
            for d in report.get("diagnostics", []) if d["severity"] == "error"]


def told_errors(text):
    """The errors among the lines of standard error: FILE:LINE:COLUMN: error CODE: message."""
    found = re.findall(r"^.*?:(\d+):(\d+): error ([A-Z0-9_]+): ", text, re.MULTILINE)
    return [{"rule": rules().get(code), "line": int(line), "column": int(column), "code": code} for line, column, code in found]


def validate(meso, a):
    report = json.loads(call([meso, "validate", a.file, "--json"]).stdout)
    return {"verdict": report["verdict"], "errors": errors_of(report)}


def canonical(meso, a):
    return {"canonical": call([meso, "canonical", a.file]).stdout}


def cells(meso, a):
    target = pathlib.Path(a.out).with_suffix(".cells.json")
    done = call([meso, "eval", a.file, str(target), "--pattern", a.pattern, "--json", *[f"--set={s}" for s in a.set or []]])
    if done.returncode == 0:
        return json.loads(target.read_text(encoding="utf-8"))
    return {"errors": told_errors(done.stderr)}


def measure(meso, a):
    done = call([meso, "verify", a.file, "--part", a.part, "--json"])
    if not done.stdout:
        return {"errors": told_errors(done.stderr)}
    report = json.loads(done.stdout)
    answer = {k: report[k] for k in ("volume", "area", "solids") if k in report}
    answer["samples"] = [c["found"] == "inside" for c in report.get("checks", []) if c["what"].startswith("sample")]
    answer["errors"] = errors_of(report)
    return answer


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--meso", required=True)
    parser.add_argument("task", choices=("validate", "canonical", "cells", "measure"))
    parser.add_argument("file")
    parser.add_argument("--out", required=True)
    parser.add_argument("--pattern")
    parser.add_argument("--part")
    parser.add_argument("--set", action="append")
    a = parser.parse_args()
    answer = {"validate": validate, "canonical": canonical, "cells": cells, "measure": measure}[a.task](a.meso, a)
    with open(a.out, "w", encoding="utf-8") as stream:
        json.dump(answer, stream)


if __name__ == "__main__":
    sys.exit(main())
