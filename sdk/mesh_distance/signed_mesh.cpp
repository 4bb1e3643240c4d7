// SPDX-License-Identifier: Apache-2.0
#include "signed_mesh.hpp"

#include <algorithm>
#include <limits>

#include "clean_mesh.hpp"

namespace meso::implicit {

SignedMesh::SignedMesh(TriangleTree tree, const MeshQuality& quality) : tree_(std::move(tree)), quality_(quality) {
  if (!quality_.closed) winding_ = WindingNumber(tree_);
}

SignedMesh::Value SignedMesh::distance(Vec3 p, std::uint32_t hint, double within) const {
  const TriangleTree::Nearest nearest = tree_.nearest(p, hint, within);
  return {std::sqrt(nearest.squared_distance), nearest.triangle};
}

bool SignedMesh::is_in_box(Vec3 p) const {
  const Box3& b = tree_.box();
  return b.min.x <= p.x && p.x <= b.max.x && b.min.y <= p.y && p.y <= b.max.y && b.min.z <= p.z && p.z <= b.max.z;
}

bool SignedMesh::is_inside_open(Vec3 p) const { return is_in_box(p) && std::abs(winding_.at(tree_, p)) > 0.5; }

int SignedMesh::sign(Vec3 p) const {
  if (!is_in_box(p)) return 1;
  const Winding winding = tree_.winding(p);
  if (winding.on_surface) return quality_.closed && is_buried(p) ? -1 : 0;
  const bool inside = quality_.closed ? winding.number != 0 : is_inside_open(p);
  return inside ? -1 : 1;
}

bool SignedMesh::is_buried(Vec3 p) const {
  const Vec3 size = tree_.box().max - tree_.box().min;
  const double step = 1e-9 * norm(size) + 1e-14 * norm(p);
  const auto is_outside = [&](Vec3 direction) {
    const double length = norm(direction);
    if (!(length > 1e-6)) return false;
    const Winding beside = tree_.winding(p + (step / length) * direction);
    return !beside.on_surface && beside.number == 0;
  };
  // Off every face, and into the wedges between any two of them.
  const std::vector<Vec3> normals = tree_.normals_at(p);
  for (const Vec3 n : normals)
    if (is_outside(n) || is_outside(-n)) return false;
  for (std::size_t i = 0; i < normals.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (const Vec3 n : {normals[i] + normals[j], normals[i] - normals[j]})
        if (is_outside(n) || is_outside(-n)) return false;
  return !normals.empty();
}

double SignedMesh::with_sign(double distance, int sign) {
  // Rounding may bring a point that is beside the surface onto it, or the other way round; the sign is right.
  return sign == 0 ? 0 : sign * std::max(distance, std::numeric_limits<double>::min());
}

double SignedMesh::value(Vec3 p) const {
  p = without_specks(p);
  return with_sign(distance(p, TriangleTree::no_triangle).distance, sign(p));
}

}  // namespace meso::implicit
