// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether points are in a solid. Private.

#include <BRepClass3d_SolidClassifier.hxx>
#include <Bnd_Box.hxx>
#include <optional>

#include "face_rays.hpp"
#include "facet_tree.hpp"

namespace meso::brep {

/// Solids of many plane facets are asked by a tree of these, others of many faces by rays, the rest by OpenCASCADE,
/// which goes through the whole solid for each point. Can be neither copied nor moved.
class PointInSolid {
 public:
  /// May throw Standard_Failure.
  explicit PointInSolid(const TopoDS_Shape& solid);
  /// Outside, however near.
  [[nodiscard]] bool is_beyond_box(Vec3 p) const;
  /// TopAbs_ON: within `tolerance_mm` of a facet, or, of other solids, of a face along some line.
  [[nodiscard]] TopAbs_State state(Vec3 p, double tolerance_mm);

 private:
  Bnd_Box box_;
  std::optional<FacetTree> facets_;
  std::optional<FaceRays> rays_;
  TopoDS_Shape solid_;
  bool is_loaded_ = false;
  BRepClass3d_SolidClassifier classifier_;
};

}  // namespace meso::brep
