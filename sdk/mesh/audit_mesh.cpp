// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh/audit_mesh.hpp"

#include <algorithm>
#include <numeric>

namespace meso {
namespace {

struct HalfEdge {
  std::uint64_t ends = 0;  // smaller index first
  bool rising = false;
};

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = t[k], b = t[(k + 1) % 3];
      if (a != b) edges.push_back({std::min(a, b) << 32 | std::max(a, b), a < b});
    }
  std::ranges::sort(edges, {}, &HalfEdge::ends);
  return edges;
}

void count_edges(const TriangleMesh& mesh, MeshAudit& audit) {
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
  for (auto first = edges.begin(); first != edges.end();) {
    const auto last = std::find_if(first, edges.end(), [&](const HalfEdge& e) { return e.ends != first->ends; });
    const auto uses = last - first, rising = std::count_if(first, last, [](const HalfEdge&e) { return e.rising; });
    audit.unmatched_half_edges += uses == 1;
    audit.flipped_edges += uses == 2 && rising != 1;
    audit.multiple_edges += uses > 2;
    first = last;
  }
}

std::uint64_t count_components(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t a) {
    while (parent[a] != a) a = parent[a] = parent[parent[a]];
    return a;
  };
  std::vector<bool> used(mesh.points.size());
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t corner : t) used[corner] = true;
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  std::uint64_t components = 0;
  for (std::uint32_t i = 0; i < parent.size(); ++i) components += used[i] && parent[i] == i;
  return components;
}

}  // namespace

MeshAudit audit_mesh(const TriangleMesh& mesh) {
  MeshAudit audit{.triangles = mesh.triangles.size(), .points = mesh.points.size()};
  for (const Vec3& p : mesh.points) audit.box.extend(p);
  // About the middle of the box, so that a small part far away keeps its digits.
  const Vec3 middle = mesh.points.empty() ? Vec3{} : 0.5 * (audit.box.min + audit.box.max);
  long double volume = 0, area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]] - middle, b = mesh.points[t[1]] - middle, c = mesh.points[t[2]] - middle;
    const Vec3 n = cross(b - a, c - a);
    const double twice = norm(n);
    audit.degenerate += !(twice > 0);
    area += twice / 2;
    volume += dot(a, n) / 6;
  }
  audit.volume = static_cast<double>(volume);
  audit.area = static_cast<double>(area);
  count_edges(mesh, audit);
  audit.components = count_components(mesh);
  return audit;
}

}  // namespace meso
