#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the commands of the Cesogen paper and compares every volume with what it must be.
#
# usage: run.sh [--quick] [FOLDER]     meshes go to FOLDER (default: a temporary one)
#
# --quick takes few samples and five times the tolerance, and leaves thin sheets out. `meso` must be on the PATH. Where the numbers come from stands
# in README.md.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)

quick=false
if [[ ${1-} == --quick ]]; then quick=true; shift; fi
if (($# > 0)); then
  mkdir -p "$1" && cd "$1"
else
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  cd "$folder"
fi
cp "$here"/*.txt .

runs=0 failures=0 volume=0
# make NAME VOLUME TOLERANCE WORDS...: writes NAME, and compares its volume, relatively; the volume stays in $volume
make() {
  local name=$1 expected=$2 tolerance=$3 coarse=()
  shift 3
  if $quick; then coarse=(-s "50^3"); tolerance=$(awk "BEGIN { print 5 * $tolerance }"); fi
  local report
  report=$(meso sdf "$@" "${coarse[@]}" -o "$name" --json)
  volume=$(sed -n 's/^  "volume": \(.*\),$/\1/p' <<< "$report")
  local verdict=ok
  if ! grep -q '"closed": true' <<< "$report"; then verdict="NOT CLOSED"; fi
  if ! awk "BEGIN { exit !(($volume - $expected)^2 <= ($tolerance * $expected)^2) }"; then verdict="WRONG"; fi
  runs=$((runs + 1))
  if [[ $verdict != ok ]]; then failures=$((failures + 1)); fi
  printf '%-24s %12.6f   expected %12.6f   %s\n' "$name" "$volume" "$expected" "$verdict"
}

# Solids and what is done to them.
make ball.ply 4.188790 2e-3 ball
make ball-2.ply 33.510322 2e-3 ball scale 2
make ellipsoid.ply 25.132741 2e-3 ball scale 1,2,3
make box.ply 8 1e-3 box
make rounded-box.ply 15.243553 2e-3 box offset 0.25
make hollow-ball.ply 2.521651 5e-3 ball shell 0.2
make cylinder.ply 6.283185 2e-3 cylinder
make lying-cylinder.ply 1.570796 2e-3 cylinder orient 1,0,0 scale 1/2
make two-cylinders.ply 3.141593 2e-3 cylinder move 0,-2,0 cylinder move 0,2,0 union scale 1/2 orient 1,0,0
make difference.ply 59.811210 2e-3 box scale 2 ball difference
make complement.ply 3.811210 2e-3 ball complement
make half-space.ply 6.666667 2e-3 expression 'x+y+z-1'

# The hourglass of section 3.
make hourglass.ply 6.429204 1e-2 -s 40^3 \
  cylinder move 0,-2,0 cylinder move 0,2,0 union scale 1/2 orient 1,0,0 complement box intersection

# Endoskeletons, sheets, exoskeleton and a sheet off the middle; 8 cells in the box.
make gyroid.ply 4 2e-3 -s 60^3 tpms.gyroid
make p-endo.ply 4.7994 2e-3 -s 60^3 tpms.p offset 0.35
make p-sheet.ply 1.5988 5e-3 -s 60^3 tpms.p shell 0.7
make gyroid-exo.ply 3.3556 2e-3 -s 60^3 tpms.gyroid offset 0.25 complement
make gyroid-off-sheet.ply 1.2942 1e-2 -s 60^3 tpms.gyroid offset 0.25 shell 0.5

# Figures 2 and 3: every surface as an endoskeleton with level .35, and as a sheet with .7; one cell, volume fractions.
cell=(-b 0,0,0,1,1,1)
while read -r name endo sheet; do
  make "$name.ply" "$endo" 5e-3 "${cell[@]}" -s 100^3 "tpms.$name" offset 0.35
  if $quick && awk "BEGIN { exit !($sheet < .25) }"; then continue; fi
  make "$name-sheet.ply" "$sheet" 2e-2 "${cell[@]}" -s 200^3 "tpms.$name" shell 0.7
done <<'TABLE'
gyroid 0.61293 0.22586
d 0.64360 0.28720
p 0.59992 0.19985
iwp 0.51591 0.09211
neovius 0.57608 0.15216
c-y 0.57705 0.15410
lidinoid 0.52364 0.27057
octo 0.70600 0.58031
frd 0.51122 0.09114
s 0.67289 0.34577
p+c-p 0.89655 0.86258
split-p 0.63590 0.25414
f 0.85170 0.70340
c-d 0.66957 0.33913
g-prime 0.56579 0.41021
g-prime-2 0.54430 0.06630
d-prime 0.90450 0.60090
k 0.59304 0.36572
c-s 0.56770 0.13540
y 0.68300 0.36590
pm-y 0.64570 0.29150
c-pm-y 0.58726 0.17452
c-i2-y 0.58010 0.14640
w 0.72770 0.45540
q-star 0.57900 0.15800
c-g 0.53450 0.06900
slotted-p 0.50946 0.06986
TABLE

# Solids of files: two meshes each filled with its own surface, joined (the tree of figure 1).
make mesh1.ply 4.188790 2e-3 ball
mesh1=$volume
make mesh2.ply 8 2e-3 box move 3,0,0 -b 1.9,-1.1,-1.1,4.1,1.1,1.1
mesh2=$volume
make tree.ply "$(awk "BEGIN { print ($mesh1 + $mesh2) / 2 }")" 2e-2 \
  tpms.gyroid scale 0.5 file mesh1.ply intersection tpms.p scale 0.5 file mesh2.ply intersection union

# Figure 6: a ball of cells of cells of cells; the volume is that of a quasi-Monte-Carlo count.
make hierarchy.ply 55.8945 25e-3 -b -4,-4,-4,4,4,4 -s 130^3 ball scale 5 tpms.p scale 4 tpms.d scale 3.75 \
  tpms.gyroid scale 1.25 intersection intersection intersection

# Figure 10: half a ball of gyroid, then through files and back.
box=(-b -4,-4,-4,4,4,4 -s 100^3)
make trip0.ply 134.041287 5e-3 "${box[@]}" ball scale 4 tpms.gyroid scale 4 intersection
first=$volume
for trip in 1 2 3; do
  make "trip$trip.ply" "$first" 2e-2 "${box[@]}" file "trip$((trip - 1)).ply"
done

# Two objects of revolution, filled: a share of them in the limit of small cells. Few samples a cell take something off
# the edges between cells and skin.
make baluster.obj 0.0213388 5e-3 -s 120^3 @baluster.txt
baluster=$volume
make baluster-neovius.ply "$(awk "BEGIN { print $baluster / 2 }")" 6e-2 -s 80^3 tpms.neovius scale .065 file baluster.obj intersection
make baluster-fine.ply "$(awk "BEGIN { print $baluster / 2 }")" 6e-2 -s 120^3 tpms.neovius scale .03 file baluster.obj intersection
make acorn.obj 0.00019985 5e-3 -s 100^3 @acorn.txt
acorn=$volume
make acorn-octo.ply "$(awk "BEGIN { print $acorn * .47059 }")" 6e-2 -s 80^3 tpms.octo scale .009 file acorn.obj intersection
make acorn-fine.ply "$(awk "BEGIN { print $acorn * .47059 }")" 15e-2 -s 120^3 tpms.octo scale .003 file acorn.obj intersection

# The optima of table 3.
make optimum-gyroid.ply 4.0943 1e-2 -s 40^3 tpms.gyroid offset .037 scale 1.3
make optimum-iwp.ply 4.3130 2e-2 -s 40^3 tpms.iwp offset .52 scale .50
make optimum-frd.ply 4.5204 1e-2 -s 40^3 tpms.frd offset .56 scale 1.1

echo "$runs runs, $failures failures"
((failures == 0))
