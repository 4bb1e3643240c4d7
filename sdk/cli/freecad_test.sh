#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The I-beam at pitch=10mm, judged by FreeCAD: closed valid solids with the volume that we tell.
#
# usage: freecad_test.sh MESO step|stl     exit 77: FreeCAD is not installed
set -euo pipefail
cd "$(dirname "$0")/../.."
meso=$1 format=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$meso" convert examples/ibeam/ibeam.meso "$folder/beam.$format" --set pitch=10mm --json > "$folder/report.json"
volume=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["volume"])' "$folder/report.json")
# Flat triangles fill a little less than round struts.
tolerance=1e-4
if [[ $format == stl ]]; then tolerance=0.1; fi
scripts/check_freecad.py "$folder/beam.$format" "$volume" "$tolerance"
