// SPDX-License-Identifier: Apache-2.0
#pragma once
// The mesh as light sees it: welded, scaled into the unit ball, with smooth normals where facets nearly agree.

#include <array>
#include <cstdint>
#include <vector>

#include "meso/base/triangle_mesh.hpp"

namespace meso::picture {

class Surface {
 public:
  /// Welds equal points (a triangle soup gains its neighbourhoods) and drops triangles without area.
  explicit Surface(const TriangleMesh& mesh);

  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }

  /// Where a point of the mesh's own space stands here.
  [[nodiscard]] Vec3 to_unit_ball(Vec3 p) const { return scale_ * (p - center_); }

  struct Spot {
    Vec3 position;
    Vec3 facet_normal;
    Vec3 normal;           ///< averaged over the facets around that lie within the crease angle
    bool section = false;  ///< a cut through the material
    Vec3 lifted;  ///< where the smooth surface would be: shadow rays start here, or coarse facets shade themselves
  };
  /// The spot with barycentric coordinates (1 - u - v, u, v) of a triangle.
  [[nodiscard]] Spot at(std::uint32_t triangle, double u, double v) const;

 private:
  struct Normal {
    float x, y, z;
  };
  void weld(const TriangleMesh& mesh);
  void measure_facets();
  void link_corners();
  [[nodiscard]] Vec3 smooth_normal(std::uint32_t triangle, std::uint32_t point) const;

  Vec3 center_;
  double scale_ = 1;
  std::vector<Vec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Normal> scaled_normals_;       ///< length is twice the facet's area
  std::vector<std::uint32_t> first_around_;  ///< point -> begin in around_; one entry more than points
  std::vector<std::uint32_t> around_;        ///< triangles that share a point
};

}  // namespace meso::picture
