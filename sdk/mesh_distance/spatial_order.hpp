// SPDX-License-Identifier: Apache-2.0
#pragma once
// Triangles in the order of a curve that fills space (Morton 1966), so that neighbours in the list are neighbours.

#include <cstdint>
#include <vector>

#include "meso/base/triangle_mesh.hpp"
#include "stop_poll.hpp"

namespace meso::implicit {

/// Place on the curve, 12 bits an axis, and a triangle. Equal triangles have equal places, whatever the order of their
/// corners.
class Placed {
 public:
  static constexpr std::size_t most_triangles = std::size_t{1} << 28;
  Placed() = default;
  Placed(std::uint64_t place, std::uint64_t triangle) : bits_(place << 28 | triangle) {}
  [[nodiscard]] std::uint64_t place() const { return bits_ >> 28; }
  [[nodiscard]] std::uint32_t triangle() const { return static_cast<std::uint32_t>(bits_ & (most_triangles - 1)); }

 private:
  std::uint64_t bits_;
};

/// How many triangles ahead to ask the memory for what they refer to.
constexpr std::size_t prefetch_distance = 16;

/// Sorted by place, equal ones by number. `box` holds all points. Cut short by `stop`,
/// the order is any. REQUIRES: at most most_triangles.
[[nodiscard]] std::vector<Placed> spatial_order(const TriangleMesh& mesh, const Box3& box, StopPoll& stop);

}  // namespace meso::implicit
