#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The statue from nothing but this repository and Debian packages: run.sh [FOLDER]. The scan and all that is made of it stays in
# FOLDER (default: statue-out). MESO and PYTHON name the programs if they are not in the path.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
meso=$(command -v "${MESO:-meso}") || { echo "run.sh: there is no program '${MESO:-meso}'; set MESO to where it is" >&2; exit 1; }
case $meso in /*) ;; *) meso=$PWD/$meso ;; esac
python=${PYTHON:-python3}
mkdir -p "${1:-statue-out}"
cd "${1:-statue-out}"

if [ ! -f armadillo.off ]; then
  apt-get download libcgal-demo
  dpkg-deb -x libcgal-demo_*.deb package
  tar xzf package/usr/share/doc/libcgal-dev/data.tar.gz --strip-components=2 data/meshes/armadillo.off
  rm -r package libcgal-demo_*.deb
fi

# The body: 4 596 facets of 52 000, as triangles and as exact plane faces.
[ -f statue.stl ] || "$python" "$here/decimate.py" armadillo.off statue.stl 4596
"$meso" verify statue.stl
if command -v admesh > /dev/null; then
  admesh statue.stl > admesh.txt
  for line in 'Total disconnected facets *: *0 +0 *$' 'Number of parts *: *1 ' 'Degenerate facets *: *0 *$' 'Edges fixed *: *0 *$' \
    'Facets reversed *: *0 *$' 'Backwards edges *: *0 *$' 'Normals fixed *: *0 *$'; do
    grep -aqE "^$line" admesh.txt || { echo "run.sh: admesh does not say: $line" >&2; exit 1; }
  done
else
  echo "admesh is not installed: the body is not looked at by it"
fi
for body in stl step; do
  case $body in stl) import='href="statue.stl" unit="millimeter"' suffix=-stl ;; step) import='href="statue.step"' suffix= ;; esac
  sed "s|@BODY@|$import|" "$here/statue.meso.in" > "statue$suffix.meso"
done
sed '/<apply/,/<\/validation>/d' statue-stl.meso > body.meso
"$meso" convert body.meso statue.step

# The copies inside it, exactly and as triangles.
"$meso" convert statue.meso hollow.step
"$meso" convert statue-stl.meso hollow.stl --json > hollow.json
"$meso" verify --deep --points 50000 statue-stl.meso
"$meso" verify --deep --points 50000 statue.meso
"$meso" verify hollow.stl
"$meso" compare statue.meso statue-stl.meso

# How many copies there should be, counted without the engine; then one copy, small enough for other programs.
"$meso" eval statue-stl.meso cells.csv
"$python" "$here/count_copies.py" statue.stl cells.csv 0.08333333333333333 0.25 \
  "$("$python" -c 'import json; print(json.load(open("hollow.json"))["cells"]["kept"])')"
"$meso" convert statue-stl.meso one-copy.step --set clearance=14mm

# Pictures, standing.
for part in body statue-stl; do
  sed 's|</parts>|</parts><build><item part="hollowStatue"><placement matrix="-1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0"/></item></build>|' \
    "$part.meso" > "upright-$part.meso"
done
"$meso" render upright-body.meso statue.png --width 560 --height 600
"$meso" render upright-statue-stl.meso statue-cut.png --cut y=-4.8mm --width 560 --height 600
