// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "plane_mesh.hpp"

namespace meso::brep {
namespace {

Vec3 unit(Vec3 v) { return v / norm(v); }

/// Loops of unit vectors as polygons of numbered points; a point of contact has one number.
struct Polygons {
  std::vector<Vec3> points;  ///< of the sphere
  std::vector<Vec3> units;   ///< seen from its centre
  std::vector<std::vector<std::uint32_t>> loops;
  std::size_t sides = 0;
};

Polygons polygons_of(Vec3 centre, const std::vector<std::vector<Vec3>>& loops) {
  Polygons out;
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  for (const auto& loop : loops) {
    auto& polygon = out.loops.emplace_back();
    for (const Vec3& p : loop) {
      const auto [at, fresh] =
          known.try_emplace(std::tuple(p.x, p.y, p.z), static_cast<std::uint32_t>(out.points.size()));
      if (fresh) {
        out.points.push_back(p);
        out.units.push_back(unit(p - centre));
      }
      polygon.push_back(at->second);
    }
    out.sides += loop.size();
  }
  return out;
}

/// Points on the sphere, evenly spread (Fibonacci's spiral), that keep `spacing` (radians) from the loops' points.
std::vector<Vec3> spread_points(const Polygons& polygons, double spacing) {
  const auto count = static_cast<int>(std::ceil(14.5 / (spacing * spacing)));  // equilateral triangles
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const double h = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - h * h), turn = 2.399963229728653 * i;
    const Vec3 n{r * std::cos(turn), r * std::sin(turn), h};
    const double nearest = 0.7 * spacing;
    if (std::ranges::all_of(polygons.units, [&](Vec3 p) { return dot(p - n, p - n) > nearest * nearest; }))
      out.push_back(n);
  }
  return out;
}

/// True where a ray leaves through an odd number of sides.
bool is_within(const PlanePoint& at, std::span<const PlanePoint> points,
               const std::vector<std::vector<std::uint32_t>>& loops) {
  bool inside = false;
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const PlanePoint &p = points[loop[i]], &q = points[loop[(i + 1) % loop.size()]];
      if ((p[1] > at[1]) != (q[1] > at[1]) && at[0] < p[0] + (at[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]))
        inside = !inside;
    }
  return inside;
}

