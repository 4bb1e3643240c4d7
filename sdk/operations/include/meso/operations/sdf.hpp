// SPDX-License-Identifier: Apache-2.0
#pragma once
// A program of the command language (docs/sdf.md) carried out: field, box, grid, mesh, file.
//
//   const std::vector<std::string> words{"-s", "60^3", "tpms.gyroid", "-o", "gyroid.ply"};
//   const auto program = sdf::parse_program(sdf::words_of_arguments(words), {.read_text = operations::read_text},
//   sink); const auto report = operations::run_sdf(*program, {.measure = true}, sink); report->measures->volume   //
//   about 4
//
// Output files appear whole or not at all. An empty solid is a file without triangles, and SDF_EMPTY; samples too far
// apart for the solid are SDF_THIN_WALL or SDF_COARSE, coordinates too large for floats SDF_FAR, all warnings. Thread
// rule: calls are independent of each other; each uses RunOptions::jobs threads.

#include <optional>
#include <string>

#include "meso/base/output_file.hpp"
#include "meso/base/run_options.hpp"
#include "meso/implicit/grid.hpp"
#include "meso/operations/mesh_accuracy.hpp"
#include "meso/operations/mesh_measures.hpp"
#include "meso/sdf/program.hpp"

namespace meso::operations {

struct SdfOptions {
  /// Volume, area, pieces: about as much work again, and 36 bytes of memory a vertex; and a quarter of all for what
  /// half as many samples along each axis say.
  bool measure = false;
  bool strict_math = false;         ///< formulas as written, none regrouped
  bool polish = false;              ///< vertices on the surface itself, not on the samples' interpolant
  bool no_slivers = false;          ///< very narrow triangles collapsed
  bool sharp = false;               ///< edges and corners of the solid are edges and corners of the mesh
  double tolerance = 0;             ///< if positive: the mesh is at most so far from the surface; picks the grid
  double simplify = 0;              ///< if positive: as few triangles as stay so close to the surface
  bool double_coordinates = false;  ///< not of .stl, which has floats only
  bool ascii = false;               ///< of .stl
  ExistingFile existing = ExistingFile::replace;
  RunOptions run{};
};

struct SdfReport {
  implicit::Grid grid;
  std::uint64_t points = 0, triangles = 0;
  std::int64_t euler = 0;
  std::uint64_t bytes = 0;
  /// Of the mesh as it was written. Components and cavities hold at least a cell of the grid.
  std::optional<MeshMeasures> measures;
  /// What the measures tend to as samples are added: where the solid is smooth, errors go with the square of the
  /// spacing, and here with its fourth power. Nothing for a few samples or an empty solid.
  struct Limit {
    double volume = 0, area = 0;
  };
  std::optional<Limit> extrapolated;
  std::optional<MeshAccuracy> accuracy;  ///< of `tolerance` and `simplify`
  struct {
    double read = 0, contour = 0, extrapolate = 0, total = 0;
  } seconds;  ///< wall-clock; contouring includes writing
};

[[nodiscard]] std::optional<SdfReport> run_sdf(const sdf::Program& program, const SdfOptions& options,
                                               DiagnosticSink& sink);

/// What is contoured.
[[nodiscard]] std::optional<Box3> sdf_box(const sdf::Program& program, const RunOptions& run, DiagnosticSink& sink);

/// What programs include is read so.
[[nodiscard]] sdf::ProgramOptions::Text read_text(const std::string& path);

}  // namespace meso::operations
