// SPDX-License-Identifier: Apache-2.0
#pragma once
// Nearest records of a cloud of points.
//
//   const auto search = PointSearch::make(points, run);   // nothing: `run` asked to stop
//   search->nearest({1, 2, 3});                // the lower number where two are equally near
//   search->inverse_distance({1, 2, 3}, 2);    // Shepard's weights over the eight nearest
//
// A kd-tree that holds the points themselves: 34 bytes each. Building is O(n log n), a look-up O(log n), above a
// million a second among 10^5 points in random order (bench/fields_bench.cpp). Immutable and safe to share. REQUIRES: 1
// to 2^32 points with finite coordinates.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "meso/base/run_options.hpp"
#include "meso/base/vec.hpp"
#include "meso/fields/stencil.hpp"

namespace meso::fields {

class PointSearch {
 public:
  [[nodiscard]] static std::optional<PointSearch> make(std::vector<Vec3> points, const RunOptions& run);
  PointSearch(PointSearch&&) noexcept;
  PointSearch& operator=(PointSearch&&) noexcept;
  ~PointSearch();

  [[nodiscard]] std::int64_t nearest(Vec3 p) const;
  [[nodiscard]] Stencil inverse_distance(Vec3 p, double power) const;
  [[nodiscard]] const Box3& box() const;

 private:
  struct Tree;
  explicit PointSearch(std::unique_ptr<const Tree> tree);

  std::unique_ptr<const Tree> tree_;
};

/// Numbers of the points that are kept, in order: each farther than `distance` from all that were kept before it.
/// O(n) by a grid of that width. Nothing: `run` asked to stop.
[[nodiscard]] std::optional<std::vector<std::size_t>> thin(std::span<const Vec3> points, double distance,
                                                           const RunOptions& run);

}  // namespace meso::fields
