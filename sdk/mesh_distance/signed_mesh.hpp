// SPDX-License-Identifier: Apache-2.0
#pragma once
// Distance and sign together: what a MeshField and its grids share.

#include "meso/mesh_distance/mesh_quality.hpp"
#include "triangle_tree.hpp"
#include "winding_number.hpp"

namespace meso::implicit {

class SignedMesh {
 public:
  struct Value {
    double distance;
    std::uint32_t triangle;  ///< the nearest one: a good hint for the next point
  };

  SignedMesh(TriangleTree tree, const MeshQuality& quality);

  [[nodiscard]] double value(Vec3 p) const;
  /// Unsigned. What is farther than `within` may be reported as farther than it is.
  [[nodiscard]] Value distance(Vec3 p, std::uint32_t hint, double within = HUGE_VAL) const;
  /// -1 inside, 0 on the surface, 1 outside.
  [[nodiscard]] int sign(Vec3 p) const;
  /// Of a point on the surface of a closed mesh: whether there is inside all around it, where parts overlap.
  [[nodiscard]] bool is_buried(Vec3 p) const;
  /// What `sign` says of a point that is not on the surface of an open mesh.
  [[nodiscard]] bool is_inside_open(Vec3 p) const;
  [[nodiscard]] static double with_sign(double distance, int sign);

  [[nodiscard]] const TriangleTree& tree() const { return tree_; }
  [[nodiscard]] const MeshQuality& quality() const { return quality_; }
  [[nodiscard]] std::uint64_t bytes() const { return tree_.bytes() + winding_.bytes(); }

 private:
  [[nodiscard]] bool is_in_box(Vec3 p) const;

  TriangleTree tree_;
  MeshQuality quality_;
  WindingNumber winding_;  // of open meshes
};

}  // namespace meso::implicit
