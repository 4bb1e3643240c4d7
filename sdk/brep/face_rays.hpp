// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether points are in a solid of many faces, by rays: OpenCASCADE's classifier goes through the whole solid for each
// point, ten milliseconds for a thousand faces. Private.

#include <IntCurvesFace_Intersector.hxx>
#include <memory>
#include <optional>
#include <vector>

#include "occt.hpp"

namespace meso::brep {

class FaceRays {
 public:
  /// May throw Standard_Failure.
  explicit FaceRays(const TopoDS_Shape& solid);
  /// TopAbs_ON: within about `tolerance_mm` of a face along one of three lines across each other. Of those that pass no
  /// edge most must agree; nothing where none does. Cost: a microsecond per hundred faces, and some more for each that
  /// a ray comes near.
  [[nodiscard]] std::optional<TopAbs_State> state(Vec3 p, double tolerance_mm);

 private:
  struct Face {
    std::unique_ptr<IntCurvesFace_Intersector> hits;
    Box3 box;
  };
  [[nodiscard]] TopAbs_State along(Vec3 p, Vec3 direction, double tolerance_mm);

  std::vector<Face> faces_;
};

}  // namespace meso::brep
