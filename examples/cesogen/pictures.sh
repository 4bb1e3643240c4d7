#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Draws the pictures of README.md into this folder; `meso` must be on the PATH.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cp "$here"/*.txt .

draw() {  # draw NAME WIDTH HEIGHT WORDS...
  local name=$1 width=$2 height=$3
  shift 3
  meso sdf "$@" -o "$name.stl"
  meso render "$name.stl" "$here/$name.png" --width "$width" --height "$height"
}

# gallery NAME CHANGE...: a cell of each of the 27 surfaces in a box of its own, nine in a row
gallery() {
  local name=$1 column=0 row=0
  shift
  : > "$name.txt"
  sed -n "/<<'TABLE'/,/^TABLE/p" "$here/run.sh" | sed '1d;$d' > surfaces
  while read -r surface _; do
    echo "tpms.$surface $* scale 2 box intersection move $((column * 5 / 2)).$((column * 25 % 10)),0,-$((row * 5 / 2)).$((row * 25 % 10))"
    if ((column + row > 0)); then echo union; fi
    column=$(((column + 1) % 9))
    if ((column == 0)); then row=$((row + 1)); fi
  done < surfaces > "$name.txt"
  draw "$name" 660 400 "@$name.txt" -b -1.05,-1.05,-6.05,21.05,1.05,1.05 -s 1106,106,356
}

draw hourglass 320 240 -s 100^3 \
  cylinder move 0,-2,0 cylinder move 0,2,0 union scale 1/2 orient 1,0,0 complement box intersection
draw hierarchy 320 240 -b -4,-4,-4,4,4,4 -s 200^3 ball scale 5 tpms.p scale 4 tpms.d scale 3.75 tpms.gyroid scale 1.25 \
  intersection intersection intersection
draw trip0 320 240 -b -4,-4,-4,4,4,4 -s 100^3 ball scale 4 tpms.gyroid scale 4 intersection
gallery endoskeletons offset 0.35
gallery sheets shell 0.7
meso sdf @baluster.txt -s 150^3 -o baluster.obj
draw baluster 400 240 -s 200^3 tpms.neovius scale .065 file baluster.obj intersection
meso sdf @acorn.txt -s 100^3 -o acorn.obj
draw acorn 320 240 -s 150^3 tpms.octo scale .009 file acorn.obj intersection
