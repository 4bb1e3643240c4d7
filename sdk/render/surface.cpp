// SPDX-License-Identifier: Apache-2.0
#include "surface.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "camera.hpp"

namespace meso::picture {
namespace {

// Facets of a cylinder meshed at the usual 0.5 rad differ by 28.6 degrees and are one surface; a design's own edges are
// rarely flatter than this.
constexpr double cos_crease = 0.766;  // cos 40 degrees

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hash(Vec3 p) {
  std::uint64_t h = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    h = (h ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9E3779B97F4A7C15;  // + 0.0: minus zero is zero
    h ^= h >> 29;
  }
  return h;
}

Box3 bounds_of(const TriangleMesh& mesh) {
  Box3 bounds;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t) bounds.extend(mesh.points[i]);
  return bounds;
}

}  // namespace

Surface::Surface(const TriangleMesh& mesh) {
  weld(mesh);
  measure_facets();
  link_corners();
}

void Surface::weld(const TriangleMesh& mesh) {
  const Box3 bounds = bounds_of(mesh);
  if (bounds.empty()) return;
  center_ = 0.5 * (bounds.min + bounds.max);
  const double size = 0.5 * norm(bounds.max - bounds.min);
  scale_ = size > 0 ? 1 / size : 1;

  // Open addressing, at most half full; the first of equal points stands for all, so the order is the input's.
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * mesh.points.size() + 1), none);
  std::vector<std::uint32_t> welded(mesh.points.size(), none);
  const auto weld_point = [&](std::uint32_t i) {
    if (welded[i] != none) return welded[i];
    const Vec3 p = to_unit_ball(mesh.points[i]);
    std::size_t slot = hash(p) & (slots.size() - 1);
    while (slots[slot] != none && points_[slots[slot]] != p) slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] == none) {
      slots[slot] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(p);
    }
    return welded[i] = slots[slot];
  };
  triangles_.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles_.push_back({weld_point(t[0]), weld_point(t[1]), weld_point(t[2])});
}

void Surface::measure_facets() {
  scaled_normals_.reserve(triangles_.size());
  std::erase_if(triangles_, [this](const auto& t) {
    const Vec3 n = cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
    const Normal rounded{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
    if (rounded.x == 0 && rounded.y == 0 && rounded.z == 0) return true;
    scaled_normals_.push_back(rounded);
    return false;
  });
}

void Surface::link_corners() {
  first_around_.assign(points_.size() + 1, 0);
  for (const auto& t : triangles_)
    for (const std::uint32_t p : t) ++first_around_[p + 1];
  for (std::size_t i = 1; i < first_around_.size(); ++i) first_around_[i] += first_around_[i - 1];
  around_.resize(first_around_.back());
  std::vector<std::uint32_t> next(first_around_.begin(), first_around_.end() - 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t p : triangles_[t]) around_[next[p]++] = t;
}

Vec3 Surface::smooth_normal(std::uint32_t triangle, std::uint32_t point) const {
  const auto facet = [this](std::uint32_t t) {
    const Normal n = scaled_normals_[t];
    return Vec3{n.x, n.y, n.z};
  };
  const Vec3 own = normalized(facet(triangle));
  Vec3 sum;
  for (std::uint32_t i = first_around_[point]; i < first_around_[point + 1]; ++i) {
    const Vec3 other = facet(around_[i]);
    if (dot(own, other) >= cos_crease * norm(other)) sum += other;
  }
  return normalized(sum);
}

Surface::Spot Surface::at(std::uint32_t triangle, double u, double v) const {
  const std::array<std::uint32_t, 3>& t = triangles_[triangle];
  const std::array<double, 3> weight{1 - u - v, u, v};
  Spot spot;
  for (std::size_t i = 0; i < 3; ++i) spot.position += weight[i] * points_[t[i]];
  const Normal n = scaled_normals_[triangle];
  spot.facet_normal = normalized({n.x, n.y, n.z});

  // Lifting after Hanika, "Hacking the shadow terminator", Ray Tracing Gems II, chapter 4: onto the corners' tangent
  // planes.
  spot.lifted = spot.position;
  Vec3 normal;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 corner_normal = smooth_normal(triangle, t[i]);
    normal += weight[i] * corner_normal;
    const double below = std::min(0.0, dot(spot.position - points_[t[i]], corner_normal));
    spot.lifted += (-below * weight[i]) * corner_normal;
  }
  spot.normal = normalized(normal);
  return spot;
}

}  // namespace meso::picture
