#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A case study under examples/, judged by `meso verify --deep` and a variant of at most 10 000 faces by FreeCAD.
#
# usage: case_studies_test.sh MESO ibeam|disk|sphere|gear|direction-beam|statue     says so where FreeCAD is not installed
#
# The statue's body is a scan that is not kept here: 77 (skipped) unless examples/statue/run.sh examples/statue has made it.
set -euo pipefail
cd "$(dirname "$0")/../.."
meso=$1 name=$2
document=examples/$name/$name.meso
deep=()
# What FreeCAD integrates coarsely is told in each page.
case $name in
  ibeam) variant=(--set pitch=10mm) tolerance=1e-4 ;;
  gear) variant=() tolerance=3e-4 ;;
  direction-beam) variant=(--set gap=29.9mm) tolerance=1e-5 ;;
  disk | sphere) variant=() tolerance=1e-6 ;;
  # The body as STL is the same body (its page): OpenCASCADE's reader takes most of the time of the other.
  statue) document=examples/statue/statue-stl.meso deep=(--points 50000) variant=(--set clearance=14mm) tolerance=1e-9 ;;
  *) sed -n '5s/^# //p' "$0" >&2; exit 2 ;;
esac
if [ ! -f "$document" ]; then
  echo "$document is not there: examples/statue/run.sh examples/statue makes it" >&2
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$meso" verify --deep "${deep[@]}" "$document"
"$meso" convert "$document" "$folder/part.step" "${variant[@]}" --json > "$folder/report.json"
read -r volume faces < <(python3 -c 'import json, sys; r = json.load(open(sys.argv[1])); print(r["volume"], r["faces"])' "$folder/report.json")
if ((faces > 10000)); then
  echo "$name: $faces faces are too many for FreeCAD" >&2
  exit 1
fi
status=0
scripts/check_freecad.py "$folder/part.step" "$volume" "$tolerance" || status=$?
if ((status != 77)); then exit "$status"; fi
