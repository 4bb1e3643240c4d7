// SPDX-License-Identifier: Apache-2.0
#include "meso/brep/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "meso/brep/placement.hpp"
#include "surface_foot.hpp"
#include "value_geometry.hpp"

namespace meso::brep {
namespace {

constexpr int points_of_edge = 9;

/// NaN is worse than any number, and stays.
void raise(double& most, double gap) {
  if (!std::isnan(most) && !(gap <= most)) most = gap;
}

void join(Gaps& to, const Gaps& other, double scale) {
  raise(to.edge_mm, scale * other.edge_mm);
  raise(to.vertex_mm, scale * other.vertex_mm);
  raise(to.triangle_mm, scale * other.triangle_mm);
  to.triangles_mm3 += scale * scale * scale * other.triangles_mm3;
  to.triangles_abs_mm3 += scale * scale * scale * other.triangles_abs_mm3;
}

/// Seen from the cell of a face, as a face's mesh and loops are.
class FaceGaps {
 public:
  FaceGaps(const Template& geometry, const FaceTemplate& face) : geometry_(geometry), face_(face), foot_(face.surface) {
    for (const auto& loop : face.loops)
      for (const Coedge& use : loop)
        if (!geometry.edges[use.edge].degenerate) add_edge(use);
    if (!std::holds_alternative<Plane>(face.surface)) add_triangles();
  }
  [[nodiscard]] const Gaps& value() const { return gaps_; }

 private:
  void add_edge(const Coedge& use) {
    const EdgeTemplate& edge = geometry_.edges[use.edge];
    std::array<Vec3, 2> ends;
    for (std::size_t k = 0; k < 2; ++k)
      ends[k] = geometry_.vertices[edge.vertex[k]] + cell_origin(geometry_, edge.vertex_offset[k]);
    const bool closed = edge.vertex[0] == edge.vertex[1] && edge.vertex_offset[0] == edge.vertex_offset[1];
    const CurveRange range = range_between(edge.curve, ends[0], ends[1], closed);
    const Handle(Geom_Curve) curve = to_geom(edge.curve);
    const Vec3 origin = cell_origin(geometry_, use.offset);
    for (int i = 0; i <= points_of_edge; ++i) {
      const Vec3 p = to_vec(curve->Value(range.first + (range.last - range.first) * i / points_of_edge));
      raise(gaps_.edge_mm, norm(foot_(p + origin) - p - origin));
      if (i == 0) raise(gaps_.vertex_mm, norm(p - ends[0]));
      if (i == points_of_edge) raise(gaps_.vertex_mm, norm(p - ends[1]));
    }
  }

  void add_triangles() {
    std::vector<Vec3> points;
    for (const MeshPoint& p : face_.mesh.points) points.push_back(p.point + cell_origin(geometry_, p.offset));
    for (const auto& t : face_.mesh.triangles) add_triangle(points[t[0]], points[t[1]], points[t[2]]);
  }

  /// The distance, integrated by the rule that is exact for cubics (Strang and Fix, 1973): corners have none.
  void add_triangle(Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 twice = cross(b - a, c - a);
    const double area = norm(twice) / 2;
    if (area == 0) return;
    const Vec3 normal = twice / (2 * area);
    // A search from anywhere takes half a millisecond; from a corner, which is on the surface, a hundredth of that.
    (void)foot_(a);
    const double near = std::max({norm(b - a), norm(c - b), norm(a - c)}) / 4;
    const auto outwards = [&](Vec3 p) {
      const double gap = dot(foot_(p, near) - p, normal);
      raise(gaps_.triangle_mm, std::fabs(gap));
      return gap;
    };
    const double middles = outwards((a + b) / 2) + outwards((b + c) / 2) + outwards((c + a) / 2);
    const double volume = area * (27 * outwards((a + b + c) / 3) + 8 * middles) / 60;
    gaps_.triangles_mm3 += volume;
    gaps_.triangles_abs_mm3 += std::fabs(volume);
  }

  const Template& geometry_;
  const FaceTemplate& face_;
  SurfaceFoot foot_;
  Gaps gaps_;
};

/// Of a face's triangles about the template's origin; those of an instance follow.
struct MeshMoments {
  double volume = 0;
  Vec3 vector_area;
};

MeshMoments mesh_moments(const Template& geometry, const Triangulation& mesh) {
  MeshMoments out;
  std::vector<Vec3> points;
  for (const MeshPoint& p : mesh.points) points.push_back(p.point + cell_origin(geometry, p.offset));
  for (const auto& t : mesh.triangles) {
    const Vec3 a = points[t[0]], b = points[t[1]], c = points[t[2]];
    out.volume += dot(a, cross(b, c)) / 6;
    out.vector_area += cross(b - a, c - a) / 2;
  }
  return out;
}

}  // namespace

Gaps measure_gaps(const Body& body) {
  Gaps total;
  std::map<const Template*, std::vector<std::optional<Gaps>>> known;
  const auto add = [&](const Shell& shell) {
    const Template& geometry = *shell.geometry;
    auto& of_face = known[&geometry];
    of_face.resize(geometry.faces.size());
    const double scale = std::cbrt(determinant(shell.placement.linear));
    shell.visit([&](const FaceInstance& instance) {
      if (instance.face >= geometry.faces.size()) return;  // the audit tells
      auto& gaps = of_face[instance.face];
      if (!gaps) gaps = FaceGaps(geometry, geometry.faces[instance.face]).value();
      join(total, *gaps, scale);
    });
  };
  for (const Solid& solid : body.solids) {
    add(solid.outer);
    std::ranges::for_each(solid.voids, add);
  }
  return total;
}

double volume_of_triangles(const Body& body) {
  double total = 0;
  std::map<const Template*, std::vector<MeshMoments>> known;
  const auto add_shell = [&](const Shell& shell) {
    const Template& geometry = *shell.geometry;
    std::vector<MeshMoments>& of_face = known[&geometry];
    if (of_face.empty())
      for (const FaceTemplate& face : geometry.faces) of_face.push_back(mesh_moments(geometry, face.mesh));
    long double volume = 0;
    shell.visit([&](const FaceInstance& instance) {
      const MeshMoments& m = of_face[instance.face];
      volume += m.volume + dot(cell_origin(geometry, instance.cell), m.vector_area) / 3;
    });
    total += static_cast<double>(volume) * determinant(shell.placement.linear);
  };
  for (const Solid& solid : body.solids) {
    add_shell(solid.outer);
    for (const Shell& hollow : solid.voids) add_shell(hollow);
  }
  return total;
}

}  // namespace meso::brep
