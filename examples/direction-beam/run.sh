#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# From the document of the I-beam to the part: body, mesh, stress, part, checks. Needs gmsh, ccx and Debian's python3-numpy.
# usage: examples/direction-beam/run.sh [path of the meso command] [folder for all that is made]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
meso=${1:-meso}
out=${2:-direction-beam}
python=/usr/bin/python3
mkdir -p "$out"
cp "$here/beam-body.meso" "$here/direction-beam.meso" "$out"
"$meso" verify "$out/beam-body.meso"
"$meso" convert "$out/beam-body.meso" "$out/beam.step"
cmp "$out/beam.step" "$here/beam.step"
"$python" -B "$here/stress.py" --meso "$meso" --out "$out"
cmp "$out/stress.raw" "$here/stress.raw" || echo "stress.raw: another solution than the one that is shipped (other versions or threads)"
"$meso" verify --deep "$out/direction-beam.meso"
"$meso" convert "$out/direction-beam.meso" "$out/part.step"
"$meso" convert "$out/direction-beam.meso" "$out/part.stl" --deflection 0.02mm
"$python" -B "$here/check.py" "$meso" --part "$out"
"$meso" compare "$out/direction-beam.meso"
