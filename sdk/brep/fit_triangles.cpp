// SPDX-License-Identifier: Apache-2.0
#include "fit_triangles.hpp"

#include <ShapeAnalysis_Surface.hxx>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "surface_foot.hpp"

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

Vec3 place_of(const MeshPoint& p, const Mat3& lattice) {
  const Index3& o = p.offset;
  return p.point + lattice * Vec3{static_cast<double>(o[0]), static_cast<double>(o[1]), static_cast<double>(o[2])};
}

using Parameters = std::optional<gp_Pnt2d>;

/// Feet on one surface. On free forms Newton's method begins at a foot nearby; a search from anywhere takes a hundred
/// times as long.
class Feet {
 public:
  struct Foot {
    Vec3 point;
    gp_Pnt2d at;
  };
  Feet(const Handle(Geom_Surface) & surface, int searches)
      : surface_(new ShapeAnalysis_Surface(surface)),
        is_free_form_(GeomAdaptor_Surface(surface).GetType() > GeomAbs_Torus),
        searches_(searches) {}

  /// Farther off than `near` a foot on a free form may be one on another side: nothing when searches are used up.
  [[nodiscard]] std::optional<Foot> operator()(Vec3 p, double near, const std::array<Parameters, 2>& starts) {
    for (const Parameters& start : starts)
      if (const Parameters at = is_free_form_ && start ? foot_beside(*surface_, *start, p) : std::nullopt)
        if (const Vec3 foot = to_vec(surface_->Value(*at)); norm(foot - p) <= near) return Foot{foot, *at};
    if (is_free_form_ && searches_-- <= 0) return {};
    const gp_Pnt2d at = surface_->ValueOfUV(to_pnt(p), 1e-7);
    return Foot{to_vec(surface_->Value(at)), at};
  }

  [[nodiscard]] Vec3 normal_at(const gp_Pnt2d& at) const {
    gp_Pnt p;
    gp_Vec u, v;
    surface_->Surface()->D1(at.X(), at.Y(), p, u, v);
    return to_vec(u.Crossed(v).XYZ());
  }

 private:
  Handle(ShapeAnalysis_Surface) surface_;
  bool is_free_form_;
  int searches_;
};

/// Halves at the surface the segments between two triangles that `wants` names, given the segment and how far its
/// middle is off. Where a half would be turned over, the segment stays, unless it `must` not.
template <typename Wants>
void halve(Triangulation& mesh, Feet feet, const Mat3& lattice, bool must, const Wants& wants) {
  constexpr int most_passes = 12;  // each halves what is too long
  // Triangles that have nothing to do with the surface get no better.
  const std::size_t most_triangles = 8 * mesh.triangles.size() + 1000;
  const auto place = [&](std::uint32_t i) { return place_of(mesh.points[i], lattice); };
  // Whether the halves of both triangles face the way that these do, seen along the surface's normal.
  const auto is_upright = [&](const Segment& segment, const Sides& sides, const Feet::Foot& foot) {
    const Vec3 normal = feet.normal_at(foot.at);
    const auto height = [&](const std::array<Vec3, 3>& p) { return dot(normal, cross(p[1] - p[0], p[2] - p[0])); };
    for (const std::size_t t : sides.triangle) {
      std::array<Vec3, 3> whole;
      for (std::size_t k = 0; k < 3; ++k) whole[k] = place(mesh.triangles[t][k]);
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.triangles[t][k] != segment[0] && mesh.triangles[t][k] != segment[1]) continue;
        std::array<Vec3, 3> half = whole;
        half[k] = foot.point;
        if (height(whole) * height(half) <= 0) return false;
      }
    }
    return true;
  };
  std::vector<bool> is_new(mesh.triangles.size(), true);  // since the last pass
  std::vector<Parameters> beside(mesh.points.size());     // of a foot near each point
  for (int pass = 0; pass < most_passes && mesh.triangles.size() < most_triangles; ++pass) {
    std::vector<bool> divided(mesh.triangles.size());
    bool any = false;
    for (const auto& [segment, sides] : segments_of(mesh)) {
      if (sides.count != 2 || !(is_new[sides.triangle[0]] || is_new[sides.triangle[1]])) continue;
      const Vec3 middle = 0.5 * (place(segment[0]) + place(segment[1]));
      const double near = 0.25 * norm(place(segment[1]) - place(segment[0]));
      const auto foot = feet(middle, near, {beside[segment[0]], beside[segment[1]]});
      if (!foot) continue;
      for (const std::uint32_t end : segment)
        if (!beside[end]) beside[end] = foot->at;
      if (!wants(segment, norm(foot->point - middle))) continue;
      any = true;
      if (divided[sides.triangle[0]] || divided[sides.triangle[1]]) continue;  // in the next pass
      // A little towards the corners beside it: on a round border the middle's foot can be one of them. Not far: a
      // short segment across a strip that bends has corners which are far away and do not see each other.
      Vec3 corners = -2.0 * (place(segment[0]) + place(segment[1]));
      for (const std::size_t t : sides.triangle)
        for (const std::uint32_t corner : mesh.triangles[t]) corners += place(corner);
      Vec3 beside_middle = 0.75 * middle + 0.125 * corners;
      if (const Vec3 aside = beside_middle - middle; norm(aside) > near)
        beside_middle = middle + near / norm(aside) * aside;
      auto point = feet(beside_middle, near, {foot->at, {}});
      if (!point) continue;
      if (!is_upright(segment, sides, *point)) {
        if (is_upright(segment, sides, *foot))
          point = foot;
        else if (!must)
          continue;
      }
      const auto fresh = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back({.point = point->point});
      beside.emplace_back(point->at);
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
    is_new = divided;
    is_new.resize(mesh.triangles.size(), true);
  }
}

