#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From one small text file to a solid: builds the command, realises the I-beam, draws it, and compares sizes.
#
# usage: demo.sh        results: build/demo; a second run only rebuilds what changed
set -euo pipefail
cd "$(dirname "$0")/.."

# As in test.sh: what one build folder compiled serves the next.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1

out=build/demo
meso=build/release/bin/meso
ibeam=examples/ibeam/ibeam.meso

say() { printf '\n\033[1m== %s\033[0m\n' "$1"; }

say "1/6 packages"
./scripts/install-deps.sh

say "2/6 building the meso command (some minutes the first time)"
cmake --preset release > /dev/null
cmake --build --preset release --target meso -- --quiet

mkdir -p "$out"
say "3/6 $ibeam to an exact solid: $out/ibeam.step"
"$meso" convert "$ibeam" "$out/ibeam.step"

say "4/6 $ibeam to triangles: $out/ibeam.stl"
"$meso" convert "$ibeam" "$out/ibeam.stl"

say "5/6 a picture of it: $out/ibeam.png"
"$meso" render "$ibeam" "$out/ibeam.png"

say "6/6 what the idea weighs, and what its geometry weighs"
"$meso" compare "$ibeam" examples/disk/disk.meso examples/sphere/sphere.meso

say "written"
du -b "$ibeam" examples/ibeam/*.step "$out"/ibeam.{step,stl,png} | awk '{ printf "%14d bytes  %s\n", $1, $2 }'
