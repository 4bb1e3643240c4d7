// SPDX-License-Identifier: Apache-2.0
#pragma once
// The signed distance to a triangle mesh, negative inside, as a field.
//
//   std::shared_ptr<const MeshField> field = MeshField::make(mesh, "part.ply", {}, sink);
//   field->value({0, 0, 0});                      // -1 in a ball of radius 1
//   Term solid = Term::external(field);           // composes with every other field
//
// Units: those of the mesh. The distance is exact up to rounding (1e-15 of the mesh's size, 1e-12 of itself), zero on
// the surface and nowhere else.
//
// Inside is decided without rounding where the mesh is closed (every edge used as often in one direction as in the
// other; it may cross itself, overlap, hold cavities or be inside out): a point is inside if the surface encloses it a
// number of times that is not zero. In any other mesh a point is inside if it lies in the mesh's box and the surface is
// seen around more than half of all directions (the winding number of Jacobson 2013 by the expansion of Barill 2018);
// there the field jumps where a hole is bridged, so that lipschitz() is infinite.
//
// Parts that overlap are one body, and outside of it the distance is the body's. Inside, walls that are buried count as
// surface: the field is negative there, also on them, but no deeper than they are far, so that nothing appears or
// vanishes where the field is compared with zero or a positive offset, while shells and negative offsets follow the
// buried walls. Whether there are any is looked for and told (MESH_OVERLAPS); bodies from several files, joined as
// fields, have none.
//
// Errors: MESH_EMPTY, MESH_COORDINATES, MESH_MEMORY, LIMIT_TIME, CANCELLED. Warnings: MESH_NOT_CLOSED, MESH_TURNED,
// MESH_INSIDE_OUT, MESH_REPEATED, MESH_OVERLAPS. Cost, on a machine busy with other
// work: 0.5 s of CPU for a million triangles; then 3 us a signed distance near the surface, several times that far
// from it (bench/mesh_distance_bench.cpp). Thread rule: immutable, safe to share; make() and prepare() use jobs
// threads.

#include <memory>
#include <string>

#include "meso/base/diagnostic.hpp"
#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/implicit/external_field.hpp"
#include "meso/mesh_distance/mesh_quality.hpp"

namespace meso::implicit {

class SignedMesh;

class MeshField final : public ExternalField {
 public:
  /// `name` stands in diagnostics. Empty after an error. REQUIRES: triangles refer to points that exist.
  [[nodiscard]] static std::shared_ptr<const MeshField> make(const TriangleMesh& mesh, const std::string& name,
                                                             const RunOptions& options, DiagnosticSink& sink);
  ~MeshField() override;

  [[nodiscard]] const MeshQuality& quality() const;
  [[nodiscard]] Vec3 closest_point(Vec3 p) const;

  [[nodiscard]] double value(Vec3 p) const override;
  [[nodiscard]] Interval interval(const Box3& box) const override;
  [[nodiscard]] double lipschitz() const override;
  [[nodiscard]] Box3 bounds(double level) const override;

  /// Signs of all nodes are found at once, distances when a row is asked for. The sign of a node is the same for every
  /// band, and that of value() where `field_from_grid` only scales and shifts. REQUIRES: the map can be inverted.
  [[nodiscard]] std::unique_ptr<Prepared> prepare(const Grid& grid, const Affine& field_from_grid, double band,
                                                  const RunOptions& run) const override;

  [[nodiscard]] std::uint64_t bytes() const override;
  [[nodiscard]] std::uint64_t prepared_bytes(const Grid& grid) const override;

 private:
  explicit MeshField(std::shared_ptr<const SignedMesh> mesh);
  std::shared_ptr<const SignedMesh> mesh_;
};

}  // namespace meso::implicit
