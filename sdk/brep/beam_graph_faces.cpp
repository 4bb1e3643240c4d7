// SPDX-License-Identifier: Apache-2.0
#include "beam_graph_faces.hpp"

#include <algorithm>

#include "beam_graph_mesh.hpp"
#include "ellipsoid.hpp"
#include "lattice/parallel.hpp"

namespace meso::brep {
namespace {

Vec3 unit(Vec3 v) { return v / norm(v); }

}  // namespace

BeamFaces::BeamFaces(const BeamGraph& graph)
    : graph_(graph), sets_(static_cast<std::uint32_t>(graph.nodes.size())), solids_(graph.nodes.size()) {
  for (const BeamGraph::Strut& s : graph.struts) sets_.join(s.node[0], s.node[1]);
}

void BeamFaces::add(FaceTemplate face, std::uint32_t strut) {
  faces_of_->push_back(static_cast<std::uint32_t>(geometry_->faces.size()));
  geometry_->faces.push_back(std::move(face));
  strut_of_face_.push_back(strut);
}

void BeamFaces::add_seam(std::uint32_t node, Vec3 axis, FaceTemplate& face) {
  const auto& [centre, r] = graph_.nodes[node];
  const std::uint32_t start = geometry_->edges[face.loops[0][0].edge].vertex[0];
  const Vec3 x = unit(geometry_->vertices[start] - centre), side = unit(x - dot(x, axis) * axis);
  const auto pole = static_cast<std::uint32_t>(geometry_->vertices.size());
  const auto seam = static_cast<std::uint32_t>(geometry_->edges.size());
  geometry_->vertices.push_back(centre - r * axis);
  geometry_->edges.push_back({.curve = Circle{{centre, unit(cross(side, -axis)), x}, r}, .vertex = {start, pole}});
  geometry_->edges.push_back({.curve = Line{}, .vertex = {pole, pole}, .degenerate = true});
  std::get<SphereSurface>(face.surface).frame = {centre, axis, side};
  face.loops[0].push_back({.edge = seam});
  face.loops[0].push_back({.edge = seam + 1});
  face.loops[0].push_back({.edge = seam, .reversed = true});
}

void BeamFaces::append_points(const Coedge& use, const InnerPoints& inner_points, const MeshFineness& fineness,
                              std::vector<Vec3>& out) const {
  std::vector<Vec3> inner = inner_points(use.edge, fineness);
  if (use.reversed) std::ranges::reverse(inner);
  out.push_back(geometry_->vertices[geometry_->edges[use.edge].vertex[use.reversed ? 1 : 0]]);
  out.insert(out.end(), inner.begin(), inner.end());
}

std::optional<Triangulation> BeamFaces::mesh_of(const SphereSurface& sphere, const FaceTemplate& face,
                                                const InnerPoints& inner_points, const MeshFineness& fineness) const {
  if (geometry_->edges[face.loops[0][0].edge].degenerate) {  // a ball alone
    const double r = sphere.radius;
    const Ellipsoid ball{{Mat3::from_columns({r, 0, 0}, {0, r, 0}, {0, 0, r}), sphere.frame.origin}};
    return brep::mesh_of(ball, fineness.deflection, fineness.angle);
  }
  std::vector<std::vector<Vec3>> loops;
  std::vector<Vec3> holes;
  for (const auto& uses : face.loops) {
    loops.emplace_back();
    for (const Coedge& use : uses) {
      if (uses.size() == 4 && geometry_->edges[uses[2].edge].degenerate && &use != &uses[0]) break;  // the seam
      append_points(use, inner_points, fineness, loops.back());
      const Vec3 off = std::get<Circle>(geometry_->edges[use.edge].curve).frame.origin - sphere.frame.origin;
      if (norm(off) > 1e-6 * sphere.radius) holes.push_back(unit(off));
    }
  }
  return sphere_mesh(sphere, loops, fineness.deflection, fineness.angle, holes);
}

bool BeamFaces::mesh_all(const MeshFineness& fineness, const RunOptions& run, const InnerPoints& inner_points,
                         const StrutMesh& strut_mesh) {
  return in_parallel(geometry_->faces.size(), run, [&](std::size_t, std::size_t f) {
    FaceTemplate& face = geometry_->faces[f];
    face.mesh = {};
    if (const auto* sphere = std::get_if<SphereSurface>(&face.surface)) {
      if (auto mesh = mesh_of(*sphere, face, inner_points, fineness)) face.mesh = std::move(*mesh);
    } else {
      face.mesh = strut_mesh(strut_of_face_[f], fineness);
    }
    return !face.mesh.triangles.empty();
  });
}

bool BeamFaces::mesh(const LatticeOptions& options, const InnerPoints& inner_points, const StrutMesh& strut_mesh) {
  if (!options.mesh) return true;
  constexpr int most_attempts = 5;
  MeshFineness fineness = *options.mesh;
  for (int attempt = 1; !mesh_all(fineness, options.run, inner_points, strut_mesh); ++attempt) {
    if (attempt == most_attempts || options.run.should_stop()) return false;
    fineness.deflection /= 3;
    fineness.angle /= 1.6;
  }
  return true;
}

Body BeamFaces::body() {
  Body body;
  for (auto& faces : solids_) {
    if (faces.empty()) continue;
    const auto visit = [list = std::make_shared<const std::vector<std::uint32_t>>(std::move(faces))](
                           const std::function<void(const FaceInstance&)>& callback) {
      for (const std::uint32_t face : *list) callback({face, {0, 0, 0}});
    };
    body.solids.push_back({Shell{geometry_, {}, visit}, {}});
  }
  return body;
}

}  // namespace meso::brep
