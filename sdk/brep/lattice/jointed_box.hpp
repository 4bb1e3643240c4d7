// SPDX-License-Identifier: Apache-2.0
#pragma once
// What is in one cell box as balls and the struts that leave them, with the sides of the box as further circles on the
// balls. Private.
//
// A side that passes a ball's centre cuts the ball in a circle like that of a strut, of half a right angle more: where
// it meets the circles of struts in points of contact, or at right angles because a strut runs in the side, all that
// bounds the box's part of the union is known without an intersection.

#include <optional>
#include <string>
#include <vector>

#include "beam_graph_joints.hpp"
#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

/// 2 * axis + (0 low, 1 high).
using Side = std::uint32_t;
[[nodiscard]] Vec3 outward(Side side);

struct JointedBox {
  enum class Place : std::uint8_t {
    inside,
    in_sides,  ///< its axis runs in one side, or in two
    beyond     ///< nothing of it is in the box
  };
  Box3 box;
  double tolerance = 0;  ///< points closer than this are one
  Joints joints;
  std::vector<Place> places;                ///< by strut
  std::vector<std::vector<Side>> in_sides;  ///< by strut
  std::vector<bool> has_ball;               ///< by node: some of it may be in the box

  /// From a point to the plane of a side, positive inside; 0 within the tolerance.
  [[nodiscard]] double depth(Vec3 p, Side side) const;
};

/// Empty, and why, where struts meet beyond their balls or a side divides one across.
[[nodiscard]] std::optional<JointedBox> jointed_box(const std::vector<CellPrimitive>& primitives, const Box3& box,
                                                    double tolerance, std::string& why);

}  // namespace meso::brep
