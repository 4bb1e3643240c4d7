// SPDX-License-Identifier: Apache-2.0
#pragma once
// Corners and edges of a cell that is put together face by face: each once, whichever face comes upon it. Private.

#include <span>
#include <vector>

#include "meso/brep/body.hpp"

namespace meso::brep {

class CellEdges {
 public:
  /// Points closer than `tolerance` are one.
  CellEdges(Template& geometry, double tolerance) : geometry_(geometry), tolerance_(tolerance) {}

  [[nodiscard]] std::uint32_t vertex(Vec3 p);
  /// The number of the vertex there; none: `count()`.
  [[nodiscard]] std::uint32_t find(Vec3 p) const;
  [[nodiscard]] std::size_t count() const { return geometry_.vertices.size(); }
  [[nodiscard]] Vec3 at(std::uint32_t vertex) const { return geometry_.vertices[vertex]; }

  [[nodiscard]] Coedge line(std::uint32_t from, std::uint32_t to);
  /// Clockwise about `axis`; all around where the ends are one.
  [[nodiscard]] Coedge arc(Vec3 centre, Vec3 axis, double radius, std::uint32_t from, std::uint32_t to);

  [[nodiscard]] std::uint32_t start(const Coedge& use) const {
    return geometry_.edges[use.edge].vertex[use.reversed ? 1 : 0];
  }
  [[nodiscard]] std::uint32_t end(const Coedge& use) const {
    return geometry_.edges[use.edge].vertex[use.reversed ? 0 : 1];
  }
  /// Points along it, from its start on, its end left out.
  [[nodiscard]] std::vector<Vec3> points(const Coedge& use, int count) const;

 private:
  [[nodiscard]] Coedge known_or(const EdgeTemplate& edge, Vec3 middle);

  Template& geometry_;
  double tolerance_;
  std::vector<Vec3> middles_;
};

[[nodiscard]] inline Coedge turned(Coedge use) {
  use.reversed = !use.reversed;
  return use;
}

/// Each of those uses in one loop, end to start. Empty where some end has no start, or has several.
[[nodiscard]] std::vector<std::vector<Coedge>> chained(const CellEdges& edges, std::span<const Coedge> uses);

}  // namespace meso::brep
