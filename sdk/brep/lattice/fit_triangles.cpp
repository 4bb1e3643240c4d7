// SPDX-License-Identifier: Apache-2.0
#include "lattice/fit_triangles.hpp"

#include <ShapeAnalysis_Surface.hxx>
#include <map>

namespace meso::brep {
namespace {

/// The triangles on both sides of a segment, by their numbers.
struct Sides {
  std::array<std::size_t, 2> triangle{};
  std::size_t count = 0;
};
using Segment = std::array<std::uint32_t, 2>;  // rising

std::map<Segment, Sides> segments_of(const Triangulation& mesh) {
  std::map<Segment, Sides> segments;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      Sides& sides = segments[{a, b}];
      if (sides.count < 2) sides.triangle[sides.count] = t;
      ++sides.count;
    }
  return segments;
}

}  // namespace

void fit_triangles(Triangulation& mesh, const Handle(Geom_Surface) & surface, const Mat3& lattice, double deflection) {
  constexpr int most_passes = 12;  // each halves what is too long
  const Handle(ShapeAnalysis_Surface) analysis = new ShapeAnalysis_Surface(surface);
  const auto place = [&](std::uint32_t i) {
    const MeshPoint& p = mesh.points[i];
    const Index3& o = p.offset;
    return p.point + lattice * Vec3{static_cast<double>(o[0]), static_cast<double>(o[1]), static_cast<double>(o[2])};
  };
  const auto foot = [&](Vec3 p) { return to_vec(analysis->Value(analysis->ValueOfUV(to_pnt(p), 1e-7))); };
  for (int pass = 0; pass < most_passes; ++pass) {
    std::vector<bool> divided(mesh.triangles.size());
    bool any = false;
    for (const auto& [segment, sides] : segments_of(mesh)) {
      if (sides.count != 2 || divided[sides.triangle[0]] || divided[sides.triangle[1]]) continue;
      const Vec3 middle = 0.5 * (place(segment[0]) + place(segment[1])), on_surface = foot(middle);
      if (norm(on_surface - middle) <= deflection) continue;
      any = true;
      const auto fresh = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back({.point = on_surface});
      for (const std::size_t t : sides.triangle) {
        divided[t] = true;
        std::array<std::uint32_t, 3> half = mesh.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t next = (k + 1) % 3;
          const auto [a, b] = std::minmax(half[k], half[next]);
          if (Segment{a, b} != segment) continue;
          mesh.triangles[t][next] = fresh;
          half[k] = fresh;
          break;
        }
        mesh.triangles.push_back(half);
      }
    }
    if (!any) return;
  }
}

}  // namespace meso::brep
