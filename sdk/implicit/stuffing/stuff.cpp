// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "fill.hpp"
#include "rims.hpp"
#include "signs.hpp"

namespace meso::implicit {
namespace {

using stuffing::Cut;
using stuffing::Points;

bool fits(const BccLattice& lattice, std::uint64_t bytes, const char* purpose, const RunOptions& run,
          DiagnosticSink& sink) {
  const std::uint64_t points = stuffing::point_count(lattice);
  if (!fits_memory(std::to_string(points), bytes, purpose, run, sink)) return false;
  constexpr std::uint64_t most_points = (std::uint64_t{1} << 31) - 1;  // they and cuts are numbered in 32 bits
  if (points <= most_points) return true;
  sink.report(
      {.code = Code::limit_grid, .args = {std::to_string(points), "its axes together", std::to_string(most_points)}});
  return false;
}

/// Six tetrahedra of the lattice for each point inside, and about five where an edge is cut; each twice while layers
/// are joined, and the faces of the boundary while they are sorted.
std::uint64_t mesh_bytes(const Points& points, std::uint64_t cuts) {
  std::uint64_t inside = 0;
  for (std::uint32_t id = 0; id < points.count(); ++id) inside += points.sign(id) == stuffing::Sign::inside ? 1 : 0;
  const std::uint64_t tets = 6 * inside + 5 * cuts;
  return tets * 2 * sizeof(stuffing::RawTet) + (inside + cuts) * sizeof(Vec3) + cuts * (sizeof(Cut) + 200);
}

}  // namespace

std::optional<TetMesh> stuff(const BccLattice& lattice, const GridSource& corners, const GridSource& centres,
                             const RunOptions& run, DiagnosticSink& sink) {
  const std::uint64_t lattice_bytes = stuffing::point_count(lattice) * Points::bytes_per_point;
  if (!fits(lattice, lattice_bytes, "its lattice", run, sink)) return std::nullopt;
  Threads threads(run);
  const auto stopped = [&]() -> std::optional<TetMesh> {
    threads.report_stop(sink);
    return std::nullopt;
  };
  Points points(lattice);
  if (!sample_signs(points, corners, centres, threads)) return stopped();
  const std::uint64_t crossings = points.count_crossings();
  if (!fits(lattice, lattice_bytes + mesh_bytes(points, crossings), "its tetrahedra", run, sink)) return std::nullopt;
  std::vector<Cut> cuts(crossings);
  if (!find_cuts(points, corners, cuts, threads)) return stopped();
  const auto moved = warp(points, cuts);
  if (!threads.go_on()) return stopped();
  auto tets = fill(points, threads);
  if (!tets) return stopped();
  stuffing::Numbered numbered = number_points(std::move(*tets), points, cuts, moved);
  if (!threads.go_on()) return stopped();
  if (!stuffing::move_to_rims(numbered, lattice, corners, threads)) return stopped();
  find_boundary(numbered, lattice.box);
  return threads.go_on() ? std::optional(std::move(numbered.mesh)) : stopped();
}

TetQuality tet_quality(const TetMesh& mesh) {
  TetQuality quality;
  double least = 1, greatest = -1;  // cosines
  for (const auto& t : mesh.tets) {
    const Vec3 o = mesh.points[t[0]], a = mesh.points[t[1]] - o, b = mesh.points[t[2]] - o, c = mesh.points[t[3]] - o;
    quality.volume += dot(cross(a, b), c) / 6;
    // Outward, one for each face; the angle between two faces is what their normals lack to half a turn.
    std::array<Vec3, 4> normal{cross(b - a, c - a), cross(c, b), cross(a, c), cross(b, a)};
    for (Vec3& n : normal) n = n / norm(n);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine = -dot(normal[i], normal[j]);
        least = std::min(least, cosine);
        greatest = std::max(greatest, cosine);
      }
  }
  if (mesh.tets.empty()) return quality;
  quality.min_dihedral = std::acos(std::min(1.0, greatest));
  quality.max_dihedral = std::acos(std::max(-1.0, least));
  return quality;
}

}  // namespace meso::implicit
