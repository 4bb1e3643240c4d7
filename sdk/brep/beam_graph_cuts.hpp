// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where circles on a ball touch or nearly do, what they leave of it is divided between them. Private.
//
//   const BallCuts cuts = cuts_between({{axis, angle}, ...});
//
// A face whose border nearly meets itself is read wrongly by OpenCASCADE: it samples the border. Arcs of great circles
// from circle to circle, the shortest there are, end each face in every neck; what is left are faces with one border
// that passes nothing twice, each less than half of the ball.

#include <array>
#include <cstdint>
#include <vector>

#include "meso/base/vec.hpp"

namespace meso::brep {

/// What a strut takes of a ball, seen from the ball's centre.
struct BallCap {
  Vec3 axis;  ///< unit
  double angle = 0;
};

/// Circles that are as close as that touch.
inline constexpr double touching_gap = 1e-7;  // radians

/// The angle between two unit vectors, exact also where it is small.
[[nodiscard]] double angle_between(Vec3 a, Vec3 b);

struct BallCuts {
  /// By number: a cap, or behind these a point. The cut leaves both at right angles, towards the other's axis.
  using Cut = std::array<std::uint32_t, 2>;
  std::vector<Cut> cuts;
  std::vector<Vec3> points;  ///< unit; where a part of the ball that no cap is near is divided
};

/// None where no two caps are closer than a tenth of a radian, and none where the faces would not be as told above.
/// Caps keep apart or touch. Cost: some 50 us. Thread rule: pure.
[[nodiscard]] BallCuts cuts_between(const std::vector<BallCap>& caps);

}  // namespace meso::brep
