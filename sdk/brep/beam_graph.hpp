// SPDX-License-Identifier: Apache-2.0
#pragma once
// The beams of all cells of a pattern as one graph: nodes that are one point are one node, struts that several cells
// share are one strut. Private.
//
//   std::string why;
//   auto graph = beam_graph(cells, snapped, why, context);   // empty, and why: not such a body; or errors in the sink
//
// Units: millimetres, in the world. Points within 1e-6 are one. A node keeps the largest ball, a shared strut the
// larger radii. Cost: the evaluation of each cell once, about 100 bytes a strut.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "meso/eval/evaluation.hpp"
#include "solid_context.hpp"

namespace meso::brep {

struct BeamGraph {
  struct Node {
    Vec3 position;
    double radius = 0;  ///< of its ball; 0: none
  };
  /// The surface is a cone between circles of these radii about its nodes, before the balls are joined to it.
  struct Strut {
    std::array<std::uint32_t, 2> node{};
    std::array<double, 2> radius{};
  };
  std::vector<Node> nodes;
  std::vector<Strut> struts;
  std::uint64_t cells = 0;  ///< whose beams these are
};

/// Radii that would be equal but for rounding in a document, and what was done about them.
struct SnappedRadii {
  std::size_t count = 0;
  double most = 0;  ///< millimetres
  void tell(double difference) {
    ++count;
    most = difference > most ? difference : most;
  }
};

/// Radii closer than this part of themselves are meant to be equal.
inline constexpr double equal_radii = 2e-5;

[[nodiscard]] std::optional<BeamGraph> beam_graph(const eval::CellStream& cells, SnappedRadii& snapped,
                                                  std::string& why, const SolidContext& context);

/// Of beams in the world.
[[nodiscard]] std::optional<BeamGraph> beam_graph(const eval::BeamsShape& beams, ElementId where, SnappedRadii& snapped,
                                                  std::string& why, const SolidContext& context);

}  // namespace meso::brep
