#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs what the guide shows.

usage: run_examples.py [--update] MESO PAGE.md...

Every ```sh block of a page runs with `sh -e` in a temporary copy of examples/, in its folder documents/, the blocks of a page one after the
other in the same copy. A block that a "```text output" block follows must print just that (both streams together); "..." there stands for
anything within a line, and numbers may differ by 1 %: volumes end in other digits elsewhere. A block fails if a
command fails. --update writes what was printed into the pages, with times as "...".
"""
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
BLOCK = re.compile(r"^```sh\n(?P<commands>.*?)^```\n(?:\n```text output\n(?P<output>.*?)^```\n)?", re.MULTILINE | re.DOTALL)
TIME = re.compile(r"\b\d+(\.\d+)? s$", re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
LIMIT_S = 120


def run(commands, folder, environment):
    done = subprocess.run(["sh", "-e", "-c", commands], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=LIMIT_S)
    return done.returncode, done.stdout


def matches(expected, printed):
    words, numbers = NUMBER.split(expected), NUMBER.findall(expected)
    pattern = f"({NUMBER.pattern})".join(re.escape(word).replace(re.escape("..."), ".*") for word in words)
    found = re.fullmatch(pattern, printed)
    return found is not None and all(math.isclose(float(a), float(b), rel_tol=0.01, abs_tol=1e-9) for a, b in zip(numbers, found.groups()))


def check_page(page, meso, update):
    """Number of blocks that ran, and of those that failed."""
    text = page.read_text(encoding="utf-8")
    environment = {**os.environ, "PATH": f"{meso.parent}{os.pathsep}{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
    failed = 0
    pieces, end = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = shutil.copytree(EXAMPLES, pathlib.Path(scratch) / "examples") / "documents"
        blocks = list(BLOCK.finditer(text))
        for block in blocks:
            code, printed = run(block["commands"], folder, environment)
            expected = block["output"]
            line = text.count("\n", 0, block.start()) + 1
            if code != 0:
                failed += 1
                print(f"{page}:{line}: exit code {code}\n{block['commands']}{printed}")
            elif expected is not None and not matches(expected, printed):
                if update:
                    pieces += [text[end:block.start("output")], TIME.sub("... s", printed)]
                    end = block.end("output")
                else:
                    failed += 1
                    print(f"{page}:{line}: other output\n--- shown\n{expected}--- printed\n{printed}")
    if update and pieces:
        page.write_text("".join(pieces) + text[end:], encoding="utf-8")
    return len(blocks), failed


def main():
    arguments = [a for a in sys.argv[1:] if a != "--update"]
    if len(arguments) < 2:
        sys.exit(__doc__)
    meso = pathlib.Path(arguments[0]).resolve()
    total = failures = 0
    for name in arguments[1:]:
        ran, failed = check_page(pathlib.Path(name), meso, "--update" in sys.argv)
        total += ran
        failures += failed
    print(f"{total - failures} passed, {failures} failed")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
