#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every ```cpp block of docs/guide must stand, word for word, in a program of this folder."""
import pathlib
import re
import sys
import textwrap

HERE = pathlib.Path(__file__).resolve().parent
programs = [textwrap.dedent("\n".join(line[2:] if line.startswith("  ") else line for line in p.read_text(encoding="utf-8").split("\n")))
            for p in HERE.glob("*.cpp")]
blocks = strays = 0
for page in sorted((HERE.parents[1] / "docs" / "guide").glob("*.md")):
    for block in re.findall(r"^```cpp\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        blocks += 1
        if not any(block in program for program in programs):
            strays += 1
            print(f"{page.name}: not in examples/cpp:\n{block}")
print(f"{blocks} blocks")
sys.exit(1 if strays or not blocks else 0)
