// SPDX-License-Identifier: Apache-2.0
// The same lattice by OpenCASCADE alone: one clipped body-centred cell, n^3 copies, one multi-tool fuse.
//
//   meso_bench_peer_fuse 3     prints {"cells": 27, "seconds": ..., "faces": ..., "volume": ...}
//
// Seconds of processor time are those of the fuse and of joining what lies in one surface: the cell and its copies are
// made before.
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <gp_Ax2.hxx>

namespace {

gp_Pnt corner_of(int number) { return {number & 1 ? 5.0 : 0, number & 2 ? 5.0 : 0, number & 4 ? 5.0 : 0}; }

TopoDS_Shape clipped_cell() {
  const gp_Pnt middle(2.5, 2.5, 2.5);
  TopTools_ListOfShape first, others;
  first.Append(BRepPrimAPI_MakeSphere(middle, 0.9).Shape());
  for (int i = 0; i < 8; ++i) {
    const gp_Vec along(corner_of(i), middle);
    others.Append(BRepPrimAPI_MakeSphere(corner_of(i), 0.9).Shape());
    others.Append(BRepPrimAPI_MakeCylinder(gp_Ax2(corner_of(i), gp_Dir(along)), 0.5, along.Magnitude()).Shape());
  }
  BRepAlgoAPI_Fuse fuse;
  fuse.SetArguments(first);
  fuse.SetTools(others);
  fuse.Build();
  return BRepAlgoAPI_Common(fuse.Shape(), BRepPrimAPI_MakeBox(5, 5, 5).Shape()).Shape();
}

TopoDS_Shape fused(const TopoDS_Shape& cell, int edge) {
  TopTools_ListOfShape first, others;
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k) {
        gp_Trsf move;
        move.SetTranslation(gp_Vec(5.0 * i, 5.0 * j, 5.0 * k));
        (first.IsEmpty() ? first : others).Append(cell.Moved(TopLoc_Location(move)));
      }
  BRepAlgoAPI_Fuse fuse;
  fuse.SetArguments(first);
  fuse.SetTools(others);
  fuse.Build();
  fuse.SimplifyResult();
  return fuse.Shape();
}

}  // namespace

int main(int argc, char** argv) {
  const int edge = argc == 2 ? std::atoi(argv[1]) : 0;
  if (edge < 2) {
    std::fputs("usage: meso_bench_peer_fuse EDGE   (cells along each axis, 2 or more)\n", stderr);
    return 2;
  }
  const TopoDS_Shape cell = clipped_cell();
  const std::clock_t start = std::clock();
  const TopoDS_Shape body = fused(cell, edge);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  int faces = 0;
  for (TopExp_Explorer it(body, TopAbs_FACE); it.More(); it.Next()) ++faces;
  GProp_GProps properties;
  BRepGProp::VolumeProperties(body, properties);
  std::printf("{\"cells\": %d, \"seconds\": %.3f, \"faces\": %d, \"volume\": %.6f}\n", edge * edge * edge, seconds,
              faces, properties.Mass());
}
