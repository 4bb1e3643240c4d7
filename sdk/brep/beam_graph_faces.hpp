// SPDX-License-Identifier: Apache-2.0
#pragma once
// Faces of balls and struts on their way to a body: what bodies of beams have in common, however their struts end.
// Private.
//
//   BeamFaces faces(graph);
//   faces.begin(n);  faces.add(face);              // faces of one solid for each connected part of the graph
//   if (faces.mesh(options, inner_points, strut_mesh)) body = faces.body();

#include <functional>
#include <memory>
#include <vector>

#include "beam_graph.hpp"
#include "lattice/union_find.hpp"
#include "meso/brep/lattice_body.hpp"

namespace meso::brep {

class BeamFaces {
 public:
  /// The points that divide an edge, without its ends; triangles of a strut.
  using InnerPoints = std::function<std::vector<Vec3>(std::uint32_t edge, const MeshFineness&)>;
  using StrutMesh = std::function<Triangulation(std::uint32_t strut, const MeshFineness&)>;

  explicit BeamFaces(const BeamGraph& graph);

  [[nodiscard]] Template& geometry() const { return *geometry_; }
  /// The faces that come now are of the solid with this node.
  void begin(std::uint32_t node) { faces_of_ = &solids_[sets_.root(node)]; }
  void add(FaceTemplate face, std::uint32_t strut = 0);
  /// A sphere with one circle, about `axis`: readers know it by a seam from the circle to the pole across.
  void add_seam(std::uint32_t node, Vec3 axis, FaceTemplate& face);
  /// Of all solids; empty lists where a node is not the first of its solid.
  [[nodiscard]] const std::vector<std::vector<std::uint32_t>>& solids() const { return solids_; }

  /// The points of a use of an edge, its end left out.
  void append_points(const Coedge& use, const InnerPoints& inner_points, const MeshFineness& fineness,
                     std::vector<Vec3>& out) const;
  /// As fine as asked for, or finer where borders are divided too coarsely. False: not even then, or the run was to
  /// stop.
  [[nodiscard]] bool mesh(const LatticeOptions& options, const InnerPoints& inner_points, const StrutMesh& strut_mesh);
  [[nodiscard]] Body body();

 private:
  [[nodiscard]] bool mesh_all(const MeshFineness& fineness, const RunOptions& run, const InnerPoints& inner_points,
                              const StrutMesh& strut_mesh);
  [[nodiscard]] std::optional<Triangulation> mesh_of(const SphereSurface& sphere, const FaceTemplate& face,
                                                     const InnerPoints& inner_points,
                                                     const MeshFineness& fineness) const;

  const BeamGraph& graph_;
  UnionFind sets_;
  std::shared_ptr<Template> geometry_ = std::make_shared<Template>();
  std::vector<std::uint32_t> strut_of_face_;
  std::vector<std::vector<std::uint32_t>> solids_;  ///< their faces, by the first node
  std::vector<std::uint32_t>* faces_of_ = nullptr;
};

}  // namespace meso::brep
