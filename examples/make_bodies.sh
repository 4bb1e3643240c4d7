#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the macrostructure STEP files of the examples from their own documents.
# usage: examples/make_bodies.sh [path of the meso command]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
meso=${1:-meso}
for name in ibeam disk sphere; do
  "$meso" convert "$here/$name/$name-body.meso" "$here/$name/$name.step"
done
