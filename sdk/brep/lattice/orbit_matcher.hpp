// SPDX-License-Identifier: Apache-2.0
#pragma once
// Finds the vertex or edge of the template that an OpenCASCADE vertex or edge is, up to a lattice translation. Private.

#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "meso/brep/body.hpp"
#include "occt.hpp"

namespace meso::brep {

class OrbitMatcher {
 public:
  /// Fills `geometry` (its lattice is set) and `samples` as new orbits come. Coordinates count from `origin`.
  OrbitMatcher(Template& geometry, std::vector<std::vector<Vec3>>& samples, Vec3 origin, double tolerance)
      : geometry_(geometry), samples_(samples), origin_(origin), tolerance_(tolerance) {}

  /// What comes now is of another solid. Corners of one solid are told apart down to a hundredth of the tolerance.
  void begin_solid();

  struct Match {
    std::uint32_t edge = 0;
    Index3 offset{};       ///< the template's edge, moved by this, is the given one
    bool flipped = false;  ///< the given edge's curve runs the other way
  };
  /// An edge of a face whose cell is (0, 0, 0). Its own orientation flag is not looked at.
  [[nodiscard]] Match match(const TopoDS_Edge& edge);
  /// A pole or apex; never shared.
  [[nodiscard]] Match add_degenerate(const TopoDS_Edge& edge);

 private:
  struct VertexMatch {
    std::uint32_t vertex = 0;
    Index3 offset{};
    friend bool operator==(const VertexMatch&, const VertexMatch&) = default;
  };
  [[nodiscard]] VertexMatch match_vertex(const TopoDS_Vertex& vertex);
  [[nodiscard]] VertexMatch find_or_add(Vec3 p);

  Template& geometry_;
  std::vector<std::vector<Vec3>>& samples_;
  Vec3 origin_;
  double tolerance_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> vertices_;  ///< by the small box they are in
  TopTools_IndexedMapOfShape of_solid_;
  std::vector<VertexMatch> matches_;                          ///< of those
  std::map<std::pair<std::uint32_t, Index3>, Vec3> corners_;  ///< which of the solid's corners is that vertex
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges_;  ///< by their two vertices
  std::vector<TopoDS_Edge> shapes_;                                                      ///< first edge of each orbit
};

}  // namespace meso::brep
