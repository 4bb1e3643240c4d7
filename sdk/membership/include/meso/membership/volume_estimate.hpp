// SPDX-License-Identifier: Apache-2.0
#pragma once
// Volumes by counting points: one random point in each cell of a grid over a box.
//
//   const JitteredPoints points(box, 2'000'000, seed);
//   const auto answers = answers_at(membership, points, run);
//   const VolumeEstimate v = estimate_volume(points, *answers);   // |true - v.low| <= 3 v.deviation, nearly always
//
// A point's place depends on the seed and its number alone, so any number of threads gives the same answers. The
// deviation is estimated from the differences between neighbouring points (collapsed strata; Cochran, Sampling
// Techniques, 1977, 5A.12), which errs on the large side. Units: millimetres.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "meso/membership/membership.hpp"

namespace meso::membership {

class JitteredPoints {
 public:
  /// About `count` points; the box must have a volume.
  JitteredPoints(const Box3& box, std::size_t count, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return counts_[0] * counts_[1] * counts_[2]; }
  [[nodiscard]] Vec3 operator[](std::size_t i) const;
  /// Of one cell of the grid.
  [[nodiscard]] double volume_each() const { return step_.x * step_.y * step_.z; }

 private:
  Vec3 corner_, step_;
  std::array<std::size_t, 3> counts_{};
  std::uint64_t seed_;
};

/// Empty if the run was stopped; reports nothing.
[[nodiscard]] std::optional<std::vector<Answer>> answers_at(const Membership& part, const JitteredPoints& points,
                                                            const RunOptions& run);

struct VolumeEstimate {
  double low = 0, high = 0;  ///< without and with what is unknown
  double deviation = 0;      ///< one standard deviation of either, at least one cell of the grid
};
[[nodiscard]] VolumeEstimate estimate_volume(const JitteredPoints& points, const std::vector<Answer>& answers);
/// The same without keeping the answers, so for any number of points. Empty if the run was stopped; reports nothing.
[[nodiscard]] std::optional<VolumeEstimate> estimate_volume(const Membership& part, const JitteredPoints& points,
                                                            const RunOptions& run);

}  // namespace meso::membership
