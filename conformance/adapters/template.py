#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A starting point for the adapter of another implementation: fill in the four functions, leave out what you do not do.

usage: run.py --profile core -- python3 template.py
"""
import argparse
import json


def validate(file):
    """Return the verdict and, for every fault, the rule it breaks and the place: PROTOCOL.md, section 3."""
    raise NotImplementedError("validate")  # return {"verdict": "invalid", "errors": [{"rule": "R-5.1.3", "line": 7, "column": 19}]}


def canonical(file):
    """Return the canonical form as text."""
    raise NotImplementedError("canonical")  # return {"canonical": text}


def cells(file, pattern, overrides):
    """Return the kept cells in order: index tuple, 3x4 row-major matrix in millimetres, parameters."""
    raise NotImplementedError("cells")  # return {"cells": [{"index": [0], "matrix": [...], "parameters": {"t": 1.0}}]}


def measure(file, part):
    """Return volume and area in mm^3 and mm^2, the number of solids, and one truth value per <sample> of the part."""
    raise NotImplementedError("measure")  # return {"volume": 1000.0, "area": 600.0, "solids": 1, "samples": [true]}


parser = argparse.ArgumentParser()
parser.add_argument("task")
parser.add_argument("file")
parser.add_argument("--out", required=True)
parser.add_argument("--pattern")
parser.add_argument("--part")
parser.add_argument("--set", action="append", default=[])
a = parser.parse_args()
tasks = {"validate": lambda: validate(a.file), "canonical": lambda: canonical(a.file),
         "cells": lambda: cells(a.file, a.pattern, a.set), "measure": lambda: measure(a.file, a.part)}
with open(a.out, "w", encoding="utf-8") as stream:
    json.dump(tasks[a.task](), stream)
