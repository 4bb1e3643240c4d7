// SPDX-License-Identifier: Apache-2.0
#include "polyhedron_field.hpp"

#include <algorithm>
#include <cassert>

#include "far_from_mesh.hpp"
#include "meso/mesh_distance/mesh_field.hpp"

namespace meso::implicit {
namespace {

double turn(Point2 a, Point2 b, Point2 c) {
  return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
}

/// Places in `corners`, which run counter-clockwise: an ear is a corner that bulges and has no other corner in it.
std::vector<std::array<std::size_t, 3>> ears(const std::vector<Point2>& corners) {
  std::vector<std::size_t> left(corners.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto is_ear = [&](std::size_t i) {
    const std::size_t n = left.size(), a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
    const Point2 pa = corners[a], pb = corners[b], pc = corners[c];
    if (!(turn(pa, pb, pc) > 0)) return false;
    return std::ranges::none_of(left, [&](std::size_t v) {
      const Point2 p = corners[v];
      return v != a && v != b && v != c && turn(pa, pb, p) >= 0 && turn(pb, pc, p) >= 0 && turn(pc, pa, p) >= 0;
    });
  };
  while (left.size() >= 3) {
    const std::size_t n = left.size();
    std::size_t ear = 0;
    while (ear < n && !is_ear(ear)) ++ear;
    if (ear == n) ear = 0;  // by rounding; what is left is a sliver
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

bool is_convex(const Polyhedron& polyhedron, const std::vector<FacePlane>& planes) {
  Box3 box;
  for (const Vec3 v : polyhedron.vertices) box.extend(v);
  const double tolerance = polyhedron_flatness * norm(box.max - box.min);
  return std::ranges::all_of(planes, [&](const FacePlane& plane) {
    return std::ranges::all_of(polyhedron.vertices,
                               [&](Vec3 v) { return dot(plane.normal, v) <= plane.offset + tolerance; });
  });
}

/// As a balanced tree, so that thousands of planes are no deep one.
Field intersection_of_all(std::vector<Field> fields) {
  while (fields.size() > 1) {
    std::vector<Field> next;
    for (std::size_t i = 0; i + 1 < fields.size(); i += 2) next.push_back(intersection_of(fields[i], fields[i + 1]));
    if (fields.size() % 2 == 1) next.push_back(fields.back());
    fields = std::move(next);
  }
  return fields.front();
}

/// Beyond it a search among triangles takes less time than all planes.
constexpr std::size_t most_planes = 64;

}  // namespace

TriangleMesh triangles_of(const Polyhedron& polyhedron) {
  TriangleMesh mesh{polyhedron.vertices, {}};
  for (std::size_t f = 0; f < polyhedron.faces.size(); ++f) {
    std::vector<std::uint32_t> face(polyhedron.faces[f].begin(), polyhedron.faces[f].end());
    std::vector<Point2> corners = flattened(polyhedron, f);
    const bool mirrored = polygon_area(corners) < 0;
    if (mirrored) std::ranges::for_each(corners, [](Point2& p) { p.first = -p.first; });
    for (const auto& [a, b, c] : ears(corners)) mesh.triangles.push_back({face[a], face[b], face[c]});
  }
  return mesh;
}

std::optional<Field> polyhedron_field(const Polyhedron& polyhedron, const RunOptions& run, DiagnosticSink& sink) {
  std::vector<FacePlane> planes;
  for (std::size_t f = 0; f < polyhedron.faces.size(); ++f) planes.push_back(plane_of(polyhedron, f));
  if (planes.size() > most_planes || !is_convex(polyhedron, planes)) {
    const auto distance = MeshField::make(triangles_of(polyhedron), "polyhedron", run, sink);
    if (!distance) return std::nullopt;
    return Field::external(std::make_shared<const FarFromMesh>(distance));
  }
  Box3 box;
  for (const Vec3 v : polyhedron.vertices) box.extend(v);
  const Vec3 half = 0.5 * (box.max - box.min);
  std::vector<Field> fields;
  for (const FacePlane& plane : planes) fields.push_back(Field::half_space(plane.normal, plane.offset));
  // The box holds the body and changes nothing but bounds().
  return intersection_of(intersection_of_all(std::move(fields)), Field::box(half).translated(box.min + half));
}

}  // namespace meso::implicit
