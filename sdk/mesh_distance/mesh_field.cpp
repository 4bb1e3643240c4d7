// SPDX-License-Identifier: Apache-2.0
#include "meso/mesh_distance/mesh_field.hpp"

#include <algorithm>
#include <limits>

#include "clean_mesh.hpp"
#include "prepared_mesh.hpp"
#include "signed_mesh.hpp"
#include "spatial_order.hpp"

namespace meso::implicit {
namespace {

/// The triangles themselves 72, boxes and nodes while the tree grows about 80, or the edges of a mesh to mend.
constexpr std::uint64_t bytes_per_triangle = 220;

void report_stop(const RunOptions& options, const std::string& name, DiagnosticSink& sink) {
  sink.report({.code = options.out_of_time() ? Code::limit_time : Code::cancelled, .where = {.file = name}});
}

}  // namespace

std::shared_ptr<const MeshField> MeshField::make(const TriangleMesh& mesh, const std::string& name,
                                                 const RunOptions& options, DiagnosticSink& sink) {
  if (mesh.triangles.size() >
      std::min<std::uint64_t>(options.max_memory_bytes / bytes_per_triangle, Placed::most_triangles)) {
    const std::uint64_t mib = mesh.triangles.size() * bytes_per_triangle >> 20;
    sink.report({.code = Code::limit_memory, .where = {.file = name}, .args = {std::to_string(mib) + " MiB"}});
    return {};
  }
  StopPoll stop(options);
  std::shared_ptr<const SignedMesh> made;
  with_jobs(options, [&] {
    std::optional<CleanMesh> clean = clean_mesh(mesh, name, stop, sink);
    if (!clean) return;
    TriangleTree tree(std::move(clean->triangles), clean->box, stop);
    if (!stop.stopped()) made = std::make_shared<SignedMesh>(std::move(tree), clean->quality);
  });
  if (stop.stopped()) report_stop(options, name, sink);
  if (!made) return {};
  return std::shared_ptr<const MeshField>(new MeshField(std::move(made)));
}

MeshField::MeshField(std::shared_ptr<const SignedMesh> mesh) : mesh_(std::move(mesh)) {}
MeshField::~MeshField() = default;

const MeshQuality& MeshField::quality() const { return mesh_->quality(); }

Vec3 MeshField::closest_point(Vec3 p) const { return p + mesh_->tree().nearest(p).offset; }

double MeshField::value(Vec3 p) const { return mesh_->value(p); }

Interval MeshField::interval(const Box3& box) const {
  const Vec3 middle = 0.5 * box.min + 0.5 * box.max;
  const double reach = norm(box.max - middle) * (1 + 1e-12);
  if (!(reach < HUGE_VAL)) return {};
  const double f = value(middle), slack = 1e-12 * std::abs(f);
  if (quality().closed) return {f - reach - slack, f + reach + slack};
  const double most = std::abs(f) + reach + slack;
  return {-most, most};
}

double MeshField::lipschitz() const { return quality().closed ? 1 : HUGE_VAL; }

Box3 MeshField::bounds(double level) const {
  // A point as deep inside a closed surface is that far from its box; an open one may have it on the box.
  if (!quality().closed) level = std::max(level, 0.0);
  Box3 box = mesh_->tree().box();
  for (std::size_t i = 0; i < 3; ++i) {
    box.min[i] -= level;
    box.max[i] += level;
  }
  const bool empty = box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z;
  return empty ? Box3{} : box;
}

std::unique_ptr<ExternalField::Prepared> MeshField::prepare(const Grid& grid, const Affine& field_from_grid,
                                                            double band, const RunOptions& run) const {
  return prepare_mesh(mesh_, grid, field_from_grid, band, run);
}

}  // namespace meso::implicit
