// SPDX-License-Identifier: Apache-2.0
#pragma once
// Finds the vertex or edge of the template that an OpenCASCADE vertex or edge is, up to a lattice translation. Private.

#include <map>
#include <optional>
#include <set>
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

  struct Match {
    std::uint32_t edge = 0;
    Index3 offset{};       ///< the template's edge, moved by this, is the given one
    bool flipped = false;  ///< the given edge's curve runs the other way
  };
  /// Of all edges of a solid whose cell is (0, 0, 0), in their order. Their own orientation flags are not looked at.
  /// Corners of one solid are told apart down to a hundredth of the tolerance; two of its edges are never one, however
  /// close they are, and of those that could be a known edge it is the closest.
  [[nodiscard]] std::vector<Match> match(const TopTools_IndexedMapOfShape& edges);

 private:
  struct VertexMatch {
    std::uint32_t vertex = 0;
    Index3 offset{};
    friend bool operator==(const VertexMatch&, const VertexMatch&) = default;
  };
  /// An edge of the solid.
  struct Own {
    TopoDS_Edge edge;  ///< forward
    VertexMatch start, end;
    std::vector<Vec3> points;
    std::optional<Match> match;
  };
  /// What an edge or a vertex of the solid could be, and how far it is from that.
  template <typename As>
  struct Possible {
    double distance = 0;
    std::size_t own = 0;
    As match;
  };
  using Candidate = Possible<Match>;
  /// A point in the cell that `offset` tells.
  struct Home {
    Vec3 place;
    Index3 offset{};
  };
  void match_vertices(const TopTools_IndexedMapOfShape& edges);
  [[nodiscard]] const VertexMatch& match_of(const TopoDS_Vertex& vertex) const {
    return *matches_[static_cast<std::size_t>(of_solid_.FindIndex(vertex)) - 1];
  }
  [[nodiscard]] Home home_of(Vec3 p) const;
  void add_candidates(Vec3 p, std::size_t own, std::vector<Possible<VertexMatch>>& to) const;
  void take_closest(std::vector<Possible<VertexMatch>> candidates);
  [[nodiscard]] VertexMatch add(Vec3 p);
  void add_candidates(const std::vector<Own>& edges, std::size_t own, std::vector<Candidate>& to) const;
  void take_closest(std::vector<Candidate> candidates, std::vector<Own>& edges);
  [[nodiscard]] Match add(const Own& own);
  /// A pole or apex; never shared.
  [[nodiscard]] Match add_degenerate(const VertexMatch& pole, const TopoDS_Edge& edge);

  Template& geometry_;
  std::vector<std::vector<Vec3>>& samples_;
  Vec3 origin_;
  double tolerance_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> vertices_;  ///< by the small box they are in
  TopTools_IndexedMapOfShape of_solid_;
  std::vector<std::optional<VertexMatch>> matches_;           ///< of those
  std::map<std::pair<std::uint32_t, Index3>, Vec3> corners_;  ///< which of the solid's corners is that vertex
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges_;  ///< by their two vertices
  std::vector<TopoDS_Edge> shapes_;                                                      ///< first edge of each orbit
  std::set<std::pair<std::uint32_t, Index3>> taken_;  ///< what edges of the solid are
};

}  // namespace meso::brep
