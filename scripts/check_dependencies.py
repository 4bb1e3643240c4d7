#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if a library is linked that docs/dependencies.md does not list, or one under the GPL.

usage: check_dependencies.py [PROGRAM]   also checks every shared library that PROGRAM loads (Debian: asks dpkg)

The tables of docs/dependencies.md are the input: columns "CMake package" (what find_package asks for), "Debian package"
(shell patterns of run-time packages) and "licence".
"""
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "dependencies.md"
# The GPL with a linking exception (the compiler's run-time libraries) does not reach what is linked.
GPL = re.compile(r"(?<!L)GPL(?!.*exception)", re.I)
# Not libraries.
TOOLS = {"Threads", "Python3"}


def table_rows(text):
    """Every row of every table as {column: cell}."""
    columns = None
    for line in text.splitlines():
        if not line.startswith("|"):
            columns = None
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if columns is None:
            columns = cells
        elif not set(line) <= set("|-: "):
            yield dict(zip(columns, cells))


def names(row, column):
    return [name.strip("`") for name in row.get(column, "").split(", ") if name not in ("", "-")]


def asked_for():
    """CMake package -> file that asks for it."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*CMakeLists.txt", "*.cmake"],
                            cwd=ROOT, capture_output=True, text=True, check=True)
    found = {}
    for name in listed.stdout.splitlines():
        if not (ROOT / name).exists():
            continue
        for package in re.findall(r"^\s*find_package\(([\w-]+)", (ROOT / name).read_text(encoding="utf-8"), re.M):
            found.setdefault(package, name)
    return {package: name for package, name in found.items() if package not in TOOLS | {"meso"}}


def package_of(library):
    """The Debian package that owns a file; /lib is a link to /usr/lib, and dpkg knows only one of the two names."""
    path = os.path.realpath(library)
    for candidate in (path, path.removeprefix("/usr"), library):
        answer = subprocess.run(["dpkg", "-S", candidate], capture_output=True, text=True)
        if answer.returncode == 0:
            return answer.stdout.split(":")[0]
    return None


def loaded_by(program):
    answer = subprocess.run(["ldd", program], capture_output=True, text=True, check=True)
    return sorted(re.findall(r"=> (/\S+)", answer.stdout))


def main():
    rows = list(table_rows(PAGE.read_text(encoding="utf-8")))
    faults = [f"{row['library']}: licence {row['licence']}" for row in rows if GPL.search(row["licence"])]

    listed = {package for row in rows for package in names(row, "CMake package")}
    asked = asked_for()
    faults += [f"{asked[package]} asks for {package}, which {PAGE.name} does not list" for package in sorted(asked.keys() - listed)]
    faults += [f"{PAGE.name} lists {package}, which no CMake file asks for" for package in sorted(listed - asked.keys())]

    libraries = []
    if len(sys.argv) > 1:
        if not shutil.which("dpkg"):
            sys.exit("check_dependencies: a program can be checked only on Debian")
        patterns = [pattern for row in rows for pattern in names(row, "Debian package")]
        libraries = loaded_by(sys.argv[1])
        for library in libraries:
            package = package_of(library)
            if not package or not any(fnmatch.fnmatchcase(package, pattern) for pattern in patterns):
                faults.append(f"{sys.argv[1]} loads {library} of package {package}, which {PAGE.name} does not list")

    for fault in faults:
        print(f"check_dependencies: {fault}", file=sys.stderr)
    if not faults:
        print(f"check_dependencies: {len(asked)} CMake packages and {len(libraries)} loaded libraries are listed, none under the GPL")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
