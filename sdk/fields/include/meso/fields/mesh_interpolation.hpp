// SPDX-License-Identifier: Apache-2.0
#pragma once
// Linear interpolation between the corners of tetrahedra or hexahedra.
//
//   const auto mesh = MeshInterpolation::make(points, 4, {0, 1, 2, 3}, run);   // nothing: `run` asked to stop
//   mesh->at({0.1, 0.1, 0.1});   // four records and their barycentric weights; nothing outside of all elements
//
// In a tetrahedron barycentric, in a hexahedron trilinear (corners in VTK's order). On a side that elements share the
// values agree, exactly at the corners within 1e-12. A box tree over the elements: look-ups O(log n). Immutable; safe
// to share.

#include <memory>
#include <optional>
#include <vector>

#include "meso/base/run_options.hpp"
#include "meso/base/vec.hpp"
#include "meso/fields/stencil.hpp"

namespace meso::fields {

class MeshInterpolation {
 public:
  /// REQUIRES: `corners` is 4 or 8 and divides the connectivity, whose entries are numbers of points.
  [[nodiscard]] static std::optional<MeshInterpolation> make(std::shared_ptr<const std::vector<Vec3>> points,
                                                             std::size_t corners,
                                                             std::vector<std::int64_t> connectivity,
                                                             const RunOptions& run);
  MeshInterpolation(MeshInterpolation&&) noexcept;
  MeshInterpolation& operator=(MeshInterpolation&&) noexcept;
  ~MeshInterpolation();

  [[nodiscard]] std::optional<Stencil> at(Vec3 p) const;

 private:
  struct Tree;
  explicit MeshInterpolation(std::unique_ptr<const Tree> tree);

  std::unique_ptr<const Tree> tree_;
};

}  // namespace meso::fields
