// SPDX-License-Identifier: Apache-2.0
#pragma once
// A body of plane facets, exactly: does it come near another, does it contain a point? Private.
//
//   const FacetTree body(*facets_of(solids));
//   if (!body.is_within(1e-5, cell, world_from_cell) && body.contains(world_from_cell * cell.first_point())) ...
//
// OpenCASCADE takes milliseconds to classify one point against a scan of thousands of facets, and seconds for the
// distance of two; here triangles stand in a tree of boxes. Distances are those of doubles, about 1e-15 of the
// coordinates. Cost: a microsecond a triangle to build; some ten for a point; for two bodies by how much of them is
// near. Thread rule: immutable.

#include <optional>
#include <vector>

#include "meso/base/triangle_mesh.hpp"
#include "meso/base/triangle_stream.hpp"
#include "solid_context.hpp"

namespace meso::brep {

/// The triangles of solids whose faces are all plane and bounded by straight lines; nothing for all others. Points are
/// not shared. May throw Standard_Failure.
[[nodiscard]] std::optional<std::vector<Triangle>> facets_of(const Solids& solids);

class FacetTree {
 public:
  /// At least one triangle; they close, outward oriented.
  explicit FacetTree(std::vector<Triangle> triangles);

  [[nodiscard]] const Box3& box() const { return nodes_.front().box; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

  /// Is a point of the other surface, placed by a similarity, at most `gap` from this one?
  [[nodiscard]] bool is_within(double gap, const FacetTree& other, const Affine& this_from_other) const;
  [[nodiscard]] bool is_within(double gap, Vec3 p) const;
  /// For points off the surface; on it, either.
  [[nodiscard]] bool contains(Vec3 p) const;

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0;  ///< of its triangles, or of its two children
    std::uint32_t count = 0;  ///< of triangles; 0: not a leaf
  };
  void build(std::size_t node, std::size_t first, std::size_t last);
  template <class Near, class Visit>
  bool any_triangle(const Near& is_near, const Visit& visit) const;
  [[nodiscard]] std::optional<int> crossings(Vec3 p, Vec3 direction) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  ///< the first is the root
};

}  // namespace meso::brep
