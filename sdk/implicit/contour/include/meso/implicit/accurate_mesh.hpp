// SPDX-License-Identifier: Apache-2.0
#pragma once
// A mesh as close to the surface of a field as is asked for, instead of from a given number of samples; and one of
// fewer triangles that stays as close.
//
//   const auto on = [&](const Grid& grid) { return compile(term, grid, {}, run, diagnostics); };
//   auto made = make_accurate_mesh(on, Grid{.box = box}, {.tolerance = 0.02}, run, diagnostics);
//   made->distance <= 0.02
//
// Distances are measured: at vertices, up to seven points of edges and thirteen of triangles, along the field's
// gradient to where it is zero; and from creases of the surface to the mesh. The grid has only to tell what is
// connected to what: it starts coarse and is made finer until nearly all of the mesh is near the surface. What is still
// too far is refined on the surface itself, where edges are halved; that keeps the mesh closed. `smallest_feature`,
// where it is known, says how coarse the first grid may be; what is thinner than the grid's spacing and hits no sample
// is not seen.
//
// Without `sharp`, the surface is taken to be smooth: normals at vertices then tell most of the distances, which takes
// a fifth of the samples; at a few places they are checked.
//
// The mesh is held in memory: some 160 bytes a triangle. Same bytes for any number of threads.
// Errors: those of contour(), and LIMIT_TOLERANCE with what it would take; for a process that ends for want of memory
// before this can be returned, foreseen_memory() has it. Warnings: TOLERANCE_NOT_REACHED, SIMPLIFY_FROM_COARSE. For
// information, before work of seconds or more: TOLERANCE_TAKES.

#include <functional>

#include "meso/base/triangle_mesh.hpp"
#include "meso/implicit/contour.hpp"

namespace meso::implicit {

struct AccurateMeshOptions {
  double tolerance = 0;         ///< positive: chooses the grid; else the grid is the one that is given
  double simplify = 0;          ///< positive: as few triangles as stay so close
  double smallest_feature = 0;  ///< 0: not known
  bool sharp = true;            ///< see ContourOptions; may_have_edges() tells when it is needed
};

struct AccurateMesh {
  TriangleMesh mesh;
  Grid grid;
  std::int64_t euler = 0;
  double distance = 0;
  std::uint64_t grid_samples = 0;     ///< at nodes of all grids that were tried
  std::uint64_t surface_samples = 0;  ///< at points beside the surface
};

/// Samples of the field on a grid; empty after a diagnostic.
using SourceOn = std::function<std::unique_ptr<GridSource>(const Grid&)>;

[[nodiscard]] std::optional<AccurateMesh> make_accurate_mesh(const SourceOn& source_on, const Grid& grid,
                                                             const AccurateMeshOptions& options, const RunOptions& run,
                                                             DiagnosticSink& diagnostics);

}  // namespace meso::implicit
