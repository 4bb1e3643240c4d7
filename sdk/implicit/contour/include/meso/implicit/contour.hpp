// SPDX-License-Identifier: Apache-2.0
#pragma once
// From samples on a grid to the closed surface around the inside, in constant memory.
//
//   TriangleMesh mesh;
//   MemoryMeshSink sink(mesh);   // or a file: make_mesh_writer() in exporters/mesh
//   const std::optional<ContourReport> report = contour(*source, sink, {}, run, diagnostics);
//
// Marching cubes in two passes that evaluate each sample once: vertices, then triangles. The surface is closed, its
// edges lie in two triangles each, triangles face outward, and none is degenerate. Where the inside reaches the box,
// the surface runs exactly in the box's planes. Vertices stand on edges of the grid, where the linear interpolant of
// the two samples is zero; volume and area converge with the square of the spacing. Samples without a value are
// outside.
//
// Equal bytes for any number of threads. Memory: some planes of samples a thread, and 2 bytes for every x-crossing.
// Errors: LIMIT_GRID, LIMIT_GRID_MEMORY, LIMIT_VERTICES, LIMIT_TIME, CANCELLED. A sink that failed is reported by its
// owner, not here. An empty surface is a result. Thread rule: blocks; uses `jobs` threads, at most as many as TBB has.

#include <cstdint>
#include <optional>

#include "meso/base/diagnostic.hpp"
#include "meso/base/mesh_sink.hpp"
#include "meso/base/run_options.hpp"
#include "meso/implicit/grid_source.hpp"

namespace meso::implicit {

struct ContourOptions {
  /// Moves every vertex along its edge to within 1e-6 of the edge's length of where the field itself is zero, by about
  /// six more evaluations of the field each.
  bool polish = false;
  /// The step of the coordinates as they are written, where that is coarse: polished vertices keep two such steps away
  /// from the grid's nodes, lest rounding folds up the triangles around one. In the grid's unit; floats: the step of
  /// the largest coordinate.
  double coordinate_step = 0;
  /// Edges and corners of the solid become edges and corners of the mesh (extended marching cubes, Kobbelt et al.
  /// 2001): where surfaces meet in a cell at more than 25 degrees, a vertex stands where they meet. Polishes, too.
  bool sharp = false;
  /// Collapses edges shorter than a quarter of the spacing where neither the shape nor the box's planes suffer, which
  /// removes slivers. Holds the mesh in memory: about 120 bytes a triangle; 2 us each.
  bool collapse_slivers = false;
};

struct ContourReport {
  std::uint64_t points = 0, triangles = 0;
  std::int64_t euler = 0;       ///< points - edges + triangles
  std::uint64_t undefined = 0;  ///< crossed edges one end of which has no value
  std::uint64_t inside = 0;     ///< nodes
  double seconds = 0;

  /// Twice the volume over the area, in grid cells, as the nodes tell: of random directions, a surface crosses 1.5
  /// edges for each of its cells. About right from half a cell on; broken walls and struts have less than 1.
  [[nodiscard]] double cells_thick() const {
    return points > 0 ? 3 * static_cast<double>(inside) / static_cast<double>(points) : 0;
  }
};

/// Whether a grid has few enough nodes, and the budget room for it: what contour() asks first. To be asked before
/// compile(), which holds tables as long as the grid.
[[nodiscard]] bool check_grid(const Grid& grid, const RunOptions& run, DiagnosticSink& diagnostics);

[[nodiscard]] std::optional<ContourReport> contour(const GridSource& source, MeshSink& sink,
                                                   const ContourOptions& options, const RunOptions& run,
                                                   DiagnosticSink& diagnostics);

}  // namespace meso::implicit
