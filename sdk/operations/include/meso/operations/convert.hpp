// SPDX-License-Identifier: Apache-2.0
#pragma once
// From a document to a file of geometry: the whole way in one call.
//
//   DiagnosticSink sink;
//   const auto made = operations::make_body("ibeam.meso", {}, sink);
//   if (made) operations::write_body(*made, "ibeam.step", {}, sink);
//   const auto report = operations::convert("ibeam.meso", "ibeam.stl", {}, sink);   // both, with measures
//
// The extension of the output decides the format: .step .stp .brep of exact bodies, .stl .ply .obj .off .vtk of
// triangles. Output files appear whole or not at all. Two engines make triangles: the exact one from its bodies, the
// implicit one from a field on a grid of samples; `automatic` takes the exact one where it can make the part.
// Lengths in millimetres, angles in radians. Thread rule: calls are independent of each other.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meso/base/run_options.hpp"
#include "meso/base/triangle_mesh.hpp"
#include "meso/brep/measure.hpp"
#include "meso/brep/realise.hpp"
#include "meso/eval/evaluation.hpp"
#include "meso/operations/mesh_accuracy.hpp"
#include "meso/operations/mesh_measures.hpp"

namespace meso::operations {

enum class Engine { automatic, brep, implicit };

struct MakeOptions {
  std::vector<eval::Override> overrides{};
  std::string part{};                     ///< empty: the document's build
  bool mesh = false;                      ///< triangles wanted
  std::optional<double> deflection_mm{};  ///< absent: the document's, else 0.02 times the smallest cell edge, else
                                          ///< 0.001 times the body's diagonal
  std::optional<double> angle_rad{};      ///< absent: the document's, else 0.5
  Engine engine = Engine::automatic;
  // Of the implicit engine. Absent: the document's samples, else a fifth of the smallest feature.
  std::optional<double> spacing_mm{};
  std::vector<double> samples{};         ///< one number for all, or three; instead of a spacing
  bool measure = false;                  ///< volume, area and pieces of the mesh: about half as much work again
  bool sharp = false;                    ///< edges and corners of the solid are edges and corners of the mesh
  std::optional<double> tolerance_mm{};  ///< largest distance of the mesh from the surface; picks the grid
  std::optional<double> simplify_mm{};   ///< as few triangles as stay so close to the surface
  RunOptions run{};
};

/// Wall-clock seconds of the stages.
struct Seconds {
  double read = 0, evaluate = 0, realise = 0, write = 0, total = 0;
};

struct Made {
  eval::Evaluation evaluation;
  brep::Realisation realisation;
  double deflection_mm = 0, angle_rad = 0;
  Seconds seconds;
};

/// Reads, validates, evaluates and realises. An empty body is a diagnostic.
[[nodiscard]] std::optional<Made> make_body(const std::filesystem::path& document, const MakeOptions& options,
                                            DiagnosticSink& sink);

struct WriteOptions {
  bool ascii = false;  ///< STL only
  bool no_clobber = false;
  RunOptions run{};  ///< deadline and cancellation
};
struct Written {
  std::uint64_t bytes = 0;
  std::uint64_t triangles = 0;
};
[[nodiscard]] std::optional<Written> write_body(const brep::Body& body, const std::filesystem::path& file,
                                                const WriteOptions& options, DiagnosticSink& sink);

/// False for .step .stp .stl, which are geometry already.
[[nodiscard]] bool is_document(const std::filesystem::path& file);

[[nodiscard]] bool is_step_file(const std::filesystem::path& file);

/// True for the extensions that need triangles; empty for extensions nothing writes.
[[nodiscard]] std::optional<bool> output_needs_mesh(const std::filesystem::path& file);

struct ConvertReport {
  std::string engine = "brep";
  std::string way;  ///< how the engine built the body: lattice, voids, boolean, direct
  brep::CellCounts cells;
  brep::ClipCounts clip;
  brep::Measures measures;
  std::uint64_t fragments = 0;  ///< loose ones; those that the document drops are not in the file
  std::uint64_t dropped_fragments = 0;
  std::uint64_t triangles = 0, bytes = 0;
  double triangles_volume = 0;  ///< what a file of triangles encloses; `measures` are those of the exact body
  bool closed = false;
  double deflection_mm = 0, angle_rad = 0;
  // Of the implicit engine: its grid, and instead of `measures` those of the mesh if they are asked for.
  std::array<std::int32_t, 3> grid_nodes{};
  double spacing_mm = 0;
  double thickness_mm = 0;  ///< twice the volume over the area, about; 0: not known
  std::optional<MeshMeasures> mesh;
  std::optional<MeshAccuracy> accuracy;  ///< of a tolerance or a simplified mesh
  Seconds seconds;
};
[[nodiscard]] std::optional<ConvertReport> convert(const std::filesystem::path& in, const std::filesystem::path& out,
                                                   MakeOptions options, const WriteOptions& write,
                                                   DiagnosticSink& sink);

}  // namespace meso::operations
