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
  /// In the space that solids leave of a box (box_frame): the solids' faces within the box, their walls, and the rest
  /// of the box's sides.
  enum class Role : std::uint8_t { skin, solid_wall, open_wall };
  struct Face {
    TopoDS_Face face;  ///< outward
    std::vector<Triangle3> triangles;
    Box3 box;
    double share = 0;  ///< of the volume
    Vec3 area;         ///< as a vector
    Role role = Role::skin;
  };
  std::vector<Face> faces;
  MeshProbe probe;
  std::deque<BRepClass3d_SolidClassifier> solids;  // they cannot be moved
  double volume = 0;
  double reach = 0;       ///< how far a face is from its triangles
  bool is_frame = false;  ///< what is asked for is not what is left of the space, but of the box
  double left_out = 0;    ///< of the box, by volume: the solids beside the space

  /// A meshed face.
  void add(const TopoDS_Face& face, Role role);
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
