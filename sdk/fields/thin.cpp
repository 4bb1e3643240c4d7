// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <unordered_map>

#include "meso/fields/point_search.hpp"

namespace meso::fields {
namespace {

struct Cube {
  std::int64_t x, y, z;
  friend bool operator==(const Cube&, const Cube&) = default;
};
struct CubeHash {
  std::size_t operator()(const Cube& c) const {
    std::uint64_t h = static_cast<std::uint64_t>(c.x) * 0x9E3779B97F4A7C15U;
    h = (h ^ h >> 29 ^ static_cast<std::uint64_t>(c.y)) * 0xBF58476D1CE4E5B9U;
    h = (h ^ h >> 32 ^ static_cast<std::uint64_t>(c.z)) * 0x94D049BB133111EBU;
    return static_cast<std::size_t>(h ^ h >> 31);
  }
};

}  // namespace

// The cubes are only looked up, never walked: their order reaches no result.
std::optional<std::vector<std::size_t>> thin(std::span<const Vec3> points, double distance, const RunOptions& run) {
  std::vector<std::size_t> kept;
  // A little wider than the distance: neighbours by one are enough also after rounding. Far from the origin cubes are
  // at least as wide as numbers are apart.
  double far = 0;
  for (const Vec3& p : points) far = std::fmax(far, std::fmax(std::abs(p.x), std::fmax(std::abs(p.y), std::abs(p.z))));
  const double width = std::fmax(distance * (1 + 1e-9), far * 0x1p-50);
  if (!(width > 0)) {  // all points at the origin, distance 0
    if (!points.empty()) kept.push_back(0);
    return kept;
  }
  const auto cube_of = [&](Vec3 p) {
    return Cube{static_cast<std::int64_t>(std::floor(p.x / width)), static_cast<std::int64_t>(std::floor(p.y / width)),
                static_cast<std::int64_t>(std::floor(p.z / width))};
  };
  std::unordered_map<Cube, std::vector<std::size_t>, CubeHash> cubes;
  const auto is_free = [&](Vec3 p, const Cube& c) {
    for (std::int64_t x = c.x - 1; x <= c.x + 1; ++x) {
      for (std::int64_t y = c.y - 1; y <= c.y + 1; ++y) {
        for (std::int64_t z = c.z - 1; z <= c.z + 1; ++z) {
          const auto found = cubes.find(Cube{x, y, z});
          if (found == cubes.end()) continue;
          for (const std::size_t i : found->second) {
            const Vec3 d = p - points[i];
            if (dot(d, d) <= distance * distance) return false;
          }
        }
      }
    }
    return true;
  };
  constexpr std::size_t poll_mask = 0x3FFF;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((i & poll_mask) == 0 && run.should_stop()) return std::nullopt;
    const Cube cube = cube_of(points[i]);
    if (!is_free(points[i], cube)) continue;
    cubes[cube].push_back(i);
    kept.push_back(i);
  }
  return kept;
}

}  // namespace meso::fields
