#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Small lattices, aligned with a body and cut by one, filled with tetrahedra by Gmsh: the volume is what we tell.
#
# usage: gmsh_test.sh MESO     exit 77: Gmsh is not installed
set -euo pipefail
cd "$(dirname "$0")/../.."
meso=$1
command -v gmsh > /dev/null || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for body in '<box dx="10" dy="10" dz="10"/>' '<sphere x="5.3" y="4.9" z="5.1" radius="5.2"/>'; do
  cat > "$folder/part.meso" << END
<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
<macrostructures><macrostructure id="m"><csg>$body</csg></macrostructure></macrostructures>
<unitCells><unitCell id="u"><box dx="5" dy="5" dz="5"/><beams radius="0.6" nodeRadius="1.1">
<node id="m" x="2.5" y="2.5" z="2.5"/><node id="a" x="0" y="0" z="0"/><node id="b" x="5" y="0" z="0"/><node id="c" x="0" y="5" z="0"/>
<node id="d" x="5" y="5" z="0"/><node id="e" x="0" y="0" z="5"/><node id="f" x="5" y="0" z="5"/><node id="g" x="0" y="5" z="5"/>
<node id="h" x="5" y="5" z="5"/><beam from="a" to="m"/><beam from="b" to="m"/><beam from="c" to="m"/><beam from="d" to="m"/>
<beam from="e" to="m"/><beam from="f" to="m"/><beam from="g" to="m"/><beam from="h" to="m"/></beams></unitCell></unitCells>
<patterns><pattern id="c" unitCell="u"><loop index="i" axis="x" count="3" spacing="5"/><loop index="j" axis="y" count="3"
spacing="5"/><loop index="k" axis="z" count="3" spacing="5"/></pattern></patterns>
<parts><part id="p" macrostructure="m"><apply pattern="c" operation="intersection" fragments="drop"/></part></parts></meso>
END
  "$meso" convert "$folder/part.meso" "$folder/part.step" --json > "$folder/report.json"
  volume=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["volume"])' "$folder/report.json")
  python3 scripts/check_gmsh.py "$folder/part.step" "$volume" 0.05 0.8
done