/// Both ends, the second counted from the cell of the first.
using SegmentName = std::array<double, 9>;
SegmentName name_of(MeshPoint a, MeshPoint b) {
  const auto key = [](const MeshPoint& p) { return std::tie(p.point.x, p.point.y, p.point.z, p.offset); };
  if (key(b) < key(a)) std::swap(a, b);
  SegmentName name{a.point.x, a.point.y, a.point.z, b.point.x, b.point.y, b.point.z};
  for (std::size_t i = 0; i < 3; ++i) name[6 + i] = b.offset[i] - a.offset[i];
  return name;
}

}  // namespace

void fit_triangles(Triangulation& mesh, const Handle(Geom_Surface) & surface, const Mat3& lattice, double deflection) {
  constexpr int searches = 32;
  halve(mesh, {surface, searches}, lattice, false, [&](const Segment&, double off) { return off > deflection; });
}

void part_segments(const std::vector<MeshedFace>& faces, const Mat3& lattice, const Box3& box, double tolerance) {
  std::map<SegmentName, int> uses;
  for (const MeshedFace& face : faces)
    for (const auto& [segment, sides] : segments_of(*face.mesh))
      ++uses[name_of(face.mesh->points[segment[0]], face.mesh->points[segment[1]])];
  for (const MeshedFace& face : faces) {
    const std::vector<MeshPoint>& points = face.mesh->points;
    const auto in_one_wall = [&](const Segment& segment) {
      const Vec3 a = place_of(points[segment[0]], lattice), b = place_of(points[segment[1]], lattice);
      for (std::size_t i = 0; i < 3; ++i)
        for (const double wall : {box.min[i], box.max[i]})
          if (std::fabs(a[i] - wall) < tolerance && std::fabs(b[i] - wall) < tolerance) return true;
      return false;
    };
    halve(*face.mesh, {face.surface, std::numeric_limits<int>::max()}, lattice, true,
          [&, given = points.size()](const Segment& segment, double) {
            if (segment[1] >= given) return false;  // a half: nobody else has its middle
            const auto found = uses.find(name_of(points[segment[0]], points[segment[1]]));
            return (found != uses.end() && found->second > 1) || (!face.is_wall && in_one_wall(segment));
          });
  }
}

}  // namespace meso::brep
