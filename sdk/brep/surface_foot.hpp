// SPDX-License-Identifier: Apache-2.0
#pragma once
// The point of a surface that is nearest to another point. Private.

#include <optional>
#include <vector>

#include "meso/brep/body.hpp"
#include "occt.hpp"

class ShapeAnalysis_Surface;

namespace meso::brep {

/// By Newton's method from parameters nearby; nothing where it does not settle.
[[nodiscard]] std::optional<gp_Pnt2d> foot_beside(ShapeAnalysis_Surface& surface, const gp_Pnt2d& start, Vec3 p);

/// Closed forms, but for B-splines: those are searched, and the nearest earlier answer is where a search begins.
class SurfaceFoot {
 public:
  explicit SurfaceFoot(const Surface& surface);
  /// `near_mm`: an answer at most that far off is taken without looking for a nearer one elsewhere.
  [[nodiscard]] Vec3 operator()(Vec3 p, double near_mm = 1e-6);

 private:
  const Surface& surface_;
  Handle(ShapeAnalysis_Surface) search_;
  struct Answer {
    Vec3 point;
    gp_Pnt2d uv;
  };
  std::vector<Answer> known_;
};

}  // namespace meso::brep
