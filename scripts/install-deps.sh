#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian packages that building and testing Meso needs; does nothing where they are already there.
#
# usage: install-deps.sh [--all]     --all: also what slower checks and benchmarks need (clang, clang-tidy, FreeCAD, Gmsh, VTK, OpenVDB)
#
# Works as root or through sudo. Made for Debian 12; the list is also a reading list for other systems.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache pkg-config git python3
  # reading and writing documents
  libpugixml-dev libssl-dev
  # libzip's CMake package insists on its three programs
  libzip-dev zipcmp zipmerge ziptool
  # expressions of patterns
  libmuparser-dev
  # vector fields: HDF5, VTU
  libhdf5-dev libexpat1-dev zlib1g-dev
  # exact geometry; OpenCASCADE's CMake package insists on all six
  libocct-foundation-dev libocct-modeling-data-dev libocct-modeling-algorithms-dev
  libocct-data-exchange-dev libocct-ocaf-dev libocct-visualization-dev
  # pictures
  libembree-dev libtbb-dev libpng-dev
  # the command
  libcli11-dev nlohmann-json3-dev libfmt-dev
  # tests: GoogleTest, two judges of the XML schema, resource measurement
  libgtest-dev libgmock-dev libbenchmark-dev libxml2-utils libxerces-c-samples time
)
# what fixtures, pictures and the checks of fields and examples are made with; run, never linked
slower_checks=(calculix-ccx python3-vtk9 python3-h5py python3-numpy python3-scipy python3-matplotlib python3-pil python3-nlopt admesh
  clang-14 clang-format-14 clang-tidy-14 libclang-rt-14-dev freecad-python3 gmsh)
# what bench/implicit_table.py compares with: VTK and OpenVDB, about 1 GB
peers=(libvtk9-dev libopenvdb-dev)

case "${1-}" in
  "") ;;
  --all) packages+=("${slower_checks[@]}" "${peers[@]}") ;;
  *) sed -n '3,7s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "install-deps: all ${#packages[@]} packages are there"
  exit 0
fi

echo "install-deps: installing ${missing[*]}"
as_root=()
if ((EUID != 0)); then as_root=(sudo); fi
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
echo "install-deps: done"
