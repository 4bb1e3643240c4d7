// SPDX-License-Identifier: Apache-2.0
#include "meso/import_surface_mesh/weld.hpp"

#include <bit>

namespace meso {
namespace {

std::size_t hash(Vec3 p) {
  std::uint64_t h = 0;
  for (const double c : {p.x, p.y, p.z}) {
    h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
  }
  return h;
}

std::size_t free_or_equal(const std::vector<std::uint32_t>& slots, const std::vector<Vec3>& points, Vec3 point) {
  const std::size_t mask = slots.size() - 1;
  std::size_t slot = hash(point) & mask;
  while (slots[slot] != 0 && !(points[slots[slot] - 1] == point)) slot = (slot + 1) & mask;
  return slot;
}

}  // namespace

void Weld::reserve(std::size_t triangles) {
  mesh_.triangles.reserve(triangles);
  mesh_.points.reserve(triangles / 2 + 2);  // Euler: a closed mesh has half as many points as triangles
  rehash(std::bit_ceil(triangles + 64));
}

void Weld::add(Vec3 a, Vec3 b, Vec3 c) {
  const std::uint32_t i = index_of(a), j = index_of(b), k = index_of(c);
  mesh_.triangles.push_back({i, j, k});
}

std::uint32_t Weld::index_of(Vec3 point) {
  point += Vec3{0, 0, 0};  // -0 + 0 is 0
  if (2 * (mesh_.points.size() + 1) > slots_.size()) rehash(slots_.empty() ? 64 : 2 * slots_.size());
  std::uint32_t& slot = slots_[free_or_equal(slots_, mesh_.points, point)];
  if (slot == 0) {
    mesh_.points.push_back(point);
    slot = static_cast<std::uint32_t>(mesh_.points.size());
  }
  return slot - 1;
}

void Weld::rehash(std::size_t slots) {
  slots_.assign(slots, 0);
  for (std::size_t i = 0; i < mesh_.points.size(); ++i)
    slots_[free_or_equal(slots_, mesh_.points, mesh_.points[i])] = static_cast<std::uint32_t>(i + 1);
}

}  // namespace meso
