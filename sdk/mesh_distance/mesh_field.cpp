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

/// The triangles themselves 72, boxes and nodes while the tree grows about 90, or the edges of a mesh to mend; and 24
/// of the mesh that is read.
constexpr std::uint64_t bytes_per_triangle = 240;

/// Parts that overlap, or shells within a body that do not face its inside.
void find_buried(const TriangleTree& tree, MeshQuality& quality) {
  constexpr std::size_t most = 2000;
  const std::span<const Triangle> triangles = tree.triangles();
  const std::size_t step = (triangles.size() + most - 1) / most;
  for (std::size_t t = 0; quality.closed && t < triangles.size(); t += step) {
    const auto& [a, b, c] = triangles[t];
    const Vec3 normal = cross(b - a, c - a), middle = (a + b + c) / 3;
    const double size = std::sqrt(norm(normal));
    if (!(size > 0)) continue;
    const Vec3 beside = (1e-6 * size / norm(normal)) * normal;
    const Winding front = tree.winding(middle + beside), back = tree.winding(middle - beside);
    ++quality.looked_at;
    const bool off_surface = !front.on_surface && !back.on_surface;
    if (off_surface && front.number != 0 && back.number != 0) ++quality.buried;
  }
}

void report_stop(const RunOptions& options, const std::string& name, DiagnosticSink& sink) {
  sink.report({.code = options.out_of_time() ? Code::limit_time : Code::cancelled, .where = {.file = name}});
}

}  // namespace

std::shared_ptr<const MeshField> MeshField::make(const TriangleMesh& mesh, const std::string& name,
                                                 const RunOptions& options, DiagnosticSink& sink) {
  if (mesh.triangles.size() >
      std::min<std::uint64_t>(options.max_memory_bytes / bytes_per_triangle, Placed::most_triangles)) {
    sink.report({.code = Code::mesh_memory,
                 .where = {.file = name},
                 .args = {std::to_string(mesh.triangles.size()), mebibytes(mesh.triangles.size() * bytes_per_triangle),
                          mebibytes(options.max_memory_bytes)}});
    return {};
  }
  StopPoll stop(options);
  std::shared_ptr<const SignedMesh> made;
  with_jobs(options, [&] {
    std::optional<CleanMesh> clean = clean_mesh(mesh, name, stop, sink);
    if (!clean) return;
    TriangleTree tree(std::move(clean->triangles), clean->box, stop);
    if (stop.stopped()) return;
    find_buried(tree, clean->quality);
    made = std::make_shared<SignedMesh>(std::move(tree), clean->quality);
  });
  if (stop.stopped()) report_stop(options, name, sink);
  if (!made) return {};
  if (const MeshQuality& q = made->quality(); q.buried > 0) {
    sink.report({.code = Code::mesh_overlaps,
                 .where = {.file = name},
                 .args = {std::to_string(q.buried), std::to_string(q.looked_at)}});
  }
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

std::uint64_t MeshField::bytes() const { return mesh_->bytes(); }

std::uint64_t MeshField::prepared_bytes(const Grid& grid) const {
  // Where rows begin, four crossings in each, found and then sorted; blocks near the surface.
  const std::uint64_t rows = std::uint64_t(grid.nodes[1]) * std::uint64_t(grid.nodes[2]);
  std::uint64_t bytes = rows * (8 + 4 * 24) + grid.node_count() / 64;
  // Triangles that are turned for the other two axes, and two bits a node.
  if (!quality().closed) bytes += mesh_->tree().triangles().size_bytes() + grid.node_count() / 4;
  return bytes;
}

std::unique_ptr<ExternalField::Prepared> MeshField::prepare(const Grid& grid, const Affine& field_from_grid,
                                                            double band, const RunOptions& run) const {
  return prepare_mesh(mesh_, grid, field_from_grid, band, run);
}

}  // namespace meso::implicit
