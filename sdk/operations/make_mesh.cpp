// SPDX-License-Identifier: Apache-2.0
#include "make_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "built_field.hpp"
#include "file_extension.hpp"
#include "measured_mesh_sink.hpp"
#include "mesh_grid.hpp"
#include "mesh_warnings.hpp"
#include "meso/base/memory_mesh_sink.hpp"
#include "meso/base/number.hpp"
#include "meso/eval/cell_fit.hpp"
#include "meso/export_mesh/mesh_writer.hpp"
#include "meso/implicit/accurate_mesh.hpp"
#include "meso/implicit/compile.hpp"
#include "meso/implicit/contour.hpp"
#include "meso/implicit/surface_edges.hpp"
#include "meso/operations/macrostructure_distance.hpp"
#include "meso/package/open_document.hpp"
#include "stopwatch.hpp"

namespace meso::operations {
namespace fs = std::filesystem;
namespace {

/// Of what samples as far apart as these do not show.
void warn_of_samples(const BuiltField& built, const MakeOptions& options, const ConvertReport& report,
                     DiagnosticSink& sink) {
  if (report.mesh) warn_of_cavities(*report.mesh, sink);
  if (built.words && warn_of_period(*built.words, report.spacing_mm, sink)) return;
  double samples = 1;
  for (const std::int32_t n : report.grid_nodes) samples *= n;
  const bool is_told = built.smallest_feature_mm < 2 * report.spacing_mm && !options.tolerance_mm;
  if (!is_told && warn_of_thinness(report.thickness_mm, {samples, report.spacing_mm}, sink)) return;
  constexpr double promised = 0.002;
  const double finer = built.density_spacing_mm, times = report.spacing_mm / finer;
  if (options.tolerance_mm || !(times > 1.02)) return;
  const double percent = std::min(100.0, 100 * promised * times * times);
  sink.report(
      {.code = Code::density_below_spacing,
       .args = {built.names, significant(percent, 2), significant(report.spacing_mm, 3), significant(finer, 2)}});
}

/// Streams from the grid; or, from a tolerance or simplified, by way of a mesh in memory. Tells the report.
bool stream_mesh(const BuiltField& built, const implicit::Grid& grid, const MakeOptions& options, MeshSink& into,
                 ConvertReport& report, DiagnosticSink& sink) {
  const auto source_on = [&](const implicit::Grid& on) {
    return implicit::compile(built.field.term(), on, {}, options.run, sink);
  };
  const auto tell = [&](const implicit::Grid& used, std::uint64_t triangles) {
    report.grid_nodes = used.nodes;
    report.spacing_mm = std::max({used.spacing(0), used.spacing(1), used.spacing(2)});
    report.triangles = triangles;
  };
  if (!options.tolerance_mm && !options.simplify_mm) {
    const auto source = implicit::check_grid(grid, options.run, sink) ? source_on(grid) : nullptr;
    const auto contoured =
        source ? implicit::contour(*source, into,
                                   {.coordinate_step = implicit::float_step(grid.box), .sharp = options.sharp},
                                   options.run, sink)
               : std::nullopt;
    if (!contoured) return false;
    tell(grid, contoured->triangles);
    report.thickness_mm = contoured->cells_thick() * report.spacing_mm;
    return true;
  }
  const double feature = std::isfinite(built.smallest_feature_mm) ? built.smallest_feature_mm : 0;
  const double tolerance = options.tolerance_mm.value_or(0);
  const bool sharp = options.tolerance_mm ? implicit::may_have_edges(built.field.term(), grid.box) : options.sharp;
  const auto made = implicit::make_accurate_mesh(source_on, grid,
                                                 {.tolerance = tolerance,
                                                  .simplify = options.simplify_mm.value_or(0),
                                                  .smallest_feature = feature,
                                                  .sharp = sharp},
                                                 options.run, sink);
  if (!made) return false;
  if (feature > 0 && feature < tolerance)
    sink.report({.code = Code::feature_below_tolerance,
                 .args = {built.names, format_number(feature) + " mm", format_number(tolerance) + " mm"}});
  tell(made->grid, made->mesh.triangles.size());
  report.thickness_mm = thickness_of(made->mesh);
  report.accuracy = {
      .distance = made->distance, .grid_samples = made->grid_samples, .surface_samples = made->surface_samples};
  return write_mesh(made->mesh, into);
}

/// Into a file, measured on the way if that is asked for.
bool write_mesh_file(const BuiltField& built, const eval::Evaluation& evaluation, const implicit::Grid& grid,
                     const fs::path& out, const MakeOptions& options, const WriteOptions& write, ConvertReport& report,
                     DiagnosticSink& sink) {
  auto file = OutputFile::create(out.string(), write.no_clobber ? ExistingFile::refuse : ExistingFile::replace, sink);
  if (!file) return false;
  const MeshFormat format = *mesh_format_of(out.string());
  const auto writer = make_mesh_writer(write.ascii ? MeshFormat::stl_ascii : format, *file);
  MeasuredMeshSink<float> measured(*writer);
  const std::size_t errors = sink.error_count();
  const bool made =
      stream_mesh(built, grid, options, options.measure ? static_cast<MeshSink&>(measured) : *writer, report, sink);
  if (made && report.triangles == 0) {  // what stands at `out` stays
    sink.report(told_of_empty(built, evaluation));
    return false;
  }
  if (sink.error_count() > errors || !file->commit(sink) || !made) return false;
  const double cell = report.spacing_mm * report.spacing_mm * report.spacing_mm;
  if (options.measure) report.mesh = measured.measures(cell);
  std::error_code error;
  const auto bytes = fs::file_size(out, error);
  report.bytes = error ? 0 : bytes;
  return true;
}

}  // namespace

std::optional<eval::Evaluation> open_document(const fs::path& document, const MakeOptions& options, Seconds& seconds,
                                              DiagnosticSink& sink) {
  Stopwatch watch;
  const auto checked = open_checked_document(document, options.run, sink);
  seconds.read = watch.lap();
  auto evaluation = checked
                        ? eval::Evaluation::make(*checked,
                                                 {.overrides = options.overrides,
                                                  .run = options.run,
                                                  .distance = macrostructure_distance(options.overrides, options.run)},
                                                 sink)
                        : std::nullopt;
  if (evaluation) eval::warn_of_misfits(*evaluation, sink);
  seconds.evaluate = watch.lap();
  return evaluation;
}

std::optional<ConvertReport> make_mesh(const eval::Evaluation& evaluation, const fs::path& out,
                                       const MakeOptions& options, const WriteOptions& write, DiagnosticSink& sink) {
  Stopwatch watch;
  const auto built = built_field(evaluation, options, sink);
  if (!built) return std::nullopt;
  const auto grid = mesh_grid(evaluation, options, built->field.bounds(), built->smallest_feature_mm, sink);
  if (!grid) return std::nullopt;
  ConvertReport report{.engine = "implicit", .way = "field", .cells = built->cells, .closed = true};
  report.seconds.realise = watch.lap();
  // To a tolerance, what is told helps most before the work is done.
  const bool is_streamed = !options.tolerance_mm && !options.simplify_mm;
  DiagnosticSink told;
  const bool made = write_mesh_file(*built, evaluation, *grid, out, options, write, report, is_streamed ? told : sink);
  pass_on_of_grid(told, evaluation, options, sink);
  if (!made) return std::nullopt;
  report.seconds.write = watch.lap();
  warn_of_clamped(*built, grid->box, sink);
  warn_of_samples(*built, options, report, sink);
  report.seconds.total = watch.total();
  return report;
}

}  // namespace meso::operations
