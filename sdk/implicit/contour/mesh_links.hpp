// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which triangles meet in a point of a closed mesh, while edges are collapsed: lists of corners that join in no time.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "meso/base/triangle_mesh.hpp"

namespace meso::implicit {

class MeshLinks {
 public:
  explicit MeshLinks(TriangleMesh& mesh);

  /// False: the point was collapsed onto another.
  [[nodiscard]] bool has_point(std::uint32_t point) const { return head_[point] != none; }
  [[nodiscard]] bool has_triangle(std::uint32_t triangle) const { return triangles_[triangle][0] != none; }
  [[nodiscard]] bool is_corner(std::uint32_t triangle, std::uint32_t point) const {
    const auto& t = triangles_[triangle];
    return t[0] == point || t[1] == point || t[2] == point;
  }
  template <class Visit>
  void visit_triangles(std::uint32_t point, Visit visit) const {
    for (std::uint32_t c = head_[point]; c != none; c = next_[c])
      if (has_triangle(c / 3)) visit(c / 3);
  }
  /// Ascending.
  void neighbours(std::uint32_t point, std::vector<std::uint32_t>& out) const;

  /// Whether the mesh stays a closed manifold, of at least four triangles, if the edge between two neighbours is
  /// collapsed: the link condition.
  [[nodiscard]] bool stays_manifold(std::uint32_t a, std::uint32_t b);
  /// Of two points that no edge joins, but two triangles back to back: takes these two out, if the points can then be
  /// one.
  bool unfold(std::uint32_t a, std::uint32_t b);
  /// Triangles of `from` become those of `onto`; those of the edge go.
  void collapse(std::uint32_t from, std::uint32_t onto);
  /// Takes what is gone out of the mesh, and ends the use of this.
  void compact();

 private:
  void unlink_gone(std::uint32_t point);

  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<Vec3>& points_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;  // the first corner of one that is gone is `none`
  std::vector<std::uint32_t> head_, tail_, next_;
  std::vector<std::uint32_t> near_a_, near_b_, common_;
};

}  // namespace meso::implicit
