// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where the struts of a beam graph leave the balls of their nodes, and whether they part there. Private.
//
// The axis of a strut runs through the centre of its node's ball, so cylinder or cone and ball meet in a circle. If the
// circles of a node lie beside each other on its ball and nothing else meets, the union's boundary is what lies outside
// of the circles on the balls, and what lies between its two circles of each strut: nothing is left to compute.
//
// Thread rule: pure.

#include <optional>
#include <string>

#include "beam_graph.hpp"
#include "beam_graph_cuts.hpp"

namespace meso::brep {

/// The circle in which a strut leaves a ball.
struct StrutEnd {
  double along = 0;   ///< of its plane from the node, along the strut
  double radius = 0;  ///< of the circle
  double angle = 0;   ///< between the strut's axis and a point of the circle, seen from the node
};

/// Where a cone about an axis through the centre of a ball has left it: of that radius at the centre, `growth` per
/// length.
[[nodiscard]] StrutEnd leave_ball(double ball, double radius, double growth);

/// One end of a strut: twice the strut's number, and one more at its second node.
using Leaving = std::uint32_t;

struct Joints {
  BeamGraph graph;
  std::vector<std::array<StrutEnd, 2>> ends;  ///< by strut
  /// The balls at the two ends of a strut meet: there is one circle, and nothing of the strut to be seen.
  std::vector<bool> is_swallowed;
  std::vector<std::vector<Leaving>> leaving;     ///< by node
  std::vector<std::array<Leaving, 2>> touching;  ///< circles of one node that touch in a point, rising
  std::vector<bool> is_straight;                 ///< by node: its two struts share their circle, no ball is to be seen

  [[nodiscard]] const StrutEnd& end(Leaving l) const { return ends[l / 2][l % 2]; }
  [[nodiscard]] std::uint32_t node(Leaving l) const { return graph.struts[l / 2].node[l % 2]; }
  /// Away from the node.
  [[nodiscard]] Vec3 direction(Leaving l) const;
};

/// Where the struts of a node may meet: within its ball, or anywhere; then there are no ends.
enum class Meeting { in_balls, beyond_balls };

/// Empty, and why, if struts or balls meet in other ways. Balls that are too small by `equal_radii` are made larger.
[[nodiscard]] std::optional<Joints> joints_of(BeamGraph graph, SnappedRadii& snapped, std::string& why,
                                              Meeting meeting = Meeting::in_balls);

}  // namespace meso::brep
