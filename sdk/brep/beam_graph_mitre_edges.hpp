// SPDX-License-Identifier: Apache-2.0
#pragma once
// Vertices and edges around the stubs of a node, each edge once for both faces that it is between. Private.

#include <optional>
#include <vector>

#include "beam_graph_miters.hpp"
#include "meso/brep/body.hpp"

namespace meso::brep {

/// Of an edge between two stubs: what it is known by besides its curve.
struct MitreArc {
  const NodeMiters* node = nullptr;
  Vec3 origin;
  std::size_t stub = 0;
  Mitre part{};
  double radius = 0;  ///< the larger one
  double sweep = 0;   ///< about the one of both axes that it goes farther around

  /// Between its ends, in its direction: one fewer than `parts`.
  [[nodiscard]] std::vector<Vec3> points(int parts) const;
};

/// An arc of a circle on the ball, counter-clockwise about the stub's axis.
struct BallArc {
  std::uint32_t edge = 0;
  std::size_t stub = 0;
};

struct NodeEdges {
  std::vector<std::vector<Coedge>> around;  ///< by stub: from its seam, counter-clockwise about its axis
  std::vector<BallArc> on_ball;
};

/// `seams`: a turn for each stub. Adds to `geometry`, and to `arcs` by edge. Nothing where two stubs see different
/// corners. REQUIRES: node.find().
[[nodiscard]] std::optional<NodeEdges> mitre_edges(const NodeMiters& node, Vec3 origin,
                                                   const std::vector<double>& seams, Template& geometry,
                                                   std::vector<MitreArc>& arcs);

}  // namespace meso::brep
