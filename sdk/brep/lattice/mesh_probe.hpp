// SPDX-License-Identifier: Apache-2.0
#pragma once
// Inside or outside of closed solids, by their triangles: for points that are not close to the surface. Private.
//
// A point is inside where the triangles are seen around more than half of all directions. Triangles stand in groups; a
// group is taken as one dipole from afar (Barill 2018). Cost: some 50 ns a triangle of the groups nearby.
// Thread rule: immutable.

#include <span>
#include <vector>

#include "lattice/box_overlap.hpp"

namespace meso::brep {

/// Distance from a triangle (Ericson 2004, 5.1.5).
[[nodiscard]] double distance_to(const Triangle3& triangle, Vec3 p);
[[nodiscard]] double distance_to(std::span<const Triangle3> triangles, Vec3 p);

class MeshProbe {
 public:
  /// Triangles counter-clockwise seen from outside.
  void add_group(std::vector<Triangle3> triangles);

  /// Undefined within the triangles' deflection of the surface.
  [[nodiscard]] bool contains(Vec3 p) const;

 private:
  struct Group {
    std::vector<Triangle3> triangles;
    Vec3 centre, area;
    double radius = 0;
  };
  std::vector<Group> groups_;
};

}  // namespace meso::brep
