// SPDX-License-Identifier: Apache-2.0
#pragma once
// The solids of one kind of box, with what is asked of them for every cell of that kind. Private.
//
// Thread rule: one for each thread.

#include <BRepClass3d_SolidClassifier.hxx>
#include <deque>
#include <vector>

#include "lattice/mesh_probe.hpp"
#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

struct WholeCell {
  struct Face {
    TopoDS_Face face;  ///< outward
    std::vector<Triangle3> triangles;
    Box3 box;
    double share = 0;  ///< of the volume
    Vec3 area;         ///< as a vector
  };
  std::vector<Face> faces;
  MeshProbe probe;
  std::deque<BRepClass3d_SolidClassifier> solids;  // they cannot be moved
  double volume = 0;
  double reach = 0;  ///< how far a face is from its triangles
};
/// `deflection` of the triangles. May throw Standard_Failure.
[[nodiscard]] WholeCell whole_cell(const TopoDS_Shape& solid, double deflection);

/// Of the volume, by the divergence theorem.
[[nodiscard]] double share_of(const FaceMoments& moments);
[[nodiscard]] std::vector<TopoDS_Face> faces_in(const TopoDS_Shape& shape);

template <typename Shapes>
[[nodiscard]] TopoDS_Compound compound_of(const Shapes& shapes) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& shape : shapes) builder.Add(compound, shape);
  return compound;
}

}  // namespace meso::brep