/// Stereographic, seen from outside: circles stay circles, so triangles that are Delaunay's in the plane are so on the
/// sphere.
std::vector<PlanePoint> seen_from(Vec3 pole, std::span<const Vec3> units) {
  const Vec3 x = unit(cross(pole, std::fabs(pole.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), y = cross(x, pole);
  std::vector<PlanePoint> out;
  for (const Vec3& n : units) {
    const double depth = std::max(1e-9, 1 - dot(n, pole));
    out.push_back({dot(n, x) / depth, dot(n, y) / depth});
  }
  return out;
}

double area_within(std::span<const PlanePoint> points, const std::vector<std::vector<std::uint32_t>>& loops) {
  double twice = 0;
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const PlanePoint &p = points[loop[i]], &q = points[loop[(i + 1) % loop.size()]];
      twice += p[0] * q[1] - p[1] * q[0];
    }
  return twice / 2;
}

/// Places to look from that may lie off the face: on the other side of a loop, in the middle of a hole.
std::vector<Vec3> places_to_try(const Polygons& polygons, std::span<const Vec3> holes) {
  std::vector<Vec3> out;
  for (const auto& loop : polygons.loops) {
    Vec3 area;
    for (std::size_t i = 0; i < loop.size(); ++i)
      area += cross(polygons.units[loop[i]], polygons.units[loop[(i + 1) % loop.size()]]);
    if (norm(area) > 1e-9) out.push_back(-unit(area));
  }
  out.insert(out.end(), holes.begin(), holes.end());
  std::erase_if(out, [&](Vec3 pole) {
    return std::ranges::any_of(polygons.units, [&](Vec3 n) { return dot(n, pole) > 1 - 1e-3; });
  });
  return out;
}

std::optional<Triangulation> mesh_between(const SphereSurface& sphere, const Polygons& polygons,
                                          std::span<const Vec3> spread, std::span<const Vec3> holes) {
  for (const Vec3& pole : places_to_try(polygons, holes)) {
    std::vector<PlanePoint> plane = seen_from(pole, polygons.units);
    if (area_within(plane, polygons.loops) <= 0) continue;
    Triangulation mesh;
    for (const Vec3& p : polygons.points) mesh.points.push_back({.point = p});
    const std::vector<PlanePoint> spread_plane = seen_from(pole, spread);
    for (std::size_t i = 0; i < spread.size(); ++i) {
      if (!is_within(spread_plane[i], plane, polygons.loops)) continue;
      mesh.points.push_back({.point = sphere.frame.origin + sphere.radius * spread[i]});
    }
    const std::size_t inner = mesh.points.size() - polygons.points.size();
    for (std::size_t i = polygons.points.size(); i < mesh.points.size(); ++i) {
      const Vec3 n = unit(mesh.points[i].point - sphere.frame.origin);
      plane.push_back(seen_from(pole, std::span(&n, 1)).front());
    }
    auto triangles = triangulate_between(plane, polygons.loops);
    if (!triangles || triangles->size() != polygons.sides + 2 * polygons.loops.size() - 4 + 2 * inner) continue;
    mesh.triangles = std::move(*triangles);
    return mesh;
  }
  return {};
}

/// The point of a triangle that is nearest to the origin: within or on a side.
Vec3 deepest_point(const std::array<Vec3, 3>& p) {
  const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
  bool is_within = norm(normal) > 0;
  Vec3 deepest = p[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 a = p[k], side = p[(k + 1) % 3] - a;
    is_within = is_within && dot(normal, cross(a, p[(k + 1) % 3])) > 0;
    const Vec3 q = a + std::clamp(-dot(a, side) / dot(side, side), 0.0, 1.0) * side;
    if (norm(q) < norm(deepest)) deepest = q;
  }
  return is_within ? dot(normal, p[0]) / dot(normal, normal) * normal : deepest;
}

/// Points of the sphere over the deepest places of triangles that are too deep below it, no two near each other.
std::vector<Vec3> points_above_deep(const Triangulation& mesh, const SphereSurface& sphere, double deflection,
                                    double apart) {
  std::vector<Vec3> out;
  for (const auto& corners : mesh.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.points[corners[k]].point - sphere.frame.origin;
    const Vec3 deepest = deepest_point(p);
    if (norm(deepest) == 0 || sphere.radius - norm(deepest) <= deflection * (1 + 1e-6)) continue;
    const Vec3 n = unit(deepest);
    if (std::ranges::all_of(out, [&](Vec3 other) { return norm(other - n) > apart; })) out.push_back(n);
  }
  return out;
}

}  // namespace

Triangulation strut_mesh(std::span<const RingPoint> lower, std::span<const RingPoint> upper) {
  Triangulation mesh;
  const auto low_count = static_cast<std::uint32_t>(lower.size()) - 1;
  const auto high_count = static_cast<std::uint32_t>(upper.size()) - 1;
  for (std::uint32_t i = 0; i < low_count; ++i) mesh.points.push_back({.point = lower[i].point});
  for (std::uint32_t k = 0; k < high_count; ++k) mesh.points.push_back({.point = upper[k].point});
  const auto low = [&](std::uint32_t i) { return i % low_count; };
  const auto high = [&](std::uint32_t k) { return low_count + k % high_count; };
  for (std::uint32_t i = 0, k = 0; i < low_count || k < high_count;) {
    const bool is_low =
        k == high_count || (i < low_count && lower[i].turn + lower[i + 1].turn <= upper[k].turn + upper[k + 1].turn);
    if (is_low) {
      mesh.triangles.push_back({low(i), low(i + 1), high(k)});
      ++i;
    } else {
      mesh.triangles.push_back({low(i), high(k + 1), high(k)});
      ++k;
    }
  }
  return mesh;
}

std::optional<Triangulation> sphere_mesh(const SphereSurface& sphere, const std::vector<std::vector<Vec3>>& loops,
                                         double deflection, double angle, std::span<const Vec3> holes) {
  constexpr int most_attempts = 12;
  const Polygons polygons = polygons_of(sphere.frame.origin, loops);
  const double spacing =  // of equilateral triangles
      std::max(0.01, std::min({0.8, angle, std::sqrt(6 * deflection / sphere.radius)}));
  std::vector<Vec3> spread = spread_points(polygons, spacing);
  std::optional<Triangulation> mesh;
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    mesh = mesh_between(sphere, polygons, spread, holes);
    if (!mesh) break;
    const std::vector<Vec3> more = points_above_deep(*mesh, sphere, deflection, spacing / 2);
    if (more.empty()) break;
    spread.insert(spread.end(), more.begin(), more.end());
  }
  return mesh;
}

}  // namespace meso::brep
